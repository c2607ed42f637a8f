"""Where the machine is: an extended Kalman filter over satellite fixes, IMU, odometry and compass.

The state is east and north position, east and north velocity, heading, and the slow errors that would else be taken for
truth: gyro bias, the satellite receiver's wander (first-order Gauss-Markov, per axis) and the compass's. Carried as
states, they keep the filter honest about what averaging cannot remove. Every measurement passes a Mahalanobis gate;
without measurements the filter dead-reckons and its uncertainty grows.
"""

import math
from dataclasses import dataclass, fields

import numpy as np

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.kernels import Floats

#: Quantiles 0.999 of the chi-square distribution with one and two degrees of freedom.
GATE_1 = 10.828
GATE_2 = 13.816


@dataclass(frozen=True, slots=True)
class FilterSettings:
    """What the filter takes its sensors' slow errors and its own prediction to be worth.

    Attributes:
        gyro_density_radps: White noise of the gyro, radians a second per square root of hertz, > 0.
        acceleration_density_mps2: White noise of the horizontal acceleration (residual gravity included), metres a
            second squared per square root of hertz, > 0.
        gyro_bias_walk_radps: Random walk of the gyro's bias, radians a second per square root of second, ≥ 0.
        wander_sigma_m: Standing deviation of the receiver's slow error per axis, metres, ≥ 0.
        wander_tau_s: Its correlation time, seconds, > 0.
        compass_wander_sigma_rad: Standing deviation of the compass's slow error, radians, ≥ 0.
        compass_wander_tau_s: Its correlation time, seconds, > 0.
        gate_1: Largest squared Mahalanobis distance of a scalar measurement, > 0.
        gate_2: Likewise of a pair.
        rejects: So many refusals in a row of one kind make the filter start that part over from the measurement, ≥ 1.

    Raises:
        SettingsError: If a value is out of range.
    """

    gyro_density_radps: float = math.radians(0.014)
    acceleration_density_mps2: float = 0.03
    gyro_bias_walk_radps: float = math.radians(0.003)
    wander_sigma_m: float = 0.01
    wander_tau_s: float = 60.0
    compass_wander_sigma_rad: float = math.radians(2.0)
    compass_wander_tau_s: float = 120.0
    gate_1: float = GATE_1
    gate_2: float = GATE_2
    rejects: int = 20

    def __post_init__(self) -> None:
        may_be_zero = {"gyro_bias_walk_radps", "wander_sigma_m", "compass_wander_sigma_rad"}
        faults = []
        for item in fields(self):
            value = getattr(self, item.name)
            good = value >= 0.0 if item.name in may_be_zero else value > 0.0
            if not (math.isfinite(value) and good):
                least = "≥ 0" if item.name in may_be_zero else "> 0"
                faults.append(Fault(f"{item.name} = {value}", f"a finite number {least}"))
        if faults:
            raise SettingsError("filter settings", faults)

    def as_array(self) -> Floats:
        """Return the settings in the order that the kernels read, shape (10,)."""
        return np.array([float(getattr(self, item.name)) for item in fields(self)])


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """What the filter believes.

    Attributes:
        pose: Position and heading; the height is not estimated and stays 0.
        vx_mps: Velocity to the east.
        vy_mps: Velocity to the north.
        position_sigma_m: Larger half axis of the position's one-sigma ellipse, metres.
        heading_sigma_rad: One sigma of the heading, radians.
        gyro_bias_radps: The gyro's bias.
    """

    pose: Pose
    vx_mps: float
    vy_mps: float
    position_sigma_m: float
    heading_sigma_rad: float
    gyro_bias_radps: float

    @property
    def speed_mps(self) -> float:
        """Speed over ground, metres a second."""
        return math.hypot(self.vx_mps, self.vy_mps)


