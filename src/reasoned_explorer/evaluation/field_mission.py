"""A mission where no world is known, as outdoors with a machine: the agent alone says whether it has arrived."""

import asyncio
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.clock import RealClock
from reasoned_explorer.evaluation.guarding import Guarding
from reasoned_explorer.evaluation.mission_course import MissionCourse, calls_by_role, versions
from reasoned_explorer.evaluation.mission_settings import CLOCKS, MissionSettings, errors_of, minds_of
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.evaluation.track import track_of
from reasoned_explorer.evaluation.vehicle_address import Errand, VehicleAddress
from reasoned_explorer.exploration.explorer import Exploration
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.registry import READ_THE_TRUTH
from reasoned_explorer.model import Fault, Gathering, LegOutcome, RecordError, SettingsError
from reasoned_explorer.model.checks import path_of
from reasoned_explorer.model.record import EpisodeRecord, MissionEnd, MissionHeader, MissionSummary, StepRecord
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.safety.limits import limited_profile
from reasoned_explorer.vehicles.safety.telemetry import Refreshes
from reasoned_explorer.vehicles.vehicle import Vehicle

#: What a person types, and a record says, for a world where none is known.
NO_WORLD = "none"
#: What a record says in the judge's stead.
UNJUDGED = "nobody judged: no world is known"


@dataclass(frozen=True, slots=True)
class FieldResult:
    """What came of a mission that nobody judged.

    Attributes:
        record: Everything that is kept of it.
        folder: Where the record lies, or None.
    """

    record: EpisodeRecord
    folder: Path | None = None

    @property
    def summary(self) -> MissionSummary:
        """How it ended."""
        if self.record.summary is None:  # a result is only made once there is one
            raise AssertionError
        return self.record.summary

    def draw_map(self, path: Path | str) -> None:
        """Draw what happened on blank ground, PNG, SVG or PDF by the path's suffix."""
        from reasoned_explorer.evaluation.record_map import draw_record

        draw_record(None, self.record, path_of(path, "map picture", RecordError))


def faults_without_world(
    settings: MissionSettings, address: VehicleAddress | None, *, vehicle: str = ""
) -> list[Fault]:
    """Return all that a mission without a world cannot do with these settings and this vehicle.

    Args:
        settings: Who does what.
        address: Where the vehicle is; None for the embedded simulator's, which is in a world.
        vehicle: What a person typed for it.
    """
    faults = []
    if address is None:
        what = f"the vehicle {vehicle or settings.vehicle!r:.60} without a world"
        faults.append(Fault(what, "a vehicle at an address, such as airsim://HOST:41451", "or a --world to simulate"))
    elif not address.has_camera:
        faults.append(Fault(f"no pictures come from {address}", "a vehicle with a camera: captions need pictures"))
    if not is_model_name(settings.captioner):
        what = f"the captioner {settings.captioner!r:.60} without a world: it looks into one"
        faults.append(Fault(what, "a model that reads pictures", "such as openai:gpt-4o-mini"))
    for name in dict.fromkeys(minds_of(settings).values()):
        if name in READ_THE_TRUTH:
            what = f"the mind {name} without a world: it reads the truth of one"
            faults.append(Fault(what, "minds that need none", "such as embedded"))
    if settings.agent != "explorer":
        faults.append(Fault(f"the agent {settings.agent!r:.60} without a world", "explorer"))
    return faults


async def whereabouts(guarding: Guarding) -> Pose:
    """Ask a vehicle where it is, in the frame that it tells its positions in; nothing is moved.

    Raises:
        PartError: If it cannot be reached or does not tell.
        MissingDependencyError: If the library of its wire is not installed.
    """
    address, nowhere = guarding.address, Pose(0.0, 0.0)
    profile = limited_profile(vehicle_profile(address.profile), guarding.limits_at(nowhere))
    vehicle = address.vehicle(profile, Errand(RealClock(), nowhere, pictures=False))
    try:
        await vehicle.connect()
        if isinstance(vehicle, Refreshes):
            await vehicle.refresh()
        else:
            await vehicle.look([])  # no view is taken, but it finds out where it is
        return vehicle.pose
    finally:
        await vehicle.close()


