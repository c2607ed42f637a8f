"""What the high-level packets of a Go1 say, as values with units."""

import math
from dataclasses import dataclass, field
from enum import IntEnum

#: What a packet of the protocol begins with, and the flag of its high level.
HEAD = (0xFE, 0xEF)
HIGH_LEVEL = 0xEE

_NO_PAIR = (0.0, 0.0)
_NO_TRIPLE = (0.0, 0.0, 0.0)
_NO_QUAD = (0.0, 0.0, 0.0, 0.0)
_REMOTE = bytes(40)

Pair = tuple[float, float]
Triple = tuple[float, float, float]
Quad = tuple[float, float, float, float]


class Mode(IntEnum):
    """What the robot is to do, or does. Those that jump or dance are left out: none is ever sent or understood."""

    IDLE = 0
    STAND = 1
    WALK = 2
    WALK_TO_POSITION = 3
    WALK_PATH = 4
    LIE_DOWN = 5
    GET_UP = 6
    DAMPING = 7
    RECOVER = 8


class Gait(IntEnum):
    """How it moves its legs."""

    IDLE = 0
    TROT = 1
    TROT_RUNNING = 2
    CLIMB_STAIRS = 3
    TROT_OBSTACLE = 4


@dataclass(frozen=True, slots=True)
class HighCommand:
    """A command, HighCmd on the wire.

    Attributes:
        mode: What to do.
        gait: How to move the legs; heeded while walking.
        speed_level: 0 slow, 1 medium, 2 fast; heeded only while walking to a position.
        foot_raise_m: Added to the height to which feet are raised, metres.
        body_height_m: Added to the height of the body, metres.
        position_m: Where to walk to, in the frame of the robot's own odometry, metres.
        euler_rad: Roll, pitch and yaw of the body while it stands.
        forward_mps: Speed ahead while walking.
        left_mps: Speed to the left.
        yaw_rate_left_radps: Turn rate, positive to the left (counterclockwise seen from above).
        battery_off: Switches the battery off where it is 0xA5; anything else does nothing.
        led_rgb: Brightness of red, green and blue of the four feet, 0 to 255, 12 values.
        wireless_remote: 40 bytes of the remote control, as they are.
        serial_number: Two words; zeros do.
        version: Two words; zeros do.
        band_width: Zero does.
        frame_reserve: Zero.
        reserve: Zero.
    """

    mode: Mode = Mode.IDLE
    gait: Gait = Gait.IDLE
    speed_level: int = 0
    foot_raise_m: float = 0.0
    body_height_m: float = 0.0
    position_m: Pair = _NO_PAIR
    euler_rad: Triple = _NO_TRIPLE
    forward_mps: float = 0.0
    left_mps: float = 0.0
    yaw_rate_left_radps: float = 0.0
    battery_off: int = 0
    led_rgb: tuple[int, ...] = (0,) * 12
    wireless_remote: bytes = _REMOTE
    serial_number: tuple[int, int] = (0, 0)
    version: tuple[int, int] = (0, 0)
    band_width: int = 0
    frame_reserve: int = 0
    reserve: int = 0

    @classmethod
    def standing(cls) -> "HighCommand":
        """Return the command to stand still on its legs."""
        return cls(Mode.STAND)

    @classmethod
    def damping(cls) -> "HighCommand":
        """Return the command to let all motors go soft: the robot sinks to the ground. The stop of last resort."""
        return cls(Mode.DAMPING)

    @classmethod
    def walking(cls, *, forward_mps: float, right_mps: float = 0.0, turn_radps: float = 0.0) -> "HighCommand":
        """Return the command to trot with a velocity.

        Args:
            forward_mps: Ahead.
            right_mps: To the right.
            turn_radps: Turn rate, positive clockwise as everywhere in this package.
        """
        return cls(
            Mode.WALK,
            Gait.TROT,
            forward_mps=forward_mps,
            left_mps=0.0 - right_mps,
            yaw_rate_left_radps=0.0 - turn_radps,
        )

    @property
    def moves(self) -> bool:
        """Whether it makes the robot walk."""
        return self.mode in (Mode.WALK, Mode.WALK_TO_POSITION, Mode.WALK_PATH)


@dataclass(frozen=True, slots=True)
class ImuReading:
    """The body's inertial unit.

    Attributes:
        quaternion: Attitude (w, x, y, z), norm 1.
        gyroscope_radps: Turn rates about x, y and z of the body (x forward, y left, z up).
        accelerometer_mps2: Accelerations along them, gravity included (+9.8 along z at rest).
        rpy_rad: Roll, pitch and yaw, yaw positive to the left and zero where the robot was switched on.
        temperature_c: Degrees centigrade.
    """

    quaternion: Quad = (1.0, 0.0, 0.0, 0.0)
    gyroscope_radps: Triple = _NO_TRIPLE
    accelerometer_mps2: Triple = _NO_TRIPLE
    rpy_rad: Triple = _NO_TRIPLE
    temperature_c: int = 0


