"""What has to be said under a table of results, whoever reads it and wherever it stands."""

from collections.abc import Iterable
from dataclasses import dataclass

from reasoned_explorer.evaluation.bench.results import reads_the_truth
from reasoned_explorer.evaluation.mission_settings import THROUGH_PIXELS
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model.record import MissionEnd

_EMBEDDED = "embedded minds"
_SIMULATED, _WITHOUT_ERROR = "simulated captioner", "perfect"


@dataclass(frozen=True, slots=True)
class Notes:
    """What has to be said of a run.

    Attributes:
        always: Under every table of it.
        once: Wherever it is first shown.
        thanks: Whom to thank for data.
    """

    always: tuple[str, ...]
    once: tuple[str, ...]
    thanks: tuple[str, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """All of them."""
        return (*self.always, *self.once, *self.thanks)


def notes_of(rows: Iterable[MissionRow], *, total: int) -> Notes:
    """Return what has to be said of a run, or of one vehicle in it.

    Args:
        rows: The missions that are finished.
        total: Missions that there are to be.
    """
    rows = list(rows)
    always, once = [], []
    if len(rows) < total:
        always.append(f"Not finished: {len(rows):,} of {total:,} missions.")
    if any(_EMBEDDED in row.minds for row in rows):
        always.append(
            "Embedded minds are no language model. They do not agree with GPT-4’s scores: rank correlation −.22 to "
            "+.21 on the 72 scores in the log of the paper’s authors."
        )
    failed = sum(row.end == MissionEnd.FAULT.value for row in rows)
    if failed:
        once.append(
            f"{failed:,} {'mission' if failed == 1 else 'missions'} ended with a fault of a part: failures, too."
        )
    captioners = sorted({row.captioner for row in rows if _SIMULATED in row.captioner})
    if captioners:
        # A mission that could not be run knows its captioner by name alone.
        plain = [name.removesuffix(THROUGH_PIXELS) for name in captioners]
        names = sorted({name.removeprefix(_SIMULATED).strip(" ()") for name in plain})
        wrong = [f"“{name}”" for name in names if name != _WITHOUT_ERROR]
        rates = f"the error rates of {' and '.join(wrong)} are assumed" if wrong else "without error"
        once.append(f"Captions are a simulated captioner’s{';' if wrong else ','} {rates}.")
        if plain != captioners:
            once.append("It sees through pixels: what has pixels in a picture of the view is visible.")
    if any(row.ct_label.startswith("modelled") for row in rows):
        once.append("CT is modelled: each call is charged what a latency profile says, not what it took.")
    unpriced = sum(row.unpriced for row in rows)
    if unpriced:
        once.append(f"What {unpriced:,} calls cost is not known (no price, or no answer): USD are the least it can be.")
    if bounds_among(rows):
        once.append("oracle, foresight and perfect-halt read the truth: bounds, no methods.")
    once.append(_about_intervals(len({row.place for row in rows})))
    return Notes(tuple(always), tuple(once), tuple(sorted({row.attribution for row in rows} - {""})))


def _about_intervals(places: int) -> str:
    if places < 2:
        return (
            "Intervals are 95 %, of one place: missions are resampled, shares have Wilson’s. They say nothing of other "
            "places."
        )
    return (
        f"Intervals are 95 %, resampled by place ({places} places; by mission, and Wilson’s for shares, where a line "
        "has one place only); a share that never varies has Wilson’s."
    )


def bounds_among(rows: Iterable[MissionRow]) -> tuple[str, ...]:
    """Return the methods of rows that read the truth, by their own names or by the minds that they were given."""
    return tuple(sorted({row.method for row in rows if reads_the_truth(row)}))
