"""What has to be said under a table of results, whoever reads it and wherever it stands."""

from collections.abc import Iterable
from dataclasses import dataclass

from reasoned_explorer.evaluation.methods import method
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import InputError
from reasoned_explorer.model.record import MissionEnd

_EMBEDDED = "embedded minds"


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
    if any("simulated" in row.captioner for row in rows):
        once.append("Captions are a simulated captioner’s; the error rates of “noisy” are assumed.")
    if any(row.ct_label.startswith("modelled") for row in rows):
        once.append("CT is modelled: each call is charged what a latency profile says, not what it took.")
    if any(is_bound(name) for name in {row.method for row in rows}):
        once.append("oracle, foresight and perfect-halt read the truth: bounds, no methods.")
    once.append(
        "Intervals are 95 %, resampled by place where there are several; a share that never varies has Wilson’s."
    )
    return Notes(tuple(always), tuple(once), tuple(sorted({row.attribution for row in rows} - {""})))


def is_bound(name: str) -> bool:
    """Return whether a method reads the truth; one that is not installed any more is taken for an honest one."""
    try:
        return method(name).is_bound
    except InputError:
        return False
