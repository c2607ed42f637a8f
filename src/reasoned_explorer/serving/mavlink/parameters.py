"""A served autopilot's parameters: few, and those that do something here."""

import math
import struct
from dataclasses import dataclass

from reasoned_explorer.vehicles.mavlink.flavours import Flavour

#: Kinds of values on the wire, of the enumeration MAV_PARAM_TYPE.
INT32, REAL32 = 6, 9
#: What the failsafe for a lost ground station does: nothing, stay, come home, land.
NOTHING, HOLD, HOME, LANDING = 0, 1, 2, 3
#: What a number of ArduCopter's FS_GCS_ENABLE means; others are not served.
_COPTER_ACTIONS = {0: NOTHING, 1: HOME, 5: LANDING, 7: HOLD}


@dataclass(slots=True)
class Parameter:
    """One parameter.

    Attributes:
        value: Its value.
        low: The least that it may be.
        high: The most.
        kind: How it travels.
    """

    value: float
    low: float
    high: float
    kind: int = REAL32


class Parameters:
    """Parameters by name, in the order of their names.

    Args:
        flavour: Whose.
        speed_mps: The machine's cruise speed.
    """

    def __init__(self, flavour: Flavour, speed_mps: float) -> None:
        self._is_px4 = flavour.is_px4
        if flavour.is_px4:
            made = {
                "COM_DL_LOSS_T": Parameter(10.0, 5.0, 300.0, INT32),
                "COM_OF_LOSS_T": Parameter(1.0, 0.0, 60.0),
                "MAV_SYS_ID": Parameter(1.0, 1.0, 250.0, INT32),
                "MPC_XY_VEL_MAX": Parameter(12.0, 0.05, 20.0),
                "NAV_DLL_ACT": Parameter(2.0, 0.0, 2.0, INT32),
            }
        elif flavour.flies:
            made = {
                "FS_GCS_ENABLE": Parameter(1.0, 0.0, 7.0),
                "FS_GCS_TIMEOUT": Parameter(5.0, 2.0, 120.0),
                "GUID_TIMEOUT": Parameter(3.0, 0.1, 5.0),
                "LAND_SPEED": Parameter(100.0, 30.0, 200.0),
                "SYSID_THISMAV": Parameter(1.0, 1.0, 255.0),
                "WPNAV_SPEED": Parameter(100.0 * speed_mps, 5.0, 2000.0),
            }
        else:
            made = {
                "FS_ACTION": Parameter(2.0, 0.0, 2.0),
                "FS_GCS_TIMEOUT": Parameter(5.0, 2.0, 120.0),
                "FS_TIMEOUT": Parameter(1.5, 1.0, 100.0),
                "GUID_TIMEOUT": Parameter(3.0, 0.1, 5.0),
                "SYSID_THISMAV": Parameter(1.0, 1.0, 255.0),
                "WP_SPEED": Parameter(speed_mps, 0.05, 100.0),
            }
        self._all = made
        self.names = tuple(made)

    def __getitem__(self, name: str) -> Parameter:
        return self._all[name]

    def __len__(self) -> int:
        return len(self.names)

    def name_of(self, name: str, index: int) -> str | None:
        """Return which parameter is meant, by its index or, where that is negative, by its name."""
        if index >= 0:
            return self.names[index] if index < len(self.names) else None
        return name if name in self._all else None

    def set(self, name: str, wire_value: float) -> bool:
        """Set one by what came; return whether it may have that value."""
        one, value = self._all[name], self._from_wire(self._all[name], wire_value)
        if not (math.isfinite(value) and one.low <= value <= one.high):
            return False
        one.value = value
        return True

    def wire_value(self, name: str) -> float:
        """Return a value as it travels: PX4 sends the bytes of whole numbers in the place of a float's."""
        one = self._all[name]
        if self._is_px4 and one.kind == INT32:
            made: float = struct.unpack("<f", struct.pack("<i", round(one.value)))[0]
            return made
        return one.value

    @property
    def station_action(self) -> int:
        """What is done when the ground station is lost."""
        if self._is_px4:
            return round(self["NAV_DLL_ACT"].value)
        if "FS_ACTION" in self._all:
            return {0: NOTHING, 1: HOME, 2: HOLD}[round(self["FS_ACTION"].value)]
        return _COPTER_ACTIONS.get(round(self["FS_GCS_ENABLE"].value), HOME)

    @property
    def station_lost_s(self) -> float:
        """After how many seconds without its heartbeat it is."""
        # A rover of ArduPilot waits for one and then for the other.
        names = ("COM_DL_LOSS_T", "FS_GCS_TIMEOUT", "FS_TIMEOUT")
        return sum(self[name].value for name in names if name in self._all)

    def _from_wire(self, one: Parameter, value: float) -> float:
        if self._is_px4 and one.kind == INT32 and math.isfinite(value):
            try:
                whole: int = struct.unpack("<i", struct.pack("<f", value))[0]
            except OverflowError:
                return math.nan
            return float(whole)
        return value
