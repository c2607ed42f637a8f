"""Which autopilot steers which kind of machine, and what its modes are called on the wire.

The numbers are ArduPilot's (``mode.h`` of ArduCopter and Rover) and PX4's (``px4_custom_mode.h``); the names are those
that pymavlink uses.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

#: Numbers of the enumeration MAV_AUTOPILOT.
ARDUPILOT, PX4, NO_AUTOPILOT = 3, 12, 8
#: Numbers of MAV_TYPE: multirotors and helicopters; what drives on the ground or on water.
FLYING_TYPES = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
DRIVING_TYPES = frozenset({10, 11})
GCS_TYPE = 6


def _px4(main: int, sub: int = 0) -> int:
    return main << 16 | sub << 24


_COPTER_MODES = {
    "STABILIZE": 0,
    "ALT_HOLD": 2,
    "AUTO": 3,
    "GUIDED": 4,
    "LOITER": 5,
    "RTL": 6,
    "LAND": 9,
    "POSHOLD": 16,
    "BRAKE": 17,
    "SMART_RTL": 21,
}
_ROVER_MODES = {
    "MANUAL": 0,
    "ACRO": 1,
    "STEERING": 3,
    "HOLD": 4,
    "LOITER": 5,
    "AUTO": 10,
    "RTL": 11,
    "SMART_RTL": 12,
    "GUIDED": 15,
}
_PX4_MODES = {
    "MANUAL": _px4(1),
    "ALTCTL": _px4(2),
    "POSCTL": _px4(3),
    "READY": _px4(4, 1),
    "TAKEOFF": _px4(4, 2),
    "LOITER": _px4(4, 3),
    "MISSION": _px4(4, 4),
    "RTL": _px4(4, 5),
    "LAND": _px4(4, 6),
    "ACRO": _px4(5),
    "OFFBOARD": _px4(6),
    "STABILIZED": _px4(7),
}


@dataclass(frozen=True, slots=True, eq=False)
class Flavour:
    """An autopilot on a kind of machine.

    Attributes:
        name: For people.
        autopilot: Its number in a heartbeat.
        vehicle_type: Likewise, of the machine.
        flies: Whether it flies.
        modes: The numbers of its modes by their names.
        guided: The mode in which a program steers.
        hold: The mode in which it stays where it is by itself.
    """

    name: str
    autopilot: int
    vehicle_type: int
    flies: bool
    modes: Mapping[str, int]
    guided: str
    hold: str

    @property
    def is_px4(self) -> bool:
        """Whether it is PX4, which leaves its guided mode where setpoints do not keep coming."""
        return self.autopilot == PX4

    def mode_name(self, custom_mode: int) -> str:
        """Return the name of a mode by its number."""
        for name, number in self.modes.items():
            if number == custom_mode:
                return name
        return f"mode {custom_mode}"


ARDUCOPTER = Flavour("ArduCopter", ARDUPILOT, 2, True, MappingProxyType(_COPTER_MODES), "GUIDED", "BRAKE")  # noqa: FBT003
ARDUROVER = Flavour("ArduRover", ARDUPILOT, 10, False, MappingProxyType(_ROVER_MODES), "GUIDED", "HOLD")  # noqa: FBT003
PX4_COPTER = Flavour("PX4 drone", PX4, 2, True, MappingProxyType(_PX4_MODES), "OFFBOARD", "LOITER")  # noqa: FBT003
PX4_ROVER = Flavour("PX4 rover", PX4, 10, False, MappingProxyType(_PX4_MODES), "OFFBOARD", "LOITER")  # noqa: FBT003
#: By the names that people use.
FLAVOURS = MappingProxyType(
    {"arducopter": ARDUCOPTER, "ardurover": ARDUROVER, "px4": PX4_COPTER, "px4-rover": PX4_ROVER}
)


def flavour_of(autopilot: int, vehicle_type: int) -> Flavour | None:
    """Return the flavour of an autopilot by what its heartbeat says; None where this package knows no such."""
    if vehicle_type not in FLYING_TYPES | DRIVING_TYPES:
        return None
    flies = vehicle_type in FLYING_TYPES
    return next((one for one in FLAVOURS.values() if (one.autopilot, one.flies) == (autopilot, flies)), None)
