"""The simulated `Vehicle`: its body moves in a world, and its cameras see what the simulator's eyes say."""

import asyncio
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import (
    Camera,
    Fault,
    Leg,
    LegOutcome,
    PartError,
    SettingsError,
    StartError,
    TrackPoint,
    View,
)
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind, Mishaps
from reasoned_explorer.simulation.motion import NO_DISCS, NO_WALLS, Body, End, Ground, Motion
from reasoned_explorer.simulation.sensors import SensorNoise, sensor_noise
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.under_way import FAILSAFE_S, State, UnderWay, told
from reasoned_explorer.vehicles.looking import turning_order
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.telemetry import Telemetry
from reasoned_explorer.vehicles.vehicle import Vehicle
from reasoned_explorer.world.taxonomy import IMPASSABLE_ON_FOOT
from reasoned_explorer.world.taxonomy import Ground as GroundKind

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import Obstacles
    from reasoned_explorer.world.world import Bounds, Building, Ring

#: What is at this height is in a walker's way, metres: about its chest.
_WALKER_Z_M = 0.3
#: Obstacles are gathered this far around a leg, metres, and further where the receiver errs by metres.
_MARGIN_M = 5.0
#: Undersides higher than this can be gone under, metres (as in `world.raster`).
_ROOF_CLEARANCE_M = 2.0


class Eyes(Protocol):
    """What says what a camera really sees (`simulation.eyes`)."""

    def look(self, pose: Pose, camera: Camera) -> ViewContent:
        """Return what a camera at a pose sees."""
        ...


class Painter(Protocol):
    """What takes pictures (`simulation.painter`)."""

    def paint(self, pose: Pose, camera: Camera) -> NDArray[np.uint8]:
        """Return what a camera at a pose sees, RGB, shape (height, width, 3)."""
        ...


def check_on_map(bounds: "Bounds", pose: Pose) -> None:
    """Check what can be known of a start without looking at what stands there.

    Raises:
        StartError: If a value is not finite or the pose is off the world.
    """
    if not all(is_within(value) for value in (pose.x_m, pose.y_m, pose.z_m, pose.heading_rad)):
        raise StartError("start", [Fault(f"{pose}", "finite coordinates and heading")])
    if not bounds.contains(pose.x_m, pose.y_m):
        what = f"({pose.x_m:g}, {pose.y_m:g}) is off the world"
        expected = (
            f"x in [{bounds.min_x_m:g}, {bounds.max_x_m:g}] and y in [{bounds.min_y_m:g}, {bounds.max_y_m:g}] metres"
        )
        raise StartError("start", [Fault(what, expected, "choose another start or a random one")])


def check_start(atlas: "Atlas", profile: VehicleProfile, pose: Pose) -> None:
    """Check that a mission can begin at a pose.

    Raises:
        StartError: If it cannot: a value is not finite, the pose is off the world, inside a building or a solid thing,
            or on ground that this vehicle cannot stand on. All faults at once.
    """
    check_on_map(atlas.world.bounds, pose)
    at = f"({pose.x_m:g}, {pose.y_m:g})"
    faults = []
    remedy = "choose another start or a random one"
    building = _building_at(atlas, pose.x_m, pose.y_m)
    if building is not None:
        named = f" ({building.name})" if building.name else ""
        faults.append(Fault(f"{at} is inside a building{named}", "open ground", remedy))
    kind = atlas.ground.at(pose.x_m, pose.y_m)
    if not profile.flies and kind in IMPASSABLE_ON_FOOT - {GroundKind.BUILDING}:
        faults.append(Fault(f"{at} is in or on: {kind.noun}", f"ground that {profile.name} can walk on", remedy))
    near = obstacles_on_leg(atlas, profile, pose, pose, margin_m=1.0)
    if near is not None:
        for row, object_id in zip(near.discs, near.disc_object, strict=True):
            if math.hypot(row[0] - pose.x_m, row[1] - pose.y_m) < row[2]:
                noun = atlas.world.objects[int(object_id)].object_class.noun
                faults.append(Fault(f"{at} is inside an obstacle: {noun}", "free space", remedy))
    if faults:
        raise StartError("start", faults)