@dataclass(frozen=True, slots=True)
class MotorReading:
    """A motor of a leg.

    Attributes:
        mode: Its working mode.
        angle_rad: Of the joint.
        rate_radps: Its rate.
        acceleration_radps2: Its acceleration.
        torque_nm: Estimated, newton metres.
        raw_angle_rad: The angle before filtering.
        raw_rate_radps: The rate before filtering.
        raw_acceleration_radps2: The acceleration before filtering.
        temperature_c: Degrees centigrade; follows slowly.
        reserve: Two words.
    """

    mode: int = 0
    angle_rad: float = 0.0
    rate_radps: float = 0.0
    acceleration_radps2: float = 0.0
    torque_nm: float = 0.0
    raw_angle_rad: float = 0.0
    raw_rate_radps: float = 0.0
    raw_acceleration_radps2: float = 0.0
    temperature_c: int = 0
    reserve: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True)
class BatteryReading:
    """The battery.

    Attributes:
        version: High and low part.
        status: Its own code.
        charge_percent: 0 to 100.
        current_ma: Milliamperes, positive while it is charged.
        cycles: How often it was charged.
        battery_temperature_c: Two sensors of the cells.
        board_temperature_c: Two sensors of its board.
        cell_voltage_mv: Ten cells, millivolts.
    """

    version: tuple[int, int] = (0, 0)
    status: int = 0
    charge_percent: int = 0
    current_ma: int = 0
    cycles: int = 0
    battery_temperature_c: tuple[int, int] = (0, 0)
    board_temperature_c: tuple[int, int] = (0, 0)
    cell_voltage_mv: tuple[int, ...] = (0,) * 10


@dataclass(frozen=True, slots=True)
class HighState:
    """What the robot tells of itself, HighState on the wire.

    Attributes:
        imu: Its inertial unit.
        motors: 20 motors, of which a Go1 has the first 12.
        battery: Its battery.
        foot_force: Of four feet, the sensors' own units.
        foot_force_estimate: Likewise, estimated from the motors.
        mode: What it does, a `Mode` or a number that this package never asks for.
        progress: Of what it does, reserved.
        gait: How it moves its legs, a `Gait` where it is a known one.
        foot_raise_m: How high feet are raised while walking.
        odometry_m: Where it believes it is by its legs, x, y, z of a frame that starts where it was switched on.
        body_height_m: Above the ground.
        velocity_mps: Of the body: ahead, left, and (the vendor's own words) rotation.
        yaw_rate_left_radps: Turn rate, positive to the left.
        range_obstacle_m: Distances to what its sensors see, four of them.
        foot_position_m: Of each foot from the body, x, y, z.
        foot_velocity_mps: Of each foot against the body.
        wireless_remote: 40 bytes of the remote control.
        serial_number: Two words.
        version: Two words.
        band_width: Of the link.
        frame_reserve: As it came.
        reserve: As it came.
    """

    imu: ImuReading = field(default_factory=ImuReading)
    motors: tuple[MotorReading, ...] = (MotorReading(),) * 20
    battery: BatteryReading = field(default_factory=BatteryReading)
    foot_force: tuple[int, ...] = (0,) * 4
    foot_force_estimate: tuple[int, ...] = (0,) * 4
    mode: int = Mode.IDLE
    progress: float = 0.0
    gait: int = Gait.IDLE
    foot_raise_m: float = 0.0
    odometry_m: Triple = _NO_TRIPLE
    body_height_m: float = 0.0
    velocity_mps: Triple = _NO_TRIPLE
    yaw_rate_left_radps: float = 0.0
    range_obstacle_m: Quad = _NO_QUAD
    foot_position_m: tuple[Triple, ...] = (_NO_TRIPLE,) * 4
    foot_velocity_mps: tuple[Triple, ...] = (_NO_TRIPLE,) * 4
    wireless_remote: bytes = _REMOTE
    serial_number: tuple[int, int] = (0, 0)
    version: tuple[int, int] = (0, 0)
    band_width: int = 0
    frame_reserve: int = 0
    reserve: int = 0

    @property
    def forward_mps(self) -> float:
        """Speed ahead by its legs."""
        return self.velocity_mps[0]

    @property
    def right_mps(self) -> float:
        """Speed to the right by its legs."""
        return 0.0 - self.velocity_mps[1]

    @property
    def turn_radps(self) -> float:
        """Turn rate of its gyroscope about the body's z, positive clockwise as everywhere in this package."""
        return 0.0 - self.imu.gyroscope_radps[2]

    @property
    def horizontal_acceleration_mps2(self) -> tuple[float, float]:
        """Acceleration ahead and to the right without gravity, as far as the attitude tells.

        Gravity is taken out by roll and pitch; what is left of it where they err by a degree is 0.17 m/s².
        """
        roll, pitch = self.imu.rpy_rad[0], self.imu.rpy_rad[1]
        ahead, left, up = self.imu.accelerometer_mps2
        rolled = left * math.cos(roll) - up * math.sin(roll)
        lifted = left * math.sin(roll) + up * math.cos(roll)
        return ahead * math.cos(pitch) + lifted * math.sin(pitch), 0.0 - rolled
