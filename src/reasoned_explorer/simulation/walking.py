"""The simulated body, driven by velocities tick by tick, with what its sensors say."""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import draws
from reasoned_explorer.simulation import kernels
from reasoned_explorer.simulation.motion import NO_DISCS, NO_WALLS, TICK_S, Body, End
from reasoned_explorer.simulation.sensors import TICK_HZ, SensorNoise
from reasoned_explorer.simulation.vehicle import ground_on_foot, obstacles_on_leg
from reasoned_explorer.simulation.walk_kernels import satellite_fix, walk_tick
from reasoned_explorer.vehicles.profile import VehicleProfile

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

#: After a command to stand the body is at rest so many ticks later, as after a leg.
REST_TICKS = 6
#: Obstacles are gathered this far around the body, metres, and again when it has gone half of that.
_GATHER_M = 6.0
_ENDS = {
    kernels.END_WALL: End.WALL,
    kernels.END_DISC: End.DISC,
    kernels.END_GROUND: End.GROUND,
    kernels.END_EDGE: End.EDGE,
}


@dataclass(frozen=True, slots=True)
class Sensed:
    """What the body's own sensors say at the end of a tick.

    Attributes:
        turn_radps: Mean of the gyro over the tick, positive clockwise.
        forward_mps: Legs' velocity ahead.
        right_mps: Legs' velocity to the right.
        yaw_rad: Heading by its inertial unit less that at the start, clockwise, [0, 2π).
        ahead_m: Where the legs believe to be, in a frame that starts where the body did and faces as it did.
        aside_m: Likewise, to the right.
    """

    turn_radps: float = 0.0
    forward_mps: float = 0.0
    right_mps: float = 0.0
    yaw_rad: float = 0.0
    ahead_m: float = 0.0
    aside_m: float = 0.0


@dataclass(frozen=True, slots=True)
class SatelliteFix:
    """What the receiver says; of the world's frame. Without a fix everything else is zero.

    Attributes:
        has_fix: Whether there is one.
        x_m: East.
        y_m: North.
        vx_mps: Velocity to the east.
        vy_mps: Velocity to the north.
    """

    has_fix: bool
    x_m: float = 0.0
    y_m: float = 0.0
    vx_mps: float = 0.0
    vy_mps: float = 0.0


