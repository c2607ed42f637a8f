"""Seeded starts and episodes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError, StartError
from reasoned_explorer.model.draws import key_of, uniform
from reasoned_explorer.task.catalogue import CatalogueGoal, goals
from reasoned_explorer.task.episode import TIME_LIMIT_S, Episode
from reasoned_explorer.task.goal_spec import GoalSpec
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.task.targets import Grader
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.freespace import Grid
from reasoned_explorer.world.geodesic import Traveller
from reasoned_explorer.world.taxonomy import IMPASSABLE_ON_FOOT, Ground

#: Goals that a blind declaration would satisfy more often than this are left out of splits.
MAX_BLIND_RATE = 0.10
_BLIND_PLACES = 300
#: Starts keep this far from the edge of a world where there is such ground, metres: half of what can be seen from the
#: very edge is nothing.
EDGE_M = 25.0
_ATTEMPTS = 60
#: Where one must settle for a start so many places are looked at, and so many ways longer than the range are searched.
_SETTLING_PLACES, _FAR_TRIES = 200, 8
_DRAWS, _CELLS_A_DRAW = 20, 2000


@dataclass(frozen=True, slots=True)
class SamplingSettings:
    """How episodes are drawn.

    Attributes:
        min_m: The reference way is at least this long, metres; above 0.
        max_m: And at most this long.
        camera_height_m: Of the robot that is judged, metres.
        success_radius_m: Metres.
        time_limit_s: T_max, seconds.
        max_blind_rate: Goals that a blind declaration satisfies more often are left out, in [0, 1].
    """

    min_m: float = 30.0
    max_m: float = 300.0
    camera_height_m: float = 1.0
    success_radius_m: float = 15.0
    time_limit_s: float = TIME_LIMIT_S
    max_blind_rate: float = MAX_BLIND_RATE

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            SettingsError: With everything that is out of range.
        """
        faults = []
        if not (math.isfinite(self.min_m) and math.isfinite(self.max_m) and 0.0 < self.min_m < self.max_m):
            faults.append(Fault(f"min_m is {self.min_m}, max_m is {self.max_m}", "0 < min_m < max_m, finite metres"))
        if not 0.0 <= self.max_blind_rate <= 1.0:
            faults.append(Fault(f"max_blind_rate is {self.max_blind_rate}", "a share in [0, 1]"))
        if faults:
            raise SettingsError("sampling of episodes", faults)


def free_places(
    atlas: Atlas,
    *,
    traveller: Traveller,
    count: int,
    seed: int,
    forbidden: frozenset[Ground] = frozenset(),
    edge_m: float = 0.0,
) -> NDArray[np.float64]:
    """Return random places where a mission could begin: free for the traveller, outdoors, on walkable ground.

    Unknown ground, and what is too near to the edge of the world, are taken only where there is no other. Flyers start
    over ground that one can walk on, too.

    Args:
        atlas: The world.
        traveller: Who starts.
        count: How many; fewer are returned only where there are no places at all.
        seed: Of the draw.
        forbidden: Ground that is none to start on.
        edge_m: How far from the world's edge, metres.

    Returns:
        ENU metres, shape (n, 2).
    """
    space = atlas.geodesics.space(traveller, shunned=forbidden)
    grid, clearance = space.grid, space.clearance.ravel()
    bulk = np.random.Generator(np.random.PCG64(key_of(seed, "free places")))
    taken = np.empty(0, dtype=np.int64)
    for _ in range(_DRAWS):
        cells = bulk.integers(0, clearance.size, size=_CELLS_A_DRAW)
        cells = _inside(atlas, grid, cells[clearance[cells] > 0], edge_m)
        taken = np.concatenate((taken, cells[_is_walkable(atlas, grid, cells, forbidden | {Ground.UNKNOWN})]))
        if taken.size >= count:
            break
    if taken.size < count:
        # Free ground is rare: look at every cell of it.
        everywhere = np.flatnonzero(clearance)
        inner = _inside(atlas, grid, everywhere, edge_m)
        known = forbidden | {Ground.UNKNOWN}
        for cells, refused in ((inner, known), (everywhere, known), (inner, forbidden), (everywhere, forbidden)):
            left = cells[_is_walkable(atlas, grid, cells, refused)]
            if left.size:
                taken = left[bulk.integers(0, left.size, size=count)]
                break
    return np.stack(_middles(grid, taken[:count]), axis=1)


