"""Runs to be rated, and desks that give them to raters."""

import shutil
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from reasoned_explorer.evaluation.bench.store import TRACES_NAME, RunStore
from reasoned_explorer.evaluation.ratings import Rating, RatingStore, latest, ratings_of
from reasoned_explorer.evaluation.record_file import parse_record, record_bytes
from reasoned_explorer.viewer.rating_desk import Choice, RatingDesk
from reasoned_explorer.viewer.rating_routes import create_rating_app
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.page_runs import MARKUP, full_of_markup

NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


class TestClock:
    """A clock of the tests, no real one: each look at it is a second later."""

    __test__ = False

    def __init__(self) -> None:
        self.looks = 0

    def __call__(self) -> datetime:
        self.looks += 1
        return NOON + timedelta(seconds=self.looks)


def copied(bench: Path, folder: Path, *, markup: bool = False, elsewhere: bool = False) -> Path:
    """Return a copy of a run.

    Args:
        bench: The run.
        folder: Of the copy.
        markup: Have its records hold markup wherever somebody could have put text.
        elsewhere: Have its missions taken place in worlds that nobody has any more.
    """
    run = Path(shutil.copytree(bench, folder))
    for path in (run / TRACES_NAME).rglob("*.z") if markup or elsewhere else ():
        record = parse_record(zlib.decompress(path.read_bytes()), path)
        if markup:
            record = full_of_markup(record)
            assert record.header.goal == MARKUP
        if elsewhere:
            record = replace(record, header=replace(record.header, world_digest="0" * 64))
        path.write_bytes(zlib.compress(record_bytes(record)))
    return run


@contextmanager
def rating(
    run: Path, *, guard: Guard | None = None, rater: str | None = None, seed: int = 0, choice: Choice | None = None
) -> Iterator[Server]:
    """Have a run rated on a free port until the block ends."""
    guard = guard or Guard(csrf="the secret")
    with RatingStore(run) as store:
        desk = RatingDesk(store, now=TestClock(), secret=b"k" * 32, seed=seed, choice=choice)
        with Server(guard.protects(create_rating_app(desk, guard=guard, rater=rater))) as server:
            yield server


def said_in(run: Path) -> list[Rating]:
    """Return every rating that the run holds."""
    with RunStore.read(run) as store:
        return list(ratings_of(store))


def counting_in(run: Path) -> list[Rating]:
    """Return the ratings that count."""
    return list(latest(said_in(run)))


def without_records(run: Path, method: str) -> None:
    """Take the records of a method away."""
    with RunStore.read(run) as store:
        for vehicle, name, mission_id in store.finished():
            if name == method:
                store.trace_path(vehicle, name, mission_id).unlink()


def declared(run: Path) -> set[tuple[str, str, str]]:
    with RunStore.read(run) as store:
        return {(row.score.vehicle, row.method, row.mission_id) for row in store.rows() if row.declared}
