"""How the driver judges what it sees: whether a leg has ended, and at which end to begin a look around."""

from reasoned_explorer.model import LegOutcome
from reasoned_explorer.vehicles.control.legs import LegWatch
from reasoned_explorer.vehicles.mavlink.pace import Moment
from reasoned_explorer.vehicles.mavlink.telemetry import Telemetry

#: How texts begin that say that the machine has run into something: ArduPilot's, and the served autopilot's.
_CRASHES = ("Crash", "Collision")
#: Slower than this a machine that turns only afterwards stands, metres a second.
_STANDING_MPS = 0.05


def crash_told(told: Telemetry, since: int) -> str:
    """Return what the autopilot says that the machine ran into, or nothing.

    Args:
        told: What it says.
        since: How many texts had come before.
    """
    fresh = told.texts[-(told.texts_seen - since) :] if told.texts_seen > since else ()
    return next((text.partition(": ")[2] or text for text in fresh if text.startswith(_CRASHES)), "")


def ending(watch: LegWatch, moment: Moment, *, limit_s: float, turns_later: bool) -> tuple[LegOutcome, str] | None:
    """Return how a leg has ended by where the machine is; None while it goes on.

    Args:
        watch: Of the leg.
        moment: The last one.
        limit_s: How long the leg may take.
        turns_later: Whether the machine faces its heading only when it is there.
    """
    if moment.is_busy is False:
        is_there = watch.is_there(moment)
        return (LegOutcome.ARRIVED, "") if is_there else (LegOutcome.STUCK, f"{watch.left_m:.1f} m short of the target")
    has_stopped = turns_later and watch.is_there(moment) and moment.speed_mps < _STANDING_MPS
    if watch.has_stood_there or has_stopped:
        return LegOutcome.ARRIVED, ""
    if watch.is_stuck:
        return LegOutcome.STUCK, "no progress"
    if watch.elapsed_s > limit_s:
        return LegOutcome.STUCK, "not there in three times the time that it should take"
    return None
