"""``rex show``."""

from pathlib import Path

from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.progress import Progress, header_lines, step_details, summary_lines
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.model import Fault, RecordError
from reasoned_explorer.model.stopping import stop_if_asked


def show_run(folder: Path, *, step: int | None = None) -> None:
    """Print a mission from its record, or one step of it in full.

    Raises:
        RecordError: If there is no such record or step.
    """
    record = read_record(folder)
    console = Output()

    def say(line: str) -> None:
        console.print(line, markup=False, soft_wrap=True)

    if step is not None:
        if not 0 <= step < len(record.steps):
            raise RecordError("--step", [Fault(f"no step {step}", f"0 to {len(record.steps) - 1}")])
        for line in step_details(record.steps[step]):
            say(line)
        return
    for line in header_lines(record.header):
        say(line)
    progress = Progress()
    for kept in record.steps:
        stop_if_asked()
        for line in progress.lines(kept):
            say(line)
    for line in summary_lines(record):
        say(line)
