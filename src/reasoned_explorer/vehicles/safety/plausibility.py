"""Whether a pose follows from those before it: receivers jump and compasses are led astray."""

from typing import NamedTuple

from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_bearing_rad
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.cause import Cause
from reasoned_explorer.vehicles.safety.limits import SafetyLimits
from reasoned_explorer.vehicles.safety.telemetry import Telemetry

#: A machine that is told to go at a speed may be so much faster for a while.
_FASTER = 1.5
#: Longer gaps between two poses allow for no more way than this, and say nothing of turning, seconds.
_GAP_S = 1.0
#: A position may wander so fast while the machine stands, metres a second.
_WANDER_MPS = 0.02


class Finding(NamedTuple):
    """What is wrong: its kind, and in words."""

    cause: Cause
    reason: str


class Plausibility:
    """Follows poses. One that does not follow is not believed, nor what comes after, until it is as before.

    Args:
        profile: How fast the machine is.
        limits: How far off is too far.
    """

    def __init__(self, profile: VehicleProfile, limits: SafetyLimits) -> None:
        self._profile, self._limits = profile, limits
        self._last: Telemetry | None = None
        self._last_s = 0.0
        self._trouble: Finding | None = None

    @property
    def trouble(self) -> Finding | None:
        """What is wrong with the pose now."""
        return self._trouble

    def forget(self) -> None:
        """Believe whatever comes next: a person has seen to it."""
        self._last = self._trouble = None

    def begin(self, told: Telemetry, now_s: float) -> Finding | None:
        """Take in where the machine is before it sets off: it has stood, and may have turned to look."""
        at_s = now_s if told.t_s is None else told.t_s
        last = self._last
        if self._trouble is not None and last is not None:
            self._recover(last, told)
        elif last is not None:
            moved_m = last.pose.distance_to_m(told.pose.x_m, told.pose.y_m)
            if moved_m > self._limits.jump_m + _WANDER_MPS * max(0.0, at_s - self._last_s):
                self._trouble = Finding(Cause.POSITION, f"the position jumped by {moved_m:.1f} m while it stood")
        if self._trouble is None:
            self._last, self._last_s = told, at_s
        return self._trouble

    def see(self, told: Telemetry, now_s: float) -> Finding | None:
        """Take in where the machine is on its way; return what is wrong, if anything."""
        at_s, last = now_s if told.t_s is None else told.t_s, self._last
        if last is None:
            self._last, self._last_s = told, at_s
            return None
        if self._trouble is not None:
            self._recover(last, told)
            return self._trouble
        elapsed_s = at_s - self._last_s
        if elapsed_s <= 0.0:
            return None  # the same moment told again
        self._trouble = self._jumped(last.pose, told.pose, elapsed_s) or self._turned(last, told, elapsed_s)
        if self._trouble is None:
            self._last, self._last_s = told, at_s
        return self._trouble

    def _jumped(self, before: Pose, now: Pose, elapsed_s: float) -> Finding | None:
        moved_m = before.distance_to_m(now.x_m, now.y_m)
        possible_m = _FASTER * self._profile.speed_mps * min(elapsed_s, _GAP_S)
        if moved_m <= possible_m + self._limits.jump_m:
            return None
        return Finding(Cause.POSITION, f"the position jumped by {moved_m:.1f} m in {elapsed_s:.2f} s")

    def _turned(self, before: Telemetry, now: Telemetry, elapsed_s: float) -> Finding | None:
        if elapsed_s > _GAP_S:
            return None
        turned_rad = bearing_between_rad(_heading_rad(before), _heading_rad(now))
        limit_rad = self._limits.turn_off_rad
        if before.yaw_rate_radps is not None and now.yaw_rate_radps is not None:
            by_gyro_rad = 0.5 * (before.yaw_rate_radps + now.yaw_rate_radps) * elapsed_s
            off_rad = abs(normalise_bearing_rad(turned_rad - by_gyro_rad))
            against = "more than the gyro says"
        else:
            off_rad = abs(turned_rad) - _FASTER * self._profile.turn_rate_radps * elapsed_s
            against = "more than the machine can turn"
        if off_rad <= limit_rad:
            return None
        return Finding(Cause.COMPASS, f"the heading turned by {57.29578 * off_rad:.0f}° {against}")

    def _recover(self, believed: Telemetry, now: Telemetry) -> None:
        """Believe again what is where the last believed pose was: the machine has stood since."""
        near = believed.pose.distance_to_m(now.pose.x_m, now.pose.y_m) <= self._limits.jump_m
        turned_rad = abs(bearing_between_rad(_heading_rad(believed), _heading_rad(now)))
        if self._trouble is None:
            return
        if near and (self._trouble.cause is Cause.POSITION or turned_rad <= self._limits.turn_off_rad):
            self._trouble = self._last = None


def _heading_rad(told: Telemetry) -> float:
    """Return the heading that may be led astray: the compass's own, where there is one."""
    return told.pose.heading_rad if told.compass_rad is None else told.compass_rad
