import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.metrics import (
    MissionOutcome,
    aggregate,
    by_level,
    compare,
    outcome_of,
    score,
    spl_of,
    wilson_interval,
)
from reasoned_explorer.model import InputError, TrackPoint
from tests.task.scenes import judge_of, world_of


def outcome(mission_id="a", **values):
    given_values = {
        "level": 1,
        "vehicle": "drone",
        "declared": True,
        "in_place": True,
        "oracle_success": True,
        "path_length_m": 200.0,
        "reference_length_m": 100.0,
        "computing_s": 300.0,
        "travelling_s": 600.0,
        "planner_computing_s": 120.0,
        "distance_to_goal_m": 4.0,
        "in_place_at": ((5.0, True), (20.0, True)),
    }
    return MissionOutcome(mission_id, **{**given_values, **values})


FAILED = {"in_place": False, "in_place_at": ((5.0, False), (20.0, True)), "distance_to_goal_m": 18.0}


def test_a_success_by_hand():
    scored = score(outcome())
    assert scored.success
    assert scored.spl == 0.5
    assert scored.time_factor == 0.5  # 1 - 900 s of 1800 s
    assert scored.planner_time_factor == pytest.approx(0.6)  # 1 - (120 + 600)/1800
    assert scored.casr == 0.5


def test_without_a_declaration_there_is_no_success_but_an_oracle_one():
    scored = score(outcome(declared=False))
    assert not scored.success
    assert scored.oracle_success
    assert (scored.spl, scored.casr) == (0.0, 0.0)
    assert scored.success_at == ((5.0, False), (20.0, False))


def test_over_time_is_failure():
    scored = score(outcome(computing_s=1200.1))
    assert scored.over_time
    assert not scored.success
    assert (scored.time_factor, scored.planner_time_factor, scored.spl) == (0.0, 0.0, 0.0)


def test_exactly_in_time_is_success_without_a_bonus():
    scored = score(outcome(computing_s=1200.0))
    assert scored.success
    assert (scored.time_factor, scored.casr) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("success", "path_m", "reference_m", "spl"),
    [
        (True, 100.0, 100.0, 1.0),
        (True, 80.0, 100.0, 1.0),
        (True, 400.0, 100.0, 0.25),
        (False, 100.0, 100.0, 0.0),
        (True, 0.0, 0.0, 1.0),
        (True, 10.0, 0.0, 0.0),
        (True, 0.0, 10.0, 1.0),
        (True, 10.0, math.inf, 0.0),
        (False, 0.0, math.inf, 0.0),
    ],
)
def test_spl_and_its_corners(success, path_m, reference_m, spl):
    assert spl_of(success=success, path_length_m=path_m, reference_length_m=reference_m) == spl


def test_a_table_by_hand():
    # One success after 900 s, one false halt after 180 s.
    table = aggregate(
        [
            score(outcome("a")),
            score(outcome("b", **FAILED, computing_s=90.0, travelling_s=90.0, planner_computing_s=0.0)),
        ]
    )
    assert table["SR"].value == 0.5
    assert table["OSR"].value == 1.0
    assert table["SPL"].value == 0.25
    assert table["CASR"].value == pytest.approx(0.5 * (0.5 + 0.9) / 2)
    assert table["CASR per mission"].value == pytest.approx((0.5 * 1 + 0) / 2)
    assert table["CASR paper-style"].value == pytest.approx(0.5 * (0.6 + 0.95) / 2)
    assert table["distance to goal"].value == pytest.approx(11.0)
    assert table["SR at 5 m"].value == 0.5
    assert table["SR at 20 m"].value == 1.0
    assert table["CT"].value == pytest.approx(195.0)


def test_a_fast_false_halt_raises_the_papers_casr_and_not_the_one_per_mission():
    def slow_or_fast(seconds):
        return aggregate(
            [
                score(outcome("a")),
                score(outcome("b", **FAILED, computing_s=0.0, travelling_s=seconds, planner_computing_s=0.0)),
            ]
        )

    slow, fast = slow_or_fast(1500.0), slow_or_fast(10.0)
    assert fast["CASR"].value > slow["CASR"].value
    assert fast["CASR per mission"].value == slow["CASR per mission"].value


def test_missions_without_a_reference_way_are_counted():
    table = aggregate([score(outcome("a")), score(outcome("b", reference_length_m=math.inf))])
    assert table.unreachable == 1
    assert table["SPL"].value == 0.25


def test_without_any_goal_the_distance_is_no_number():
    metric = aggregate([score(outcome("a", distance_to_goal_m=math.inf))])["distance to goal"]
    assert math.isnan(metric.value)
    assert metric.count == 0


def test_the_table_does_not_depend_on_the_order():
    scores = [score(outcome(str(i), path_length_m=100.0 + 37 * i, in_place=i % 3 > 0)) for i in range(9)]
    assert aggregate(scores) == aggregate(scores[::-1])


def test_intervals_hold_the_value_and_narrow_with_missions():
    few = [score(outcome(str(i), in_place=i % 2 == 0)) for i in range(10)]
    many = [score(outcome(str(i), in_place=i % 2 == 0)) for i in range(200)]
    for name in ("SR", "SPL", "CASR", "CASR per mission"):
        wide, narrow = aggregate(few)[name], aggregate(many)[name]
        assert wide.low <= wide.value <= wide.high
        assert narrow.high - narrow.low < wide.high - wide.low


