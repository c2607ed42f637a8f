"""Writes a report into a folder: all of it or nothing."""

import csv
import os
import shutil
import tempfile
from collections.abc import Sequence
from io import StringIO
from pathlib import Path

from reasoned_explorer.evaluation.human_success import Judged
from reasoned_explorer.evaluation.ratings import Rating
from reasoned_explorer.evaluation.report.about import ReportAbout, TraceSource
from reasoned_explorer.evaluation.report.charts import Chart, png_bytes
from reasoned_explorer.evaluation.report.contents import sections_of
from reasoned_explorer.evaluation.report.looks import looks_of
from reasoned_explorer.evaluation.report.missions import missions_head, missions_records
from reasoned_explorer.evaluation.report.page import Section, page_html
from reasoned_explorer.evaluation.report.results import paper_tables
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.tables import Table, Value
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import Fault, RecordError
from reasoned_explorer.model.disk import disk_error

PAGE_NAME = "index.html"


def write_report(
    rows: Sequence[MissionRow],
    about: ReportAbout,
    folder: Path,
    *,
    traces: TraceSource | None = None,
    ratings: Sequence[Rating] = (),
) -> Path:
    """Write the report of a run and return the path of its page.

    In the folder lie ``index.html``, which needs nothing else, and beside it ``figures/*.png``, ``tables/*.csv`` and
    ``missions.csv``. The same rows and the same ``about`` give the same bytes (with the same version of matplotlib and
    Pillow); so does any order of the rows, where ``about.methods`` names all methods.

    Args:
        rows: Of the run, at least one. Methods need not have the same missions: differences are taken over those that
            both have.
        about: What the run is, in words.
        folder: Made, or replaced as a whole, once everything is written. A folder that holds something else than a
            report is left alone.
        traces: Gives records for the trajectories; None leaves them out, and the page says so.
        ratings: What people say of the missions, in the order in which they said it; a section shows it where there is
            anything.

    Raises:
        InputError: If the rows cannot be a report: none, a mission twice, two T_max in one method, an unknown end.
        RecordError: If the folder is none of a report or cannot be written; what was there stays.
        PartError: If the disk fails, e.g. because it is full; likewise.
    """
    study = Study(rows, about)
    _check_target(folder)
    looks = looks_of(study.methods, study.bounds)
    judged = Judged.of((entry.row for entry in study.entries), ratings) if ratings else None
    sections = sections_of(study, looks, traces, judged)
    paper = paper_tables()
    contents: dict[str, bytes] = {PAGE_NAME: page_html(study, looks, sections, paper).encode()}
    charts: dict[str, Chart] = {chart.key: chart for section in sections for chart in section.charts}
    contents |= {f"figures/{key}.png": png_bytes(chart) for key, chart in charts.items()}
    contents |= {f"figures/{picture.key}.png": picture.png for section in sections for picture in section.pictures}
    contents |= {f"tables/{table.key}.csv": _csv(table.head, table.records) for table in (*_tables(sections), *paper)}
    contents["missions.csv"] = _csv(missions_head(study), missions_records(study))
    try:
        _replace_folder(folder, contents)
    except OSError as error:
        raise disk_error("report", folder, error, kind=RecordError) from error
    return folder / PAGE_NAME


def _tables(sections: Sequence[Section]) -> list[Table]:
    return [table for section in sections for table in (*section.tables, *section.folded)]


def _csv(head: Sequence[str], records: Sequence[Sequence[Value]]) -> bytes:
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(records)
    return text.getvalue().encode()


def _check_target(folder: Path) -> None:
    """Refuse to replace what is no report.

    Raises:
        RecordError: If the folder is a file, holds something and no page of ours, or cannot be made.
    """
    if folder.is_dir() and (not any(folder.iterdir()) or _is_ours(folder / PAGE_NAME)):
        return
    if folder.exists() or folder.is_symlink():
        fault = Fault(f"{folder} is there and is no report", "a new folder, or one with a report", "name another")
        raise RecordError("report", [fault])
    above = next(parent for parent in folder.absolute().parents if parent.exists())
    if not (above.is_dir() and os.access(above, os.W_OK | os.X_OK)):
        raise RecordError("report", [Fault(f"{folder} cannot be made in {above}", "a folder that may be written to")])


def _is_ours(page: Path) -> bool:
    """Return whether a page says that it was made here: somebody's web site is not replaced."""
    if not page.is_file():
        return False
    with page.open("rb") as file:
        return b'<meta name="generator" content="reasoned-explorer' in file.read(4096)


def _replace_folder(folder: Path, contents: dict[str, bytes]) -> None:
    """Put the files into a folder beside the target and swap the two."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", suffix=".part", dir=folder.parent))
    old = made.with_suffix(".old")
    try:
        made.chmod(0o755)
        for name, data in contents.items():
            path = made / name
            path.parent.mkdir(exist_ok=True)
            with path.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
        if folder.exists():
            folder.rename(old)
        try:
            made.rename(folder)
        except OSError:
            if old.exists():
                old.rename(folder)
            raise
    except BaseException:
        shutil.rmtree(made, ignore_errors=True)
        raise
    shutil.rmtree(old, ignore_errors=True)
