"""One mission from a sentence to its score: puts the rooms together, runs the agent, has the judge look at it."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.evaluation.guarding import Guarding
from reasoned_explorer.evaluation.guide import GUIDE_LABEL, Guide
from reasoned_explorer.evaluation.mission_course import MissionCourse, calls_by_role, versions
from reasoned_explorer.evaluation.mission_settings import CLOCKS, errors_of
from reasoned_explorer.evaluation.mission_settings import MissionSettings as MissionSettings  # noqa: PLC0414 - is had from here, too
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.scoring import MissionScore, outcome_of, score
from reasoned_explorer.evaluation.track import looks_of, track_of
from reasoned_explorer.evaluation.truth import OracleTruth
from reasoned_explorer.exploration.explorer import Exploration, Explorer
from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.geometry.frames import NOWHERE
from reasoned_explorer.model import (
    Fault,
    Gathering,
    InputError,
    LegOutcome,
    RecordError,
    SettingsError,
    StartError,
    WorldError,
)
from reasoned_explorer.model.checks import kind_faults, path_of
from reasoned_explorer.model.record import EpisodeRecord, MissionEnd, MissionHeader, MissionSummary, StepRecord
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.painter import Painter
from reasoned_explorer.simulation.pixel_eyes import PixelEyes
from reasoned_explorer.simulation.vehicle import SimulatedVehicle, check_on_map, check_start
from reasoned_explorer.task.goal_spec import GoalSpec
from reasoned_explorer.task.judge import Judge, TrackReport
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.task.sampling import OutOfRangeError, SamplingSettings, sample_start, settle_for_a_start
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.vehicles.looking import Content
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.safety.watch import RangeAhead
from reasoned_explorer.vehicles.vehicle import Vehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.geodesic import Traveller
from reasoned_explorer.world.world import World

#: A seeded random start is at least and at most this far, on the shortest compliant way, from being successful, where
#: there is such a start.
START_RANGE_M = (60.0, 400.0)


@dataclass(frozen=True, slots=True)
class MissionResult:
    """What came of a mission.

    Attributes:
        record: Everything that is kept of it.
        world: Where it took place.
        score: Its metrics.
        folder: Where the record lies, or None.
    """

    record: EpisodeRecord
    world: World
    score: MissionScore
    folder: Path | None = None

    @property
    def summary(self) -> MissionSummary:
        """How it ended."""
        if self.record.summary is None:  # a result is only made once there is one
            raise AssertionError
        return self.record.summary

    def draw_map(self, path: Path | str) -> None:
        """Draw what happened on a map, PNG, SVG or PDF by the path's suffix."""
        from reasoned_explorer.evaluation.record_map import draw_record

        draw_record(self.world, self.record, path_of(path, "map picture", RecordError))


