"""``rex report``."""

from pathlib import Path

from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.human_success import Judged, people_sheet
from reasoned_explorer.evaluation.ratings import ratings_of
from reasoned_explorer.evaluation.report.of_run import report_run

REPORT_NAME = "report"


def write_run_report(run: Path, out: Path | None) -> None:
    """Write the report of a run into a folder, by default inside the run's own."""
    with RunStore.read(run) as store:
        page = report_run(store, out or run / REPORT_NAME)
        judged = Judged.of(store.rows(), ratings_of(store))
        if judged.missions:
            print_sheet(Output(), people_sheet(judged, store.plan.methods))
    Output().print(f"report in {page}", markup=False, soft_wrap=True)
