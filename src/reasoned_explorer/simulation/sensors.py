"""How the simulated sensors err: satellite receiver, gyro, accelerometer, compass, odometry.

Every error has a white part and, where real sensors have one, a slow part that averaging does not remove (first-order
Gauss-Markov, or a random walk). All draws are keyed by seed, leg and tick, never by order.
"""

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, SettingsError, UnknownNameError
from reasoned_explorer.vehicles.control.localization import FilterSettings

#: Ticks of the simulation a second; motion, follower and filter run at this rate.
TICK_HZ = 20

_MAY_BE_ZERO = {
    "position_sigma_m",
    "velocity_sigma_mps",
    "wander_sigma_m",
    "gyro_density_radps",
    "gyro_bias_sigma_radps",
    "gyro_bias_walk_radps",
    "acceleration_density_mps2",
    "compass_sigma_rad",
    "compass_wander_sigma_rad",
    "odometry_sigma_mps",
    "odometry_scale_sigma",
    "outlier_share",
    "outlier_m",
    "gap_share",
    "gap_s",
}
_SHARES = {"outlier_share", "gap_share"}
_RATES = {"fix_hz", "compass_hz", "odometry_hz"}


@dataclass(frozen=True, slots=True)
class SensorNoise:
    """How much the sensors err. Sigmas are one standard deviation; "assumed" means without a source.

    Attributes:
        name: Of the preset.
        position_sigma_m: White error of a satellite fix per axis. RTK fixed: data sheets of dual-band receivers (u-blox
            ZED-F9P, ZED-F9R) give 0.01 m + 1 ppm of the baseline, circular error probable; 0.0165 m at 6.5 km (assumed
            baseline) is 0.014 m a axis (CEP = 1.177 sigma).
        wander_sigma_m: Slowly wandering error of a fix per axis (multipath, troposphere); assumed for RTK. Without
            corrections the same data sheet gives 1.5 m CEP, 1.27 m a axis, nearly all of it slow (assumed).
        wander_tau_s: Its correlation time; assumed.
        velocity_sigma_mps: White error of the Doppler velocity per axis; 0.05 m/s in the same data sheet.
        fix_hz: Fixes a second, a divisor of 20. With all constellations such a receiver gives 5 to 10.
        gyro_density_radps: White noise of the gyro per square root of hertz; 0.014 °/s/√Hz (Bosch BMI088 data sheet).
        gyro_bias_sigma_radps: What is left of its bias after calibration at rest; assumed 0.1 °/s.
        gyro_bias_walk_radps: Random walk of the bias per square root of second; assumed.
        acceleration_density_mps2: White noise of the horizontal acceleration per square root of hertz; assumed: the
            accelerometer's own (175 µg/√Hz for the BMI088) is far less than what is left of gravity on a swaying body.
        compass_sigma_rad: White error of the compass; assumed 1° (data sheets of magnetometers promise 1 to 2°).
        compass_wander_sigma_rad: Its slow error (iron nearby); assumed 2°.
        compass_wander_tau_s: Correlation time of that; assumed.
        compass_hz: Compass readings a second, a divisor of 20.
        odometry_sigma_mps: White error of legs' or optical flow's velocity per axis; assumed.
        odometry_scale_sigma: Error of its scale, one draw a mission; assumed 1 %.
        odometry_hz: Odometry readings a second, a divisor of 20.
        outlier_share: Share of fixes that are off by ``outlier_m`` (wrongly fixed ambiguities, reflections); assumed.
        outlier_m: How far off those are.
        gap_share: Share of fixes at which a gap without fixes begins; assumed.
        gap_s: Mean length of a gap, exponentially distributed.

    Raises:
        SettingsError: If a value is out of range.
    """

    name: str
    position_sigma_m: float = 0.014
    wander_sigma_m: float = 0.01
    wander_tau_s: float = 60.0
    velocity_sigma_mps: float = 0.05
    fix_hz: int = 5
    gyro_density_radps: float = math.radians(0.014)
    gyro_bias_sigma_radps: float = math.radians(0.1)
    gyro_bias_walk_radps: float = math.radians(0.003)
    acceleration_density_mps2: float = 0.05
    compass_sigma_rad: float = math.radians(1.0)
    compass_wander_sigma_rad: float = math.radians(2.0)
    compass_wander_tau_s: float = 120.0
    compass_hz: int = 5
    odometry_sigma_mps: float = 0.05
    odometry_scale_sigma: float = 0.01
    odometry_hz: int = 10
    outlier_share: float = 0.0005
    outlier_m: float = 1.0
    gap_share: float = 0.0
    gap_s: float = 0.0

    def __post_init__(self) -> None:
        faults = []
        for item in fields(self):
            if item.name == "name":
                continue
            value = getattr(self, item.name)
            if item.name in _RATES:
                if not (isinstance(value, int) and 1 <= value <= TICK_HZ and TICK_HZ % value == 0):
                    faults.append(Fault(f"{item.name} = {value}", f"a divisor of {TICK_HZ}"))
            elif item.name in _SHARES:
                if not 0.0 <= value <= 1.0:
                    faults.append(Fault(f"{item.name} = {value}", "a share in [0, 1]"))
            elif not (math.isfinite(value) and (value > 0.0 or (value == 0.0 and item.name in _MAY_BE_ZERO))):
                least = "≥ 0" if item.name in _MAY_BE_ZERO else "> 0"
                faults.append(Fault(f"{item.name} = {value}", f"a finite number {least}"))
        if faults:
            raise SettingsError(f"sensor noise {self.name!r}", faults)

    def filter_settings(self) -> FilterSettings:
        """Return the settings of a filter that knows its sensors' data sheets.

        A filter cannot take a sensor to be perfect: zeros become a tenth of a millimetre and the like.
        """
        return FilterSettings(
            gyro_density_radps=max(self.gyro_density_radps, 1e-6),
            acceleration_density_mps2=max(self.acceleration_density_mps2, 1e-4),
            gyro_bias_walk_radps=self.gyro_bias_walk_radps,
            wander_sigma_m=self.wander_sigma_m,
            wander_tau_s=self.wander_tau_s,
            compass_wander_sigma_rad=self.compass_wander_sigma_rad,
            compass_wander_tau_s=self.compass_wander_tau_s,
        )

    def as_array(self) -> NDArray[np.float64]:
        """Return the figures in the order that the kernels read, shape (23,)."""
        return np.array(
            [
                self.position_sigma_m,
                self.velocity_sigma_mps,
                self.wander_sigma_m,
                self.wander_tau_s,
                TICK_HZ // self.fix_hz,
                self.gyro_density_radps,
                self.gyro_bias_walk_radps,
                self.acceleration_density_mps2,
                self.compass_sigma_rad,
                self.compass_wander_sigma_rad,
                self.compass_wander_tau_s,
                TICK_HZ // self.compass_hz,
                self.odometry_sigma_mps,
                self.odometry_scale_sigma,
                TICK_HZ // self.odometry_hz,
                self.outlier_share,
                self.outlier_m,
                self.gap_share,
                self.gap_s,
                max(self.position_sigma_m, 1e-4),
                max(self.velocity_sigma_mps, 1e-3),
                max(self.odometry_sigma_mps, 1e-3),
                max(self.compass_sigma_rad, 1e-4),
            ],
            dtype=np.float64,
        )


