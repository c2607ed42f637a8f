"""How the driver of an AirSim drone flies and looks."""

import math
from dataclasses import dataclass

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """How the driver flies and looks.

    Attributes:
        cameras: Names of the cameras to look with; which way they look is asked. A heading is seen by the one that
            looks there, where there is one.
        fits_rad: How far off a heading a camera may look that is taken for it.
        aims: Whether the first camera may be turned to a heading that no camera looks in. Otherwise the vehicle turns.
        pictures: Whether to take pictures; without, views carry only what `content` says of them.
        lands: Whether to land when it is over; otherwise it hovers.
        settle_s: How long to stand still after a leg; None for what the vehicle's profile says.
        arrival_m: So near the target, or past the line across the way through it, the vehicle has arrived.
        facing_rad: How well the final heading is met.
        stuck_s: Seconds without progress that mean "stuck".
        stuck_m: What counts as progress, metres.
        poll_s: How often to look how a leg goes, seconds.
        deadline_s: How long an answer may take, real seconds.
        reads_gps: Whether to ask, on the way, for the age of the last fix; no more where the simulator has no receiver.
        range_sensor: Name of a distance sensor that looks ahead, "" for the only one; None for none.
        range_camera: Name of a camera whose depth pictures tell how far it is to what stands ahead; None for none.
            Where a distance sensor is named too, the nearer counts.

    Raises:
        SettingsError: If one is out of range.
    """

    cameras: tuple[str, ...] = ("front_center", "front_left", "front_right")
    fits_rad: float = math.radians(2.0)
    aims: bool = False
    pictures: bool = True
    lands: bool = True
    settle_s: float | None = None
    arrival_m: float = 0.5
    facing_rad: float = math.radians(5.0)
    stuck_s: float = 6.0
    stuck_m: float = 0.2
    poll_s: float = 0.25
    deadline_s: float = 10.0
    reads_gps: bool = True
    range_sensor: str | None = None
    range_camera: str | None = None

    def __post_init__(self) -> None:
        ranges = {
            "fits_rad": (0.0, math.pi),
            "arrival_m": (0.01, 100.0),
            "facing_rad": (0.001, math.pi),
            "stuck_s": (0.5, 600.0),
            "stuck_m": (0.001, 100.0),
            "poll_s": (0.05, 10.0),
            "deadline_s": (0.01, 3600.0),
        }
        faults = [
            Fault(f"{name} = {getattr(self, name)!r:.40}", f"a number in [{low:g}, {high:g}]")
            for name, (low, high) in ranges.items()
            if not is_within(getattr(self, name), low, high)
        ]
        if self.settle_s is not None and not is_within(self.settle_s, 0.0, 3600.0):
            faults.append(Fault(f"settle_s = {self.settle_s!r:.40}", "a number in [0, 3600], or None"))
        if not self.cameras or not all(isinstance(name, str) and name for name in self.cameras):
            faults.append(Fault(f"cameras = {self.cameras!r:.60}", "at least one name"))
        if faults:
            raise SettingsError("AirSim driver", faults)
