"""Tables: the figures are the metrics', the counts add up, each number has its missions."""

from dataclasses import replace
from urllib.parse import parse_qs

import pytest

from reasoned_explorer.evaluation.metrics import aggregate, compare
from reasoned_explorer.evaluation.report.causes import Cause
from reasoned_explorer.evaluation.report.curves import casr_curves, observations, relations
from reasoned_explorer.evaluation.report.links import link
from reasoned_explorer.evaluation.report.results import (
    causes_table,
    cities_table,
    collisions_table,
    differences_table,
    headroom_table,
    levels_table,
    overall_table,
    paper_tables,
    spent_table,
)
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.wording import amount, money, share, signed
from reasoned_explorer.model import InputError
from tests.evaluation.report.rows import ABOUT, METHODS, made_row, many_rows


@pytest.fixture(scope="module")
def study() -> Study:
    return Study(many_rows(), ABOUT)


def test_figures_are_those_of_the_metrics(study: Study) -> None:
    expected = aggregate(study.scores("llm-as-eval"), places=study.place_of)
    records = [record for record in overall_table(study).records if record[0] == "llm-as-eval"]
    written = {record[2]: record[3:6] for record in records}
    for name in ("SR", "OSR", "SPL", "CASR", "CASR per mission", "CASR paper-style", "CT", "TT"):
        assert written[name] == (expected[name].value, expected[name].low, expected[name].high)
    assert written["tokens"] == (12_900.0, 12_900.0, 12_900.0)
    line = overall_table(study).groups[0].lines[1]
    assert line.cells[1].text == share(expected["SR"].value)
    assert parse_qs(line.cells[1].href[1:]) == {"method": ["llm-as-eval"], "outcome": ["success"]}


def test_methods_stand_in_the_order_that_was_asked_for(study: Study) -> None:
    assert [line.name for line in levels_table(study).groups[0].lines] == list(METHODS)
    assert [cell.href for cell in levels_table(study).groups[0].lines[0].cells][1] == (
        "#method=llm-rrt&level=2&outcome=success"
    )


def test_differences_are_paired_and_taken_from_the_first_method(study: Study) -> None:
    expected = compare(study.scores("oracle"), study.scores("llm-rrt"), places=study.place_of)["CASR"]
    table = differences_table(study)
    assert table is not None
    record = next(record for record in table.records if record[0] == "oracle" and record[2] == "CASR")
    figures = (expected.value, expected.low, expected.high, 24, "clustered bootstrap", expected.p)
    assert record == ("oracle", "llm-rrt", "CASR", *figures, record[-1])
    assert record[-1] >= expected.p, "corrected for four comparisons"


def test_methods_with_other_missions_are_compared_on_those_that_both_have() -> None:
    rows = many_rows(12, ("llm-rrt",)) + many_rows(24, ("llm-as-eval",))
    table = differences_table(Study(rows, replace(ABOUT, methods=())))
    assert table is not None
    assert table.groups[0].lines[0].cells[0].text == "12"
    strangers = [*many_rows(3, ("llm-rrt",)), *many_rows(9, ("llm-as-eval",))[5:]]
    assert differences_table(Study(strangers, ABOUT)) is None


def test_p_is_corrected_for_the_lines_and_headroom_is_told_where_it_is() -> None:
    names = ("llm-rrt", "llm-as-eval", "follow-paths", "foresight-60m")
    told = Study(many_rows(24, names), replace(ABOUT, methods=names, bounds=("foresight-60m",)))
    table = differences_table(told)
    assert table is not None
    assert table.columns[-2:] == ("p (SR)", "p, corrected")
    for line in table.groups[0].lines:
        p, corrected = (float(cell.text) for cell in line.cells[-2:])
        assert p <= corrected <= 1.0
    headroom = headroom_table(told)
    assert headroom is not None
    assert [line.name for line in headroom.groups[0].lines] == ["llm-rrt", "llm-as-eval"]
    assert headroom_table(Study(many_rows(4, ("llm-rrt", "follow-paths")), ABOUT)) is None


def test_intervals_say_how_they_were_made(study: Study) -> None:
    assert "clustered by place" in study.interval_method
    assert "3 places" in study.interval_method
    record = next(record for record in overall_table(study).records if record[2] == "calls")
    assert record[-1] == "clustered bootstrap"
    alone = Study([replace(row, place="park:3") for row in many_rows(8, ("llm-rrt",))], ABOUT)
    assert "Wilson" in alone.interval_method
    assert overall_table(alone).records[0][-1] == "Wilson"


def test_a_figure_that_no_mission_has_is_a_dash_and_stands_in_no_file(study: Study) -> None:
    table = spent_table(study)
    assert table.columns[1] == "nDTW"
    assert [line.cells[0].text for line in table.groups[0].lines] == ["–"] * len(METHODS)
    assert not any(record[2] == "nDTW" for record in table.records)


