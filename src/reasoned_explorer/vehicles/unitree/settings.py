"""How the driver of a walking robot walks and looks."""

import math
from dataclasses import dataclass, field

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.positioning.localizer import LocalizerSettings
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings


def _localizer() -> LocalizerSettings:
    # The "compass" is the inertial unit's yaw on top of the heading that a person gave: it is off by some degrees from
    # the start on and drifts slowly.
    track = TrackSettings(compass_wander_rad=math.radians(8.0), compass_wander_tau_s=900.0)
    return LocalizerSettings(track=track)


@dataclass(frozen=True, slots=True)
class WalkSettings:
    """How the driver walks and looks.

    Attributes:
        lies: Whether it lies down when it is over; otherwise it is left standing.
        gets_up: Whether a robot that lies is told to get up at the start; otherwise that is an error.
        localizer: What is made of fixes, yaw, turn rates and legs, where there is a receiver. The start heading that a
            person gives is taken to be right within about 8° (one sigma).
        reckon_m: Without a receiver: so far it walks by its legs alone, metres, before it stops for good.
        position_patience_s: How long it stands and waits for a good position before a leg is given up, seconds.
        lost_patience_s: How long it waits at the start of a look or leg for a robot that is not heard, seconds.
        poll_s: In which parts a leg is walked: how soon a cancellation is heeded, seconds.

    Raises:
        SettingsError: If one is out of range.
    """

    lies: bool = False
    gets_up: bool = True
    localizer: LocalizerSettings = field(default_factory=_localizer)
    reckon_m: float = 200.0
    position_patience_s: float = 10.0
    lost_patience_s: float = 5.0
    poll_s: float = 0.5

    def __post_init__(self) -> None:
        ranges = {
            "position_patience_s": (0.0, 600.0),
            "lost_patience_s": (0.0, 600.0),
            "poll_s": (0.05, 10.0),
        }
        faults = [
            Fault(f"{name} = {getattr(self, name)!r:.40}", f"a number in [{low:g}, {high:g}]")
            for name, (low, high) in ranges.items()
            if not is_within(getattr(self, name), low, high)
        ]
        if not (isinstance(self.reckon_m, int | float) and self.reckon_m > 0.0):
            faults.append(Fault(f"reckon_m = {self.reckon_m!r:.40}", "metres > 0, or infinity"))
        if faults:
            raise SettingsError("driver of a walking robot", faults)
