"""The rows of a run, checked, named and put in order: what tables and figures are made from."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from reasoned_explorer.evaluation.bench.results import Results, places_of
from reasoned_explorer.evaluation.metrics import Metric, MetricTable
from reasoned_explorer.evaluation.report.about import ReportAbout
from reasoned_explorer.evaluation.report.causes import Cause, cause_of
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.evaluation.statistics import RESAMPLES
from reasoned_explorer.model import Fault, InputError


@dataclass(frozen=True, slots=True)
class Entry:
    """One mission as the report shows it.

    Attributes:
        row: Its row, as it stands in the store.
        method: Name of the method; with the vehicle, where the run has several.
        cause: What became of it.
    """

    row: MissionRow
    method: str
    cause: Cause

    @property
    def score(self) -> MissionScore:
        """Its metrics, under the row's mission id: by that, missions are paired."""
        return self.row.score


@dataclass(frozen=True, slots=True)
class Difference:
    """A method against the first one of the same vehicle, on the missions that both have.

    Attributes:
        method: The one.
        base: The other, which is taken off.
        table: Paired differences.
    """

    method: str
    base: str
    table: MetricTable


class Study:
    """All rows of a report.

    Args:
        rows: At least one; any order.
        about: What the report is of.

    Raises:
        InputError: If there is no row, a mission stands twice for a method, T_max differs within a method, or an end is
            unknown; with everything that is wrong.
    """

    def __init__(self, rows: Sequence[MissionRow], about: ReportAbout) -> None:
        self.about = about
        several = len({row.score.vehicle for row in rows}) > 1
        # Profiles are never pooled in one number: with several, each is a method of its own.
        named = [(f"{row.method} · {row.score.vehicle}" if several else row.method, _keyed(row)) for row in rows]
        faults = _faults(named)
        if faults:
            raise InputError("rows of a report", faults)
        order = {name: place for place, name in enumerate(about.methods)}
        seen = list(dict.fromkeys(name for name, _ in named))
        #: Of each method as it is shown: its name in the store, and its vehicle.
        self.stored = {name: row.method for name, row in named}
        self.vehicle = {name: row.score.vehicle for name, row in named}
        self.methods = tuple(
            sorted(seen, key=lambda name: (order.get(self.stored[name], len(order)), seen.index(name)))
        )
        self.bounds = frozenset(name for name in seen if self.stored[name] in about.bounds)
        place = {name: at for at, name in enumerate(self.methods)}
        self.entries = tuple(
            Entry(row, name, cause_of(row))
            for name, row in sorted(named, key=lambda pair: (place[pair[0]], pair[1].mission_id))
        )
        self.places = tuple(sorted({row.place for row in rows}))
        self.results = Results(
            {name: [entry.row for entry in mine] for name, mine in self._by_method.items()}, seed=about.seed
        )
        self.levels = self.results.levels
        self.cities = self.results.cities
        #: Where each mission took place.
        self.place_of = places_of(rows)

    def of(
        self, method: str, *, level: int | None = None, city: str | None = None, cause: Cause | None = None
    ) -> list[Entry]:
        """Return a method's missions, by id; None takes all."""
        return [
            entry
            for entry in self._by_method[method]
            if (level is None or entry.row.level == level)
            and (city is None or entry.row.city == city)
            and (cause is None or entry.cause is cause)
        ]

    def scores(self, method: str, *, level: int | None = None) -> list[MissionScore]:
        """Return a method's scores, by mission id."""
        return [entry.score for entry in self.of(method, level=level)]

    def table(self, method: str) -> MetricTable:
        """Return a method's figures over all levels."""
        table = self.results.table(method)
        if table is None:  # a method without a row is none
            raise AssertionError
        return table

    def metric(self, method: str, level: int | None, name: str) -> Metric | None:
        """Return a figure of a method at a level (None: all of them); None where it has no mission there."""
        table = self.results.table(method, level)
        return None if table is None else next((metric for metric in table.metrics if metric.name == name), None)

    def fellow(self, method: str, name: str) -> str | None:
        """Return the name of a method of the store with the vehicle of another one; None where it was not run."""
        vehicle = self.vehicle[method]
        return next((each for each in self.methods if (self.stored[each], self.vehicle[each]) == (name, vehicle)), None)

    @cached_property
    def differences(self) -> tuple[Difference, ...]:
        """Every further method against the first one of its vehicle; those without a common mission are left out."""
        found = []
        for method in self.methods:
            base = next(name for name in self.methods if self.vehicle[name] == self.vehicle[method])
            limits_s = {self.of(name)[0].score.time_limit_s for name in (method, base)}
            if method == base or len(limits_s) > 1:
                continue
            table = self.results.difference(method, base)
            if table is not None:
                found.append(Difference(method, base, table))
        return tuple(found)

    @property
    def interval_method(self) -> str:
        """How intervals were made, in words."""
        if len(self.places) < 2:
            return (
                f"Wilson’s score interval for shares, percentile bootstrap over missions ({RESAMPLES:,} resamples) for "
                "everything else; there is one place only, and its missions are taken for independent"
            )
        return (
            f"percentile bootstrap clustered by place ({RESAMPLES:,} resamples of the {len(self.places):,} places, "
            "each with all its missions); shares that never vary have Wilson’s score interval. With few places such "
            "intervals are too narrow: read p, and docs/metrics.md of the package"
        )

    def common(self, methods: Sequence[str]) -> set[str]:
        """Return the ids of the missions that all of some methods have."""
        ids = [{entry.row.mission_id for entry in self._by_method[name]} for name in methods]
        return set.intersection(*ids) if ids else set()

    @cached_property
    def causes(self) -> tuple[Cause, ...]:
        """The causes that occur, in their order."""
        occurring = {entry.cause for entry in self.entries}
        return tuple(cause for cause in Cause if cause in occurring)

    @cached_property
    def attributions(self) -> tuple[str, ...]:
        """Whom to thank: those that rows name and those that the report was given."""
        return tuple(sorted(({entry.row.attribution for entry in self.entries} | set(self.about.attributions)) - {""}))

    @cached_property
    def _by_method(self) -> dict[str, list[Entry]]:
        split: dict[str, list[Entry]] = {method: [] for method in self.methods}
        for entry in self.entries:
            split[entry.method].append(entry)
        return split


def _keyed(row: MissionRow) -> MissionRow:
    """Return the row with its own mission id in its score."""
    if row.score.mission_id == row.mission_id:
        return row
    return replace(row, score=replace(row.score, mission_id=row.mission_id))


def _faults(named: Sequence[tuple[str, MissionRow]]) -> list[Fault]:
    faults = []
    if not named:
        faults.append(Fault("there is no row", "at least one mission"))
    twice = [pair for pair, count in Counter((name, row.mission_id) for name, row in named).items() if count > 1]
    for name, mission_id in sorted(twice)[:10]:
        faults.append(Fault(f"mission {mission_id!r} of {name} stands twice", "each mission of a method once"))
    for name in dict.fromkeys(name for name, _ in named):
        limits = sorted({row.score.time_limit_s for other, row in named if other == name})
        if len(limits) > 1:
            faults.append(Fault(f"{name} has T_max of {limits} s", "one T_max a method", "make a report of each"))
    return faults