def test_causes_add_up_to_the_missions(study: Study) -> None:
    for method in study.methods:
        counts = [record for record in causes_table(study).records if record[0] == method]
        assert sum(int(record[2] or 0) for record in counts) == 24
    assert {entry.cause for entry in study.entries} == set(study.causes)
    assert Cause.FOUND in study.causes


def test_collisions_are_told_by_size_and_by_way() -> None:
    rows = [made_row("m", at, small_collisions=2, large_collisions=at, path_m=500.0) for at in range(4)]
    cells = collisions_table(Study(rows, ABOUT)).groups[0].lines[0].cells
    assert [cell.text for cell in cells] == ["2.00", "1.50", "4.00", "3.00"]


def test_cities_have_a_table_while_they_are_few(study: Study) -> None:
    table = cities_table(study)
    assert table is not None
    assert table.columns[1:4] == ("generated", "monaco", "victoria")
    assert cities_table(Study([made_row()], ABOUT)) is None
    many = [replace(made_row("m", at), city=f"city {at}") for at in range(9)]
    assert cities_table(Study(many, ABOUT)) is None


def test_vehicles_are_never_pooled() -> None:
    rows = many_rows(8, ("llm-rrt", "llm-as-eval"))
    walked = [replace(row, score=replace(row.score, vehicle="go1")) for row in rows]
    study = Study(rows + walked, ABOUT)
    assert study.methods == ("llm-rrt · drone", "llm-rrt · go1", "llm-as-eval · drone", "llm-as-eval · go1")
    assert [(item.method, item.base) for item in study.differences] == [
        ("llm-as-eval · drone", "llm-rrt · drone"),
        ("llm-as-eval · go1", "llm-rrt · go1"),
    ]


def test_rows_that_are_no_run_are_refused_with_all_reasons() -> None:
    with pytest.raises(InputError, match="no row"):
        Study([], ABOUT)
    row = made_row()
    other = made_row("llm-rrt", 1)
    shorter = replace(other, score=replace(other.score, time_limit_s=900.0))
    with pytest.raises(InputError) as refused:
        Study([row, row, shorter], ABOUT)
    assert "stands twice" in str(refused.value)
    assert "T_max" in str(refused.value)


def test_casr_is_shown_up_to_the_runs_own_limit_only() -> None:
    rows = [
        replace(row, score=replace(row.score, time_limit_s=900.0, time_factor=0.5))
        for row in many_rows(6, ("llm-rrt",))
    ]
    curve = casr_curves(Study(rows, ABOUT))[0]
    assert [limit for limit, _ in curve.points] == [5.0, 10.0, 15.0]
    assert [limit for limit, _ in curve.line] == [float(limit) for limit in range(5, 16)]


def test_observations_say_what_ranks_say_and_leave_bounds_out(study: Study) -> None:
    found = relations(study)
    assert [relation.level for relation in found] == [None, 1, 2, 3, 4]
    assert found[0].casr is not None
    assert found[0].casr.count == 4, "the oracle is left out"
    told = observations(found)
    assert [item.name.split()[0] for item in told] == ["Positive", "Negative", "Steady"]
    for item, reading in zip(told, ("positive", "negative", "steady"), strict=True):
        shown = any(relation.casr and relation.casr.reading == reading for relation in found)
        assert item.seen.startswith("Shown" if shown else "Not shown")


def test_with_few_methods_nothing_is_said_of_ct_and_casr() -> None:
    few = Study(many_rows(8, ("llm-rrt", "llm-as-eval")), ABOUT)
    assert all("Nothing can be said" in item.seen for item in observations(relations(few)))


def test_the_papers_tables_are_as_the_paper_prints_them() -> None:
    tables = {table.key: table for table in paper_tables()}
    rrt = tables["paper-i"].groups[0].lines[2]
    assert [cell.text for cell in rrt.cells[:5]] == [".59", ".49", ".63", ".32", ".51"]
    assert [cell.text for cell in tables["paper-iii"].groups[0].lines[4].cells] == [".520", ".34"]
    assert tables["paper-iv"].groups[0].lines[2].cells[0].text == "–"


def test_numbers_are_written_for_people() -> None:
    assert [share(value) for value in (0.0, 0.254, 1.0, -0.07, 0.999, float("nan"))] == [
        ".00", ".25", "1.00", "−.07", "1.00", "–",
    ]  # fmt: skip
    assert [signed(value) for value in (0.1, -0.1, 0.001, -0.001)] == ["+.10", "−.10", ".00", ".00"]
    assert [amount(value) for value in (0.0, 1.234, 45.67, 986.4, 12_345.0, 123_456.0)] == [
        "0", "1.23", "45.7", "986", "12.3k", "123k",
    ]  # fmt: skip
    assert [money(value) for value in (0.0, 0.0042, 1.5)] == ["0.00", "0.0042", "1.50"]
    assert link(method="a&b=c#", level=None, city="São") == "#method=a%26b%3Dc%23&city=S%C3%A3o"
