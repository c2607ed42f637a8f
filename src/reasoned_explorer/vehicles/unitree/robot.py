"""A walking robot as the tracker sees it: told a velocity for a moment, it says what it sensed at the moment's end."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from reasoned_explorer.geometry import normalise_heading_rad
from reasoned_explorer.vehicles.unitree.messages import HighState, Mode


@dataclass(frozen=True, slots=True)
class Velocity:
    """How fast to walk.

    Attributes:
        forward_mps: Ahead, metres a second.
        right_mps: To the right.
        turn_radps: Turn rate, radians a second, positive clockwise.
    """

    forward_mps: float
    right_mps: float = 0.0
    turn_radps: float = 0.0


@dataclass(frozen=True, slots=True)
class BodyReading:
    """What a robot said of itself.

    Attributes:
        time_s: When it was heard, on the robot's `Robot.now_s`.
        turn_radps: Gyro, positive clockwise.
        forward_mps: Legs' velocity ahead.
        right_mps: Legs' velocity to the right.
        yaw_rad: By its inertial unit, clockwise, [0, 2π); zero is where it was switched on, or anywhere.
        ahead_m: Where its legs believe it to be, in the frame whose yaw is zero: along its x.
        aside_m: Likewise, to the right of that.
        lies: Whether it lies or has let its motors go: it must get up before it can walk.
        battery_percent: Charge, 0 to 100; None where it does not say.
        hottest_motor_c: Of its motors, degrees centigrade; None where it does not say.
    """

    time_s: float
    turn_radps: float
    forward_mps: float
    right_mps: float
    yaw_rad: float
    ahead_m: float
    aside_m: float
    lies: bool = False
    battery_percent: float | None = None
    hottest_motor_c: float | None = None

    @classmethod
    def of(cls, state: HighState, time_s: float) -> "BodyReading":
        """Return what a Go1's state says; its frame's y and its turns are to the left."""
        motors = [motor.temperature_c for motor in state.motors[:12]]
        return cls(
            time_s,
            state.turn_radps,
            state.forward_mps,
            state.right_mps,
            normalise_heading_rad(0.0 - state.imu.rpy_rad[2]),
            state.odometry_m[0],
            0.0 - state.odometry_m[1],
            lies=state.mode in (Mode.LIE_DOWN, Mode.DAMPING),
            battery_percent=float(state.battery.charge_percent),
            hottest_motor_c=float(max(motors)),
        )

    @property
    def speed_mps(self) -> float:
        """Speed by its legs."""
        return math.hypot(self.forward_mps, self.right_mps)


class Robot(ABC):
    """The link to a robot. Its coroutines run in one event loop, that in which it was started.

    Attributes:
        name: For messages.
        period_s: How long a moment is, seconds.
        is_stepped: Whether its time goes on only by moments that it is told to let pass.
    """

    name: str
    period_s: float
    is_stepped: bool = False

    @abstractmethod
    def now_s(self) -> float:
        """Return the robot's time, seconds: that of the clock, or where it is stepped, its own."""

    @abstractmethod
    async def start(self) -> None:
        """Open the link; the robot is told to stand.

        Raises:
            PartError: If that is not possible, or nothing is heard of it.
        """

    @abstractmethod
    async def close(self, *, lies: bool) -> None:
        """Leave the robot standing, or lying, and hang up. Safe to call twice."""

    @abstractmethod
    async def moment(self, velocity: Velocity | None) -> BodyReading:
        """Have it walk, or stand where no velocity is given, for a moment; return what it senses at its end.

        Raises:
            PartError: If nothing is heard of it. It has then been told to stand.
        """

    async def stand(self, moments: int) -> BodyReading:
        """Have it stand for one or more moments, as many as it can in one go; return what it senses then.

        Raises:
            PartError: See `moment`.
        """
        del moments
        return await self.moment(None)

    @abstractmethod
    async def get_up(self) -> None:
        """Have it rise to its feet.

        Raises:
            PartError: If it does not.
        """

    @abstractmethod
    def cut(self, velocity: Velocity) -> Velocity:
        """Return what is really sent for a velocity."""

    @property
    def silent_s(self) -> float:
        """For how long nothing has been heard of it, seconds; safe from any thread."""
        return 0.0

    @property
    def fixes_due(self) -> int:
        """How many fixes the receiver served beside a stepped robot has sent so far."""
        return 0
