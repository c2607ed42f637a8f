"""What people say, in a report: there where somebody rated, the same bytes twice, no markup of anybody's."""

import csv
import importlib.util
import re
from datetime import UTC, datetime
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.human_success import Judged
from reasoned_explorer.evaluation.ratings import Answer, Rating
from reasoned_explorer.evaluation.report import write_report
from reasoned_explorer.evaluation.report.contents import sections_of
from reasoned_explorer.evaluation.report.looks import looks_of
from reasoned_explorer.evaluation.report.people import people_section
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.row import MissionRow
from tests.evaluation.report.rows import ABOUT, many_rows

ROWS = many_rows(12)
EVIL = "<script>alert(1)</script>\"'&</td></table> {{ about.title }}"
LOOKS = looks_of(ABOUT.methods, frozenset(ABOUT.bounds))
NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


def rated(rows: list[MissionRow], *, comment: str = "") -> list[Rating]:
    """Return what two people say: Ann as the judge does, Bob always yes."""
    found = []
    for row in rows:
        key = (row.score.vehicle, row.method, row.mission_id)
        as_judged = Answer.YES if row.score.success else Answer.NO
        found.append(Rating("Ann Secret", *key, as_judged, 5 if row.score.success else 1, comment, NOON, "0.1.0"))
        found.append(Rating("Bob Secret", *key, Answer.YES, 4, "", NOON, "0.1.0"))
    return found


def section(page: Path) -> str:
    found = re.search(r'<section id="people".*?</section>', page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return found[0] if found else ""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(ROWS, ABOUT, tmp_path_factory.mktemp("people") / "report", ratings=rated(ROWS, comment=EVIL))


def test_without_ratings_there_is_nothing_of_people() -> None:
    study = Study(ROWS, ABOUT)
    assert people_section(study, Judged.of(ROWS, ())) is None
    assert "people" not in [part.key for part in sections_of(study, LOOKS, None)]
    judged = Judged.of(ROWS, rated(ROWS))
    assert "people" in [part.key for part in sections_of(study, LOOKS, None, judged)]


def test_human_success_stands_beside_automatic_success(page: Path) -> None:
    said = section(page)
    assert "2 people answered “Did it do what was asked?” for 60 missions" in said
    for head in ("human success", "automatic success", "human − automatic", "yes or partly", "how well, 1–5"):
        assert head in said
    with (page.parent / "tables" / "people.csv").open(newline="") as file:
        lines = {(line["method"], line["metric"]): line for line in csv.DictReader(file)}
    for method in ABOUT.methods:
        mine = [row for row in ROWS if row.method == method]
        in_time = [row for row in mine if row.declared and not row.score.over_time]
        automatic = sum(row.score.success for row in mine) / len(mine)
        # Bob calls all of them a success that were declared in time, Ann those that the judge does, too.
        human = sum(0.5 + 0.5 * row.score.success for row in in_time) / len(mine)
        assert float(lines[method, "automatic success"]["value"]) == pytest.approx(automatic)
        assert float(lines[method, "human success"]["value"]) == pytest.approx(human)
        assert lines[method, "human success"]["count"] == f"{len(mine)}"


@pytest.mark.skipif(importlib.util.find_spec("nltk") is None, reason="NLTK is not installed")
def test_agreement_between_raters_is_said(page: Path) -> None:
    found = re.findall(r"Agreement on ([\w, ]+): Krippendorff’s α = (\S+) \(ordinal; 60 missions", section(page))
    assert [name for name, _ in found] == ["yes, partly or no", "how well"]


def test_missions_where_people_and_judge_differ_are_listed_and_lead_to_the_mission(page: Path) -> None:
    said = section(page)
    disputed = [row for row in ROWS if row.declared and not row.score.over_time and not row.score.success]
    assert disputed, "Bob differs from the judge in these"
    table = re.search(r'<table id="t-disputed".*?</table>', said, flags=re.DOTALL)
    assert table
    links = re.findall(r'href="(#method=[^"]+)"', table[0])
    assert len(links) == len(disputed)
    assert all("mission=" in link for link in links)
    assert "no 1, yes 4" in table[0]


def test_nothing_that_people_wrote_becomes_markup(page: Path) -> None:
    said = section(page)
    assert "<script>alert" not in said
    assert "&lt;script&gt;alert(1)" in said


def test_raters_are_not_named(page: Path) -> None:
    for path in page.parent.rglob("*"):
        assert not path.is_file() or b"Secret" not in path.read_bytes()


def test_the_same_ratings_give_the_same_section_in_whatever_order_the_rows_come() -> None:
    ratings = rated(ROWS, comment=EVIL)
    sections = []
    for rows in (ROWS, ROWS[::-1]):
        study = Study(rows, ABOUT)
        sections.append(people_section(study, Judged.of((entry.row for entry in study.entries), ratings)))
    assert sections[0] is not None
    first, second = ((part.texts, part.tables, part.folded) for part in sections if part)
    assert first == second