class Mission(MissionCourse):
    """A mission that is ready to run: every input has been checked, nothing has been written.

    Args:
        goal: The goal sentence.
        world: A world, or an atlas of one where several missions share it.
        settings: Who does what.
        start: Where it begins; None draws a start by the seed.
        judge: A judge of this goal, world, vehicle and success radius from an earlier mission, to share its work with.
        desk: Makes the callers of models; None where the settings name none, or for one without cache, tape and budget.
        pictures: Folder in which the pictures of all views are kept; None keeps none.
        guarding: Which vehicle outside of this process stands at the start; None for the embedded simulator's.

    Raises:
        GoalError: If the goal cannot be understood.
        PartError: If a model does not answer.
        MissingDependencyError: If a model needs what is not installed.
        StartError: If the start is none or no mission can begin at it, or no start can be found.
        WorldError: If the world is none.
        UnknownNameError: If a name is not registered.
        SettingsError: If settings are none or out of range.
        InputError: If several of these are wrong, with all that can be told without looking into the world.
    """

    def __init__(
        self,
        goal: str,
        world: World | Atlas,
        settings: MissionSettings | None = None,
        *,
        start: Pose | None = None,
        judge: Judge | None = None,
        desk: ModelDesk | None = None,
        pictures: Path | None = None,
        guarding: Guarding | None = None,
    ) -> None:
        _check_arguments(world, settings, start)
        self.settings = settings if settings is not None else MissionSettings()
        self.atlas = world if isinstance(world, Atlas) else Atlas(world)
        spec = _checked(goal, self.atlas.world, self.settings, start)
        self.profile = vehicle_profile(self.settings.vehicle)
        stop_if_asked()
        self.judge = judge or judge_of(spec, self.atlas, self.settings.vehicle, self.settings.success_radius_m)
        self.spec = self.judge.spec
        self.goal = self.spec.goal
        stop_if_asked()
        self._notes: tuple[str, ...] = ()
        self.start = self._start(start, self.judge.traveller)
        stop_if_asked()
        self.clock = CLOCKS[self.settings.clock]()
        self._desk, self._pictures, self._guarding = desk, pictures, guarding
        # Privileged minds and the guide alone may read the truth; they are the only ones that ask for it.
        truth = OracleTruth(self.atlas, self.judge, self.profile, self.settings.explorer)
        self.explorer: Explorer | Guide
        self.explorer = self._guide(truth) if self.settings.agent == "guide" else self._explorer(truth)

    def run(self, *, folder: Path | None = None, on_step: Callable[[StepRecord], None] | None = None) -> MissionResult:
        """Run the mission to its end.

        Args:
            folder: Where the record is written as it happens; None keeps it in memory only.
            on_step: Called with each step's record as soon as the step is over.

        Raises:
            RecordError: If no record can be begun in the folder.
            RecordWriteError: If the record cannot be written on; the mission ends at once, and the record at its last
                whole step. Before the first one nothing is left.
            KeyboardInterrupt: If a person stops it; the record then says so and ends at its last whole step.
        """
        record, score, folder = self._record(folder, on_step)
        if score is None:  # a mission in a world is judged
            raise AssertionError
        return MissionResult(record, self.atlas.world, score, folder)

    def _start(self, start: Pose | None, traveller: Traveller) -> Pose:
        if start is not None:
            check_start(self.atlas, self.profile, start)
            return replace(start, z_m=self.profile.camera_height_m)
        sampling = SamplingSettings(
            min_m=START_RANGE_M[0],
            max_m=START_RANGE_M[1],
            camera_height_m=self.profile.camera_height_m,
            success_radius_m=self.settings.success_radius_m,
            time_limit_s=self.settings.explorer.t_max_s,
        )
        seed = self.settings.seed
        try:
            drawn, _ = sample_start(self.atlas, self.spec, traveller, seed=seed, settings=sampling, judge=self.judge)
        except OutOfRangeError as error:
            drawn, length_m = settle_for_a_start(
                self.atlas, self.spec, traveller, seed=seed, settings=sampling, judge=self.judge
            )
            self._notes = _about_settled(length_m, error.near)
        return replace(drawn, z_m=self.profile.camera_height_m)

    def _guide(self, truth: OracleTruth) -> Guide:
        self._labels = (GUIDE_LABEL, "no minds", "no captions")
        return Guide(truth, self._vehicle(), self.clock)

    @property
    def home(self) -> Pose:
        """Where the vehicle was switched on: where the mission begins."""
        return self.start

    @property
    def origin(self) -> GeoOrigin:
        """Where on earth the origin of the world lies; for a world that is nowhere, where served receivers put it."""
        return self.atlas.world.origin or NOWHERE

    def content(self) -> Content | None:
        """Return what says what a camera shows, for simulated captioners; None where a model looks at pictures."""
        if is_model_name(self.settings.captioner):
            return None
        return (PixelEyes if self.settings.eyes == "pixels" else Eyes)(self.atlas).look

    def range_ahead(self) -> RangeAhead | None:
        """Return what says how far something stands before a pose, at the height of the camera."""
        eyes, height_m = PixelEyes(self.atlas), self.profile.camera_height_m
        return lambda pose: eyes.range_ahead_m(replace(pose, z_m=height_m))

    def _place(self) -> str | None:
        world = self.atlas.world
        return None if world.origin is None else world.name

    def _vehicle(self) -> Vehicle:
        if self._guarding is not None:
            return self._guarding.vehicle(self)
        settings, painter = self.settings, None
        if self._pictures is not None or is_model_name(settings.captioner):
            painter = Painter(self.atlas, side_px=settings.picture_px, conditions=settings.conditions)
        return SimulatedVehicle(
            self.atlas,
            self.profile,
            self.start,
            clock=self.clock,
            eyes=PixelEyes(self.atlas) if settings.eyes == "pixels" else Eyes(self.atlas),
            painter=painter,
            seed=settings.seed,
        )

    @property
    def header(self) -> MissionHeader:
        """What the mission starts with."""
        start, world = self.start, self.atlas.world
        length_m = self.judge.reference_length_m(start)
        way = self.judge.reference_path(start)
        planner, minds_label, captioner_label = self._labels
        return MissionHeader(
            goal=self.goal.text,
            level=self.goal.level,
            world=world.name,
            world_digest=self.atlas.digest,
            attribution=world.attribution,
            start=(round(start.x_m, 3), round(start.y_m, 3), round(start.z_m, 3), round(start.heading_rad, 6)),
            planner=planner,
            minds=minds_label,
            captioner=captioner_label,
            vehicle=self.profile.name,
            clock=self.settings.clock,
            ct_label=self._ct_label(),
            settings=asdict(self.settings),
            seed=self.settings.seed,
            versions=dict(versions()),
            goal_objects=self._goal_objects(),
            reference_length_m=round(length_m, 3) if np.isfinite(length_m) else None,
            reference_way=tuple((round(float(x), 2), round(float(y), 2)) for x, y in way) if way is not None else (),
            success_radius_m=self.settings.success_radius_m,
            understood=tuple(self.spec.describe()),
            notes=self._notes if self._guarding is None else (*self._notes, f"vehicle at {self._guarding.address}"),
            origin_deg=None if world.origin is None else (world.origin.lat_deg, world.origin.lon_deg),
        )

    def _goal_objects(self) -> tuple[tuple[int, str, float, float, int], ...]:
        objects = self.atlas.world.objects
        return tuple(
            (index, objects[index].class_name, round(objects[index].x_m, 2), round(objects[index].y_m, 2), grade)
            for index, grade in self.judge.satisfying
        )

    def _summary(
        self, header: MissionHeader, ended: Exploration, steps: list[StepRecord]
    ) -> tuple[MissionSummary, MissionScore]:
        track = track_of(self.start, steps)
        judged = self.judge.review(track)
        declared = ended.end is MissionEnd.FOUND
        reference_m = self.judge.reference_length_m(self.start)
        scored = score(
            outcome_of(
                track,
                self.judge,
                mission_id=f"{self.atlas.world.name}|{self.goal.text}|{self.settings.seed}",
                vehicle=self.profile.name,
                declared=declared,
                computing_s=ended.ct_s,
                planner_computing_s=min(ended.plan_s, ended.ct_s),
                travelling_s=ended.tt_s,
                time_limit_s=self.settings.explorer.t_max_s,
                looks=looks_of(steps),
                fov_rad=self.profile.camera.horizontal_fov_rad,
                report=judged,
                reference_length_m=reference_m,
                reference_way=header.reference_way,
            )
        )
        summary = MissionSummary(
            end=ended.end,
            reason=ended.reason,
            declared=declared,
            success=scored.success,
            oracle_success=scored.oracle_success,
            compliant=judged.compliance.compliant if self.spec.forbidden else None,
            spl=round(scored.spl, 6),
            casr=round(scored.casr, 6),
            path_length_m=round(judged.length_m, 3),
            reference_length_m=_finite(reference_m),
            distance_to_goal_m=_finite(judged.end.nearest_m),
            ct_s=round(ended.ct_s, 6),
            tt_s=round(ended.tt_s, 6),
            plan_s=round(ended.plan_s, 6),
            steps=ended.steps,
            calls=calls_by_role(steps),
            radii={f"{radius_m:g}": hit for radius_m, hit in scored.success_at},
            judge=self._verdict(judged),
            collisions=tuple(leg.detail for step in steps for leg in step.legs if leg.outcome is LegOutcome.COLLISION),
        )
        return summary, scored

    def _verdict(self, judged: TrackReport) -> str:
        """Return what the judge says of the end, in words."""
        if not judged.compliance.compliant:
            return f"{judged.compliance.longest_stretch_m:.0f} m in one stretch on ground that the goal shuns"
        end, objects = judged.end, self.atlas.world.objects
        if end.success:
            return f"{objects[end.object_id].object_class.noun} {end.distance_m:.0f} m away, in sight"
        if np.isfinite(end.distance_m):
            return f"in sight, but {end.distance_m:.0f} m away"
        if end.nearest_m <= self.settings.success_radius_m:
            return f"{end.nearest_m:.0f} m away, but not in sight"
        return f"the nearest is {end.nearest_m:.0f} m away" if np.isfinite(end.nearest_m) else "there is none"


