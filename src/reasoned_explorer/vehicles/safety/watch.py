"""What a guard looks after while a machine moves, and before it does."""

import math
from collections.abc import Callable

from reasoned_explorer.geometry import Pose, bearing_between_rad, heading_towards_rad
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.area import AllowedGround, in_words
from reasoned_explorer.vehicles.safety.cause import Cause
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, stopping_m
from reasoned_explorer.vehicles.safety.plausibility import Finding, Plausibility
from reasoned_explorer.vehicles.safety.telemetry import Telemetry

RangeAhead = Callable[[Pose], float | None]
#: A range that the machine measures in its heading counts while it goes within this of its heading, radians.
_AHEAD_RAD = math.radians(30.0)
#: How far a height may be outside of the band before that counts, metres: what estimates err by.
_HEIGHT_M = 0.3
#: How much faster than allowed it may measure itself to be before that counts: gusts and noise.
_FASTER, _FASTER_MPS = 1.25, 0.3
#: How far a position may wander towards an edge on the way in, metres.
_NOISE_M = 0.1


class Watch:
    """Looks after one machine.

    Args:
        profile: What it can do.
        limits: What it may do.
        ground: Where it may be.
        range_ahead_m: Says how far something stands before a pose, in its heading; None for nothing in sight.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        limits: SafetyLimits,
        ground: AllowedGround,
        range_ahead_m: RangeAhead | None = None,
    ) -> None:
        self._profile, self._limits, self._ground = profile, limits, ground
        self._range_ahead_m = range_ahead_m
        self.plausibility = Plausibility(profile, limits)
        self._braking_mps2 = limits.braking_mps2 or profile.acceleration_mps2
        self._edge_m = 0.0
        self._set_off_s = 0.0

    def set_off(self, told: Telemetry, now_s: float) -> None:
        """Note that a leg begins."""
        clear_m, _ = self._ground.clearance(told.pose.x_m, told.pose.y_m)
        self._edge_m = min(0.5 * self._limits.margin_m, clear_m)
        self._set_off_s = now_s

    def standing(self, told: Telemetry, now_s: float) -> Finding | None:
        """Return what speaks against setting off, if anything."""
        return self._battery(told) or self.plausibility.begin(told, now_s) or self._position(told)

    def under_way(self, told: Telemetry, target: Pose, now_s: float) -> Finding | None:
        """Return why to stop, if anything."""
        return (
            self._link(told, now_s)
            or self.plausibility.see(told, now_s)
            or self._position(told)
            or self._obstacle(told, target)
            or self._edge(told, target)
            or self._height(told)
            or self._speed(told)
            or self._picture(told, now_s)
            or self._battery(told)
        )

    def _link(self, told: Telemetry, now_s: float) -> Finding | None:
        # What was not heard before the leg says nothing: nobody listens while the machine stands.
        age_s = None if told.link_age_s is None else min(told.link_age_s, now_s - self._set_off_s)
        if age_s is None or age_s <= self._limits.link_age_s:
            return None
        return Finding(Cause.LINK, f"nothing heard of the machine for {age_s:.1f} s")

    def _position(self, told: Telemetry) -> Finding | None:
        verdict = told.position
        if verdict is not None and not verdict.is_good:
            return Finding(Cause.POSITION, f"the position is {verdict.grade.value}: {verdict.reason}")
        if told.position_age_s is not None and told.position_age_s > self._limits.position_age_s:
            return Finding(Cause.POSITION, f"no fix for {told.position_age_s:.1f} s")
        return None

    def _obstacle(self, told: Telemetry, target: Pose) -> Finding | None:
        pose = told.pose
        left_m = pose.distance_to_m(target.x_m, target.y_m)
        if left_m <= 0.0:
            return None
        course_rad = heading_towards_rad(pose.x_m, pose.y_m, target.x_m, target.y_m)
        ranges = [] if self._range_ahead_m is None else [self._range_ahead_m(pose.facing(course_rad))]
        if abs(bearing_between_rad(pose.heading_rad, course_rad)) <= _AHEAD_RAD:
            ranges.append(told.range_ahead_m)
        near_m = min((each for each in ranges if each is not None and not math.isnan(each)), default=math.inf)
        gap_m, keep_m = near_m - self._profile.radius_m, self._limits.clearance_m
        if gap_m >= min(self._stopping_m(told), left_m) + keep_m:
            return None
        return Finding(Cause.OBSTACLE, f"something {near_m:.1f} m ahead")

    def _edge(self, told: Telemetry, target: Pose) -> Finding | None:
        pose = told.pose
        clear_m, cause = self._ground.clearance(pose.x_m, pose.y_m)
        if clear_m < self._edge_m - _NOISE_M:
            return Finding(cause, in_words(cause, clear_m))
        self._edge_m = min(0.5 * self._limits.margin_m, max(self._edge_m, clear_m))
        left_m = pose.distance_to_m(target.x_m, target.y_m)
        ahead_m = min(self._stopping_m(told), left_m)
        there = pose.facing(heading_towards_rad(pose.x_m, pose.y_m, target.x_m, target.y_m)).ahead(ahead_m)
        clear_m, cause = self._ground.clearance(there.x_m, there.y_m)
        return (
            None
            if clear_m >= min(0.0, self._edge_m)
            else Finding(cause, f"braking would end {in_words(cause, clear_m)}")
        )

    def _height(self, told: Telemetry) -> Finding | None:
        low_m, high_m = self._limits.lowest_m - _HEIGHT_M, self._limits.highest_m + _HEIGHT_M
        if not self._profile.flies or low_m <= told.pose.z_m <= high_m:
            return None
        return Finding(Cause.HEIGHT, f"at a height of {told.pose.z_m:.1f} m")

    def _speed(self, told: Telemetry) -> Finding | None:
        most_mps = self._limits.speed_mps
        if most_mps is None or told.speed_mps is None or told.speed_mps <= _FASTER * most_mps + _FASTER_MPS:
            return None
        return Finding(Cause.SPEED, f"at {told.speed_mps:.1f} m/s")

    def _picture(self, told: Telemetry, now_s: float) -> Finding | None:
        limit_s = self._limits.picture_age_s
        if limit_s is None or told.picture_age_s is None:
            return None
        age_s = min(told.picture_age_s, now_s - self._set_off_s)
        return None if age_s <= limit_s else Finding(Cause.CAMERA, f"no picture for {age_s:.1f} s")

    def _battery(self, told: Telemetry) -> Finding | None:
        if told.battery is None or told.battery >= self._limits.battery_low:
            return None
        return Finding(Cause.BATTERY, f"the battery is at {100.0 * told.battery:.0f} %")

    def _stopping_m(self, told: Telemetry) -> float:
        speed_mps = self._profile.speed_mps if told.speed_mps is None else told.speed_mps
        return stopping_m(speed_mps, braking_mps2=self._braking_mps2, reaction_s=self._limits.reaction_s)
