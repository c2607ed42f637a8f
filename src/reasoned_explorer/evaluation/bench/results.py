"""The rows of a run by method, and the figures of them that every table shows, on the screen and on a page."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.evaluation.methods import BOUND_METHODS, PERFECT_HALT, method
from reasoned_explorer.evaluation.metrics import Metric, MetricTable, aggregate, compare, headroom_closed
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.statistics import holm
from reasoned_explorer.model import InputError

#: Figures of which paired differences are shown.
DIFFERENCES = ("SR", "OSR", "SPL", "CASR", "CASR per mission")
#: Figures of which the share of headroom that is closed is shown: from the baseline to the bound.
HEADROOM = ("SR", "SPL", "CASR", "CASR per mission")
#: What the labels of minds that read the truth end with, and of planners that ask no mind but the checker.
_A_BOUND, _NO_MODEL = "bound)", "[no model]"
BASELINE, BOUND = "follow-paths", "foresight-60m"


@dataclass(frozen=True)
class Results:
    """The rows of one vehicle in a run, by method; of several, where methods have names of their own for each.

    Attributes:
        rows: Each method's rows, in the order of the table.
        seed: Of the intervals' resampling.
    """

    rows: Mapping[str, Sequence[MissionRow]]
    seed: int = 0
    _tables: dict[tuple[str, int | None, str | None], MetricTable | None] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @classmethod
    def of(cls, rows: Iterable[MissionRow], methods: Sequence[str]) -> "Results":
        """Return the results of rows; methods without a row are left out."""
        by_method: dict[str, list[MissionRow]] = {name: [] for name in methods}
        for row in rows:
            by_method.setdefault(row.method, []).append(row)
        return cls({name: tuple(mine) for name, mine in by_method.items() if mine})

    def of_missions(self, missions: Collection[str]) -> "Results":
        """Return the results of some missions, by their ids; methods without a row of them are left out."""
        kept = {name: tuple(row for row in mine if row.mission_id in missions) for name, mine in self.rows.items()}
        return Results({name: mine for name, mine in kept.items() if mine}, self.seed)

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods, in order."""
        return tuple(self.rows)

    @property
    def cities(self) -> tuple[str, ...]:
        """The cities that there are rows of, sorted."""
        return tuple(sorted({row.city for mine in self.rows.values() for row in mine}))

    @property
    def levels(self) -> tuple[int, ...]:
        """The levels that there are rows of, sorted."""
        return tuple(sorted({row.level for mine in self.rows.values() for row in mine}))

    def of_level(self, method: str, level: int | None = None) -> list[MissionRow]:
        """Return a method's rows of a level; None is all levels."""
        return [row for row in self.rows[method] if level in {None, row.level}]

    def table(self, method: str, level: int | None = None, city: str | None = None) -> MetricTable | None:
        """Return a method's figures at a level (None for all) in a city (None for all); None without missions."""
        key = (method, level, city)
        if key not in self._tables:
            mine = [row for row in self.of_level(method, level) if city in {None, row.city}]
            made = aggregate([row.score for row in mine], places=places_of(mine), seed=self.seed) if mine else None
            self._tables[key] = made
        return self._tables[key]

    def difference(
        self, method: str, other: str, *, level: int | None = None, theirs: "Results | None" = None
    ) -> MetricTable | None:
        """Return by how much a method is better than another on the missions that both have; None where none is.

        Args:
            method: Of these results.
            other: Of the other results.
            level: OUTDOOR's level, or None for all.
            theirs: The other results; these by default.
        """
        mine, its = _common(self.of_level(method, level), (theirs or self).of_level(other, level))
        if not mine:
            return None
        scores = [[row.score for row in rows] for rows in (mine, its)]
        return compare(*scores, places=places_of(mine), seed=self.seed)

    def headroom(self, method: str, name: str, *, baseline: str = BASELINE, bound: str = BOUND) -> Metric | None:
        """Return which share of the way from a baseline to a bound a method has come, on the missions that all have.

        Args:
            method: Whose.
            name: Of the figure, one of `HEADROOM`.
            baseline: Another method.
            bound: Another method.

        Returns:
            None where there is no headroom, or one of the three has no mission that the others have.
        """
        if not {method, baseline, bound} <= set(self.rows):
            return None
        sets = _common(*(self.rows[each] for each in (method, baseline, bound)))
        if not sets[0]:
            return None
        scores = [[row.score for row in rows] for rows in sets]
        return headroom_closed(*scores, name=name, places=places_of(sets[0]), seed=self.seed)


def _common(*sets: Sequence[MissionRow]) -> list[list[MissionRow]]:
    """Return of each set the rows of the missions that all sets have, in the same order."""
    by_id = [{row.mission_id: row for row in rows} for rows in sets]
    ids = sorted(set.intersection(*(set(rows) for rows in by_id)))
    return [[rows[name] for name in ids] for rows in by_id]


def places_of(rows: Iterable[MissionRow]) -> dict[str, str]:
    """Return where each mission took place, by its id."""
    return {row.mission_id: row.place for row in rows}


def corrected(tables: Mapping[str, MetricTable], name: str) -> dict[str, float]:
    """Return p of a figure's difference in each table, corrected for the number of tables (Holm)."""
    return holm({key: p_of(table, name) for key, table in tables.items()})


def p_of(table: MetricTable, name: str) -> float:
    """Return p of a figure's difference, not corrected."""
    p = table[name].p
    return 1.0 if p is None else p


def reads_the_truth(row: MissionRow) -> bool:
    """Return whether a mission was one of a bound: its method is one, or a mind that it asks knows the world.

    A method that is not installed any more is taken for an honest one.
    """
    with suppress(InputError):
        if method(row.method).is_bound:
            return True
    # Of minds, who asks no model has the checker only.
    asked = row.minds.rpartition("checker: ")[2] if _NO_MODEL in row.planner else row.minds
    return _A_BOUND in asked


def label_of(rows: Sequence[MissionRow]) -> str:
    """Return what a method is called in a table: its name, whose minds, and how its thinking time came about."""
    what = what_of(rows)
    return f"{rows[0].method} [{what[0]}]{what[1]}" if what[0] else f"{rows[0].method}{what[1]}"


def what_of(rows: Sequence[MissionRow]) -> tuple[str, str]:
    """Return of a method whose minds it has, or that it is a bound, and how its thinking time came about."""
    # A mission that could not be run knows nothing of the kind.
    row = next((row for row in rows if row.ct_label), rows[0])
    _, _, minds = row.planner.partition("[")
    notes = [minds.rstrip("]")] if minds and row.method not in BOUND_METHODS else []
    checker = row.minds.rpartition("checker: ")[2]
    if notes and _NO_MODEL in row.planner and is_model_name(checker):
        notes.append(f"{checker} checks")
    if row.method in BOUND_METHODS:
        notes.append("a bound: knows the world")
    elif row.method.endswith(f"+{PERFECT_HALT}"):
        notes.append("the judge halts, a bound")
    elif reads_the_truth(row) and _A_BOUND not in minds:
        notes.append("a mind knows the world, a bound")
    return "; ".join(notes), f", CT {row.ct_label}" if row.ct_label else ""
