"""The filter and what goes with it in real time: its own time, which sensor spoke last, what was refused since when."""

import copy
import math
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.localization import PoseFilter
from reasoned_explorer.vehicles.positioning import abrupt, wander
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.receivers import ReceiverModel
from reasoned_explorer.vehicles.positioning.scatter import Scatter
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings

Measurement = ImuSample | CompassReading | OdometryReading | Fix

# A step of the prediction; a gap is crossed in several.
_STEP_S = 0.1
# So long a gap is crossed at most; what was believed before it is worth nothing anyway.
_LONGEST_GAP_S = 600.0
# Odometry alone leads the way when no fix was believed for longer than the first; longer than the second adds nothing.
_SOON_S = 1.0
_LONGEST_ALONE_S = 120.0
# From this speed on a course tells where a machine that walks ahead is facing, if nothing else does.
_TELLING_MPS = 0.5
_COURSE_SIGMA_RAD = math.radians(20.0)


@dataclass(slots=True)
class Refusals:
    """A run of measurements that the filter refused.

    Attributes:
        since_s: When it began; None where the last one was believed.
        count: How many so far.
        total: How many ever.
        restarts: How often the filter had to start over from them.
        restarted_s: When it last had to.
    """

    since_s: float | None = None
    count: int = 0
    total: int = 0
    restarts: int = 0
    restarted_s: float = -math.inf

    def note(self, time_s: float, *, believed: bool, rejects: int) -> None:
        """Take in whether a measurement was believed."""
        if not believed:
            self.since_s = time_s if self.since_s is None else self.since_s
            self.count += 1
            self.total += 1
            return
        if self.count >= rejects - 1:  # it was believed because there were so many
            self.restarts += 1
            self.restarted_s = time_s
        self.since_s, self.count = None, 0

    def lasted_s(self, now_s: float) -> float:
        """Return for how long measurements have been refused."""
        return 0.0 if self.since_s is None else now_s - self.since_s


