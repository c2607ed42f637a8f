"""The report of a run that `rex bench` made: what its store says of it, and its missions' records and worlds."""

from functools import lru_cache
from pathlib import Path

from reasoned_explorer.evaluation.bench.notes import bounds_among, notes_of
from reasoned_explorer.evaluation.bench.store import NOTHING_FINISHED, RunStore
from reasoned_explorer.evaluation.ratings import ratings_of
from reasoned_explorer.evaluation.report.about import ReportAbout
from reasoned_explorer.evaluation.report.writing import write_report
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.wording import share
from reasoned_explorer.model import InputError
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.task.splitting import ceiling_casr, open_place
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.world import World


class RunTraces:
    """The records of a run's missions, and the worlds that these took place in: a `TraceSource`.

    Args:
        store: Of the run; it stays open as long as records are asked for.
    """

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._split = store.plan.split
        # A report shows a few missions; those of one level are often of one place.
        self._world_of = lru_cache(maxsize=4)(self._open)

    def record(self, row: MissionRow) -> EpisodeRecord | None:
        """Return the record of a row's mission; None where it was not kept.

        Raises:
            RecordError: If what is there is no record.
        """
        return self._store.record(row)

    def world(self, row: MissionRow) -> World | None:
        """Return the world of a row's mission; None where its file is gone or holds another world by now."""
        return self._world_of(row.place)

    def _open(self, place: str) -> World | None:
        try:
            atlas = open_place(self._split.place(place))
        except InputError:
            return None
        return atlas.world if atlas.digest == self._split.world_digests.get(place) else None


def about_run(store: RunStore, rows: list[MissionRow]) -> ReportAbout:
    """Return what the report of a run has to say beside its rows.

    Args:
        store: Of the run.
        rows: All that are finished.
    """
    plan, about = store.plan, store.about
    split, notes = plan.split, notes_of(rows, total=plan.count)
    speeds_mps = {name: vehicle_profile(name).speed_mps for name in plan.vehicles}
    names = sorted({row.method for row in rows})
    return ReportAbout(
        title=f"{len(names)} planners on split {split.name}, {' and '.join(plan.vehicles)}",
        split=split.name,
        split_version=f"{split.version}",
        split_hash=split.digest[:12],
        command=str(about.get("command", "")),
        version=str(about.get("versions", {}).get("reasoned-explorer", "")),
        attributions=(*split.attributions, *notes.thanks),
        minds=notes.once,
        honesty=notes.always,
        posed=tuple(split.lines()),
        ceilings=tuple(
            (f"CASR of who knows the way, {name}", share(ceiling_casr(split, speed_mps=speed_mps)))
            for name, speed_mps in speeds_mps.items()
        ),
        methods=plan.methods,
        bounds=bounds_among(rows),
    )


def report_run(store: RunStore, folder: Path) -> Path:
    """Write the report of a run, finished or not, into a folder and return the path of its page.

    Raises:
        InputError: If no mission of the run is finished, or as `write_report`.
        RecordWriteError: If the disk is full.
    """
    rows = list(store.rows())
    if not rows:
        raise InputError("run", [NOTHING_FINISHED])
    traces = RunTraces(store) if store.plan.keep_traces else None
    return write_report(rows, about_run(store, rows), folder, traces=traces, ratings=ratings_of(store))
