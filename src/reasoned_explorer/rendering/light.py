"""What conditions mean for the shader: colours of sun, sky and air."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.conditions import Conditions
from reasoned_explorer.rendering.sky_kernels import Light

Rgb = tuple[float, float, float]
_CLOUD_SIDE = 128


@dataclass(frozen=True, slots=True)
class _Weather:
    """Linear-light colours and strengths of one kind of weather; by eye."""

    sun: Rgb
    sky: Rgb
    bounce: Rgb
    zenith: Rgb
    horizon: Rgb
    glow: Rgb
    cloud: Rgb
    cover: float
    haze_m: float
    shadow: float
    soft: bool
    wetness: float
    lamps: float


_CLEAR = _Weather(
    sun=(1.75, 1.6, 1.36), sky=(0.34, 0.43, 0.58), bounce=(0.22, 0.21, 0.19), zenith=(0.13, 0.3, 0.72),
    horizon=(0.6, 0.72, 0.86), glow=(0.3, 0.27, 0.2), cloud=(0.95, 0.96, 1.0), cover=0.5, haze_m=1400.0, shadow=1.0,
    soft=False, wetness=0.0, lamps=1.0,
)  # fmt: skip
_DUSK = _Weather(
    sun=(1.2, 0.62, 0.26), sky=(0.3, 0.32, 0.46), bounce=(0.16, 0.14, 0.14), zenith=(0.1, 0.17, 0.4),
    horizon=(0.66, 0.48, 0.36), glow=(0.9, 0.4, 0.1), cloud=(0.8, 0.5, 0.42), cover=0.45, haze_m=900.0, shadow=1.0,
    soft=False, wetness=0.0, lamps=2.2,
)  # fmt: skip
_OVERCAST = _Weather(
    sun=(0.34, 0.34, 0.34), sky=(0.62, 0.65, 0.7), bounce=(0.22, 0.22, 0.22), zenith=(0.55, 0.58, 0.63),
    horizon=(0.68, 0.71, 0.75), glow=(0.05, 0.05, 0.05), cloud=(0.45, 0.47, 0.51), cover=0.7, haze_m=700.0, shadow=0.9,
    soft=True, wetness=0.0, lamps=1.1,
)  # fmt: skip
_FOG = _Weather(
    sun=(0.2, 0.2, 0.2), sky=(0.62, 0.64, 0.67), bounce=(0.28, 0.28, 0.28), zenith=(0.6, 0.62, 0.65),
    horizon=(0.6, 0.62, 0.65), glow=(0.04, 0.04, 0.03), cloud=(0.6, 0.62, 0.65), cover=0.0, haze_m=55.0, shadow=0.7,
    soft=True, wetness=0.15, lamps=1.4,
)  # fmt: skip
_RAIN = _Weather(
    sun=(0.16, 0.17, 0.18), sky=(0.46, 0.49, 0.54), bounce=(0.16, 0.16, 0.17), zenith=(0.32, 0.35, 0.4),
    horizon=(0.46, 0.49, 0.53), glow=(0.02, 0.02, 0.02), cloud=(0.26, 0.28, 0.32), cover=0.8, haze_m=260.0, shadow=0.8,
    soft=True, wetness=0.85, lamps=1.6,
)  # fmt: skip
_BY_NAME = {"clear": _CLEAR, "overcast": _OVERCAST, "fog": _FOG, "rain": _RAIN}


def light_of(conditions: Conditions) -> Light:
    """Return the light of conditions."""
    weather = _BY_NAME[conditions.weather]
    low = _lowness(conditions.sun_elevation_rad)

    other = _DUSK if conditions.weather == "clear" else weather

    def mixed(name: str) -> NDArray[np.float64]:
        day = np.array(getattr(weather, name), np.float64)
        return day + low * (np.array(getattr(other, name), np.float64) - day)

    tones = [mixed(name) for name in ("sun", "sky", "bounce", "zenith", "horizon", "glow", "cloud")]
    return Light(
        tones=np.array([sun_direction(conditions), *tones]),
        clouds=_clouds(conditions.seed, weather.cover),
        haze_m=float(conditions.haze_m or mixed("haze_m")),
        shadow=weather.shadow,
        soft=weather.soft,
        wetness=weather.wetness,
        lamps=float(mixed("lamps")),
    )


def sun_direction(conditions: Conditions) -> NDArray[np.float64]:
    """Return the direction to the sun, ENU, of length 1."""
    flat = math.cos(conditions.sun_elevation_rad)
    return np.array(
        [
            flat * math.sin(conditions.sun_azimuth_rad),
            flat * math.cos(conditions.sun_azimuth_rad),
            math.sin(conditions.sun_elevation_rad),
        ]
    )


def developing_curve() -> NDArray[np.uint8]:
    """Return the sRGB byte of each linear radiance in [0, 4], with a shoulder for what is brighter than paper."""
    light = np.linspace(0.0, 4.0, 16384)
    knee = 0.7
    soft = np.where(light <= knee, light, 1.0 - (1.0 - knee) * np.exp(-(light - knee) / (1.0 - knee)))
    straight = soft * 12.92
    curved = 1.055 * np.maximum(soft, 1e-9) ** (1.0 / 2.4) - 0.055
    return np.round(255.0 * np.where(soft <= 0.0031308, straight, curved)).astype(np.uint8)


def _lowness(elevation_rad: float) -> float:
    """1 with the sun at the horizon, 0 well above it."""
    share = (math.radians(22.0) - elevation_rad) / math.radians(14.0)
    share = min(max(share, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


@lru_cache(maxsize=8)
def _clouds(seed: int, cover: float) -> NDArray[np.float32]:
    """Return tileable clouds: noise of many sizes, its lower part cut away."""
    rng = np.random.default_rng([seed & 0x7FFFFFFF, 77])
    side = np.fft.fftfreq(_CLOUD_SIDE) * _CLOUD_SIDE
    radius = np.hypot(side[:, None], side[None, :])
    spectrum = np.fft.fft2(rng.standard_normal((_CLOUD_SIDE, _CLOUD_SIDE))) / np.maximum(radius, 1.5) ** 1.8
    spectrum[0, 0] = 0.0
    noise = np.fft.ifft2(spectrum).real
    noise /= noise.std()
    return np.clip((noise + 2.0 * cover - 0.9) * 0.55, 0.0, cover + 0.3 if cover else 0.0).astype(np.float32)
