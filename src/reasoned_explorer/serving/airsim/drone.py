"""The served drone: the embedded simulator's body, flown by AirSim's commands."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.serving.airsim.drifting import Drift, drifted
from reasoned_explorer.serving.airsim.flight import Flight, Floats, Hit, State
from reasoned_explorer.serving.airsim.scenery import name_of_disc, name_of_wall
from reasoned_explorer.simulation.motion import NO_DISCS, NO_WALLS, Body, End, Motion
from reasoned_explorer.simulation.sensors import SensorNoise, sensor_noise
from reasoned_explorer.simulation.vehicle import check_start, ground_on_foot, obstacles_on_leg
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.world.taxonomy import Ground as GroundKind

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import Obstacles

#: AirSim's own flight controller rises so far to take off, metres, and so fast, metres a second.
TAKEOFF_M, TAKEOFF_MPS = 2.0, 0.5
#: Sinking to land, metres a second.
CLIMB_MPS = 1.0
#: So near the ground it stands on it, metres.
_LANDED_M = 0.05
#: Nearer than this a point needs no flight to, metres.
_THERE_M = 1e-6
_MARGIN_M = 5.0
#: Two ways that are nearer to each other at a moment are one so far, metres.
_APART_M = 0.1
#: Less than this is no time but the rounding of sums, seconds.
_NO_TIME_S = 1e-6


@dataclass(slots=True)
class _Leg:
    """One straight part of a flight, as the body flies it."""

    start_s: float
    motion: Motion
    saved: object
    again: Callable[[float | None], Motion]
    near: "Obstacles | None"
    number: int
    face: bool


class Drone:
    """A drone in a world. Times are the server's seconds; whoever asks must not go back in time.

    To points it flies as the simulated vehicle does: the same body, seeds and draws, so that the same commands at the
    same times end in the same places. Its heights are its own: the body knows only the ground plane.

    Args:
        atlas: Of the world.
        profile: What it can do.
        start: Where it stands at the start, on the ground; its height is not read.
        noise: How the sensors err by which it steers, or the name of a preset.
        seed: Of all draws.

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
    ) -> None:
        check_start(atlas, profile, start)
        self.atlas, self.profile, self.start = atlas, profile, Pose(start.x_m, start.y_m, 0.0, start.heading_rad)
        self._noise = sensor_noise(noise) if isinstance(noise, str) else noise
        self._seed = seed
        self.reset()

    def reset(self) -> None:
        """Stand at the start again, as if nothing had been."""
        bounds, profile = self.atlas.world.bounds, self.profile
        ground = None if profile.flies or not profile.collides else ground_on_foot(self.atlas)
        self._body = Body(profile, self._noise, self.start, seed=self._seed, bounds=bounds, ground=ground)
        self._z_m = 0.0
        self._flight: Flight | None = None
        self._way: _Leg | None = None  # what the flight is, where it is one to one point
        self._motions = 0
        self._accounted_s: float | None = None
        self.last_hit: tuple[float, Hit] | None = None

    # Where it is.

    def state(self, now_s: float) -> State:
        """Return where it really is."""
        self._pass(now_s)
        if self._flight is not None:
            return self._flight.state(now_s - self._flight.start_s)
        return self._rest()

    def belief(self, now_s: float) -> State:
        """Return where it takes itself to be: the truth, moved by the error of its filter."""
        true = self.state(now_s)
        body, believed = self._body.true_pose, self._body.pose
        if self._flight is None:
            return true._replace(x_m=believed.x_m, y_m=believed.y_m, heading_rad=believed.heading_rad)
        # The filter was carried to the flight's end when that was worked out: its error there serves for all of it.
        turn_rad = bearing_between_rad(body.heading_rad, believed.heading_rad)
        return true._replace(
            x_m=true.x_m + believed.x_m - body.x_m,
            y_m=true.y_m + believed.y_m - body.y_m,
            heading_rad=normalise_heading_rad(true.heading_rad + turn_rad),
        )

    def is_landed(self, now_s: float) -> bool:
        """Whether it stands on the ground."""
        return self.state(now_s).z_m <= _LANDED_M and self._flight is None

    def look(self, now_s: float) -> State:
        """Return where it really is, for pictures: what it stood still until now has then passed for its sensors."""
        state = self.state(now_s)
        self._stand(now_s)
        return state

    # What it does. Each ends what it was doing and returns the new flight.

    def fly(self, now_s: float, path: Sequence[Pose], *, speed_mps: float, face: bool) -> Flight:
        """Fly straight from point to point.

        Args:
            now_s: The time.
            path: Where to, in the frame of what it believes; heights above the ground.
            speed_mps: How fast.
            face: Whether to turn to each point's heading.
        """
        self.stop(now_s)
        self._stand(now_s)
        self._body.cruise_at(speed_mps)
        legs: list[_Leg] = []
        rows: list[Floats] = []
        elapsed_s, z_m, hit, arrived = 0.0, self._z_m, None, True
        for target in path:
            believed = self._body.pose
            if believed.distance_to_m(target.x_m, target.y_m) > _THERE_M or face:
                leg = self._leg(elapsed_s, target, face=face, z_m=target.z_m)
                legs.append(leg)
                arrived = leg.motion.end is End.ARRIVED
                part = _with_height(leg.motion, z_m, target.z_m, speed_mps)
                hit = self._hit(leg, part)
            else:
                here = self._body.true_pose
                part = _vertical(here, z_m, target.z_m, speed_mps)
            part[:, 0] += elapsed_s
            rows.append(part)
            elapsed_s, z_m = float(part[-1, 0]), float(part[-1, 3])
            if not arrived:
                break
        points = _joined(rows)
        flight = Flight(now_s, points, elapsed_s, arrived, hit, lambda cut_s: self._leave_legs(legs, cut_s))
        self._begin(flight)
        self._way = legs[0] if len(path) == len(legs) == 1 else None
        return flight

    def fly_on(self, now_s: float, target: Pose, *, speed_mps: float, face: bool) -> Flight | None:
        """Fly on to another point of the way that it is on, as if it had been sent there at once.

        Returns:
            The flight; None, and nothing has changed, where that would have taken it elsewhere until now: the point
            lies in another direction, or it has begun to brake.
        """
        self._pass(now_s)
        flight, way = self._flight, self._way
        if flight is None or way is None or way.face != face or speed_mps != self._body.profile.speed_mps:
            return None
        elapsed_s, body = now_s - flight.start_s, self._body
        body.restore(way.saved)
        leg = self._leg(0.0, target, face=face, z_m=target.z_m, number=way.number)
        points = _joined([_with_height(leg.motion, self._z_m, target.z_m, speed_mps)])
        there, ends_s = flight.state(elapsed_s), float(points[-1, 0])
        arrived, hit = leg.motion.end is End.ARRIVED, self._hit(leg, points)
        other = Flight(flight.start_s, points, ends_s, arrived, hit, lambda cut_s: self._leave_legs([leg], cut_s))
        here = other.state(elapsed_s)
        if elapsed_s >= ends_s or math.dist(here[:3], there[:3]) > _APART_M:
            body.restore(way.saved)
            way.again(None)
            return None
        self._begin(other)
        self._way = leg
        return other

    def turn(self, now_s: float, heading_rad: float) -> Flight:
        """Turn in place."""
        self.stop(now_s)
        self._stand(now_s)
        number, saved = self._next_motion(), self._body.save()
        motion = self._body.turn(heading_rad, leg=number)

        def leave(elapsed_s: float) -> None:
            # A turn that is cut short ends on the way; the body knows no half turns.
            there = flight.state(elapsed_s)
            if elapsed_s < flight.duration_s:
                self._body.restore(saved)
                self._body.place(Pose(there.x_m, there.y_m, 0.0, there.heading_rad))

        points = _joined([_with_height(motion, self._z_m, self._z_m, 1.0)])
        flight = Flight(now_s, points, motion.duration_s, motion.end is End.ARRIVED, None, leave)
        return self._begin(flight)

    def climb(self, now_s: float, z_m: float, *, speed_mps: float = CLIMB_MPS) -> Flight:
        """Rise or sink to a height above the ground."""
        self.stop(now_s)
        points = _vertical(self._body.true_pose, self._z_m, max(0.0, z_m), speed_mps)
        succeeded = z_m >= -_LANDED_M
        flight = Flight(now_s, points, float(points[-1, 0]), succeeded, None, lambda _: None)
        return self._begin(flight)

    def drift(self, now_s: float, drift: Drift) -> Flight:
        """Fly by velocity for a while, then brake."""
        begun = self.state(now_s)
        self.stop(now_s)
        self._stand(now_s)
        points, hit = drifted(self.atlas, self.profile, begun, drift)
        points[:, 4] = np.unwrap(points[:, 4])

        def leave(elapsed_s: float) -> None:
            there = flight.state(elapsed_s)
            self._body.place(Pose(there.x_m, there.y_m, 0.0, there.heading_rad))

        flight = Flight(now_s, points, drift.duration_s, hit is None, hit, leave)
        return self._begin(flight)

    def stop(self, now_s: float) -> None:
        """Stand still in the air, at once, wherever it is."""
        self._pass(now_s)
        flight, self._flight = self._flight, None
        if flight is not None:
            elapsed_s = now_s - flight.start_s
            self._note_hit(flight, elapsed_s)
            self._z_m = flight.state(elapsed_s).z_m
            flight.leave(elapsed_s)
            self._accounted_s = now_s

    def place(self, now_s: float, pose: Pose) -> None:
        """Be somewhere else."""
        self.stop(now_s)
        self._stand(now_s)
        self._body.place(pose)
        self._z_m = max(0.0, pose.z_m)

    # Time.

    def _pass(self, now_s: float) -> None:
        """End a flight that is over."""
        flight = self._flight
        if flight is None:
            return
        self._note_hit(flight, now_s - flight.start_s)
        if now_s >= flight.start_s + flight.duration_s - 1e-9:
            self._flight = None
            self._z_m = float(flight.points[-1, 3])
            flight.leave(flight.duration_s)
            if self._accounted_s is not None:
                self._accounted_s = max(self._accounted_s, flight.start_s + flight.duration_s)

    def _stand(self, now_s: float) -> None:
        """Let the time that it stood still pass for its sensors; before its first deed none counts."""
        if self._accounted_s is not None and now_s - self._accounted_s > _NO_TIME_S:
            self._body.wait(now_s - self._accounted_s)
        self._accounted_s = now_s

    def _begin(self, flight: Flight) -> Flight:
        self._flight, self._way = flight, None
        return flight

    def _note_hit(self, flight: Flight, elapsed_s: float) -> None:
        if flight.hit is not None and elapsed_s >= flight.hit.elapsed_s - 1e-9:
            self.last_hit = flight.start_s + flight.hit.elapsed_s, flight.hit

    def _rest(self) -> State:
        here = self._body.true_pose
        return State(here.x_m, here.y_m, self._z_m, here.heading_rad)

    def _next_motion(self) -> int:
        self._motions += 1
        return self._motions - 1

    def _leg(self, start_s: float, target: Pose, *, face: bool, z_m: float, number: int | None = None) -> _Leg:
        number = self._next_motion() if number is None else number
        saved, here = self._body.save(), self._body.true_pose
        noise = self._noise
        margin_m = _MARGIN_M + 4.0 * (noise.position_sigma_m + noise.wander_sigma_m)
        at_m = z_m if self.profile.flies else None
        near = obstacles_on_leg(self.atlas, self.profile, here, target, margin_m=margin_m, z_m=at_m)
        walls, discs = (NO_WALLS, NO_DISCS) if near is None else (near.walls, near.discs)

        def again(limit_s: float | None) -> Motion:
            return self._body.drive(target, leg=number, walls=walls, discs=discs, face=face, limit_s=limit_s)

        return _Leg(start_s, again(None), saved, again, near, number, face)

    def _leave_legs(self, legs: Sequence[_Leg], elapsed_s: float) -> None:
        """Have the body be where it was so many seconds into a flight: the same draws once more, up to then."""
        for leg in legs:
            end_s = leg.start_s + leg.motion.duration_s
            if leg.start_s <= elapsed_s < end_s - 1e-9:
                self._body.restore(leg.saved)
                leg.again(elapsed_s - leg.start_s)
                return

    def _hit(self, leg: _Leg, rows: Floats) -> Hit | None:
        end, row, near = leg.motion.end, leg.motion.hit, leg.near
        world = self.atlas.world
        if end is End.GROUND:
            name = GroundKind(row).noun
        elif near is None or end not in {End.WALL, End.DISC}:
            return None
        else:
            name = name_of_wall(world, near, row) if end is End.WALL else name_of_disc(world, near, row)
        _, x_m, y_m, z_m, heading_rad = rows[-1].tolist()
        if len(rows) > 1:
            dx, dy = (rows[-1, 1:3] - rows[0, 1:3]).tolist()
            heading_rad = math.atan2(dx, dy) if dx or dy else heading_rad
        return Hit(leg.start_s + leg.motion.duration_s, name, x_m, y_m, z_m, normalise_heading_rad(heading_rad))


