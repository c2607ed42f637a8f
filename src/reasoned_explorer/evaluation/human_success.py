"""What people say of missions beside what the judge says: human success, agreement, and where the two differ.

A mission's **human success** is the share of its raters who say "yes" to "did it do what was asked?", and 0 where the
robot did not say in time that it had found it: that is part of the task and need not be asked of people. **Partly**
counts in a figure of its own. Automatic success stands beside it over the same missions, so that both can be compared;
it is not the method's SR over all its missions.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

from reasoned_explorer.evaluation.agreement import Agreement, Ratings, Scale, agreement
from reasoned_explorer.evaluation.bench.tables import Sheet
from reasoned_explorer.evaluation.metrics import Metric, mean_of
from reasoned_explorer.evaluation.ratings import Answer, MissionKey, Rating, latest
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.statistics import wilson_interval
from reasoned_explorer.evaluation.wording import figure, level_name, share
from reasoned_explorer.model import MissingDependencyError

#: Figures of a method, in order: name, and what it is in words.
FIGURES = ("human success", "automatic success", "human − automatic", "yes or partly", "how well, 1–5")
_SHARES = frozenset({"human success", "automatic success", "yes or partly"})
#: From worst to best: what an answer is on an ordinal scale.
_GRADES = {Answer.NO: 0, Answer.PARTLY: 1, Answer.YES: 2}


@dataclass(frozen=True, slots=True)
class RatedMission:
    """A mission that people have rated.

    Attributes:
        row: The mission.
        ratings: The latest of each rater, by rater's name; at least one.
    """

    row: MissionRow
    ratings: tuple[Rating, ...]

    @property
    def in_time(self) -> bool:
        """Whether the robot said in time that it had found it."""
        return self.row.declared and not self.row.score.over_time

    @property
    def yes(self) -> float:
        """Share of raters who say that it did what was asked."""
        return fmean(said.answer is Answer.YES for said in self.ratings)

    @property
    def human_success(self) -> float:
        """Share of raters who call it a success; 0 where the robot did not say so in time."""
        return self.yes if self.in_time else 0.0

    @property
    def is_disputed(self) -> bool:
        """Whether at least half of the raters say something else than the judge."""
        return abs(self.human_success - float(self.row.score.success)) >= 0.5

    @property
    def values(self) -> dict[str, float]:
        """What it adds to each of `FIGURES`."""
        judged = float(self.row.score.success)
        kind = fmean(said.answer is not Answer.NO for said in self.ratings)
        well = fmean(said.how_well for said in self.ratings)
        found = (self.human_success, judged, self.human_success - judged, kind if self.in_time else 0.0, well)
        return dict(zip(FIGURES, found, strict=True))


@dataclass(frozen=True, slots=True)
class Judged:
    """The missions of a run that people have rated.

    Attributes:
        missions: In the order of the rows.
        earlier: How many ratings were changed later; they do not count.
        lost: How many ratings are of missions that the run does not have any more.
    """

    missions: tuple[RatedMission, ...]
    earlier: int = 0
    lost: int = 0

    @classmethod
    def of(cls, rows: Iterable[MissionRow], ratings: Sequence[Rating]) -> "Judged":
        """Return what people say of missions.

        Args:
            rows: Of the run.
            ratings: Of the run, all of them, in the order in which they were given.
        """
        counting = latest(ratings)
        by_mission: dict[MissionKey, list[Rating]] = {}
        for said in counting:
            by_mission.setdefault(said.key, []).append(said)
        missions = []
        for row in rows:
            mine = by_mission.pop((row.score.vehicle, row.method, row.mission_id), None)
            if mine:
                missions.append(RatedMission(row, tuple(mine)))
        lost = sum(map(len, by_mission.values()))
        return cls(tuple(missions), len(ratings) - len(counting), lost)

    @property
    def raters(self) -> tuple[str, ...]:
        """Who rated, sorted."""
        return tuple(sorted({said.rater for mission in self.missions for said in mission.ratings}))

    @property
    def levels(self) -> tuple[int, ...]:
        """Levels of which there are ratings, sorted."""
        return tuple(sorted({mission.row.level for mission in self.missions}))

    @property
    def count(self) -> int:
        """How many ratings count."""
        return sum(len(mission.ratings) for mission in self.missions)

    @property
    def disputed(self) -> tuple[RatedMission, ...]:
        """The missions of which at least half of the raters say something else than the judge."""
        return tuple(mission for mission in self.missions if mission.is_disputed)

    def agreements(self) -> dict[str, Agreement | str]:
        """Return how well raters agree on each question; words where the library for it is not installed."""
        found: dict[str, Agreement | str] = {}
        for name, table in (("yes, partly or no", self._table(answers=True)), ("how well", self._table(answers=False))):
            try:
                found[name] = agreement(table, Scale.ORDINAL)
            except MissingDependencyError as error:
                found[name] = str(error)
        return found

    def _table(self, *, answers: bool) -> Ratings:
        # Named by what they are, so that the order of the rows changes nothing.
        return {
            "\0".join(mission.ratings[0].key): {
                said.rater: _GRADES[said.answer] if answers else said.how_well for said in mission.ratings
            }
            for mission in self.missions
        }


def figures_of(missions: Sequence[RatedMission], *, places: Mapping[str, str], seed: int = 0) -> dict[str, Metric]:
    """Return `FIGURES` of some missions of one method; none of no mission.

    Intervals as `evaluation.metrics.aggregate` makes them: a percentile bootstrap in which places are drawn as a whole;
    shares of one place, and shares that never vary, have Wilson's. Raters are taken as they are: other people may judge
    otherwise.

    Args:
        missions: Of one method and vehicle.
        places: Of each mission, by its id.
        seed: Of the bootstrap.
    """
    if not missions:
        return {}
    values = {mission.row.mission_id: mission.values for mission in missions}
    return {name: _figure(name, {key: mine[name] for key, mine in values.items()}, places, seed) for name in FIGURES}


def _figure(name: str, values: Mapping[str, float], places: Mapping[str, str], seed: int) -> Metric:
    found = mean_of(name, values, places=places, seed=seed)
    is_share = name in _SHARES and set(values.values()) <= {0.0, 1.0}
    if is_share and (found.interval == "bootstrap" or found.low == found.high):
        # A bootstrap of what never varies would claim certainty.
        low, high = wilson_interval(round(sum(values.values())), len(values))
        return replace(found, low=low, high=high, interval="Wilson")
    return found


def said_of(mission: RatedMission) -> str:
    """Return what people said of a mission, in short: ``yes 4, partly 3``."""
    return ", ".join(f"{said.answer} {said.how_well}" for said in mission.ratings)


def agreement_words(found: Agreement | str) -> str:
    """Return how well raters agree, in words."""
    if isinstance(found, str):
        return f"not computed: {found}"
    over = f"{found.units:,} missions that two or more rated, {found.values:,} ratings, {found.raters} raters"
    if found.alpha is None:
        return f"not defined: {found.why_not}"
    return f"Krippendorff’s α = {share(found.alpha)} (ordinal; {over})"


def people_sheet(judged: Judged, methods: Sequence[str], *, notes: Sequence[str] = ()) -> Sheet:
    """Return human beside automatic success by method and level, as text."""
    lines = []
    several = len({mission.row.score.vehicle for mission in judged.missions}) > 1
    for level in (*judged.levels, None):
        for (vehicle, method), mine in _grouped(judged, methods).items():
            chosen = [mission for mission in mine if level in {None, mission.row.level}]
            if not chosen:
                continue
            places = {mission.row.mission_id: mission.row.place for mission in chosen}
            found = figures_of(chosen, places=places)
            name = f"{method} · {vehicle}" if several else method
            ratings = sum(len(mission.ratings) for mission in chosen)
            cells = [figure(found[each]) for each in FIGURES]
            lines.append((level_name(level), name, f"{len(chosen)}", f"{ratings}", *cells))
    said = [f"Agreement on {name}: {agreement_words(found)}." for name, found in judged.agreements().items()]
    head = ("level", "planner", "missions", "ratings", *FIGURES)
    who = f"{len(judged.raters)} rater{'s' * (len(judged.raters) != 1)}"
    return Sheet(f"What people say ({who})", head, tuple(lines), (*said, *notes))


def _grouped(judged: Judged, methods: Sequence[str]) -> dict[tuple[str, str], list[RatedMission]]:
    """Return rated missions by vehicle and method, in the order of methods."""
    found: dict[tuple[str, str], list[RatedMission]] = {}
    order = {name: place for place, name in enumerate(methods)}
    for mission in judged.missions:
        found.setdefault((mission.row.score.vehicle, mission.row.method), []).append(mission)
    return dict(sorted(found.items(), key=lambda one: (one[0][0], order.get(one[0][1], len(order)), one[0][1])))
