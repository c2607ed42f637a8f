"""The follower of a straight leg: from where the machine believes it is, to the next command.

It turns towards the target (in place, where the bearing is large and the machine cannot move sideways), follows the
straight line with a heading PID and a speed that brakes in time, stops, and turns to the heading that is asked for. It
has arrived within a distance of the target, or past the perpendicular through it; without progress it is stuck.
"""

import math
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import positive_faults
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.kernels import Floats
from reasoned_explorer.vehicles.control.pid import PidGains
from reasoned_explorer.vehicles.profile import VehicleProfile


class Phase(IntEnum):
    """What a follower is at."""

    TURN = kernels.PHASE_TURN
    DRIVE = kernels.PHASE_DRIVE
    BRAKE = kernels.PHASE_BRAKE
    FACE = kernels.PHASE_FACE
    ARRIVED = kernels.PHASE_ARRIVED
    STUCK = kernels.PHASE_STUCK


@dataclass(frozen=True, slots=True)
class Command:
    """What a machine is told to do until the next step.

    Attributes:
        forward_mps: Speed ahead, metres a second.
        right_mps: Speed to the right, metres a second; 0 for machines that do not move sideways.
        yaw_rate_radps: Turning, radians a second, positive clockwise.
        phase: What the follower is at.
    """

    forward_mps: float
    right_mps: float
    yaw_rate_radps: float
    phase: Phase


_HEADING_GAINS = PidGains(2.5, integral=0.3, derivative=0.1, integral_limit=0.1)


@dataclass(frozen=True, slots=True)
class FollowerSettings:
    """How a leg is followed. All values are positive and finite.

    Attributes:
        speed_mps: Cruise speed.
        acceleration_mps2: Largest change of the commanded velocity.
        braking_mps2: What slowing down before the target is planned with; less than the acceleration.
        turn_rate_radps: Largest commanded yaw rate.
        turn_acceleration_radps2: Largest change of it.
        sideways: Whether the machine moves in any direction whatever it faces.
        turn_in_place_above_rad: Off-course angle from which a machine that cannot move sideways stops to turn.
        turn_in_place_below_rad: Off-course angle below which it drives again.
        lookahead_m: How far along the line the point lies that is aimed at.
        arrival_m: Distance at which the final stop begins.
        facing_rad: How well the final heading is met.
        stuck_s: Seconds without progress that mean "stuck".
        stuck_m: What counts as progress, metres.
        stuck_rad: What counts as progress while turning, radians.
        heading_gains: Of the heading PID: yaw rate per heading error.

    Raises:
        SettingsError: If a value is not positive and finite, or two are at odds.
    """

    speed_mps: float
    acceleration_mps2: float
    braking_mps2: float
    turn_rate_radps: float
    turn_acceleration_radps2: float
    sideways: bool = False
    turn_in_place_above_rad: float = math.radians(40.0)
    turn_in_place_below_rad: float = math.radians(8.0)
    lookahead_m: float = 1.5
    arrival_m: float = 0.2
    facing_rad: float = math.radians(3.0)
    stuck_s: float = 4.0
    stuck_m: float = 0.1
    stuck_rad: float = math.radians(3.0)
    heading_gains: PidGains = _HEADING_GAINS

    def __post_init__(self) -> None:
        numbers = {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if item.name not in {"sideways", "heading_gains"}
        }
        faults = positive_faults(numbers.items())
        if self.braking_mps2 > self.acceleration_mps2:
            faults.append(Fault(f"braking_mps2 = {self.braking_mps2}", f"at most {self.acceleration_mps2}"))
        if self.turn_in_place_below_rad >= self.turn_in_place_above_rad:
            what = f"turn_in_place_below_rad = {self.turn_in_place_below_rad}"
            faults.append(Fault(what, f"less than turn_in_place_above_rad = {self.turn_in_place_above_rad}"))
        if faults:
            raise SettingsError("follower settings", faults)

    @classmethod
    def of(cls, profile: VehicleProfile) -> "FollowerSettings":
        """Return the settings for a machine: its limits, and a look-ahead that grows with its speed."""
        return cls(
            speed_mps=profile.speed_mps,
            acceleration_mps2=profile.acceleration_mps2,
            braking_mps2=0.7 * profile.acceleration_mps2,
            turn_rate_radps=profile.turn_rate_radps,
            turn_acceleration_radps2=profile.turn_acceleration_radps2,
            sideways=profile.moves_sideways,
            lookahead_m=max(1.0, profile.speed_mps),
            # A slow machine stops within centimetres: it need not begin a hand's breadth before.
            arrival_m=min(0.2, max(0.05, 0.75 * profile.speed_mps**2 / profile.acceleration_mps2)),
        )

    def as_array(self) -> Floats:
        """Return the settings in the order that the kernels read, shape (14,)."""
        return np.array(
            [
                self.speed_mps,
                self.acceleration_mps2,
                self.braking_mps2,
                self.turn_rate_radps,
                self.turn_acceleration_radps2,
                float(self.sideways),
                self.turn_in_place_above_rad,
                self.turn_in_place_below_rad,
                self.lookahead_m,
                self.arrival_m,
                self.facing_rad,
                self.stuck_s,
                self.stuck_m,
                self.stuck_rad,
            ]
        )

    def gains_array(self) -> Floats:
        """Return the heading PID's gains, limited to the turn rate, shape (5,)."""
        gains = self.heading_gains.as_array()
        gains[kernels.PID_LIMIT] = min(gains[kernels.PID_LIMIT], self.turn_rate_radps)
        return gains