class SimulatedVehicle(Vehicle):
    """A vehicle in the embedded simulator.

    Args:
        atlas: Of the world.
        profile: What the machine can do.
        start: Where it truly is at the start; the height is the profile's.
        clock: Time passes on it.
        eyes: What its cameras see.
        painter: Takes the pictures of its cameras; None for views without pictures.
        seed: Of the mission; all draws of noise are keyed by it.
        noise: How its sensors err, or the name of a preset.
        faults: For tests: legs (counted from 0) at which the link fails, each with the reason.
        mishaps: What befalls it, in mission seconds. They change what it tells of itself and what it obeys, not how it
            steers on a leg that is under way. Half a second after its link is lost it stands, by a failsafe of its own.

    Raises:
        StartError: If no mission can begin at the start.
        UnknownNameError: If there is no such preset.
    """

    def __init__(
        self,
        atlas: "Atlas",
        profile: VehicleProfile,
        start: Pose,
        *,
        clock: Clock,
        eyes: Eyes,
        painter: Painter | None = None,
        seed: int,
        noise: SensorNoise | str = "rtk-fixed",
        faults: Mapping[int, str] | None = None,
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        check_start(atlas, profile, start)
        self.profile = profile
        self._atlas = atlas
        self._clock = clock
        self._eyes, self._painter = eyes, painter
        self._faults = dict(faults or {})
        self.noise = sensor_noise(noise) if isinstance(noise, str) else noise
        ground = None if profile.flies or not profile.collides else ground_on_foot(atlas)
        self._body = Body(profile, self.noise, start, seed=seed, bounds=atlas.world.bounds, ground=ground)
        self._motions = 0
        self._legs = 0
        self._looks = 0
        self._idle_since_s: float | None = None
        self.mishaps = Mishaps(tuple(mishaps))
        self._under_way: UnderWay | None = None
        #: The last leg; after a cancelled `go_to` the part of it that was travelled.
        self.last_leg: Leg | None = None

    @property
    def pose(self) -> Pose:
        """Where the filter believes the vehicle to be; the height is its camera's."""
        return self.mishaps.told(self._at_height(self._body.pose), self._clock.now_s())

    @property
    def true_pose(self) -> Pose:
        """Where it really is: for the simulator, the judge and pictures, never for the agent."""
        return self._at_height(self._body.true_pose)

    def telemetry(self) -> Telemetry:
        """Return what it tells of itself now, also on the way."""
        now_s, going = self._clock.now_s(), self._under_way
        state = State(self._at_height(self._body.pose)) if going is None else going.at(now_s)
        return told(replace(state, pose=self._at_height(state.pose)), self.mishaps, now_s)

    async def connect(self) -> None:
        """Nothing: it looks as it stands."""

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Take one view in each heading, in that order; keys are (legs so far, looks since the last leg, index).

        A vehicle that turns to look begins at the end of the list that is nearer to where it faces.

        Raises:
            SettingsError: If a heading is not finite.
            PartError: If its link is lost, or its camera silent (``mishaps``).
        """
        faults = [
            Fault(f"heading {heading}", "finite radians") for heading in headings_rad if not math.isfinite(heading)
        ]
        if faults:
            raise SettingsError("look", faults)
        self._check_reached()
        if self.mishaps.at(MishapKind.CAMERA_SILENCE, self._clock.now_s()):
            raise PartError("camera", "no picture comes")
        self._pass_idle_time()
        order = self._turning_order(headings_rad)
        duration_s = self.profile.look_s
        taken: dict[int, View] = {}
        for index in order:
            heading_rad = normalise_heading_rad(headings_rad[index])
            if self.profile.turns_to_look:
                duration_s += self._body.turn(heading_rad, leg=self._next_motion()).duration_s
                heading_rad = self._body.pose.heading_rad
            bearing_rad = bearing_between_rad(self.pose.heading_rad, heading_rad)
            true_camera = self.true_pose.facing(self.true_pose.heading_rad + bearing_rad)
            content = self._eyes.look(true_camera, self.profile.camera)
            image = None if self._painter is None else self._painter.paint(true_camera, self.profile.camera)
            key = (self._legs, self._looks, index)
            taken[index] = View(key, self.pose.facing(heading_rad), self.profile.camera, image, content)
        self._looks += 1
        self._body.wait(self.profile.look_s)
        if duration_s > 0.0:
            await self._clock.act(duration_s)
        self._idle_since_s = self._clock.now_s()
        return [taken[index] for index in range(len(headings_rad))]

    async def go_to(self, target: Pose) -> Leg:
        """Go to a point in a straight leg and face the target's heading.

        Cancelled on the way, the vehicle stops where it is then; `last_leg` tells what it travelled.

        Raises:
            SettingsError: If the target is not finite.
            PartError: If this leg was to fail (``faults``), or its link is lost (``mishaps``).
        """
        if not is_finite(target.x_m, target.y_m, target.heading_rad):
            raise SettingsError("go_to", [Fault(f"target {target}", "finite coordinates and heading")])
        number, self._legs, self._looks = self._legs, self._legs + 1, 0
        if number in self._faults:
            raise PartError("vehicle", self._faults[number])
        self._check_reached()
        self._pass_idle_time()
        here = self._body.true_pose
        margin_m = _MARGIN_M + 4.0 * (self.noise.position_sigma_m + self.noise.wander_sigma_m)
        near = obstacles_on_leg(self._atlas, self.profile, here, target, margin_m=margin_m)
        motion_number, saved, started_s = self._next_motion(), self._body.save(), self._clock.now_s()
        motion = self._drive(target, motion_number, near)
        alone_s = self.mishaps.next_s(MishapKind.LINK_LOSS, started_s) + FAILSAFE_S - started_s
        is_lost = alone_s < motion.duration_s
        if is_lost:
            self._body.restore(saved)
            motion = self._drive(target, motion_number, near, limit_s=alone_s)
        self._under_way = UnderWay(started_s, motion, here, self._body)
        try:
            await self._clock.act(motion.duration_s)
        except asyncio.CancelledError:
            # The same leg once more, up to the moment of the cancellation: all draws are keyed, so it is the same.
            self._body.restore(saved)
            spent_s = min(self._clock.now_s() - started_s, motion.duration_s)
            cut = self._drive(target, motion_number, near, limit_s=max(0.0, spent_s))
            self.last_leg = self._leg(target, cut, near, started_s)
            self._idle_since_s = self._clock.now_s()
            raise
        finally:
            self._under_way = None
        self._idle_since_s = self._clock.now_s()
        self.last_leg = self._leg(target, motion, near, started_s)
        if is_lost:
            self._check_reached()
        return self.last_leg

    def _drive(self, target: Pose, number: int, near: "Obstacles | None", *, limit_s: float | None = None) -> Motion:
        walls, discs = (NO_WALLS, NO_DISCS) if near is None else (near.walls, near.discs)
        return self._body.drive(target, leg=number, walls=walls, discs=discs, limit_s=limit_s)

    def _leg(self, target: Pose, motion: Motion, near: "Obstacles | None", started_s: float) -> Leg:
        outcome, detail = self._outcome(motion, near)
        z_m = self.profile.camera_height_m
        track = tuple(TrackPoint(started_s + t, x, y, z_m, heading) for t, x, y, heading in motion.points.tolist())
        return Leg(
            target_x_m=target.x_m,
            target_y_m=target.y_m,
            outcome=outcome,
            duration_s=motion.duration_s,
            length_m=motion.length_m,
            track=track,
            detail=detail,
            cross_track_rms_m=motion.cross_track_rms_m,
            localization_rms_m=motion.localization_rms_m,
        )

    def _outcome(self, motion: Motion, near: "Obstacles | None") -> tuple[LegOutcome, str]:
        world = self._atlas.world
        if motion.end is End.WALL and near is not None:
            place = int(near.wall_object[motion.hit])
            what = "wall of a building" if place < 0 else world.objects[place].object_class.noun
            return LegOutcome.COLLISION, what
        if motion.end is End.DISC and near is not None:
            return LegOutcome.COLLISION, world.objects[int(near.disc_object[motion.hit])].object_class.noun
        if motion.end is End.GROUND:
            return LegOutcome.COLLISION, GroundKind(motion.hit).noun
        return {
            End.ARRIVED: (LegOutcome.ARRIVED, ""),
            End.EDGE: (LegOutcome.STOPPED, "edge of the world"),
            End.CUT: (LegOutcome.STOPPED, "cancelled"),
            End.TIME: (LegOutcome.STUCK, "not there in three times the time that it should take"),
            End.STUCK: (LegOutcome.STUCK, "no progress"),
        }[motion.end]

    def _check_reached(self) -> None:
        """Check that the machine hears what it is told.

        Raises:
            PartError: If its link is lost.
        """
        if self.mishaps.at(MishapKind.LINK_LOSS, self._clock.now_s()):
            raise PartError("vehicle", "the link is lost")

    def _next_motion(self) -> int:
        self._motions += 1
        return self._motions - 1

    def _pass_idle_time(self) -> None:
        now_s = self._clock.now_s()
        if self._idle_since_s is not None:
            self._body.wait(now_s - self._idle_since_s)
        self._idle_since_s = now_s

    def _turning_order(self, headings_rad: Sequence[float]) -> list[int]:
        if not self.profile.turns_to_look:
            return list(range(len(headings_rad)))
        return turning_order(self._body.pose.heading_rad, dict(enumerate(headings_rad)))

    def _at_height(self, pose: Pose) -> Pose:
        return Pose(pose.x_m, pose.y_m, self.profile.camera_height_m, pose.heading_rad)


def obstacles_on_leg(
    atlas: "Atlas",
    profile: VehicleProfile,
    here: Pose,
    there: Pose,
    *,
    margin_m: float = _MARGIN_M,
    z_m: float | None = None,
) -> "Obstacles | None":
    """Return what a vehicle could run into on a straight leg and up to a margin beside it; None where it never does.

    Args:
        atlas: Of the world.
        profile: Of the vehicle.
        here: Where the leg begins.
        there: Where it ends.
        margin_m: How far beside it, metres.
        z_m: At which height above the ground, metres; by default where the profile's machine is.
    """
    if not profile.collides:
        return None
    if z_m is None:
        z_m = profile.camera_height_m if profile.flies else _WALKER_Z_M
    return atlas.sight.obstacles_near(here.x_m, here.y_m, there.x_m, there.y_m, z_m=z_m, margin_m=margin_m)


def ground_on_foot(atlas: "Atlas") -> Ground:
    """Return what stops a walker. Buildings do not: their walls are known more exactly than a raster's cells."""
    blocked: NDArray[np.bool_] = np.zeros(256, np.bool_)
    blocked[[int(kind) for kind in IMPASSABLE_ON_FOOT - {GroundKind.BUILDING}]] = True
    raster = atlas.ground
    return Ground(np.ascontiguousarray(raster.codes), raster.min_x_m, raster.min_y_m, raster.cell_m, blocked)


def _building_at(atlas: "Atlas", x_m: float, y_m: float) -> "Building | None":
    # The raster is right to a cell: only where it knows a building close by need the outlines be asked.
    cell_m = atlas.ground.cell_m
    around = [-cell_m, 0.0, cell_m]
    xs, ys = np.meshgrid([x_m + shift for shift in around], [y_m + shift for shift in around])
    if not (atlas.ground.at_many(xs, ys) == GroundKind.BUILDING).any():
        return None
    for building in atlas.world.buildings:
        if building.min_height_m > _ROOF_CLEARANCE_M:
            continue
        if sum(_in_ring(ring, x_m, y_m) for ring in (building.outer, *building.holes)) % 2 == 1:
            return building
    return None


def _in_ring(ring: "Ring", x_m: float, y_m: float) -> bool:
    """Return whether a point is in a closed ring (even-odd rule)."""
    x, y = ring[:, 0], ring[:, 1]
    if not (x.min() <= x_m <= x.max() and y.min() <= y_m <= y.max()):
        return False
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > y_m) != (next_y > y_m)
    rise = np.where(crosses, next_y - y, 1.0)
    return bool(np.count_nonzero(crosses & (x_m < x + (next_x - x) * (y_m - y) / rise)) % 2)
