"""What a machine may do: plain settings, checked all at once."""

import math
from dataclasses import dataclass, replace
from typing import Literal

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.area import Area


@dataclass(frozen=True, slots=True)
class SafetyLimits:
    """What a machine may do. Lengths are metres in the world's frame, times are seconds of the mission's clock.

    Attributes:
        fence: The machine stays inside; None for anywhere.
        keep_out: It stays out of these.
        margin_m: How far it keeps from those edges: what its position may be off by, and more.
        outside: What becomes of a leg that leads out: "refuse", or "shorten" to the last allowed point.
        lowest_m: Of a flyer's camera above the ground.
        highest_m: Likewise.
        speed_mps: Fastest cruise; None for what the profile says.
        turn_rate_radps: Fastest turn; likewise.
        braking_mps2: How hard it brakes; None for what the profile accelerates by.
        reaction_s: From seeing something to braking.
        clearance_m: What must be left before an obstacle when it stands; from its body.
        link_age_s: It stops where nothing was heard of the machine for longer.
        position_age_s: It stops where the last believed fix is older.
        jump_m: A position that moves further than the machine can, and by so much, is not believed.
        turn_off_rad: A heading that turns otherwise than the gyro says, by so much, is not believed.
        battery_low: Share of the battery, [0, 1]; below it the machine comes home or lands.
        when_low: Which of the two.
        look_s: How long a look may take before the camera counts as silent.
        picture_age_s: On the way a picture must not be older; None where no camera tells.
        model_failures: So many lost model calls in a row, and it hovers.
        patience_s: How long it waits, standing, for a trouble to pass before a leg is refused.
        check_s: How often it looks after all this.

    Raises:
        SettingsError: If one is out of range.
    """

    fence: Area | None = None
    keep_out: tuple[Area, ...] = ()
    margin_m: float = 1.0
    outside: Literal["refuse", "shorten"] = "refuse"
    lowest_m: float = 0.0
    highest_m: float = 120.0  # the highest that drones may fly without permission, EU 2019/947
    speed_mps: float | None = None
    turn_rate_radps: float | None = None
    braking_mps2: float | None = None
    reaction_s: float = 0.4
    clearance_m: float = 0.5
    link_age_s: float = 0.6
    position_age_s: float = 0.6
    jump_m: float = 3.0
    turn_off_rad: float = math.radians(20.0)
    battery_low: float = 0.2
    when_low: Literal["home", "land"] = "home"
    look_s: float = 60.0
    picture_age_s: float | None = None
    model_failures: int = 3
    patience_s: float = 15.0
    check_s: float = 0.1

    def __post_init__(self) -> None:
        ranges: dict[str, tuple[float, float]] = {
            "margin_m": (0.0, 1e3),
            "lowest_m": (0.0, 1e4),
            "highest_m": (0.0, 1e4),
            "reaction_s": (0.0, 10.0),
            "clearance_m": (0.0, 100.0),
            "link_age_s": (0.05, 60.0),
            "position_age_s": (0.05, 60.0),
            "jump_m": (0.1, 1e3),
            "turn_off_rad": (math.radians(2.0), math.pi),
            "battery_low": (0.0, 1.0),
            "look_s": (0.1, 3600.0),
            "patience_s": (0.0, 3600.0),
            "check_s": (0.01, 0.5),
        }
        optional = {
            "speed_mps": (0.01, 100.0),
            "turn_rate_radps": (0.01, 100.0),
            "braking_mps2": (0.01, 100.0),
            "picture_age_s": (0.05, 3600.0),
        }
        ranges |= {name: limits for name, limits in optional.items() if getattr(self, name) is not None}
        faults = [
            Fault(f"{name} = {getattr(self, name)!r:.40}", f"a number in [{low:g}, {high:g}]")
            for name, (low, high) in ranges.items()
            if not is_within(getattr(self, name), low, high)
        ]
        if not is_within(self.model_failures, 1, 1000, whole=True):
            faults.append(Fault(f"model_failures = {self.model_failures!r:.40}", "a whole number in [1, 1000]"))
        if self.outside not in {"refuse", "shorten"}:
            faults.append(Fault(f"outside = {self.outside!r:.40}", "'refuse' or 'shorten'"))
        if self.when_low not in {"home", "land"}:
            faults.append(Fault(f"when_low = {self.when_low!r:.40}", "'home' or 'land'"))
        areas = [("fence", self.fence)] if self.fence is not None else []
        areas += [(f"keep_out[{index}]", area) for index, area in enumerate(self.keep_out)]
        faults += [
            Fault(f"{name} = {area!r:.60}", "a Circle or a Polygon")
            for name, area in areas
            if not callable(getattr(area, "inside_by_m", None))
        ]
        if not faults and self.lowest_m > self.highest_m:
            faults.append(
                Fault(f"lowest_m = {self.lowest_m:g}, highest_m = {self.highest_m:g}", "the first not higher")
            )
        if faults:
            raise SettingsError("safety limits", faults)


def limited_profile(profile: VehicleProfile, limits: SafetyLimits) -> VehicleProfile:
    """Return a profile cut down to what is allowed: drivers and simulators take their speeds from it.

    Raises:
        SettingsError: If the machine's camera is higher or lower than it may be.
    """
    if profile.flies and not limits.lowest_m <= profile.camera_height_m <= limits.highest_m:
        what = f"{profile.name} flies {profile.camera_height_m:g} m above the ground"
        band = f"a height in [{limits.lowest_m:g}, {limits.highest_m:g}] m"
        raise SettingsError("safety limits", [Fault(what, band, "choose another profile or other limits")])
    speed_mps = min(profile.speed_mps, math.inf if limits.speed_mps is None else limits.speed_mps)
    turn = min(profile.turn_rate_radps, math.inf if limits.turn_rate_radps is None else limits.turn_rate_radps)
    return replace(profile, speed_mps=speed_mps, turn_rate_radps=turn)


def stopping_m(speed_mps: float, *, braking_mps2: float, reaction_s: float) -> float:
    """Return how far a machine goes on from the moment at which it should stop, metres: v·t + v²/2a."""
    speed_mps = max(0.0, speed_mps)
    return speed_mps * reaction_s + speed_mps * speed_mps / (2.0 * braking_mps2)
