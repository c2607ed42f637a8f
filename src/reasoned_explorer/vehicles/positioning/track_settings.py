"""What the sensors of a machine are worth, in real time."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import positive_faults
from reasoned_explorer.vehicles.control.localization import FilterSettings
from reasoned_explorer.vehicles.positioning.fix import FixQuality
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS, ReceiverModel


@dataclass(frozen=True, slots=True)
class TrackSettings:
    """What the sensors are worth, in real time.

    Attributes:
        receivers: What fixes of each quality are worth.
        gyro_density_radps: White noise of the gyro per square root of hertz.
        gyro_bias_walk_radps: Random walk of its bias per square root of second.
        gyro_bias_sigma_radps: Its unknown bias at the start.
        acceleration_density_mps2: White noise of measured accelerations per square root of hertz.
        unknown_acceleration_mps2: Likewise of what the machine does where no accelerations are measured.
        unknown_turn_radps: White noise of the turn rate where no turn rates come in.
        compass_sigma_rad: White error of the compass.
        compass_wander_rad: Its slow error.
        compass_wander_tau_s: Correlation time of that, seconds.
        odometry_sigma_mps: White error of the odometry per axis.
        odometry_scale_sigma: Error of its scale, a share; counts where there are no fixes that would make up for it.
        worst_fix_factor: Where fixes scatter more than their model or the receiver's word has it, the receiver is taken
            to be worse by up to this factor; 1 has both believed.
        imu_hold_s: A turn rate is taken to go on for so long when none follows.
        rejects: So many refusals in a row make the filter start that part over.

    Raises:
        SettingsError: If a figure is no finite number > 0, or a quality has no model.
    """

    receivers: Mapping[FixQuality, ReceiverModel] = field(default_factory=lambda: RECEIVERS)
    gyro_density_radps: float = math.radians(0.02)
    gyro_bias_walk_radps: float = math.radians(0.003)
    gyro_bias_sigma_radps: float = math.radians(0.5)
    acceleration_density_mps2: float = 0.05
    unknown_acceleration_mps2: float = 0.3
    unknown_turn_radps: float = 0.5
    compass_sigma_rad: float = math.radians(1.0)
    compass_wander_rad: float = math.radians(2.0)
    compass_wander_tau_s: float = 120.0
    odometry_sigma_mps: float = 0.05
    odometry_scale_sigma: float = 0.03
    worst_fix_factor: float = 4.0
    imu_hold_s: float = 0.15
    rejects: int = 20

    def __post_init__(self) -> None:
        names = [item.name for item in fields(self) if item.name != "receivers"]
        faults = positive_faults((name, getattr(self, name)) for name in names)
        faults += [
            Fault(f"no model of fixes that are {quality.as_text}", "one for each quality but none")
            for quality in FixQuality
            if quality is not FixQuality.NONE and quality not in self.receivers
        ]
        if faults:
            raise SettingsError("localization in real time", faults)

    def filter_settings(self, receiver: ReceiverModel) -> FilterSettings:
        """Return the filter's settings for fixes of a kind."""
        return FilterSettings(
            gyro_density_radps=self.gyro_density_radps,
            acceleration_density_mps2=self.acceleration_density_mps2,
            gyro_bias_walk_radps=self.gyro_bias_walk_radps,
            wander_sigma_m=receiver.wander_m,
            wander_tau_s=receiver.wander_tau_s,
            compass_wander_sigma_rad=self.compass_wander_rad,
            compass_wander_tau_s=self.compass_wander_tau_s,
            rejects=self.rejects,
        )
