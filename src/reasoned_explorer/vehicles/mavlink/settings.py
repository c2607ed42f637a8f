"""How the driver of a machine behind MAVLink moves and looks."""

import math
from dataclasses import dataclass

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """How the driver moves and looks.

    Attributes:
        arms: Whether the driver may switch the motors on. Without, it waits for a person who does.
        lands: Whether to land when it is over; otherwise it holds its place in the air.
        origin: Where on earth the world's origin lies. With it, targets and positions are geodetic ones; without, they
            are in the autopilot's local frame, whose origin is `home` of the vehicle.
        system: Who this program is on the wire; ArduPilot's failsafe listens to 255.
        component: Likewise.
        autopilot_system: Which system is meant, or 0 for the first autopilot that is heard.
        rate_hz: How often positions are asked for.
        stream_hz: How often setpoints are sent; None for what the autopilot needs (10 for PX4, else 4).
        takes_speed: Whether PX4's parameter for the greatest speed is set while the driver steers.
        lost_s: So many seconds without a heartbeat the link is lost.
        worst_error_m: Where the autopilot's receiver says that it errs by more, a guard takes the position for poor.
        reply_s: How long an answer may take, seconds; it is asked for three times.
        ready_s: How long to wait for an autopilot, its position, and for motors that a person switches on.
        settle_s: How long to stand still after a leg; None for what the vehicle's profile says.
        arrival_m: So near the target, or past the line across the way through it, the vehicle has arrived.
        facing_rad: How well the final heading is met.
        stuck_s: Seconds without progress that mean "stuck".
        stuck_m: What counts as progress, metres.
        poll_s: How often to look how a leg goes, seconds.

    Raises:
        SettingsError: If one is out of range.
    """

    arms: bool = False
    lands: bool = True
    origin: GeoOrigin | None = None
    system: int = 255
    component: int = 190
    autopilot_system: int = 0
    rate_hz: float = 10.0
    stream_hz: float | None = None
    takes_speed: bool = True
    lost_s: float = 5.0
    worst_error_m: float = 5.0
    reply_s: float = 2.0
    ready_s: float = 60.0
    settle_s: float | None = None
    arrival_m: float = 0.5
    facing_rad: float = math.radians(5.0)
    stuck_s: float = 6.0
    stuck_m: float = 0.2
    poll_s: float = 0.25

    def __post_init__(self) -> None:
        ranges = {
            "rate_hz": (0.5, 100.0),
            "lost_s": (1.5, 600.0),
            "worst_error_m": (0.01, 1000.0),
            "reply_s": (0.05, 600.0),
            "ready_s": (0.1, 3600.0),
            "arrival_m": (0.01, 100.0),
            "facing_rad": (0.001, math.pi),
            "stuck_s": (0.5, 600.0),
            "stuck_m": (0.001, 100.0),
            "poll_s": (0.05, 10.0),
        }
        faults = [
            Fault(f"{name} = {getattr(self, name)!r:.40}", f"a number in [{low:g}, {high:g}]")
            for name, (low, high) in ranges.items()
            if not is_within(getattr(self, name), low, high)
        ]
        for name, low in (("system", 1), ("component", 1), ("autopilot_system", 0)):
            if not is_within(getattr(self, name), low, 255, whole=True):
                faults.append(Fault(f"{name} = {getattr(self, name)!r:.40}", f"a whole number in [{low}, 255]"))
        if self.settle_s is not None and not is_within(self.settle_s, 0.0, 3600.0):
            faults.append(Fault(f"settle_s = {self.settle_s!r:.40}", "a number in [0, 3600], or None"))
        if self.stream_hz is not None and not is_within(self.stream_hz, 0.5, 50.0):
            faults.append(Fault(f"stream_hz = {self.stream_hz!r:.40}", "a number in [0.5, 50], or None"))
        if faults:
            raise SettingsError("MAVLink driver", faults)
