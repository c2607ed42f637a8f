"""The served robot: the embedded simulator's body, walked by a Go1's commands."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from reasoned_explorer.geometry import Pose
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind, Mishaps
from reasoned_explorer.simulation.motion import TICK_S
from reasoned_explorer.simulation.sensors import SensorNoise, sensor_noise
from reasoned_explorer.simulation.vehicle import check_start
from reasoned_explorer.simulation.walking import SatelliteFix, WalkedBody
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.unitree.messages import (
    BatteryReading,
    Gait,
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    MotorReading,
)

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

#: Getting up and lying down take so many ticks.
_POSTURE_TICKS = 30
_STANDING_M, _LYING_M = 0.28, 0.08
_GRAVITY_MPS2 = 9.81
_NOBODY_NEAR_M = 4.0
_MODES_THAT_STAND = frozenset({Mode.IDLE, Mode.STAND})


@dataclass(slots=True)
class Health:
    """What the robot says of its battery and motors; tests and demonstrations change it.

    Attributes:
        charge_percent: Of its battery, 0 to 100.
        motor_c: Of all its motors, degrees centigrade.
    """

    charge_percent: int = 90
    motor_c: int = 35


class Walker:
    """A Go1 in a world. Its time goes on by `tick` alone, a twentieth of a second each.

    Args:
        atlas: Of the world.
        profile: What it can do.
        start: Where it stands at the start.
        noise: How its sensors err, or the name of a preset.
        seed: Of all draws.
        mishaps: What befalls it, on its own seconds: its receiver is silent or jumps, its yaw turns, its battery is
            low. It has no compass: its yaw is what serves for one.

    Raises:
        StartError: If it cannot stand there.
        UnknownNameError: If there is no such preset.
    """

    def __init__(
        self,
        atlas: "Atlas",
        profile: VehicleProfile,
        start: Pose,
        *,
        noise: SensorNoise | str = "none",
        seed: int = 0,
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        check_start(atlas, profile, start)
        self.noise = sensor_noise(noise) if isinstance(noise, str) else noise
        self.body = WalkedBody(atlas, profile, self.noise, start, seed=seed)
        self.health = Health()
        self.mishaps = Mishaps(tuple(mishaps))
        self.ticks = 0
        #: What the receiver last said.
        self.fix = SatelliteFix(True, start.x_m, start.y_m)  # noqa: FBT003 - has a fix
        self._command = HighCommand.standing()
        #: How far up it is: 0 lies, `_POSTURE_TICKS` stands.
        self._height = _POSTURE_TICKS
        self._is_soft = False

    @property
    def time_s(self) -> float:
        """How long it has been on, seconds."""
        return self.ticks * TICK_S

    @property
    def is_upright(self) -> bool:
        """Whether it stands on its legs."""
        return self._height == _POSTURE_TICKS and not self._is_soft

    def obey(self, command: HighCommand) -> None:
        """Take a command, which holds until the next."""
        self._command = command

    def tick(self) -> SatelliteFix | None:
        """Carry on; return what the receiver says, where it says something."""
        command, body = self._command, self.body
        if command.mode == Mode.DAMPING:
            self._is_soft = True
        elif command.mode in (Mode.GET_UP, Mode.RECOVER):
            self._is_soft = False
        sinks = self._is_soft or command.mode == Mode.LIE_DOWN
        if command.mode is Mode.WALK and self.is_upright:
            fix = body.walk(
                forward_mps=command.forward_mps,
                right_mps=-command.left_mps,
                turn_radps=-command.yaw_rate_left_radps,
            )
        else:
            fix = body.stand()
            if sinks and (body.is_resting or self._is_soft):
                self._height = max(0, self._height - 1)
            elif command.mode in (Mode.GET_UP, Mode.RECOVER):
                self._height = min(_POSTURE_TICKS, self._height + 1)
        self.ticks += 1
        if fix is None or self.mishaps.at(MishapKind.POSITION_SILENCE, self.time_s):
            return None
        if fix.has_fix and (jump := self.mishaps.at(MishapKind.POSITION_JUMP, self.time_s)):
            fix = replace(fix, x_m=fix.x_m + jump.amount)
        self.fix = fix
        return fix

    @property
    def mode(self) -> Mode:
        """What it does."""
        if self._is_soft:
            return Mode.DAMPING
        if self._height < _POSTURE_TICKS:
            return Mode.GET_UP if self._command.mode in (Mode.GET_UP, Mode.RECOVER) else Mode.LIE_DOWN
        if self._command.mode is Mode.WALK or not self.body.is_resting:
            return Mode.WALK
        return self._command.mode if self._command.mode in _MODES_THAT_STAND else Mode.STAND

    def state(self) -> HighState:
        """Return what it says of itself."""
        sensed, health = self.body.sensed, self.health
        turned, low = (self.mishaps.at(kind, self.time_s) for kind in (MishapKind.COMPASS_OFF, MishapKind.BATTERY_LOW))
        yaw_rad = sensed.yaw_rad + (0.0 if turned is None else turned.amount)
        yaw_left = math.remainder(-yaw_rad, 2.0 * math.pi)
        half = 0.5 * yaw_left
        share = self._height / _POSTURE_TICKS
        motor = MotorReading(mode=10, temperature_c=health.motor_c)
        return HighState(
            imu=ImuReading(
                quaternion=(math.cos(half), 0.0, 0.0, math.sin(half)),
                gyroscope_radps=(0.0, 0.0, -sensed.turn_radps),
                accelerometer_mps2=(0.0, 0.0, _GRAVITY_MPS2),
                rpy_rad=(0.0, 0.0, yaw_left),
                temperature_c=health.motor_c,
            ),
            motors=(motor,) * 12 + (MotorReading(),) * 8,
            battery=BatteryReading(
                status=8,
                charge_percent=health.charge_percent if low is None else round(100.0 * low.amount),
                current_ma=-3000,
                battery_temperature_c=(30, 30),
                board_temperature_c=(32, 32),
                cell_voltage_mv=(3800,) * 6 + (0,) * 4,
            ),
            foot_force=(90,) * 4 if self.is_upright else (0,) * 4,
            mode=self.mode,
            gait=Gait.TROT if self.mode is Mode.WALK else Gait.IDLE,
            odometry_m=(sensed.ahead_m, -sensed.aside_m, _LYING_M + share * (_STANDING_M - _LYING_M)),
            body_height_m=_LYING_M + share * (_STANDING_M - _LYING_M),
            velocity_mps=(sensed.forward_mps, -sensed.right_mps, -sensed.turn_radps),
            yaw_rate_left_radps=-sensed.turn_radps,
            range_obstacle_m=(_NOBODY_NEAR_M,) * 4,
        )


def numbered(state: HighState, number: int, fixes: int) -> HighState:
    """Return a state that answers a numbered command, with how many fixes have been sent beside it."""
    return replace(state, reserve=number, serial_number=(fixes, 0))
