"""What a guard is told of a machine behind MAVLink."""

from reasoned_explorer.vehicles.mavlink.autopilot import Autopilot
from reasoned_explorer.vehicles.mavlink.pace import Moment
from reasoned_explorer.vehicles.mavlink.telemetry import PositionQuality
from reasoned_explorer.vehicles.positioning.verdict import Grade, PositionVerdict
from reasoned_explorer.vehicles.safety.telemetry import Telemetry


def news(autopilot: Autopilot, moment: Moment, *, lived: bool) -> Telemetry:
    """Return what is known now.

    Ages are by the autopilot's own clock, as its messages tell it. Nobody listens to a machine whose time is held: then
    there is no age of the link, whoever asks it for something finds out.

    Args:
        autopilot: Who told it.
        moment: Where the machine is.
        lived: Whether its time passes by itself.
    """
    told = autopilot.telemetry
    # Up to when anything was last heard: what is silent after that is the link.
    now_s = told.boot_s + (max(0.0, told.heard_at_s - told.boot_at_s) if lived else 0.0)
    ages_s = [max(0.0, now_s - at_s) for at_s in (told.place_boot_s, told.fix_boot_s) if at_s is not None]
    return Telemetry(
        pose=moment.believed,
        t_s=told.boot_s,
        speed_mps=moment.speed_mps,
        yaw_rate_radps=moment.yaw_rate_radps,
        link_age_s=autopilot.silent_s if lived else None,
        position_age_s=max(ages_s, default=None),
        position=verdict_on(told.position, worst_error_m=autopilot.settings.worst_error_m),
        battery=told.battery.remaining,
        range_ahead_m=autopilot.range_ahead_m,
    )


def verdict_on(quality: PositionQuality, *, worst_error_m: float) -> PositionVerdict | None:
    """Return whether a machine may move by its autopilot's position; None where nothing is said of it.

    Args:
        quality: What is said.
        worst_error_m: The receiver may err by so much.
    """
    error_m, is_good = quality.horizontal_error_m, quality.filter_is_good
    if is_good is False:
        return PositionVerdict(Grade.POOR, "the autopilot's filter knows no position")
    if error_m is not None and error_m > worst_error_m:
        return PositionVerdict(Grade.POOR, f"the autopilot's receiver errs by {error_m:.1f} m")
    return None if is_good is None and error_m is None else PositionVerdict(Grade.GOOD)
