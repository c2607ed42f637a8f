"""Whether a machine stands where a mission begins."""

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError

#: A start that is typed is off by metres, a fix without corrections by more; another town is farther.
WITHIN_M = 50.0


def check_stands(part: str, here: Pose, start: Pose | None, *, within_m: float = WITHIN_M) -> None:
    """Check that a machine is where it is to start.

    Args:
        part: The machine's driver, for people.
        here: Where it believes to be.
        start: Where it is to start; None for anywhere.
        within_m: How far it may be from there, metres.

    Raises:
        PartError: If it is farther away.
    """
    if start is None:
        return
    off_m = here.distance_to_m(start.x_m, start.y_m)
    if not off_m <= within_m:
        far = f"{off_m:.0f} m" if off_m < 1e4 else f"{off_m / 1e3:.0f} km"
        raise PartError(part, f"the machine stands {far} from the start: see to --start, --world and where it is")
