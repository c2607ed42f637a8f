"""The report on disk: one page that needs nothing, files beside it, all or nothing, the same bytes twice."""

import csv
import json
import random
import re
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.report import write_report, writing
from reasoned_explorer.evaluation.report.missions import missions_json
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import InputError, PartError, RecordError
from tests.evaluation.report.rows import ABOUT, METHODS, made_row, many_rows

EVIL = "<script>alert(1)</script>\"'&</style></table><!-- \u2028 {{ about.title }}"


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(many_rows(), ABOUT, tmp_path_factory.mktemp("run") / "report")


def test_page_figures_tables_and_missions_are_there(report: Path) -> None:
    names = set(contents(report.parent))
    assert {"index.html", "missions.csv", "figures/sr-osr.png", "figures/causes.png"} <= names
    assert {f"tables/{name}.csv" for name in ("main", "levels", "differences", "causes", "paper-i")} <= names
    page = report.read_text(encoding="utf-8")
    assert "No language model took part." in page
    assert "another simulator (AirSim" in page
    assert "rex bench --split mini" in page
    assert "kept no records" in page, "without traces the page says so"


def test_the_page_asks_for_nothing_from_outside(report: Path) -> None:
    page = report.read_text(encoding="utf-8")
    # Addresses of XML namespaces are names, nothing is fetched from them.
    plain = re.sub(r' xmlns(:\w+)?="[^"]*"', "", page)
    assert not re.search(r"https?://|//[a-z]+\.|@import|url\((?!#)|<link\b|<iframe|fetch\(|XMLHttp", plain)
    assert set(re.findall(r'\bsrc="([^"]{0,16})', plain)) <= {"data:image/webp;b"}
    assert "default-src 'none'" in page


def test_tables_have_captions_and_scopes_and_figures_have_words(report: Path) -> None:
    page = report.read_text(encoding="utf-8")
    tables = re.findall(r"<table.*?</table>", page, flags=re.DOTALL)
    assert len(tables) >= 10
    for table in tables:
        assert "<caption" in table
        assert not re.search(r"<th(?![^>]*scope=)[\s>]", table)
    for figure in re.findall(r"<figure.*?</figure>", page, flags=re.DOTALL):
        assert re.search(r'role="img" aria-label="[^"]{20,}"', figure)
        assert "<figcaption>" in figure
    ids = re.findall(r'\sid="([^"]+)"', page)
    assert len(set(ids)) == len(ids)


def test_what_people_and_models_wrote_is_data(tmp_path: Path) -> None:
    rows = [
        replace(
            row, goal=EVIL, judge=EVIL, reason=EVIL, place=EVIL, city=EVIL, minds=EVIL, attribution=EVIL, method=EVIL
        )
        for row in many_rows(6, ("x",))
    ]
    about = replace(ABOUT, title=EVIL, command=EVIL, honesty=(EVIL,), minds=(EVIL,), ceilings=((EVIL, EVIL),))
    page = write_report([*rows, *many_rows(6, ("y",))], about, tmp_path / "report").read_text(encoding="utf-8")
    assert page.count("<script") == 2
    assert page.count("</script>") == 2
    assert page.count("</style>") == 1
    assert "<!--" not in page
    assert page.count("A run of the tests") == 0, "what looks like a template is none"
    data = json.loads(re.search(r'id="missions-data">(.*?)</script>', page, flags=re.DOTALL)[1])  # type: ignore[index]
    assert data["goals"][0] == EVIL


def test_the_same_rows_in_any_order_give_the_same_bytes(report: Path, tmp_path: Path) -> None:
    rows = many_rows()
    random.Random(3).shuffle(rows)
    write_report(rows, ABOUT, tmp_path / "report")
    assert contents(tmp_path / "report") == contents(report.parent)


def test_missions_are_kept_in_full(report: Path) -> None:
    with (report.parent / "missions.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    rows = many_rows()
    assert len(lines) == len(rows)
    known = {(row.method, row.mission_id): row for row in rows}
    for line in lines:
        row = known[line["method"], line["mission_id"]]
        assert line["goal"] == row.goal
        assert float(line["computing_s"]) == row.score.computing_s
        assert bool(int(line["success"])) is row.score.success


def test_an_old_report_is_replaced_as_a_whole(tmp_path: Path) -> None:
    target = tmp_path / "report"
    write_report(many_rows(4, ("llm-rrt",)), ABOUT, target)
    (target / "figures" / "of-last-week.png").write_bytes(b"")
    write_report(many_rows(4, ("llm-rrt", "llm-as-eval")), ABOUT, target)
    assert not (target / "figures" / "of-last-week.png").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["report"], "nothing else is left"


def test_a_report_that_cannot_be_written_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "report"
    write_report(many_rows(4, ("llm-rrt",)), ABOUT, target)
    before = contents(target)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writing.os, "fsync", full)
    with pytest.raises(PartError, match="No space left on device; make room"):
        write_report(many_rows(4, ("llm-as-eval",)), ABOUT, target)
    assert contents(target) == before
    assert [path.name for path in tmp_path.iterdir()] == ["report"]


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("everything", encoding="utf-8")
    with pytest.raises(RecordError, match="no report"):
        write_report([made_row()], ABOUT, tmp_path)
    assert (tmp_path / "thesis.tex").read_text(encoding="utf-8") == "everything"
    with pytest.raises(InputError, match="no row"):
        write_report([], ABOUT, tmp_path / "report")
    assert not (tmp_path / "report").exists()


def test_one_mission_of_one_method_is_a_report(tmp_path: Path) -> None:
    page = write_report([made_row()], ABOUT, tmp_path / "new" / "report")
    assert "the run has one method" in page.read_text(encoding="utf-8")


def test_ten_thousand_missions_stay_small() -> None:
    rows: list[MissionRow] = [
        replace(row, goal=f"{row.goal} number {row.seed}", judge=f"the nearest is {row.score.path_length_m:.3f} m away")
        for row in many_rows(2000, METHODS)
    ]
    text = missions_json(Study(rows, ABOUT))
    assert len(json.loads(text)["rows"]) == 10_000
    assert len(text.encode()) < 2_500_000
