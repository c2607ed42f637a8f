"""Flying by velocity: an integrator of its own, since the simulator's body flies to points only."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from reasoned_explorer.geometry import bearing_between_rad
from reasoned_explorer.serving.airsim.flight import Floats, Hit, State
from reasoned_explorer.serving.airsim.scenery import name_of_disc, name_of_wall
from reasoned_explorer.vehicles.profile import VehicleProfile

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import Obstacles

#: One step, seconds; shorter where the drone is so fast that it would pass through its own radius.
_TICK_S = 0.05
#: Obstacles are gathered this far around the way of the next second, metres.
_MARGIN_M = 3.0
_GATHER_S = 1.0
#: Steps at most: an hour at the usual step.
_MOST_STEPS = 400_000


class Yaw(NamedTuple):
    """How to face while flying: turn at a rate (radians a second), towards a heading, or along the velocity."""

    rate_radps: float = 0.0
    heading_rad: float | None = None
    along: bool = False


@dataclass(frozen=True, slots=True)
class Drift:
    """What is asked for.

    Attributes:
        vx_mps: East.
        vy_mps: North.
        vz_mps: Up.
        duration_s: How long; it brakes afterwards.
        yaw: How to face.
        z_m: The height to hold instead of the vertical speed, or None.
    """

    vx_mps: float
    vy_mps: float
    vz_mps: float
    duration_s: float
    yaw: Yaw
    z_m: float | None = None


def drifted(atlas: "Atlas", profile: VehicleProfile, state: State, drift: Drift) -> tuple[Floats, Hit | None]:
    """Return the points of a flight (see `Flight.points`) and what it ran into, where it stops.

    It changes its velocity within the profile's acceleration and stays above the ground and within the world.
    """
    speed = math.hypot(drift.vx_mps, drift.vy_mps)
    fastest = max(speed, math.hypot(state.vx_mps, state.vy_mps), 1e-6)
    dt = min(_TICK_S, 0.5 * profile.radius_m / fastest)
    steps = math.ceil(drift.duration_s / dt - 1e-9)
    braking = math.ceil(fastest / profile.acceleration_mps2 / dt) + 2
    body = _Body(atlas, profile, state, dt)
    rows = [body.row(0.0)]
    for step in range(1, min(steps + braking, _MOST_STEPS) + 1):
        body.step(drift, braking=step > steps)
        rows.append(body.row(step * dt))
        if body.hit is not None:
            break
        if step > steps and body.stands:
            break
    if body.hit is not None and rows[-1][0] < drift.duration_s:
        rows.append(body.row(drift.duration_s))
    return np.array(rows), body.hit


class _Body:
    def __init__(self, atlas: "Atlas", profile: VehicleProfile, state: State, dt_s: float) -> None:
        self._atlas, self._profile, self._dt_s = atlas, profile, dt_s
        self.x, self.y, self.z = state.x_m, state.y_m, state.z_m
        self.heading = state.heading_rad
        self.velocity = np.array([state.vx_mps, state.vy_mps, state.vz_mps])
        self.hit: Hit | None = None
        self._time_s = 0.0
        self._gathered_until_s = -1.0
        self._near: Obstacles | None = None

    @property
    def stands(self) -> bool:
        return not self.velocity.any()

    def row(self, time_s: float) -> tuple[float, float, float, float, float]:
        return time_s, self.x, self.y, self.z, self.heading

    def step(self, drift: Drift, *, braking: bool) -> None:
        dt = self._dt_s
        self._time_s += dt
        climb = drift.vz_mps if drift.z_m is None else max(-2.0, min(2.0, (drift.z_m - self.z) / max(dt, 0.5)))
        wanted = np.zeros(3) if braking else np.array([drift.vx_mps, drift.vy_mps, climb])
        gap = wanted - self.velocity
        most, length = self._profile.acceleration_mps2 * dt, float(np.linalg.norm(gap))
        self.velocity = wanted if length <= most else self.velocity + gap * (most / length)
        if not braking:
            self.heading += self._turn(drift.yaw)
        self._move(*(self.velocity * dt).tolist())

    def _turn(self, yaw: Yaw) -> float:
        most = self._profile.turn_rate_radps * self._dt_s
        if yaw.along:
            vx, vy = self.velocity[:2].tolist()
            if math.hypot(vx, vy) < 0.1:
                return 0.0
            gap = bearing_between_rad(self.heading, math.atan2(vx, vy))
        elif yaw.heading_rad is not None:
            gap = bearing_between_rad(self.heading, yaw.heading_rad)
        else:
            gap = yaw.rate_radps * self._dt_s
        return max(-most, min(most, gap))

    def _move(self, dx: float, dy: float, dz: float) -> None:
        self.z += dz
        if self.z <= 0.0 and dz < 0.0:
            self.z, self.velocity[2] = 0.0, 0.0
        free = self._free_share(dx, dy)
        self.x, self.y = self.x + free * dx, self.y + free * dy
        if free < 1.0:
            self.velocity[:] = 0.0

    def _free_share(self, dx: float, dy: float) -> float:
        if dx == 0.0 and dy == 0.0:
            return 1.0
        bounds = self._atlas.world.bounds
        if not bounds.contains(self.x + dx, self.y + dy) and bounds.contains(self.x, self.y):
            self._touch("edge of the world", dx, dy)
            return 0.0
        if not self._profile.collides:
            return 1.0
        if self._time_s > self._gathered_until_s:
            ahead_x, ahead_y = self.velocity[:2] * _GATHER_S
            self._near = self._atlas.sight.obstacles_near(
                self.x, self.y, self.x + ahead_x, self.y + ahead_y, z_m=self.z, margin_m=_MARGIN_M
            )
            self._gathered_until_s = self._time_s + 0.5 * _GATHER_S
        if self._near is None:
            raise AssertionError
        # Compiled when it is first needed.
        from reasoned_explorer.simulation.kernels import STANDOFF_M, first_touch

        walls, discs = self._near.walls, self._near.discs
        share, hit = first_touch(walls, discs, self.x, self.y, self.x + dx, self.y + dy, self._profile.radius_m)
        if hit < 0:
            return 1.0
        world = self._atlas.world
        if hit < len(walls):
            name = name_of_wall(world, self._near, int(hit))
        else:
            name = name_of_disc(world, self._near, int(hit) - len(walls))
        self._touch(name, dx, dy)
        return max(0.0, float(share) - STANDOFF_M / math.hypot(dx, dy))

    def _touch(self, name: str, dx: float, dy: float) -> None:
        self.hit = Hit(self._time_s, name, self.x, self.y, self.z, math.atan2(dx, dy))