class PoseFilter:
    """The localization filter with its state. Call `predict` for each IMU sample, then what was measured.

    Args:
        settings: What the sensors are worth.
        pose: Where the machine believes it is at the start.
        position_sigma_m: One sigma of that, per axis.
        heading_sigma_rad: Likewise of the heading.
        gyro_bias_sigma_radps: One sigma of the gyro's unknown bias.
    """

    def __init__(
        self,
        settings: FilterSettings,
        pose: Pose,
        *,
        position_sigma_m: float,
        heading_sigma_rad: float,
        gyro_bias_sigma_radps: float = math.radians(0.5),
    ) -> None:
        self.settings = settings
        self.settings_array = settings.as_array()
        self.state = np.zeros(kernels.EKF_SIZE)
        self.state[kernels.EKF_X], self.state[kernels.EKF_Y] = pose.x_m, pose.y_m
        self.state[kernels.EKF_HEADING] = pose.heading_rad
        self.covariance = np.zeros((kernels.EKF_SIZE, kernels.EKF_SIZE))
        sigmas = (
            position_sigma_m,
            position_sigma_m,
            1e-3,
            1e-3,
            heading_sigma_rad,
            gyro_bias_sigma_radps,
            settings.wander_sigma_m,
            settings.wander_sigma_m,
            settings.compass_wander_sigma_rad,
        )
        np.fill_diagonal(self.covariance, np.square(sigmas))
        self.rejects = np.zeros(kernels.REJECT_SIZE, dtype=np.int64)
        self.work = np.zeros(kernels.EKF_SIZE)

    @property
    def pose(self) -> Pose:
        """The estimated position and heading."""
        x_m, y_m = float(self.state[kernels.EKF_X]), float(self.state[kernels.EKF_Y])
        return Pose(x_m, y_m, 0.0, normalise_heading_rad(float(self.state[kernels.EKF_HEADING])))

    @property
    def estimate(self) -> PoseEstimate:
        """Everything that the filter believes."""
        state, cov = self.state, self.covariance
        mean = 0.5 * (cov[0, 0] + cov[1, 1])
        spread = math.hypot(0.5 * (cov[0, 0] - cov[1, 1]), cov[0, 1])
        return PoseEstimate(
            self.pose,
            float(state[kernels.EKF_VX]),
            float(state[kernels.EKF_VY]),
            math.sqrt(mean + spread),
            math.sqrt(cov[kernels.EKF_HEADING, kernels.EKF_HEADING]),
            float(state[kernels.EKF_GYRO_BIAS]),
        )

    def predict(
        self, dt_s: float, *, yaw_rate_radps: float, forward_mps2: float = 0.0, right_mps2: float = 0.0
    ) -> None:
        """Carry the estimate on by an IMU sample.

        Args:
            dt_s: Seconds since the last sample, > 0.
            yaw_rate_radps: Mean yaw rate since then, positive clockwise.
            forward_mps2: Mean horizontal acceleration ahead.
            right_mps2: Mean horizontal acceleration to the right.
        """
        kernels.filter_predict(
            self.settings_array, self.state, self.covariance, dt_s, yaw_rate_radps, forward_mps2, right_mps2
        )

    def stand(self, dt_s: float) -> None:
        """Carry the estimate over seconds in which the machine is known to stand still."""
        kernels.filter_stand(self.settings_array, self.state, self.covariance, dt_s)

    def position(self, x_m: float, y_m: float, *, sigma_m: float) -> bool:
        """Take in a satellite fix and return whether it was believed; ``sigma_m`` is its white error per axis."""
        return bool(kernels.filter_position(*self._parts(), x_m, y_m, sigma_m))

    def velocity(self, vx_mps: float, vy_mps: float, *, sigma_mps: float) -> bool:
        """Take in a receiver's Doppler velocity (east, north) and return whether it was believed."""
        return bool(kernels.filter_velocity(*self._parts(), vx_mps, vy_mps, sigma_mps))

    def course(self, course_rad: float, speed_mps: float, *, sigma_mps: float) -> bool:
        """Take in course and speed over ground (as NMEA's RMC gives them) and return whether they were believed.

        At rest a course means nothing, and as a velocity it says just that.
        """
        return self.velocity(speed_mps * math.sin(course_rad), speed_mps * math.cos(course_rad), sigma_mps=sigma_mps)

    def odometry(self, forward_mps: float, right_mps: float = 0.0, *, sigma_mps: float) -> bool:
        """Take in a body-frame velocity and return whether it was believed."""
        return bool(kernels.filter_odometry(*self._parts(), forward_mps, right_mps, sigma_mps))

    def compass(self, heading_rad: float, *, sigma_rad: float) -> bool:
        """Take in a compass heading and return whether it was believed."""
        return bool(kernels.filter_compass(*self._parts(), heading_rad, sigma_rad))

    def _parts(self) -> tuple[Floats, Floats, Floats, object, Floats]:
        return self.settings_array, self.state, self.covariance, self.rejects, self.work