class WalkedBody(Body):
    """A body in a world that does what it is told for a tick at a time.

    A motion begins with the first tick that is told to move after a rest; motions are counted and their draws keyed
    as those of `Body`'s legs and turns are, so that the same commands sway it in the same way.

    Args:
        atlas: Of the world.
        profile: What it can do.
        noise: How its sensors err.
        start: Where it truly is at the start.
        seed: Of all its draws.
    """

    def __init__(self, atlas: "Atlas", profile: VehicleProfile, noise: SensorNoise, start: Pose, *, seed: int) -> None:
        ground = None if profile.flies or not profile.collides else ground_on_foot(atlas)
        super().__init__(profile, noise, start, seed=seed, bounds=atlas.world.bounds, ground=ground)
        self._atlas = atlas
        self._near_from: Pose | None = None
        self._walls, self._discs = NO_WALLS, NO_DISCS
        self._motions = 0
        self._tick = self._still = 0
        self._is_resting = True
        self._ticks = 0
        self._first_rad = start.heading_rad
        self._compass_first = float(self._true[kernels.TRUE_COMPASS])
        self.sensed = Sensed()
        #: What it ran into in the last tick, and the row or code of that (see `Motion.hit`); None where nothing.
        self.touched: tuple[End, int] | None = None

    @property
    def is_resting(self) -> bool:
        """Whether it stands, and has for a while."""
        return self._is_resting

    def walk(self, *, forward_mps: float, right_mps: float, turn_radps: float) -> SatelliteFix | None:
        """Carry on over a tick with a velocity; return what the receiver says, where it says something."""
        if self._is_resting:
            self._is_resting, self._tick = False, 0
            self._motions += 1
        self._still = 0
        return self._carry_on(forward_mps, right_mps, turn_radps)

    def stand(self) -> SatelliteFix | None:
        """Carry on over a tick in which it comes to rest or stands."""
        fix = self._carry_on(0.0, 0.0, 0.0)
        self._still += 1
        if not self._is_resting and self._still >= REST_TICKS:
            self._rest()
            self._is_resting = True
            self.sensed = replace(self.sensed, forward_mps=0.0, right_mps=0.0)
        return fix

    def _carry_on(self, forward_mps: float, right_mps: float, turn_radps: float) -> SatelliteFix | None:
        true, was_rad = self._true, float(self._true[kernels.TRUE_HEADING])
        base = np.uint64(draws.key_of(self._seed, "leg", self._motions - 1))
        if self._is_resting:
            self.touched = None
            key = np.uint64(draws.key_of(self._seed, "rest", self._ticks))
        else:
            self._gather()
            how, what = walk_tick(
                base,
                self._tick,
                true,
                self._body,
                self._walls,
                self._discs,
                self._ground.codes,
                self._ground.blocked,
                self._ground_array,
                self._bounds,
                forward_mps,
                right_mps,
                turn_radps,
                TICK_S,
            )
            self.touched = (_ENDS[how], what) if how != kernels.END_NONE else None
            key = np.uint64(kernels.chain(base, self._tick))
        turned_rad = math.remainder(float(true[kernels.TRUE_HEADING]) - was_rad, 2.0 * math.pi)
        self._feel(int(key), turned_rad)
        fix = self._hear_satellites(key)
        self._tick += 1
        self._ticks += 1
        return fix

    def _gather(self) -> None:
        """Have at hand what is near."""
        here = self.true_pose
        known = self._near_from
        if known is not None and here.distance_to_m(known.x_m, known.y_m) < 0.5 * _GATHER_M:
            return
        near = obstacles_on_leg(self._atlas, self.profile, here, here, margin_m=_GATHER_M)
        self._walls, self._discs = (NO_WALLS, NO_DISCS) if near is None else (near.walls, near.discs)
        self._near_from = here

    def _feel(self, key: int, turned_rad: float) -> None:
        true, noise = self._true, self.noise
        white = noise.gyro_density_radps / math.sqrt(TICK_S)
        gyro = turned_rad / TICK_S + float(true[kernels.TRUE_BIAS]) + white * draws.normal(key, "gyro")
        heading_rad = float(true[kernels.TRUE_HEADING])
        east, north = float(true[kernels.TRUE_VX]), float(true[kernels.TRUE_VY])
        sin_h, cos_h = math.sin(heading_rad), math.cos(heading_rad)
        scale = float(true[kernels.TRUE_SCALE])
        ahead = (east * sin_h + north * cos_h) * scale
        aside = (east * cos_h - north * sin_h) * scale
        last = self.sensed
        yaw_rad = heading_rad + float(true[kernels.TRUE_COMPASS]) - self._compass_first - self._first_rad
        # The legs' own place: their velocity along the inertial unit's yaw, by the trapezoidal rule.
        was_ahead, was_aside = _turned(last.forward_mps, last.right_mps, last.yaw_rad)
        now_ahead, now_aside = _turned(ahead, aside, yaw_rad)
        ahead_m = last.ahead_m + 0.5 * (was_ahead + now_ahead) * TICK_S
        aside_m = last.aside_m + 0.5 * (was_aside + now_aside) * TICK_S
        self.sensed = Sensed(gyro, ahead, aside, normalise_heading_rad(yaw_rad), ahead_m, aside_m)

    def _hear_satellites(self, key: np.uint64) -> SatelliteFix | None:
        every = TICK_HZ // self.noise.fix_hz
        if self._ticks % every != every - 1:
            return None
        kernels.wander(self._true, self._noise, key, every * TICK_S)
        has_fix, x_m, y_m = satellite_fix(self._true, self._noise, key, every * TICK_S)
        if not has_fix:
            return SatelliteFix(has_fix=False)
        sigma = self.noise.velocity_sigma_mps
        vx = float(self._true[kernels.TRUE_VX]) + sigma * draws.normal(int(key), "doppler", 0)
        vy = float(self._true[kernels.TRUE_VY]) + sigma * draws.normal(int(key), "doppler", 1)
        return SatelliteFix(True, float(x_m), float(y_m), vx, vy)  # noqa: FBT003 - has a fix


def _turned(ahead: float, aside: float, yaw_rad: float) -> tuple[float, float]:
    """Return a velocity of a body that has turned by a yaw, in the frame that it faced before."""
    sin_y, cos_y = math.sin(yaw_rad), math.cos(yaw_rad)
    return ahead * cos_y - aside * sin_y, ahead * sin_y + aside * cos_y