class PidFollower:
    """Follows one straight leg after the other; for drivers of real machines and for tests.

    Args:
        settings: How legs are followed.
    """

    def __init__(self, settings: FollowerSettings) -> None:
        self.settings = settings
        self._settings = settings.as_array()
        self._gains = settings.gains_array()
        self._memory = np.zeros(kernels.MEM_SIZE)
        self._memory[kernels.MEM_PHASE] = kernels.PHASE_ARRIVED

    @property
    def phase(self) -> Phase:
        """What the follower is at; ARRIVED before the first leg."""
        return Phase(int(self._memory[kernels.MEM_PHASE]))

    @property
    def cross_track_m(self) -> float:
        """Distance of the last estimated position from the straight line, positive to its right, metres."""
        return float(self._memory[kernels.MEM_CROSS])

    def start(self, pose: Pose, target: Pose, *, face: bool = True) -> None:
        """Set off for a target.

        Args:
            pose: Where the machine believes it is.
            target: Where to go.
            face: Whether to turn to the target's heading in the end.

        Raises:
            SettingsError: If a coordinate is not finite.
        """
        faults = [
            Fault(f"{name} = {item}", "finite coordinates and heading")
            for name, item in (("pose", pose), ("target", target))
            if not is_finite(item.x_m, item.y_m, item.heading_rad)
        ]
        if faults:
            raise SettingsError("leg", faults)
        heading = target.heading_rad if face else math.nan
        kernels.follower_start(self._memory, pose.x_m, pose.y_m, target.x_m, target.y_m, heading, kernels.PHASE_DRIVE)

    def face(self, pose: Pose, heading_rad: float) -> None:
        """Set off to turn in place, to a heading.

        Raises:
            SettingsError: If a coordinate is not finite.
        """
        self.start(pose, pose.facing(heading_rad))
        self._memory[kernels.MEM_PHASE] = kernels.PHASE_FACE

    def step(self, pose: Pose, *, yaw_rate_radps: float, dt_s: float) -> Command:
        """Return the next command.

        Args:
            pose: Where the machine believes it is now.
            yaw_rate_radps: Its measured yaw rate, positive clockwise.
            dt_s: Seconds since the last step, > 0.
        """
        phase = kernels.follower_step(
            self._settings, self._gains, self._memory, pose.x_m, pose.y_m, pose.heading_rad, yaw_rate_radps, dt_s
        )
        if phase in {kernels.PHASE_ARRIVED, kernels.PHASE_STUCK}:
            # Whatever ends a leg, the machine stands still afterwards.
            self._memory[kernels.MEM_FORWARD] = self._memory[kernels.MEM_RIGHT] = self._memory[kernels.MEM_RATE] = 0.0
        memory = self._memory
        return Command(
            float(memory[kernels.MEM_FORWARD]),
            float(memory[kernels.MEM_RIGHT]),
            float(memory[kernels.MEM_RATE]),
            Phase(phase),
        )
