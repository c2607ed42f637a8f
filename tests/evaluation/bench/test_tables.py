"""Tables of a run as text, and what has to be said under them."""

import math
from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.bench.ablations import depth_methods, depth_sheet, minds_methods, minds_sheet
from reasoned_explorer.evaluation.bench.notes import bounds_among, notes_of
from reasoned_explorer.evaluation.bench.results import Results, corrected, label_of
from reasoned_explorer.evaluation.bench.tables import (
    compared_sheet,
    difference_sheet,
    headroom_sheet,
    main_sheet,
    more_sheet,
    paper_sheets,
    vehicles_sheet,
)
from reasoned_explorer.evaluation.metrics import aggregate, compare, headroom_closed
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.wording import figure, share, signed
from reasoned_explorer.model import InputError
from tests.evaluation.report.rows import made_row, many_rows

NAMES = ("llm-rrt", "follow-paths", "foresight-60m")


@pytest.fixture(scope="module")
def results() -> Results:
    return Results.of(many_rows(24, NAMES), NAMES)


def _method(name: str, successes: int, count: int = 6) -> list[MissionRow]:
    return [made_row(name, at, in_place=at < successes) for at in range(count)]


def test_figures_are_those_of_the_metrics_with_places_drawn_as_wholes(results: Results) -> None:
    rows = results.rows["llm-rrt"]
    places = {row.mission_id: row.place for row in rows}
    expected = aggregate([row.score for row in rows], places=places)["SR"]
    assert expected.interval == "clustered bootstrap"
    line = next(line for line in main_sheet(results, title="").lines if line[0] == "all")
    assert line[1:4] == (label_of(rows), "24", figure(expected))
    table = results.difference("foresight-60m", "llm-rrt")
    assert table == compare(
        [row.score for row in results.rows["foresight-60m"]], [row.score for row in rows], places=places
    )


def test_a_figure_that_no_mission_has_is_a_dash(results: Results) -> None:
    none = results.table("llm-rrt")
    assert none is not None
    assert (none["nDTW"].count, math.isnan(none["nDTW"].value)) == (0, True)
    sheet = more_sheet(results)
    assert [line[sheet.head.index("nDTW")] for line in sheet.lines] == ["–"] * 3
    assert figure(None) == "–"


def test_headroom_is_from_follow_paths_to_foresight() -> None:
    # By hand: SR of 1/6, 3/6, 5/6; the share is (3 - 1) / (5 - 1).
    rows = [*_method("llm-rrt", 3), *_method("follow-paths", 1), *_method("foresight-60m", 5)]
    results = Results.of(rows, NAMES)
    metric = results.headroom("llm-rrt", "SR")
    assert metric is not None
    assert metric.value == pytest.approx(0.5)
    scores = [[row.score for row in results.rows[name]] for name in NAMES]
    places = {row.mission_id: row.place for row in rows}
    assert metric == headroom_closed(*scores, name="SR", places=places)
    sheet = headroom_sheet(results)
    assert sheet is not None
    assert [line[:2] for line in sheet.lines] == [("llm-rrt", figure(metric))]


def test_without_headroom_or_without_a_bound_nothing_is_said_of_it() -> None:
    level = Results.of([*_method("llm-rrt", 3), *_method("follow-paths", 5), *_method("foresight-60m", 5)], NAMES)
    sheet = headroom_sheet(level)
    assert sheet is not None
    assert sheet.lines[0][1] == "–"
    assert headroom_sheet(Results.of([*_method("llm-rrt", 3), *_method("follow-paths", 5)], NAMES)) is None


def test_p_is_corrected_for_the_lines_of_the_table(results: Results) -> None:
    sheet = difference_sheet(results, "llm-rrt")
    tables = {name: results.difference(name, "llm-rrt") for name in NAMES[1:]}
    found = {name: table for name, table in tables.items() if table is not None}
    for line, name in zip(sheet.lines, NAMES[1:], strict=True):
        p, fixed = found[name]["SR"].p, corrected(found, "SR")[name]
        assert p is not None
        assert p <= fixed <= 2.0 * p
        assert line[-2:] == (share(p, 3), share(fixed, 3))


def test_runs_without_a_planner_in_common_are_told_apart() -> None:
    ours, theirs = Results.of(_method("llm-rrt", 3), ()), Results.of(_method("random", 3), ())
    with pytest.raises(InputError, match="no planner in common"):
        compared_sheet(ours, theirs, names=("A", "B"), methods=(None, None))
    sheet = compared_sheet(ours, theirs, names=("A", "B"), methods=("llm-rrt", "random"))
    assert sheet.lines[0][0] == "llm-rrt − random"


def test_a_row_says_what_it_is_though_its_first_mission_could_not_be_run() -> None:
    lost = replace(made_row("llm-rrt"), planner="llm-rrt", ct_label="", end="fault")
    assert label_of([lost, made_row("llm-rrt", 1)]) == "llm-rrt [embedded minds], CT modelled (gpt-2023)"
    assert label_of([lost]) == "llm-rrt"
    assert label_of([made_row("oracle")]) == "oracle [a bound: knows the world], CT modelled (gpt-2023)"
    halted = made_row("llm-rrt+perfect-halt")
    assert label_of([halted]).startswith("llm-rrt+perfect-halt [embedded minds; the judge halts, a bound], CT")