def _inside(atlas: Atlas, grid: Grid, cells: NDArray[np.int64], edge_m: float) -> NDArray[np.int64]:
    """Return the cells that are at least so far from the edge of the world."""
    if edge_m <= 0.0:
        return cells
    bounds, (x_m, y_m) = atlas.world.bounds, _middles(grid, cells)
    inner_x = (x_m >= bounds.min_x_m + edge_m) & (x_m <= bounds.max_x_m - edge_m)
    inner_y = (y_m >= bounds.min_y_m + edge_m) & (y_m <= bounds.max_y_m - edge_m)
    return cells[inner_x & inner_y]


def _is_walkable(atlas: Atlas, grid: Grid, cells: NDArray[np.int64], refused: frozenset[Ground]) -> NDArray[np.bool_]:
    codes = np.zeros(256, dtype=np.bool_)
    codes[[int(ground) for ground in IMPASSABLE_ON_FOOT | refused]] = True
    return ~codes[atlas.ground.at_many(*_middles(grid, cells))]


def _middles(grid: Grid, cells: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows, cols = np.divmod(cells, grid.cols)
    return grid.min_x_m + (cols + 0.5) * grid.cell_m, grid.min_y_m + (rows + 0.5) * grid.cell_m


def sample_start(
    atlas: Atlas,
    spec: GoalSpec,
    traveller: Traveller,
    *,
    seed: int,
    settings: SamplingSettings | None = None,
    judge: Judge | None = None,
) -> tuple[Pose, float]:
    """Return a random start for a goal, and the length of the reference way from it, metres.

    It is free, outdoors, on ground that one can walk on and that the goal allows, and not at the edge of the world
    (`EDGE_M`); the way from it to success is within the settings' range. It faces anywhere.

    Raises:
        OutOfRangeError: If no place is within the range.
        StartError: If nothing satisfies the goal, or there is no place to start.
    """
    chosen = settings or SamplingSettings()
    judge = judge or _judge(atlas, spec, traveller, chosen, None)
    if not judge.targets:
        what = f"nothing in {atlas.world.name!r} satisfies {spec.text!r}"
        raise StartError("start", [Fault(what, "a goal that something satisfies", "take another goal or world")])
    places = free_places(
        atlas, traveller=traveller, count=_ATTEMPTS, seed=seed, forbidden=spec.forbidden, edge_m=EDGE_M
    )
    if not len(places):
        what = f"{atlas.world.name!r} has no place to start"
        raise StartError("start", [Fault(what, "free ground outdoors that the goal allows")])
    seen: list[float] = []
    for attempt, (x_m, y_m) in enumerate(places):
        place = float(x_m), float(y_m)
        length_m = _length_m(judge, place, chosen)
        if chosen.min_m <= length_m <= chosen.max_m:
            heading_rad = 2.0 * math.pi * uniform(seed, "start heading", attempt)
            return Pose(*place, chosen.camera_height_m if traveller.flies else 0.0, heading_rad), length_m
        seen.append(length_m)
    raise OutOfRangeError(atlas.world.name, spec.text, chosen, seen)


class OutOfRangeError(StartError):
    """No random place lies within the range of a start.

    Args:
        world: Name of the world.
        goal: The sentence.
        settings: With the range.
        lengths_m: Of the reference way from each place; infinity where it is too long or there is none.
    """

    def __init__(self, world: str, goal: str, settings: SamplingSettings, lengths_m: Sequence[float]) -> None:
        self.near = sum(length < settings.min_m for length in lengths_m)
        far = len(lengths_m) - self.near
        what = f"{len(lengths_m)} random places in {world!r} for {goal!r}: {self.near} too near, {far} too far"
        expected = f"a way of {settings.min_m:g} to {settings.max_m:g} m"
        super().__init__("start", [Fault(what, expected, "name a start, take another goal or another world")])


def settle_for_a_start(
    atlas: Atlas, spec: GoalSpec, traveller: Traveller, *, seed: int, settings: SamplingSettings, judge: Judge
) -> tuple[Pose, float]:
    """Return the start that comes nearest to the range where `sample_start` finds none within it.

    For a goal that is everywhere that is the farthest start that there is; for one that is far away, the nearest.

    Args:
        atlas: The world.
        spec: What the goal asks for.
        traveller: Who starts.
        seed: Of the draw.
        settings: With the range.
        judge: Of the goal.

    Raises:
        StartError: If from no place anything is left to be looked for, or can be reached.
    """
    places: list[tuple[float, float]] = []
    lengths: list[float] = []
    # More places, and at last the world's rim, may still hold one that is within the range.
    for edge_m in (EDGE_M, 0.0):
        for x_m, y_m in free_places(
            atlas, traveller=traveller, count=_SETTLING_PLACES, seed=seed, forbidden=spec.forbidden, edge_m=edge_m
        ):
            places.append((float(x_m), float(y_m)))
            lengths.append(_length_m(judge, places[-1], settings))
            if settings.min_m <= lengths[-1] <= settings.max_m:
                return _facing_anywhere(places[-1], seed, settings, traveller), lengths[-1]
    reached = [index for index, length_m in enumerate(lengths) if 0.0 < length_m < math.inf]
    if reached:
        farthest = max(reached, key=lengths.__getitem__)
        return _facing_anywhere(places[farthest], seed, settings, traveller), lengths[farthest]
    by_distance = sorted(
        (judge.success(*place).nearest_m, index) for index, place in enumerate(places) if lengths[index] == math.inf
    )
    for _, index in by_distance[:_FAR_TRIES]:
        length_m = judge.reference_length_m(places[index])
        if length_m < math.inf:
            return _facing_anywhere(places[index], seed, settings, traveller), length_m
    succeed = sum(length == 0.0 for length in lengths)
    what = f"of {len(places)} random places in {atlas.world.name!r} for {spec.text!r}, {succeed} are there already"
    expected = "a place from which there is something to look for, and a way to it"
    raise StartError("start", [Fault(what, expected, "name a start, take another goal or another world")])


def _facing_anywhere(place: tuple[float, float], seed: int, settings: SamplingSettings, traveller: Traveller) -> Pose:
    heading_rad = 2.0 * math.pi * uniform(seed, "settled heading")
    return Pose(*place, settings.camera_height_m if traveller.flies else 0.0, heading_rad)


def _length_m(judge: Judge, place: tuple[float, float], settings: SamplingSettings) -> float:
    """Return the length of the reference way from a place, metres; infinity where it is too long, or there is none."""
    # The straight line is the shortest: what is too far by it needs no search.
    if judge.success(*place).nearest_m - settings.success_radius_m > settings.max_m:
        return math.inf
    return judge.reference_length_m(place, max_m=settings.max_m)


def sample_episodes(
    atlas: Atlas,
    *,
    levels: Sequence[int] = (1, 2, 3, 4),
    count: int,
    seed: int,
    traveller: Traveller,
    settings: SamplingSettings | None = None,
) -> tuple[Episode, ...]:
    """Return random episodes in a world: levels in turn, goals of a level in a random order, each with its own start.

    Goals that nothing satisfies, that cannot be reached, or that a blind declaration satisfies too often are left out.

    Raises:
        StartError: If a level has no goal left.
        SettingsError: If the count is below 1 or no level is given.
    """
    chosen = settings or SamplingSettings()
    if count < 1 or not levels:
        raise SettingsError(
            "sampling of episodes", [Fault(f"count {count}, levels {tuple(levels)}", "at least one of each")]
        )
    dealer = EpisodeDealer(atlas, traveller, seed=seed, settings=chosen)
    return tuple(dealer.deal(levels[place % len(levels)]) for place in range(count))


@dataclass(slots=True)
class _Known:
    """What dealers of one world share: places to declare blindly from, judges, and how often blindness succeeds."""

    grader: Grader
    places: list[tuple[float, float]]
    judges: dict[tuple[int, str], Judge] = field(default_factory=dict)
    blind: dict[tuple[int, str], float] = field(default_factory=dict)

    @classmethod
    def of(cls, atlas: Atlas, traveller: Traveller, seed: int) -> "_Known":
        places = free_places(atlas, traveller=traveller, count=_BLIND_PLACES, seed=key_of(seed, "blind"))
        return cls(Grader(atlas), [(float(x), float(y)) for x, y in places])


class EpisodeDealer:
    """Deals episodes of one world: goals of each level from a shuffled deck, round after round.

    Args:
        atlas: The world.
        traveller: Who goes.
        seed: Of every draw.
        settings: How episodes are drawn.
        name: What the world is called in the episodes; its own name by default.
        share: Another dealer of the same world, traveller and success radius, to share judges with.
    """

    def __init__(
        self,
        atlas: Atlas,
        traveller: Traveller,
        *,
        seed: int,
        settings: SamplingSettings | None = None,
        name: str | None = None,
        share: "EpisodeDealer | None" = None,
    ) -> None:
        self._atlas, self._traveller, self._seed, self._settings = (
            atlas,
            traveller,
            seed,
            settings or SamplingSettings(),
        )
        self._name = name or atlas.world.name
        self._decks: dict[int, list[CatalogueGoal]] = {}
        self._rounds: dict[tuple[int, str], int] = {}
        self._known: _Known = share._known if share is not None else _Known.of(atlas, traveller, seed)

    def blind_rate(self, episode: Episode) -> float:
        """Return how often a declaration at a random spot of the world would satisfy a dealt episode's goal."""
        level, name = episode.id.split("/")[-3:-1]
        return self._known.blind[int(level[1:]), name]

    def deal(self, level: int) -> Episode:
        """Return the next episode of a level; goals that cannot be posed leave the deck.

        Raises:
            StartError: If the deck is empty.
        """
        if level not in self._decks:
            self._decks[level] = _shuffled(goals(level), self._seed)
        deck = self._decks[level]
        while deck:
            goal = deck.pop(0)
            try:
                episode = self._episode(goal)
            except StartError:
                continue
            deck.append(goal)
            return episode
        what = f"level {level} has no goal left in {self._atlas.world.name!r}"
        expected = "goals that something satisfies, that can be reached and that are not everywhere"
        raise StartError("episodes", [Fault(what, expected, "take another world or a wider range")])

    def _episode(self, goal: CatalogueGoal) -> Episode:
        key = goal.level, goal.name
        lap = self._rounds.get(key, 0)
        self._rounds[key] = lap + 1
        seed = key_of(self._seed, "episode", goal.level, goal.name, lap)
        spec = goal.spec(int(uniform(seed, "paraphrase") * len(goal.sentences)))
        if key not in self._known.judges:
            judge = _judge(self._atlas, spec, self._traveller, self._settings, self._known.grader)
            if key not in self._known.blind:
                self._known.blind[key] = judge.blind_success_rate(self._known.places)
            if self._known.blind[key] > self._settings.max_blind_rate:
                raise StartError(
                    "episode", [Fault(f"{spec.text!r} is satisfied everywhere", "a goal to be looked for")]
                )
            self._known.judges[key] = judge
        start, length_m = sample_start(
            self._atlas, spec, self._traveller, seed=seed, settings=self._settings, judge=self._known.judges[key]
        )
        return Episode(
            id=f"{self._name}/L{goal.level}/{goal.name}/{lap}",
            world=self._name,
            spec=spec,
            start=start,
            seed=seed,
            reference_length_m=length_m,
            time_limit_s=self._settings.time_limit_s,
            success_radius_m=self._settings.success_radius_m,
        )


def _judge(
    atlas: Atlas, spec: GoalSpec, traveller: Traveller, settings: SamplingSettings, grader: Grader | None
) -> Judge:
    return Judge(
        atlas,
        spec,
        traveller=traveller,
        success_radius_m=settings.success_radius_m,
        camera_height_m=settings.camera_height_m,
        grader=grader,
    )


def _shuffled(listed: Sequence[CatalogueGoal], seed: int) -> list[CatalogueGoal]:
    return sorted(listed, key=lambda goal: (uniform(seed, "order", goal.level, goal.name), goal.name))
