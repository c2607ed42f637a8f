"""Where a walking robot is: by a satellite receiver and its own senses, or by its own senses alone."""

import math
from collections.abc import AsyncGenerator
from dataclasses import dataclass
from typing import Protocol

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.vehicles.positioning.fix import Fix
from reasoned_explorer.vehicles.positioning.localizer import Localizer, LocalizerSettings
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.verdict import Grade, PositionVerdict
from reasoned_explorer.vehicles.unitree.robot import BodyReading

#: The yaw is taken for a heading so often: its errors are slow, more often says nothing new.
_YAW_EVERY_S = 0.2


class PositionSource(Protocol):
    """What has fixes, a `positioning.Receiver`."""

    def fixes(self) -> AsyncGenerator[Fix, None]:
        """Yield fixes as they come; it raises a `PartError` where the receiver goes away."""
        ...


@dataclass(frozen=True, slots=True)
class Here:
    """Where the robot is.

    Attributes:
        pose: What is believed; the height is 0.
        verdict: Whether it may walk by it.
        gyro_bias_radps: What its turn rates are off by.
        fix_age_s: Since the last fix that was believed; None without a receiver.
        compass_rad: The heading that its yaw alone says, which serves for a compass; None where the pose's is that.
    """

    pose: Pose
    verdict: PositionVerdict
    gyro_bias_radps: float = 0.0
    fix_age_s: float | None = None
    compass_rad: float | None = None


class Whereabouts(Protocol):
    """Makes a position of what a robot and a receiver say."""

    #: How the position comes about, for people.
    note: str

    def take(self, reading: BodyReading) -> None:
        """Take in what the robot senses."""

    def take_fix(self, fix: Fix) -> None:
        """Take in what a receiver says."""

    def at(self, now_s: float) -> Here:
        """Return where the robot is at a time, which is not before that of the last call."""


class Reckoned:
    """By the robot's own legs and yaw alone, from where a person says that it starts.

    Nothing corrects it: it drifts by some hundredths of the way, and by the degrees that the start heading is off.

    Args:
        home: Where it starts.
        reckon_m: So far it may walk by that, metres.
    """

    note = "no receiver: where it is, is reckoned from the start by its legs and its yaw alone"

    def __init__(self, home: Pose, *, reckon_m: float) -> None:
        self._home, self._limit_m = home, reckon_m
        self._first: BodyReading | None = None
        self._last: BodyReading | None = None
        self._way_m = 0.0

    def take(self, reading: BodyReading) -> None:
        """Take in where its legs believe to be."""
        last = self._last
        if last is not None:
            self._way_m += math.hypot(reading.ahead_m - last.ahead_m, reading.aside_m - last.aside_m)
        self._first = self._first or reading
        self._last = reading

    def take_fix(self, fix: Fix) -> None:
        """Nothing: there is no receiver."""

    def at(self, now_s: float) -> Here:
        """Return where it was when it was last heard."""
        del now_s
        first, last, home = self._first, self._last, self._home
        if first is None or last is None:
            return Here(home, PositionVerdict(Grade.STALE, "nothing was heard of the robot yet"))
        heading_rad = normalise_heading_rad(home.heading_rad + last.yaw_rad - first.yaw_rad)
        # The frame of its legs, whose x is where its yaw was zero, turned into the world's.
        frame_rad = home.heading_rad - first.yaw_rad
        ahead, aside = last.ahead_m - first.ahead_m, last.aside_m - first.aside_m
        sin_f, cos_f = math.sin(frame_rad), math.cos(frame_rad)
        x_m = home.x_m + ahead * sin_f + aside * cos_f
        y_m = home.y_m + ahead * cos_f - aside * sin_f
        verdict = PositionVerdict(Grade.GOOD)
        if self._way_m > self._limit_m:
            verdict = PositionVerdict(Grade.POOR, f"{self._way_m:.0f} m walked by its legs alone, without a receiver")
        return Here(Pose(x_m, y_m, 0.0, heading_rad), verdict)


class Surveyed:
    """By a receiver's fixes, its yaw, its turn rates and its legs.

    A Go1 has no compass. Its yaw is taken as one, whose north is set by the heading that a person gives at the start
    and which wanders; walking on corrects it.

    Args:
        home: Where it is believed to start; of it only the heading is used once fixes come.
        settings: What the sensors are worth.
    """

    note = "by satellite receiver, inertial unit and legs"

    def __init__(self, home: Pose, *, settings: LocalizerSettings) -> None:
        self.localizer = Localizer(settings)
        self._home = self._by_yaw = home
        self._first_yaw_rad: float | None = None
        self._yaw_s = -math.inf

    def take(self, reading: BodyReading) -> None:
        """Take in what it senses."""
        if self._first_yaw_rad is None:
            self._first_yaw_rad = reading.yaw_rad
        turned_rad = reading.yaw_rad - self._first_yaw_rad
        self._by_yaw = self._home.facing(self._home.heading_rad + turned_rad)
        self.localizer.take(ImuSample(reading.time_s, reading.turn_radps))
        self.localizer.take(OdometryReading(reading.time_s, reading.forward_mps, reading.right_mps))
        if reading.time_s - self._yaw_s >= _YAW_EVERY_S - 1e-6:
            self._yaw_s = reading.time_s
            self.localizer.take(CompassReading(reading.time_s, self._by_yaw.heading_rad))

    def take_fix(self, fix: Fix) -> None:
        """Take in a fix."""
        self.localizer.take(fix)

    def at(self, now_s: float) -> Here:
        """Return where the filter believes it to be."""
        there = self.localizer.at(now_s)
        if there.estimate is None:
            return Here(self._by_yaw, there.verdict, fix_age_s=there.fix_age_s)
        bias_radps, compass_rad = there.estimate.gyro_bias_radps, self._by_yaw.heading_rad
        return Here(there.estimate.pose, there.verdict, bias_radps, there.fix_age_s, compass_rad)