def _with_height(motion: Motion, from_z_m: float, to_z_m: float, speed_mps: float) -> Floats:
    """Return a motion's points with a height that changes evenly over it, longer where rising takes longer."""
    points = motion.points
    rows = np.empty((len(points), 5))
    rows[:, :3] = points[:, :3]
    rows[:, 4] = np.unwrap(points[:, 3])
    duration_s = max(motion.duration_s, 1e-9)
    rows[:, 3] = from_z_m + (to_z_m - from_z_m) * np.minimum(1.0, points[:, 0] / duration_s)
    if rows[-1, 0] < motion.duration_s:
        rows = np.concatenate((rows, rows[-1:]))
        rows[-1, 0], rows[-1, 3] = motion.duration_s, to_z_m
    slowest_s = abs(to_z_m - from_z_m) / speed_mps
    if motion.end is End.ARRIVED and slowest_s > motion.duration_s:
        share = motion.duration_s / slowest_s
        rows[:, 3] = from_z_m + (rows[:, 3] - from_z_m) * share
        rows = np.concatenate((rows, rows[-1:]))
        rows[-1, 0], rows[-1, 3] = slowest_s, to_z_m
    return rows


def _vertical(here: Pose, from_z_m: float, to_z_m: float, speed_mps: float) -> Floats:
    duration_s = abs(to_z_m - from_z_m) / speed_mps
    first = (0.0, here.x_m, here.y_m, from_z_m, here.heading_rad)
    last = (duration_s, here.x_m, here.y_m, to_z_m, here.heading_rad)
    return np.array([first, last] if duration_s > 0.0 else [first])


def _joined(rows: list[Floats]) -> Floats:
    points = np.concatenate(rows)
    # Parts share their ends: times must grow.
    points = points[np.concatenate(([True], np.diff(points[:, 0]) > 0.0))]
    points[:, 4] = np.unwrap(points[:, 4])
    return points
