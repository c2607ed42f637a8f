"""What befalls a simulated machine, to try out whether it is kept safe: a lost link, a position that jumps."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within


class MishapKind(StrEnum):
    """What can befall a machine."""

    LINK_LOSS = "link loss"
    POSITION_JUMP = "position jump"
    POSITION_SILENCE = "position silence"
    COMPASS_OFF = "compass off"
    CAMERA_SILENCE = "camera silence"
    BATTERY_LOW = "battery low"


@dataclass(frozen=True, slots=True)
class Mishap:
    """Something that befalls a machine.

    Attributes:
        kind: What.
        from_s: From when on, on the simulator's time, seconds.
        until_s: Until when.
        amount: How much: metres eastwards of a jump, radians clockwise of a compass, share that a battery is left with.

    Raises:
        SettingsError: If a value is out of range.
    """

    kind: MishapKind
    from_s: float = 0.0
    until_s: float = math.inf
    amount: float = 0.0

    def __post_init__(self) -> None:
        if not is_within(self.from_s, 0.0) or not self.until_s >= self.from_s or not is_within(self.amount):
            fault = Fault(f"{self}", "0 ≤ from_s ≤ until_s and a finite amount")
            raise SettingsError("mishap", [fault])


@dataclass(frozen=True, slots=True)
class Mishaps:
    """All that befalls one machine."""

    planned: Sequence[Mishap] = ()

    def at(self, kind: MishapKind, now_s: float) -> Mishap | None:
        """Return what of a kind is going on at a time, if anything."""
        return next((one for one in self.planned if one.kind is kind and one.from_s <= now_s < one.until_s), None)

    def next_s(self, kind: MishapKind, now_s: float) -> float:
        """Return when something of a kind goes on from a time on: now, later, or never (infinity)."""
        return min(
            (max(now_s, one.from_s) for one in self.planned if one.kind is kind and now_s < one.until_s),
            default=math.inf,
        )

    def told(self, pose: Pose, now_s: float) -> Pose:
        """Return where a machine takes itself to be that would take itself to be at a pose."""
        jump, turn = self.at(MishapKind.POSITION_JUMP, now_s), self.at(MishapKind.COMPASS_OFF, now_s)
        east_m, off_rad = (0.0 if one is None else one.amount for one in (jump, turn))
        if jump is None and turn is None:
            return pose
        return replace(pose, x_m=pose.x_m + east_m, heading_rad=normalise_heading_rad(pose.heading_rad + off_rad))

    def silent_s(self, kind: MishapKind, now_s: float) -> float:
        """Return for how long something has been silent; 0 where it is not."""
        going_on = self.at(kind, now_s)
        return 0.0 if going_on is None else now_s - going_on.from_s