class FieldMission(MissionCourse):
    """A mission of a vehicle at an address, in a place of which nothing is known.

    Its frame is east and north of where the vehicle stands when it is made. Nobody judges it.

    Args:
        goal: The goal sentence.
        settings: Who does what; the captioner is a model.
        guarding: Which vehicle.
        there: Where the vehicle says that it is, by its own frame (`whereabouts`); None asks it.
        desk: Makes the callers of models.
        pictures: Folder in which the pictures of all views are kept; None keeps none.

    Raises:
        PartError: If the vehicle or a model does not answer.
        MissingDependencyError: If a model or the vehicle's wire needs what is not installed.
        InputError: With all that is wrong.
    """

    def __init__(
        self,
        goal: str,
        settings: MissionSettings,
        guarding: Guarding,
        *,
        there: Pose | None = None,
        desk: ModelDesk | None = None,
        pictures: Path | None = None,
    ) -> None:
        found = Gathering()
        spec = found.take(lambda: read_goal(goal), None)
        found.add(*errors_of(settings))
        if not found.errors and (faults := faults_without_world(settings, guarding.address)):
            found.add(SettingsError("mission", faults))
        found.finish("mission")
        if spec is None:  # its error was raised
            raise AssertionError
        self.settings, self.spec, self.goal = settings, spec, spec.goal
        self.profile = vehicle_profile(settings.vehicle)
        self._desk, self._pictures, self._guarding = desk, pictures, guarding
        there = asyncio.run(whereabouts(guarding)) if there is None else there
        self._home = Pose(-there.x_m, -there.y_m)
        self.start = replace(there, x_m=0.0, y_m=0.0, z_m=self.profile.camera_height_m)
        self.clock = CLOCKS[settings.clock]()
        self.explorer = self._explorer(None)

    @property
    def home(self) -> Pose:
        """Where the frame in which the vehicle tells its position begins."""
        return self._home

    @property
    def header(self) -> MissionHeader:
        """What the mission starts with."""
        start, (planner, minds, captioner) = self.start, self._labels
        return MissionHeader(
            goal=self.goal.text,
            level=self.goal.level,
            world=NO_WORLD,
            world_digest="",
            attribution="",
            start=(0.0, 0.0, round(start.z_m, 3), round(start.heading_rad, 6)),
            planner=planner,
            minds=minds,
            captioner=captioner,
            vehicle=self.profile.name,
            clock=self.settings.clock,
            ct_label=self._ct_label(),
            settings=asdict(self.settings),
            seed=self.settings.seed,
            versions=dict(versions()),
            success_radius_m=self.settings.success_radius_m,
            understood=tuple(self.spec.describe()),
            notes=(f"vehicle at {self._guarding.address}", f"{UNJUDGED}; metres are from where the vehicle stood"),
        )

    def run(self, *, folder: Path | None = None, on_step: Callable[[StepRecord], None] | None = None) -> FieldResult:
        """Run the mission to its end; see `Mission.run`.

        Args:
            folder: Where the record is written as it happens; None keeps it in memory only.
            on_step: Called with each step's record as soon as the step is over.
        """
        record, _, folder = self._record(folder, on_step)
        return FieldResult(record, folder)

    def _place(self) -> str:
        # Nobody knows that it is nowhere on earth.
        return f"what {self._guarding.address} sees"

    def _vehicle(self) -> Vehicle:
        return self._guarding.vehicle(self)

    def _summary(
        self, header: MissionHeader, ended: Exploration, steps: list[StepRecord]
    ) -> tuple[MissionSummary, MissionScore | None]:
        del header
        points = np.array([(point.x_m, point.y_m) for point in track_of(self.start, steps)])
        summary = MissionSummary(
            end=ended.end,
            reason=ended.reason,
            declared=ended.end is MissionEnd.FOUND,
            success=None,
            oracle_success=None,
            compliant=None,
            spl=None,
            casr=None,
            path_length_m=round(float(np.hypot(*np.diff(points, axis=0).T).sum()), 3),
            reference_length_m=None,
            distance_to_goal_m=None,
            ct_s=round(ended.ct_s, 6),
            tt_s=round(ended.tt_s, 6),
            plan_s=round(ended.plan_s, 6),
            steps=ended.steps,
            calls=calls_by_role(steps),
            judge=UNJUDGED,
            collisions=tuple(leg.detail for step in steps for leg in step.legs if leg.outcome is LegOutcome.COLLISION),
        )
        return summary, None