#: The presets by name.
SENSOR_NOISE = {
    noise.name: noise
    for noise in (
        SensorNoise("rtk-fixed"),
        # Ambiguities not yet fixed: decimetres, slowly converging (assumed).
        SensorNoise("rtk-float", position_sigma_m=0.05, wander_sigma_m=0.25, wander_tau_s=120.0, outlier_share=0.001),
        SensorNoise(
            "single",
            position_sigma_m=0.3,
            wander_sigma_m=1.23,
            wander_tau_s=180.0,
            outlier_share=0.002,
            outlier_m=10.0,
            gap_share=0.001,
            gap_s=2.0,
        ),
        SensorNoise(
            "none",
            position_sigma_m=0.0,
            wander_sigma_m=0.0,
            velocity_sigma_mps=0.0,
            gyro_density_radps=0.0,
            gyro_bias_sigma_radps=0.0,
            gyro_bias_walk_radps=0.0,
            acceleration_density_mps2=0.0,
            compass_sigma_rad=0.0,
            compass_wander_sigma_rad=0.0,
            odometry_sigma_mps=0.0,
            odometry_scale_sigma=0.0,
            outlier_share=0.0,
        ),
    )
}


def sensor_noise(name: str) -> SensorNoise:
    """Return a preset by its name.

    Raises:
        UnknownNameError: If there is none; it names the near misses.
    """
    if name not in SENSOR_NOISE:
        raise UnknownNameError("sensor noise", name, list(SENSOR_NOISE))
    return SENSOR_NOISE[name]
