"""What a machine knows of itself, as far as it does."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.vehicle import Vehicle

if TYPE_CHECKING:
    from reasoned_explorer.vehicles.positioning.verdict import PositionVerdict


@dataclass(frozen=True, slots=True)
class Telemetry:
    """A moment of a machine; None for what it does not tell.

    Attributes:
        pose: Where it believes to be now, also on the way.
        t_s: When that was so, on any clock of its own, seconds; equal for the same moment told twice.
        speed_mps: Over ground.
        yaw_rate_radps: Measured by a gyro, positive clockwise.
        link_age_s: Since it was last heard of; None also where nobody is listening now.
        position_age_s: Since its last believed fix.
        position: What its filter says of the position.
        battery: Share that is left, [0, 1].
        range_ahead_m: To what stands before it, in its heading.
        picture_age_s: Since its camera last gave a picture.
        compass_rad: The heading by its compass alone, where its filter may refuse that; None where the pose's is all.
    """

    pose: Pose
    t_s: float | None = None
    speed_mps: float | None = None
    yaw_rate_radps: float | None = None
    link_age_s: float | None = None
    position_age_s: float | None = None
    position: "PositionVerdict | None" = None
    battery: float | None = None
    range_ahead_m: float | None = None
    picture_age_s: float | None = None
    compass_rad: float | None = None


@runtime_checkable
class ReportsTelemetry(Protocol):
    """A vehicle that tells what it knows of itself."""

    def telemetry(self) -> Telemetry:
        """Return what is known now; must not wait."""


@runtime_checkable
class Halts(Protocol):
    """A vehicle that can be told to stand still whatever it is doing."""

    async def halt(self) -> None:
        """Stand still.

        Raises:
            PartError: If the link fails.
        """


@runtime_checkable
class Refreshes(Protocol):
    """A vehicle that is asked for its news while it stands; others hear of it all the time."""

    async def refresh(self) -> None:
        """Have `telemetry` and `pose` tell what is so now.

        Raises:
            PartError: If the link fails.
        """


#: What is read of a vehicle that has no `telemetry` but attributes of these names.
PLAIN = (
    "t_s",
    "speed_mps",
    "yaw_rate_radps",
    "link_age_s",
    "position_age_s",
    "battery",
    "range_ahead_m",
    "picture_age_s",
    "compass_rad",
)


def telemetry_of(vehicle: Vehicle) -> Telemetry:
    """Return what a vehicle tells of itself: by `telemetry`, else by plain attributes of the same names.

    What is no finite number there counts as not told.
    """
    if isinstance(vehicle, ReportsTelemetry):
        return vehicle.telemetry()
    told = {name: value for name in PLAIN if is_within(value := getattr(vehicle, name, None))}
    verdict = getattr(vehicle, "position", None)
    return Telemetry(vehicle.pose, position=verdict if hasattr(verdict, "is_good") else None, **told)
