"""The rows of a run: what they say, and that they say what the run's own tables say."""

import json
import math
from pathlib import Path

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.report.causes import cause_of
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.listing import CODED, COLUMNS, Listing, opaque_id
from tests.viewer.small_runs import MISSIONS


def _cells(listing: Listing) -> list[dict[str, object]]:
    return [
        {
            name: listing.words[cell] if name in CODED and cell is not None else cell
            for name, cell in zip(COLUMNS, row, strict=True)
        }
        for row in listing.rows
    ]


def test_rows_say_what_the_runs_own_rows_say(bench: Path) -> None:
    (run,) = Library(bench).runs()
    shown = _cells(run.listing())
    with RunStore.read(bench) as store:
        rows = list(store.rows())
    assert len(shown) == len(rows) == MISSIONS
    for cells, row in zip(shown, rows, strict=True):
        assert cells["method"] == row.method
        assert cells["mission_id"] == row.mission_id
        assert (cells["level"], cells["goal"], cells["place"]) == (row.level, row.goal, row.place)
        assert cells["cause"] == cause_of(row).value
        assert cells["outcome"] == ("success" if row.score.success else "failure")
        assert cells["end"] == row.end
        assert cells["seed"] == str(row.seed)
        assert cells["casr"] == round(row.score.casr, 4)
        assert cells["tt_s"] == round(row.score.travelling_s, 1)
        assert cells["steps"] == row.steps
        assert cells["has_record"] == 1
        assert cells["fault"] is None


def test_it_is_small_and_plain_json(bench: Path) -> None:
    (run,) = Library(bench).runs()
    read = json.loads(run.listing_json())
    assert read["columns"] == list(COLUMNS)
    assert read["coded"] == list(CODED)
    assert len(read["words"]) == len(set(read["words"]))
    assert len({row[0] for row in read["rows"]}) == MISSIONS


def test_seeds_larger_than_a_script_can_count_stay_whole() -> None:
    listing = Listing.of([{"id": "a", "seed": 17269052386175380023}])
    assert "17269052386175380023" in listing.as_json({}).decode()
    assert listing.rows[0][COLUMNS.index("seed")] == 0


def test_what_is_missing_or_endless_is_null() -> None:
    (row,) = Listing.of([{"id": "a", "spl": math.nan, "ct_s": math.inf}]).rows
    assert set(row[1:]) == {None}


def test_ids_of_different_things_differ() -> None:
    assert opaque_id("a", "bc") != opaque_id("ab", "c")
    assert opaque_id("a", "b") == opaque_id("a", "b")