def _check_arguments(world: object, settings: object, start: object) -> None:
    made = "open_world makes one of a name or a file"
    found: dict[type[InputError], list[Fault]] = {
        WorldError: kind_faults("world", world, (World, Atlas), "a World or an Atlas", made),
        SettingsError: kind_faults("settings", settings, (MissionSettings, type(None)), "MissionSettings, or None"),
        StartError: kind_faults("start", start, (Pose, type(None)), "a Pose, or None for a random one"),
    }
    kinds = [kind for kind, faults in found.items() if faults]
    if kinds:
        kind = kinds[0] if len(kinds) == 1 else InputError
        raise kind("mission", [fault for faults in found.values() for fault in faults])


def _checked(goal: str, world: World, settings: MissionSettings, start: Pose | None) -> GoalSpec:
    """Return what the goal asks for, once all that is given has been checked that needs no look into the world."""
    found = Gathering()
    spec = found.take(lambda: read_goal(goal), None)
    found.add(*errors_of(settings))
    if start is not None:
        found.check(lambda: check_on_map(world.bounds, start))
    found.finish("mission")
    if spec is None:  # its error was raised
        raise AssertionError
    return spec


def _about_settled(length_m: float, too_near: int) -> tuple[str, ...]:
    """Return what to say of a start that had to be settled for; nothing where a longer search found one in range."""
    low, high = START_RANGE_M
    if low <= length_m <= high:
        return ()
    kind = "farthest" if length_m < low else "nearest"
    lacking = f"no random start has a shortest way of {low:g} to {high:g} m"
    return (f"{lacking} ({too_near} too near); this is the {kind} found, {length_m:.1f} m",)