def test_levels_have_tables_of_their_own():
    tables = by_level([score(outcome("a", level=1)), score(outcome("b", level=4, **FAILED))])
    assert {level: table["SR"].value for level, table in tables.items()} == {1: 1.0, 4: 0.0, None: 0.5}


def test_wilson_by_hand():
    # 8 of 10 at z = 1.96: centre (0.8 + 0.19208)/1.38416, half width 1.96·√(0.016 + 0.009604)/1.38416.
    low, high = wilson_interval(8, 10)
    assert low == pytest.approx(0.4902, abs=2e-4)
    assert high == pytest.approx(0.9433, abs=2e-4)
    assert wilson_interval(0, 10)[0] == 0.0
    assert wilson_interval(10, 10)[1] == 1.0


def test_a_paired_comparison_sees_what_two_intervals_do_not():
    # The second method needs 5 % longer ways, on missions that differ widely.
    first = [score(outcome(str(i), path_length_m=110.0 + 40 * i)) for i in range(30)]
    second = [score(outcome(str(i), path_length_m=1.05 * (110.0 + 40 * i))) for i in range(30)]
    difference = compare(first, second)["SPL"]
    assert difference.low > 0.0
    assert aggregate(first)["SPL"].low < aggregate(second)["SPL"].high
    assert compare(first, first)["SR"].value == 0.0


def test_what_must_not_be_pooled_is_refused_at_once():
    scores = [score(outcome("a")), score(outcome("b", vehicle="go1", time_limit_s=900.0))]
    with pytest.raises(InputError) as caught:
        aggregate(scores, confidence=1.0)
    assert len(caught.value.faults) == 3
    with pytest.raises(InputError, match="no mission"):
        aggregate([])


def test_only_the_same_missions_are_compared():
    with pytest.raises(InputError, match="one set only"):
        compare([score(outcome("a"))], [score(outcome("b"))])
    with pytest.raises(InputError, match="twice"):
        compare([score(outcome("a"))] * 2, [score(outcome("a"))])


@pytest.mark.parametrize(
    "values",
    [
        {"path_length_m": math.nan},
        {"path_length_m": -1.0},
        {"reference_length_m": math.nan},
        {"computing_s": math.inf},
        {"travelling_s": math.nan},
        {"time_limit_s": 0.0},
        {"distance_to_goal_m": math.nan},
        {"planner_computing_s": 301.0},
        {"level": 0},
    ],
)
def test_numbers_out_of_range_are_refused(values):
    with pytest.raises(InputError):
        outcome(**values)


def test_a_track_is_judged_and_scored():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    track = [TrackPoint(0.0, 50, 9.7, 1.0, 0.0), TrackPoint(60.0, 50, 39.7, 1.0, 0.0)]
    came = outcome_of(track, judge, mission_id="a", vehicle="go1", declared=True, computing_s=30.0, travelling_s=60.0)
    assert came.in_place
    assert came.in_place_at == ((5.0, False), (10.0, True), (15.0, True), (20.0, True))
    assert came.distance_to_goal_m == pytest.approx(10.0)
    assert score(came).spl == pytest.approx(25.0 / 30.0, abs=0.04)
    known = outcome_of(
        track,
        judge,
        mission_id="a",
        vehicle="go1",
        declared=True,
        computing_s=30.0,
        travelling_s=60.0,
        reference_length_m=15.0,
    )
    assert score(known).spl == pytest.approx(0.5)


OUTCOMES = st.builds(
    outcome,
    level=st.sampled_from([1, 2, 3, 4]),
    declared=st.booleans(),
    in_place=st.booleans(),
    oracle_success=st.booleans(),
    path_length_m=st.floats(0, 1e4),
    reference_length_m=st.floats(0, 1e4) | st.just(math.inf),
    computing_s=st.floats(0, 3000),
    travelling_s=st.floats(0, 3000),
    planner_computing_s=st.just(0.0),
    distance_to_goal_m=st.floats(0, 1e4) | st.just(math.inf),
)


@given(OUTCOMES)
def test_a_score_is_bounded_by_success(came):
    scored = score(came)
    assert 0.0 <= scored.spl <= scored.success
    assert 0.0 <= scored.casr <= scored.success
    assert 0.0 <= scored.time_factor <= scored.planner_time_factor <= 1.0
    assert scored.oracle_success >= scored.success


@given(OUTCOMES, st.floats(0, 2000))
def test_more_time_never_helps(came, more_s):
    values = {name: getattr(came, name) for name in came.__slots__ if name != "mission_id"}
    later = score(outcome(**{**values, "computing_s": came.computing_s + more_s}))
    assert later.time_factor <= score(came).time_factor
    assert later.casr <= score(came).casr


@given(st.lists(OUTCOMES, min_size=1, max_size=12))
def test_a_table_is_bounded_by_its_success_rate(outcomes):
    table = aggregate([score(came) for came in outcomes])
    tiny = 1e-12
    for name in ("SPL", "CASR", "CASR per mission", "CASR paper-style"):
        assert 0.0 <= table[name].value <= table["SR"].value + tiny
        assert 0.0 <= table[name].low <= table[name].high <= 1.0 + tiny
    assert table["OSR"].value >= table["SR"].value


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_wilson_holds_the_share(pair):
    successes, count = pair
    low, high = wilson_interval(successes, count)
    assert 0.0 <= low <= successes / count <= high <= 1.0
