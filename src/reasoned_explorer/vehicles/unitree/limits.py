"""How fast a Go1 is ever asked to move."""

import math
from dataclasses import dataclass, fields, replace

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.unitree.messages import HighCommand, Mode


@dataclass(frozen=True, slots=True)
class CommandLimits:
    """What a command is cut down to before it is sent. The defaults are a brisk walk, well below what the robot can do.

    Attributes:
        forward_mps: Largest speed ahead, metres a second, > 0 and at most 1.5.
        backward_mps: Largest speed backwards, at most 1.0.
        sideways_mps: Largest speed to either side, at most 1.0.
        turn_radps: Largest turn rate to either side, radians a second, at most 3.0.

    Raises:
        SettingsError: If a limit is out of its range.
    """

    forward_mps: float = 1.0
    backward_mps: float = 0.4
    sideways_mps: float = 0.4
    turn_radps: float = 1.5

    def __post_init__(self) -> None:
        most = {"forward_mps": 1.5, "backward_mps": 1.0, "sideways_mps": 1.0, "turn_radps": 3.0}
        faults = [
            Fault(f"{item.name} = {getattr(self, item.name)}", f"a number > 0 and ≤ {most[item.name]}")
            for item in fields(self)
            if not 0.0 < getattr(self, item.name) <= most[item.name]
        ]
        if faults:
            raise SettingsError("limits of a Go1", faults)

    def cut(self, command: HighCommand) -> HighCommand:
        """Return what is really sent for a command.

        Speeds are cut to the limits, the direction of the velocity kept. A number that is not finite makes the robot
        stand, and so does every mode in which it would find its own way.
        """
        numbers = (
            command.forward_mps,
            command.left_mps,
            command.yaw_rate_left_radps,
            command.foot_raise_m,
            command.body_height_m,
            *command.euler_rad,
        )
        if not all(map(math.isfinite, numbers)) or command.mode in (Mode.WALK_TO_POSITION, Mode.WALK_PATH):
            return HighCommand.standing()
        if command.mode is not Mode.WALK:
            return replace(command, forward_mps=0.0, left_mps=0.0, yaw_rate_left_radps=0.0)
        ahead = self.forward_mps if command.forward_mps >= 0.0 else self.backward_mps
        over = max(abs(command.forward_mps) / ahead, abs(command.left_mps) / self.sideways_mps, 1.0)
        turn = max(-self.turn_radps, min(self.turn_radps, command.yaw_rate_left_radps))
        return replace(
            command,
            forward_mps=command.forward_mps / over,
            left_mps=command.left_mps / over,
            yaw_rate_left_radps=turn,
        )