def _finite(value: float | None) -> float | None:
    return round(value, 3) if value is not None and np.isfinite(value) else None


def traveller_of(profile: VehicleProfile) -> Traveller:
    """Return who the shortest ways are for: what a profile's body can pass."""
    return Traveller(flies=profile.flies, radius_m=profile.radius_m, collides=profile.collides)


def judge_of(goal: str | GoalSpec, atlas: Atlas, vehicle: str, success_radius_m: float) -> Judge:
    """Return the judge of a goal in a world for a vehicle.

    Raises:
        GoalError: If the goal cannot be understood.
        UnknownNameError: If there is no such vehicle.
        SettingsError: If the radius is out of range.
    """
    profile = vehicle_profile(vehicle)
    return Judge(
        atlas,
        read_goal(goal) if isinstance(goal, str) else goal,
        traveller=traveller_of(profile),
        success_radius_m=success_radius_m,
        camera_height_m=profile.camera_height_m,
    )


def run_mission(
    goal: str,
    world: World | Atlas,
    settings: MissionSettings | None = None,
    *,
    start: Pose | None = None,
    folder: Path | str | None = None,
    on_step: Callable[[StepRecord], None] | None = None,
) -> MissionResult:
    """Run one mission; see `Mission` for the arguments and what it raises."""
    mission = Mission(goal, world, settings, start=start)
    return mission.run(folder=path_of(folder, "folder", RecordError) if folder is not None else None, on_step=on_step)
