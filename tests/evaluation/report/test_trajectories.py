"""Two methods side by side on the same mission: which mission is shown, and what is seen of it."""

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.report import write_report
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.trajectories import Picture, pair_of, pictures, ranked_missions
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.world import World
from tests.evaluation.report.rows import ABOUT, made_row, many_rows

PAIR = ("llm-as-eval", "llm-rrt")


class Kept:
    """Two records of the same mission in a small park, given for one mission of level 1."""

    def __init__(self) -> None:
        self._world = open_world("park:7@200")
        self._records: dict[str, EpisodeRecord] = {}
        self.asked: list[str] = []
        atlas = Atlas(self._world)
        for method in PAIR:
            settings = MissionSettings(planner=method, captioner="perfect", seed=5)
            self._records[method] = Mission("Find me a bench", atlas, settings).run().record

    def record(self, row: MissionRow) -> EpisodeRecord | None:
        self.asked.append(row.mission_id)
        return self._records[row.method] if row.mission_id == "park:3|0000" else None

    def world(self, row: MissionRow) -> World | None:
        return self._world


@pytest.fixture(scope="module")
def kept() -> Kept:
    return Kept()


@pytest.fixture(scope="module")
def drawn(kept: Kept) -> Picture:
    found: Iterator[Picture] = pictures(Study([made_row(method, 0) for method in PAIR], ABOUT), kept)
    return next(found)


def test_llm_as_eval_stands_left_of_llm_rrt_as_in_the_paper() -> None:
    assert pair_of(Study(many_rows(4), ABOUT)) == PAIR
    assert pair_of(Study(many_rows(4, ("a", "b", "c")), replace(ABOUT, methods=()))) == ("a", "b")
    wanted = replace(ABOUT, side_by_side=("oracle", "llm-rrt"))
    assert pair_of(Study(many_rows(4), wanted)) == ("oracle", "llm-rrt")
    assert pair_of(Study(many_rows(4, ("a", "b")), wanted)) is None
    assert pair_of(Study([made_row()], ABOUT)) is None


def test_missions_in_which_the_two_differ_most_come_first() -> None:
    rows = [made_row(method, number) for method in PAIR for number in (0, 4, 8, 12)]
    rows[2] = made_row(PAIR[0], 8, in_place=False)  # found by one only
    rows[5] = made_row(PAIR[1], 4, ct_s=600.0)  # found by both, later by one
    ranked = ranked_missions(Study(rows, ABOUT), PAIR, 1)
    assert [first.row.seed for first, _ in ranked] == [8, 4, 0, 12]
    assert all((first.method, second.method) == PAIR for first, second in ranked)


def test_the_next_mission_is_taken_where_records_are_missing(kept: Kept) -> None:
    rows = [
        made_row(method, number, ct_s=300.0 if method == PAIR[0] else 300.0 + number)
        for method in PAIR
        for number in (0, 4)
    ]
    kept.asked.clear()
    (picture,) = pictures(Study(rows, ABOUT), kept)
    assert kept.asked[0] == "uvic/0|0004", "it differs more, but was not kept"
    assert picture.entries[0].row.mission_id == "park:3|0000"


def test_the_picture_says_what_it_shows(drawn: Picture) -> None:
    assert "Find me a bench" in drawn.caption
    assert "llm-as-eval: found rightly" in drawn.alt
    with Image.open(BytesIO(drawn.png)) as whole, Image.open(BytesIO(drawn.webp)) as small:
        assert whole.width == 2000
        assert small.width == 1600
        left, right = small.crop((60, 200, 780, 900)), small.crop((820, 200, 1540, 900))
        assert left.tobytes() != right.tobytes(), "two ways, not one drawn twice"
    assert len(drawn.webp) < 600_000


def test_the_page_shows_it_and_leads_to_both_missions(kept: Kept, tmp_path: Path) -> None:
    rows = [made_row(method, 0) for method in PAIR]
    first = write_report(rows, ABOUT, tmp_path / "first", traces=kept).read_bytes()
    assert first == write_report(rows, ABOUT, tmp_path / "second", traces=kept).read_bytes()
    assert b'src="data:image/webp;base64,' in first
    assert b"#method=llm-as-eval&amp;mission=park%3A3%7C0000" in first
    assert (tmp_path / "first" / "figures" / "trajectories-level-1.png").is_file()


def test_without_records_the_page_says_so(kept: Kept, tmp_path: Path) -> None:
    rows = [made_row(method, 1) for method in PAIR]
    page = write_report(rows, ABOUT, tmp_path / "report", traces=kept).read_text(encoding="utf-8")
    assert "No mission has the records of both methods and its world." in page
