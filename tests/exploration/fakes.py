"""Fake parts for the agent's loop: an empty plane, and parts that answer what a test tells them to."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.clock import Clock, VirtualClock
from reasoned_explorer.exploration.explorer import Exploration, Explorer, Parts
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Goal, Leg, LegOutcome, PartError, Scene, TrackPoint, Undescribed, Verdict, View
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.planning import FrontierScore, Plan
from reasoned_explorer.vehicles import PROFILES, Vehicle, VehicleProfile


class FakeVehicle(Vehicle):
    """Moves at 1 m/s over an empty plane; ``wall`` says where it cannot go, ``broken`` which command fails."""

    def __init__(self, clock: Clock, *, wall: Callable[[Pose], bool] = lambda pose: False) -> None:
        self.profile: VehicleProfile = PROFILES["drone"]
        self.clock, self.wall = clock, wall
        self.looks = self.legs = 0
        self.broken: set[str] = set()
        self.closed = False
        self._pose = Pose(0.0, 0.0, 1.5, 0.0)

    @property
    def pose(self) -> Pose:
        return self._pose

    async def close(self) -> None:
        self.closed = True

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        await self.clock.act(1.0)
        self.looks += 1
        if "camera" in self.broken:
            raise PartError("camera", "no picture")
        return [View((self.legs, self.looks, i), self._pose.facing(h)) for i, h in enumerate(headings_rad)]

    async def go_to(self, target: Pose) -> Leg:
        self.legs += 1
        if "link" in self.broken:
            raise PartError("link", "lost")
        if self.wall(target):
            await self.clock.act(0.5)
            return Leg(target.x_m, target.y_m, LegOutcome.COLLISION, 0.5, 0.2, (), "a wall")
        length_m = self._pose.distance_to_m(target.x_m, target.y_m)
        await self.clock.act(length_m)
        self._pose = target
        track = (TrackPoint(self.clock.now_s(), target.x_m, target.y_m, target.z_m, target.heading_rad),)
        return Leg(target.x_m, target.y_m, LegOutcome.ARRIVED, length_m, length_m, track)


@dataclass
class FakeCaptioner:
    """Says where it stands; takes 2 seconds."""

    clock: Clock
    name: str = "fake"
    label: str = "fake captioner"
    broken: bool = False
    lost: frozenset[int] = frozenset()  # these views of each look are not described

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str | Undescribed]:
        await self.clock.think(2.0)
        if self.broken:
            raise PartError("captioner", "no answer")
        return [
            Undescribed("refused") if index in self.lost else f"at {view.pose.x_m:.0f}, {view.pose.y_m:.0f}"
            for index, view in enumerate(views)
        ]


@dataclass
class FakePlanner:
    """Scores by a rule; takes 10 seconds; counts how often it was cut short."""

    clock: Clock
    rule: Callable[[Scene], FrontierScore] = lambda scene: FrontierScore(3.0)
    seconds: float = 10.0
    name: str = "fake"
    label: str = "fake planner"
    finished: int = 0
    broken: bool = False

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        await self.clock.think(self.seconds)
        if self.broken:
            raise PartError("planner", "no answer")
        self.finished += 1
        return Plan(tuple(self.rule(scene) for scene in scenes))


@dataclass
class FakeChecker:
    """Finds the goal where a rule says so; takes 3 seconds."""

    clock: Clock
    rule: Callable[[Scene], bool] = lambda scene: False
    broken: bool = False

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        await self.clock.think(3.0)
        if self.broken:
            raise PartError("checker", "no answer")
        return [Verdict(self.rule(scene), 0.9, "a bench") for scene in scenes]


@dataclass
class Plane:
    """The parts, and what came of running them."""

    settings: ExplorerSettings = field(default_factory=lambda: ExplorerSettings(t_max_s=300.0))
    clock: Clock = field(default_factory=VirtualClock)
    steps: list[StepRecord] = field(default_factory=list)
    on_step: Callable[[StepRecord], None] = lambda step: None

    def __post_init__(self) -> None:
        self.ledger = Ledger()
        self.must_end: Callable[[], tuple[MissionEnd, str] | None] = lambda: None
        self.vehicle = FakeVehicle(self.clock)
        self.captioner = FakeCaptioner(self.clock)
        self.planner = FakePlanner(self.clock)
        self.checker = FakeChecker(self.clock)

    def run(self) -> Exploration:
        parts = Parts(self.vehicle, self.captioner, self.planner, self.checker, self.clock, self.ledger, self.must_end)

        def keep(step: StepRecord) -> None:
            self.steps.append(step)
            self.on_step(step)

        self.explorer = Explorer(parts, self.settings, on_step=keep)
        return self.clock.run(self.explorer.run(Goal("Find me a bench", 1)))