def test_notes_say_what_is_missing_and_whose_minds_they_were() -> None:
    rows = [made_row("llm-rrt"), made_row("oracle", 1, end="fault", declared=False)]
    notes = notes_of(rows, total=3)
    assert notes.always[0] == "Not finished: 2 of 3 missions."
    assert "do not agree with GPT-4" in notes.always[1]
    assert notes.once[0].startswith("1 mission ended with a fault")
    assert any("read the truth" in line for line in notes.once)
    assert notes.thanks == ("© OpenStreetMap contributors, ODbL 1.0",)
    assert notes_of([replace(made_row(), minds="a language model")], total=1).always == ()


def test_notes_tell_what_was_really_done() -> None:
    rows = [made_row("llm-rrt", number) for number in range(4)]
    here = [replace(row, place="park") for row in rows]
    assert any("of one place" in line for line in notes_of(here, total=4).once)
    apart = [replace(row, place=f"park {number}") for number, row in enumerate(rows)]
    assert any("resampled by place (4 places" in line for line in notes_of(apart, total=4).once)
    for captioner, said in (
        ("simulated captioner (perfect)", "a simulated captioner’s, without error"),
        ("simulated captioner (noisier)", "the error rates of “noisier” are assumed"),
        ("simulated captioner (perfect) through pixels", "a simulated captioner’s, without error"),
        ("simulated captioner (noisy) through pixels", "It sees through pixels"),
    ):
        seen = [replace(row, captioner=captioner) for row in rows]
        assert any(said in line for line in notes_of(seen, total=4).once)
    for places in (here, apart):
        results = Results.of([*places, *(replace(row, method="random") for row in places)], ())
        drawn = "mission (of one place)" if places is here else "place"
        note = difference_sheet(results, "random").notes[0]
        assert f"resampled by {drawn}. p: sign-flip test on SR by {drawn}" in note


def test_minds_that_read_the_truth_make_a_bound_of_a_method() -> None:
    told = replace(made_row("llm-rrt"), minds="oracle (knows the world; an upper bound)")
    halted = replace(
        made_row("random"),
        planner="random [no model]",
        minds="visionary: embedded, evaluator: embedded, checker: perfect halt (knows the world; a bound)",
    )
    honest = replace(halted, method="follow-paths", minds="visionary: v, evaluator: e, checker: x")
    unasked = replace(halted, method="nearest-frontier", minds="visionary: v, evaluator: o (a bound), checker: x")
    rows = [told, halted, honest, unasked]
    assert bounds_among(rows) == ("llm-rrt", "random")
    assert any("read the truth" in line for line in notes_of(rows, total=4).once)
    assert label_of([halted]).startswith("random [no model; a mind knows the world, a bound]")


def test_a_planner_without_a_model_says_so_where_a_model_halts_it() -> None:
    row = replace(made_row("random"), planner="random [no model]", minds="openai:gpt-4o-mini")
    assert label_of([row]).startswith("random [no model; openai:gpt-4o-mini checks]")
    assert label_of([replace(row, minds="embedded minds")]).startswith("random [no model]")


def test_vehicles_stand_side_by_side() -> None:
    walked = [replace(row, score=replace(row.score, vehicle="go1")) for row in _method("random", 2)]
    flown = Results.of([*_method("llm-rrt", 3), *_method("random", 1)], ())
    sheet = vehicles_sheet({"drone": flown, "go1": Results.of(walked, ())})
    assert sheet.head[1:] == ("SR drone", "OSR drone", "CASR drone", "SR go1", "OSR go1", "CASR go1")
    assert sheet.lines[0][4:] == ("–", "–", "–")
    assert sheet.lines[1][4].startswith(".33 [")


def test_ablations_stand_beside_the_papers() -> None:
    depths = depth_methods((0, 2))
    sheet = depth_sheet(Results.of([row for name in depths for row in _method(name, 3)], depths), title="")
    assert [(line[0], line[-1]) for line in sheet.lines] == [("L = 0", ".141 (.38)"), ("L = 2", ".732 (.05)")]
    names = minds_methods(("a",), ("a", "b"))
    sheet = minds_sheet(Results.of([row for name in names for row in _method(name, 3)], names), title="")
    # Each row has 20 scores that sum to 60.
    assert [(*line[:3], line[-1]) for line in sheet.lines[:2]] == [("a", "a", "6", "3.00"), ("a", "b", "6", "3.00")]
    assert sheet.lines[-1][3] == "– (left out)"


def test_the_papers_main_table_stands_by_level() -> None:
    (sheet,) = paper_sheets()
    assert ("L3", "Reasoned Explorer (LLM-RRT)", ".63", ".71", ".43", ".46") in sheet.lines
    assert "another simulator" in sheet.notes[0]


def test_numbers_are_written_for_people() -> None:
    assert [share(value) for value in (0.25, -0.03, 1.0, -0.001, -math.inf, math.nan)] == [
        ".25", "−.03", "1.00", ".00", "−∞", "–",
    ]  # fmt: skip
    assert [signed(value) for value in (0.25, -0.03, 0.001)] == ["+.25", "−.03", ".00"]
