"""Unitree's Go1 over its high-level UDP protocol: what the packets say, and the link that carries them.

`HighCommand` goes to the robot, `HighState` comes back; `encode_command` and its three siblings turn them into bytes
and back, for either end of the wire. Byte for byte as the vendor's library ``unitree_legged_sdk`` 3.8 lays them out;
high-level packets are not encrypted (the checksum of a state is scrambled, see `checksum`).

The robot's body frame is x forward, y left, z up, so that its yaw rates are positive to the left. Names say which it
is: `…_left_mps` and `…_left_radps` are the robot's, "right" is ours; `HighCommand.walking` and the properties of
`HighState` turn one into the other. Not yet tried on a real robot.
"""

from reasoned_explorer.vehicles.unitree.codec import (
    COMMAND_BYTES,
    STATE_BYTES,
    PacketError,
    decode_command,
    decode_state,
    encode_command,
    encode_state,
)
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.link import Go1Link, LinkCounts, LinkSettings
from reasoned_explorer.vehicles.unitree.messages import (
    BatteryReading,
    Gait,
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    MotorReading,
)

__all__ = [
    "COMMAND_BYTES",
    "STATE_BYTES",
    "BatteryReading",
    "CommandLimits",
    "Gait",
    "Go1Link",
    "HighCommand",
    "HighState",
    "ImuReading",
    "LinkCounts",
    "LinkSettings",
    "Mode",
    "MotorReading",
    "PacketError",
    "decode_command",
    "decode_state",
    "encode_command",
    "encode_state",
]
