"""Time of day and weather."""

import math
from dataclasses import dataclass
from types import MappingProxyType

from reasoned_explorer.model import Fault, SettingsError, UnknownNameError
from reasoned_explorer.model.draws import choice, uniform

#: Kinds of weather.
WEATHERS: tuple[str, ...] = ("clear", "overcast", "fog", "rain")
#: The sun stands at least this high, radians: lower ones throw shadows without end.
LEAST_ELEVATION_RAD = math.radians(6.0)


@dataclass(frozen=True, slots=True)
class Conditions:
    """How a world is lit.

    Attributes:
        sun_elevation_rad: Height of the sun above the horizon, radians, in [6°, 90°].
        sun_azimuth_rad: Compass heading of the sun, radians.
        weather: One of `WEATHERS`.
        haze_m: Distance at which 1 - 1/e of what is seen is air, metres; None is what the weather brings.
        seed: Of the clouds.

    Raises:
        SettingsError: If any of them is out of range.
    """

    sun_elevation_rad: float = math.radians(48.0)
    sun_azimuth_rad: float = math.radians(215.0)
    weather: str = "clear"
    haze_m: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        faults = []
        if not LEAST_ELEVATION_RAD - 1e-9 <= self.sun_elevation_rad <= 0.5 * math.pi:
            faults.append(Fault(f"sun_elevation_rad = {self.sun_elevation_rad}", "an angle from 6° to 90°, in radians"))
        if not math.isfinite(self.sun_azimuth_rad):
            faults.append(Fault(f"sun_azimuth_rad = {self.sun_azimuth_rad}", "a finite angle"))
        if self.weather not in WEATHERS:
            faults.append(Fault(f"weather = {self.weather!r}", "one of " + ", ".join(WEATHERS)))
        if self.haze_m is not None and not 1.0 <= self.haze_m < math.inf:
            faults.append(Fault(f"haze_m = {self.haze_m}", "at least 1 metre"))
        if faults:
            raise SettingsError("conditions", faults)

    @property
    def is_dusk(self) -> bool:
        """Whether the sun is so low that lamps are lit."""
        return self.sun_elevation_rad < math.radians(12.0)


#: Conditions by name.
PRESETS = MappingProxyType(
    {
        "clear": Conditions(),
        "overcast": Conditions(sun_elevation_rad=math.radians(62.0), weather="overcast"),
        "dusk": Conditions(sun_elevation_rad=math.radians(8.0), sun_azimuth_rad=math.radians(275.0)),
        "fog": Conditions(sun_elevation_rad=math.radians(55.0), weather="fog"),
        "rain": Conditions(sun_elevation_rad=math.radians(60.0), weather="rain"),
    }
)


def conditions_named(name: str) -> Conditions:
    """Return the conditions of a name in `PRESETS`.

    Raises:
        UnknownNameError: If there is none.
    """
    if name not in PRESETS:
        raise UnknownNameError("conditions", name, sorted(PRESETS))
    return PRESETS[name]


def drawn_conditions(seed: int) -> Conditions:
    """Return conditions drawn by a seed: mostly clear, the sun anywhere that it can be by day at middle latitudes."""
    weather = choice(("clear",) * 5 + ("overcast",) * 2 + ("fog", "rain"), seed, "weather")
    elevation = math.radians(12.0 + 50.0 * uniform(seed, "sun elevation"))
    if weather == "clear" and uniform(seed, "dusk") < 0.15:
        elevation = math.radians(7.0 + 4.0 * uniform(seed, "dusk elevation"))
    if weather != "clear":
        elevation = math.radians(50.0 + 15.0 * uniform(seed, "sun elevation"))
    azimuth = math.radians(90.0 + 180.0 * uniform(seed, "sun azimuth"))
    return Conditions(elevation, azimuth, weather, seed=seed)
