"""The page in a real Chromium, from file://: a number that is clicked shows exactly the missions behind it."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from html import unescape
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.report import Cause, cause_of, write_report
from reasoned_explorer.evaluation.row import MissionRow
from tests.evaluation.report.rows import ABOUT, METHODS, many_rows

Pairs = set[tuple[str, str]]


def _chromium() -> str:
    for name in ("chromium", "chromium-browser", "google-chrome"):
        found = shutil.which(name)
        if found:
            return found
    pytest.skip("no Chromium on this machine")


@pytest.fixture(scope="module")
def rows() -> list[MissionRow]:
    return many_rows(120)


@pytest.fixture(scope="module")
def page(rows: list[MissionRow], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(rows, ABOUT, tmp_path_factory.mktemp("browser") / "report")


def dom(page: Path, address: str, profile: Path) -> str:
    """Return the document as it stands after its scripts have run."""
    command = [
        _chromium(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
        "--disable-dev-shm-usage", f"--user-data-dir={profile}", "--virtual-time-budget=5000", "--dump-dom",
        f"{page.as_uri()}{address}",
    ]  # fmt: skip
    environment = {name: value for name, value in os.environ.items() if not name.lower().endswith("_proxy")}
    ran = subprocess.run(command, capture_output=True, timeout=120, check=True, env=environment)
    return ran.stdout.decode()


def listed(document: str) -> list[tuple[str, str]]:
    """Return method and id of each mission in the table, in order."""
    return [
        (unescape(method), unescape(mission))
        for mission, method in re.findall(r'<tr data-mission="([^"]*)" data-method="([^"]*)">', document)
    ]


def status(document: str) -> str:
    return unescape(re.search(r'<p id="status" role="status">(.*?)</p>', document)[1])  # type: ignore[index]


def expected(rows: list[MissionRow], test: Callable[[MissionRow], bool]) -> Pairs:
    return {(row.method, row.mission_id) for row in rows if test(row)}


def cell_address(page: Path, table: str, line: int, column: int) -> str:
    """Return where the number in a line and column (from 0, names left out) of a table leads."""
    text = page.read_text(encoding="utf-8")
    body = re.search(rf'<table id="t-{table}".*?</table>', text, flags=re.DOTALL)[0]  # type: ignore[index]
    lines = re.findall(r'<tr><th scope="row".*?</tr>', body, flags=re.DOTALL)
    cell = re.findall(r"<td.*?</td>", lines[line], flags=re.DOTALL)[column]
    return unescape(re.search(r'href="([^"]+)"', cell)[1])  # type: ignore[index]


def test_a_number_leads_to_its_missions(page: Path, rows: list[MissionRow], tmp_path: Path) -> None:
    def in_time(row: MissionRow) -> bool:
        return row.score.success and row.score.computing_s + row.score.travelling_s <= 1200.0

    of = {name: [row for row in rows if row.method == name] for name in METHODS}
    other = {row.mission_id: row.score.success for row in of["llm-rrt"]}
    differ = {row.mission_id for row in of["llm-as-eval"] if row.score.success != other[row.mission_id]}
    cases: list[tuple[tuple[str, int, int], Pairs]] = [
        # SR of llm-as-eval at level 2; OSR of the oracle over all levels.
        (("levels", 1, 1), expected(of["llm-as-eval"], lambda row: row.level == 2 and row.score.success)),
        (("main", 4, 2), expected(of["oracle"], lambda row: row.score.oracle_success)),
        (("causes", 2, 3), expected(of["nearest-frontier"], lambda row: cause_of(row) is Cause.FALSE_HALT_NEVER)),
        (("cities", 3, 1), expected(of["follow-paths"], lambda row: row.city == "monaco" and row.score.success)),
        (("casr-over-tmax", 0, 3), expected(of["llm-rrt"], in_time)),
        (("success-over-radius", 0, 1), expected(of["llm-rrt"], lambda row: dict(row.score.success_at)[10.0])),
        (("collisions", 0, 0), expected(of["llm-rrt"], lambda row: row.small_collisions > 0)),
        (("differences", 0, 1), expected([*of["llm-rrt"], *of["llm-as-eval"]], lambda row: row.mission_id in differ)),
    ]
    for (table, line, column), missions in cases:
        document = dom(page, cell_address(page, table, line, column), tmp_path / "profile")
        assert set(listed(document)) == missions, (table, line, column)
        assert status(document).startswith(f"{len(missions)} of ")
        assert missions, "a case without missions shows nothing"


def test_a_click_does_it(page: Path, rows: list[MissionRow], tmp_path: Path) -> None:
    # The page lets no script run but its own; for the test's click its policy is taken out of a copy.
    text = page.read_text(encoding="utf-8")
    clicked = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text)
    click = "<script>document.querySelector('#t-levels tbody tr:nth-child(2) td:nth-of-type(2) a').click()</script>"
    copy = tmp_path / "clicked.html"
    copy.write_text(clicked.replace("</body>", f"{click}</body>"), encoding="utf-8")
    document = dom(copy, "", tmp_path / "profile")
    assert set(listed(document)) == expected(
        rows, lambda row: row.method == "llm-as-eval" and row.level == 2 and row.score.success
    )
    assert "missions of llm-as-eval, level 2: success" in status(document)


def test_without_a_filter_the_first_two_hundred_stand_there_and_more_can_be_had(page: Path, tmp_path: Path) -> None:
    document = dom(page, "", tmp_path / "profile")
    assert len(listed(document)) == 200
    assert status(document) == "600 missions"
    assert "Show 200 more of 400" in document


def test_an_address_that_asks_for_nothing_known_shows_nothing(page: Path, tmp_path: Path) -> None:
    document = dom(page, "#method=%3Cimg%20src%3Dx%3E&outcome=wonder", tmp_path / "profile")
    assert listed(document) == []
    assert "<img src=x>" not in document
    assert status(document) == "0 of 0 missions of <img src=x> (there is none of that name): wonder"
