"""What a table of the report is: cells with intervals and links for the page, plain records for the file."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from reasoned_explorer.evaluation.metrics import Metric
from reasoned_explorer.evaluation.wording import NONE, ends

#: A value of a file: text, a number in full, or nothing.
Value = str | int | float | None


@dataclass(frozen=True, slots=True)
class Cell:
    """One figure on the page.

    Attributes:
        text: The figure.
        interval: Its interval, e.g. ``"[.15, .39]"``; empty where it has none.
        href: Address of its missions inside the page; empty where none stand behind it.
        about: What the link leads to, for those who do not see the table.
    """

    text: str
    interval: str = ""
    href: str = ""
    about: str = ""


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a table.

    Attributes:
        name: Of the line.
        cells: Its figures.
        mark: The method whose colour it carries, or empty.
        label: What a reader must know of it, under its name; may be empty.
    """

    name: str
    cells: tuple[Cell, ...]
    mark: str = ""
    label: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """Lines that belong together, under a name of their own unless it is empty."""

    name: str
    lines: tuple[Line, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """One table.

    Attributes:
        key: Of its anchor and its file.
        caption: What it shows.
        columns: Heads; the first is of the line names.
        groups: The lines.
        spans: Heads above the heads: text and number of columns, the first column left out; empty where there are none.
        note: What must be known to read it.
        head: Heads of the file.
        records: Lines of the file.
        words: Whether its cells hold sentences more than figures.
    """

    key: str
    caption: str
    columns: tuple[str, ...]
    groups: tuple[Group, ...]
    spans: tuple[tuple[str, int], ...] = ()
    note: str = ""
    head: tuple[str, ...] = ()
    records: tuple[tuple[Value, ...], ...] = ()
    words: bool = False

    @property
    def starts(self) -> frozenset[int]:
        """The places of the columns at which a head above the heads begins."""
        return frozenset(1 + sum(count for _, count in self.spans[:place]) for place in range(len(self.spans)))


#: Heads of the files that list metrics.
METRIC_HEAD = ("metric", "value", "low", "high", "count", "interval")


def metric_cell(
    metric: Metric | None, write: Callable[[float], str], *, href: str = "", about: str = "", interval: bool = True
) -> Cell:
    """Return the cell of a figure; without a figure it is a dash that leads nowhere."""
    if metric is None or metric.count == 0:
        return Cell(NONE)
    return Cell(write(metric.value), ends(metric, write) if interval else "", href, about)


def metric_record(first: Sequence[Value], metric: Metric | None) -> list[tuple[Value, ...]]:
    """Return the line of a file for a figure, in full; none where there is no figure."""
    if metric is None or metric.count == 0:
        return []
    return [(*first, metric.name, metric.value, metric.low, metric.high, metric.count, metric.interval)]