class Track:
    """Where the machine was, up to a time; measurements are applied in the order of theirs.

    Attributes:
        filter: What is believed; None until a fix and a heading have come in.
        time_s: Up to when.
        quality: Of the last fix, None before the first.
        believed_s: When the last fix that was believed was taken.
        off_m: How far the last refused fix was from where it was expected.
        fixes: Which fixes were refused.
        compass: Which compass readings were refused.
        imu_s: When the last turn rate came.
    """

    def __init__(self, settings: TrackSettings) -> None:
        self.settings = settings
        self.filter: PoseFilter | None = None
        self.time_s = -math.inf
        self.quality: FixQuality | None = None
        self.believed_s = -math.inf
        self.off_m = 0.0
        self.fixes, self.compass = Refusals(), Refusals()
        self.imu_s = -math.inf
        self._imu = ImuSample(-math.inf, 0.0)
        self._odometry_s = -math.inf
        self._refused: OdometryReading | None = None  # the last one, where that was refused
        self._moving_s = -math.inf  # when odometry was last believed
        self._receiver = settings.receivers[FixQuality.SINGLE]
        self._scatter = Scatter(settings.worst_fix_factor)
        self._heading: tuple[float, float] | None = None  # with its sigma, until the filter begins

    def copy(self) -> "Track":
        """Return a track of its own that goes on from here."""
        other = copy.copy(self)
        other.fixes, other.compass = copy.copy(self.fixes), copy.copy(self.compass)
        other._scatter = self._scatter.copy()
        if self.filter is not None:
            other.filter = copy.copy(self.filter)
            for name in ("settings_array", "state", "covariance", "rejects", "work"):
                setattr(other.filter, name, getattr(self.filter, name).copy())
        return other

    @property
    def missing(self) -> str:
        """What the filter waits for to begin."""
        if self.filter is not None:
            return ""
        if self.quality is None:
            return "no fix has come in"
        if self.quality is FixQuality.NONE:
            return "the receiver has no fix"
        return "no heading has come in, of a compass or of walking on"

    def apply(self, measurement: Measurement) -> None:
        """Go on to the time of a measurement, which is not before that of the track, and take it in."""
        if isinstance(measurement, ImuSample):
            # It is the mean of the time up to now, so it counts for the way here.
            self._imu, self.imu_s = measurement, measurement.time_s
            self.go_on_to(measurement.time_s)
            return
        self.go_on_to(measurement.time_s)
        if isinstance(measurement, CompassReading):
            self._take_compass(measurement)
        elif isinstance(measurement, OdometryReading):
            self._take_odometry(measurement)
        else:
            self._take_fix(measurement)

    def go_on_to(self, time_s: float) -> None:
        """Carry the estimate on to a time without a measurement."""
        if self.filter is not None:
            left_s = min(time_s - self.time_s, _LONGEST_GAP_S)
            while left_s > 0.0:
                step_s = min(left_s, _STEP_S)
                self._predict(self.filter, time_s - left_s + step_s, step_s)
                left_s -= step_s
        self.time_s = max(self.time_s, time_s)

    def _predict(self, filter_: PoseFilter, until_s: float, step_s: float) -> None:
        imu, settings = self._imu, self.settings
        is_heard = until_s - imu.time_s <= settings.imu_hold_s
        is_felt = is_heard and imu.forward_mps2 is not None and imu.right_mps2 is not None
        filter_.settings_array[kernels.SET_GYRO_DENSITY] = (
            settings.gyro_density_radps if is_heard else settings.unknown_turn_radps
        )
        filter_.settings_array[kernels.SET_ACCELERATION_DENSITY] = (
            settings.acceleration_density_mps2 if is_felt else settings.unknown_acceleration_mps2
        )
        filter_.predict(
            step_s,
            yaw_rate_radps=imu.yaw_rate_radps if is_heard else float(filter_.state[kernels.EKF_GYRO_BIAS]),
            forward_mps2=(imu.forward_mps2 or 0.0) if is_felt else 0.0,
            right_mps2=(imu.right_mps2 or 0.0) if is_felt else 0.0,
        )

    def _take_compass(self, reading: CompassReading) -> None:
        settings = self.settings
        if self.filter is None:
            self._heading = reading.heading_rad, math.hypot(settings.compass_sigma_rad, settings.compass_wander_rad)
            return
        believed = self.filter.compass(reading.heading_rad, sigma_rad=settings.compass_sigma_rad)
        self.compass.note(reading.time_s, believed=believed, rejects=settings.rejects)

    def _take_odometry(self, reading: OdometryReading) -> None:
        every_s = min(1.0, max(0.01, reading.time_s - self._odometry_s))
        self._odometry_s = reading.time_s
        if self.filter is None:
            return
        self._take_velocity(self.filter, reading)
        alone_s = min(reading.time_s - self.believed_s, _LONGEST_ALONE_S)
        if alone_s > _SOON_S:
            # A wrong scale is wrong the same way each time: the error grows with the way, not with its root.
            state, cov = self.filter.state, self.filter.covariance
            growth = 2.0 * alone_s * every_s * self.settings.odometry_scale_sigma**2
            way = state[[kernels.EKF_VX, kernels.EKF_VY]]
            cov[kernels.EKF_X : kernels.EKF_Y + 1, kernels.EKF_X : kernels.EKF_Y + 1] += growth * np.outer(way, way)

    def _take_velocity(self, filter_: PoseFilter, reading: OdometryReading) -> None:
        """Take in a velocity. Two refused ones in a row that agree mean that the machine stopped or set off at once."""
        sigma_mps, last = self.settings.odometry_sigma_mps, self._refused
        believed = filter_.odometry(reading.forward_mps, reading.right_mps, sigma_mps=sigma_mps)
        if not believed and last is not None and abrupt.agree(last, reading, sigma_mps):
            abrupt.allow(filter_, reading, reading.time_s - self._moving_s)
            believed = filter_.odometry(reading.forward_mps, reading.right_mps, sigma_mps=sigma_mps)
        self._refused = None if believed else reading
        self._moving_s = reading.time_s if believed else self._moving_s

    def _take_fix(self, fix: Fix) -> None:
        last, self.quality = self.quality, fix.quality
        if fix.quality is FixQuality.NONE:
            return
        receiver = self.settings.receivers[fix.quality].scaled_to(fix.sigma_m)
        if self.filter is None:
            self._begin(fix, receiver)
            return
        if fix.quality is not last:
            self._scatter.forget()
        elif self._scatter.note(self.filter, fix, receiver):
            wander.doubt(self.filter, self._receiver, self._scatter.applied_to(receiver))
            self._receiver = self._scatter.applied_to(receiver)
        receiver = self._scatter.applied_to(receiver)
        wander.retune(self.filter, self._receiver, receiver)
        self._receiver = receiver
        off_m = wander.off_m(self.filter, fix)
        if fix.quality is not last:
            believed, off_m = wander.change(self.filter, fix, receiver)
        else:
            believed = self.filter.position(fix.x_m, fix.y_m, sigma_m=receiver.white_m)
        self.fixes.note(fix.time_s, believed=believed, rejects=self.settings.rejects)
        if not believed:
            self.off_m = off_m
            return  # its velocity is of the same making
        self.believed_s = fix.time_s
        if fix.speed_mps is not None and fix.course_rad is not None:
            self.filter.course(fix.course_rad, fix.speed_mps, sigma_mps=receiver.velocity_mps)

    def _begin(self, fix: Fix, receiver: ReceiverModel) -> None:
        speed_mps, course_rad = fix.speed_mps, fix.course_rad
        heading = self._heading
        if heading is None and speed_mps is not None and course_rad is not None and speed_mps > _TELLING_MPS:
            heading = course_rad, _COURSE_SIGMA_RAD
        if heading is None:
            return
        self.filter = PoseFilter(
            self.settings.filter_settings(receiver),
            Pose(fix.x_m, fix.y_m, 0.0, heading[0]),
            position_sigma_m=receiver.sigma_m,
            heading_sigma_rad=heading[1],
            gyro_bias_sigma_radps=self.settings.gyro_bias_sigma_radps,
        )
        state, cov = self.filter.state, self.filter.covariance
        for place, slow in zip(wander.PLACES, wander.WANDERS, strict=True):
            # The position is as far off as the receiver is: more fixes of the same error say nothing new.
            cov[place, slow] = cov[slow, place] = -(receiver.wander_m**2)
        if self._heading is not None:
            cov[kernels.EKF_HEADING, kernels.EKF_COMPASS_WANDER] = -(self.settings.compass_wander_rad**2)
            cov[kernels.EKF_COMPASS_WANDER, kernels.EKF_HEADING] = -(self.settings.compass_wander_rad**2)
        # It may be on the move.
        cov[kernels.EKF_VX, kernels.EKF_VX] = cov[kernels.EKF_VY, kernels.EKF_VY] = 1.0
        if speed_mps is not None and course_rad is not None:
            state[kernels.EKF_VX] = speed_mps * math.sin(course_rad)
            state[kernels.EKF_VY] = speed_mps * math.cos(course_rad)
            cov[kernels.EKF_VX, kernels.EKF_VX] = cov[kernels.EKF_VY, kernels.EKF_VY] = receiver.velocity_mps**2
        self._receiver, self.believed_s, self.time_s = receiver, fix.time_s, fix.time_s
