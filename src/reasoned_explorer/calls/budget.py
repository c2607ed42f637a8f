"""How much a run may cost, in money and in time. When it is spent no new call begins; what is under way ends."""

import math
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from reasoned_explorer.model.checks import is_within, path_of
from reasoned_explorer.model.disk import disk_error, in_words
from reasoned_explorer.model.errors import Fault, RecordWriteError, SettingsError


def faults_of_budget(usd: object, minutes: object, unpriced: Iterable[str] = ()) -> list[Fault]:
    """Return what is wrong with a budget before anything is spent.

    Args:
        usd: US dollars, or None for no limit.
        minutes: Of real time, or None for no limit.
        unpriced: Models that are to be asked and whose price is not known.
    """
    faults = [
        Fault(f"the budget is {value!r:.60} {unit}", "a finite number above 0", "leave it out for no limit")
        for value, unit in ((usd, "US dollars"), (minutes, "minutes"))
        if value is not None and not (is_within(value, 0.0) and value != 0)
    ]
    if usd is not None:
        remedy = "add its price to a price table, or limit the run with --budget-minutes instead of --budget-usd"
        faults += [
            Fault(f"the price of {name} is not known", "known prices for a budget in money", remedy)
            for name in unpriced
        ]
    return faults


class Budget:
    """What all calls of a run share.

    A call begins only where what is spent, and what the calls under way will cost if each is as dear as the dearest so
    far, leave something. A call that was cancelled or failed before its cost was known counts as the dearest, too: the
    server may well have done the work.

    Args:
        usd: US dollars, or None for no limit.
        minutes: Of real time from the making of this on, or None for no limit.
        path: Of a file in which several processes of this machine add up what they spend; what it holds counts as spent
            already. None for this process alone.
        sharers: How many processes share that file: each takes it that the others have as much under way as it has.
        since_s: When the minutes began, as ``now_s`` tells it; None for now.
        now_s: Real time, seconds; the same for all processes of a machine.

    Attributes:
        denied: Why the first call that might not begin might not, or None: the run is to be ended, and gone on with
            under another budget.

    Raises:
        SettingsError: If a limit is no number above 0, or the file cannot be written.
    """

    def __init__(
        self,
        *,
        usd: float | None = None,
        minutes: float | None = None,
        path: Path | str | None = None,
        sharers: int = 1,
        since_s: float | None = None,
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        faults = faults_of_budget(usd, minutes)
        if faults:
            raise SettingsError("budget", faults)
        self.usd, self.minutes = usd, minutes
        self.denied: str | None = None
        self._now_s = now_s
        self._sharers = sharers
        began_s = now_s() if since_s is None else since_s
        self._ends_s = math.inf if minutes is None else began_s + 60.0 * minutes
        self._out, self._dearest_usd = 0, 0.0
        self._unpriced: str | None = None
        self._sum = _Sum() if path is None else _SharedSum(path_of(path, "budget", SettingsError))

    @property
    def spent_usd(self) -> float:
        """What is spent so far, US dollars; calls of unknown cost as dear as the dearest."""
        return self._sum.total()

    def begin(self, most_usd: float = 0.0) -> str | None:
        """Let a call begin, which must `end`; or return why it may not.

        Args:
            most_usd: What it may well cost, US dollars: the first calls of a run have none before them to go by.
        """
        self._dearest_usd = max(self._dearest_usd, most_usd)
        reason = self._reason()
        if reason is None:
            self._out += 1
        elif self.denied is None:
            self.denied = reason
        return reason

    def end(self, usd: float | None, *, model: str = "", answered: bool = True) -> None:
        """Count a call that has ended.

        Args:
            usd: What it cost, US dollars, or None where that is not known.
            model: Who was asked.
            answered: Whether there was an answer. If not, its cost is guessed where it is not known. What an answer
                cost must be known; where it is not, and there is a limit in money, no further call begins.
        """
        self._out -= 1
        if usd is not None:
            self._dearest_usd = max(self._dearest_usd, usd)
            self._sum.add(usd)
        elif not answered:
            self._sum.add(self._dearest_usd)
        elif self.usd is not None:
            self._unpriced = self._unpriced or f"{model or 'a model'} did not say what its call cost"

    def _reason(self) -> str | None:
        if self._now_s() >= self._ends_s:
            return f"the budget of {self.minutes:g} minutes is spent"
        if self.usd is None:
            return None
        if self._unpriced is not None:
            return f"the budget of {self.usd:g} US dollars cannot be kept: {self._unpriced}"
        spent_usd = self.spent_usd
        out = self._out * self._sharers
        if spent_usd < self.usd and spent_usd + (out + 1) * self._dearest_usd <= self.usd:
            return None
        under_way = f", {out} calls under way" if out else ""
        if spent_usd < self.usd and not out:
            under_way = f", a call may cost {self._dearest_usd:.4f}"
        return f"the budget of {self.usd:g} US dollars is spent ({spent_usd:.4f}{under_way})"


class _Sum:
    def __init__(self) -> None:
        self._total = 0.0

    def add(self, usd: float) -> None:
        self._total += usd

    def total(self) -> float:
        return self._total


class _SharedSum(_Sum):
    """A file to which each process appends a line a call: one short write each, so that no lock is needed."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path, self._read_bytes = path, 0
        try:
            with path.open("ab"):
                pass
        except OSError as error:
            raise disk_error("budget", path, error, kind=SettingsError) from error

    def add(self, usd: float) -> None:
        if usd == 0.0:
            return
        try:
            with self._path.open("ab", buffering=0) as file:
                file.write(b"%r\n" % usd)
        except OSError as error:
            raise RecordWriteError(f"budget: {in_words(self._path, error)}") from error

    def total(self) -> float:
        with self._path.open("rb") as file:
            file.seek(self._read_bytes)
            new = file.read()
        whole = new[: new.rfind(b"\n") + 1]
        self._read_bytes += len(whole)
        self._total += math.fsum(map(float, whole.split()))
        return self._total
