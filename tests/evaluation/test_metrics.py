import math
import pickle
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.metrics import (
    COMPARED,
    aggregate,
    by_level,
    compare,
    headroom_closed,
    paired_differences,
)
from reasoned_explorer.evaluation.scoring import score
from reasoned_explorer.evaluation.statistics import wilson_interval
from reasoned_explorer.model import InputError
from tests.evaluation.scores import FAILED, scored
from tests.evaluation.test_scoring import OUTCOMES


def in_places(count, each):
    """Ids of missions, and where they took place."""
    ids = [f"{place:02}/{k}" for place in range(count) for k in range(each)]
    return ids, {name: name[:2] for name in ids}


def test_a_table_by_hand():
    # One success after 900 s, one false halt after 180 s.
    table = aggregate(
        [
            scored("a"),
            scored("b", **FAILED, oracle_seen=False, computing_s=90.0, travelling_s=90.0, planner_computing_s=0.0),
        ]
    )
    assert table["SR"].value == 0.5
    assert table["OSR"].value == 1.0
    assert table["OSR-seen"].value == 0.5
    assert table["SPL"].value == 0.25
    assert table["soft-SPL"].value == pytest.approx((0.5 + 0.97 * 0.5) / 2)
    assert table["CASR"].value == pytest.approx(0.5 * (0.5 + 0.9) / 2)
    assert table["CASR per mission"].value == pytest.approx((0.5 * 1 + 0) / 2)
    assert table["CASR paper-style"].value == pytest.approx(0.5 * (0.6 + 0.95) / 2)
    assert table["distance to goal"].value == pytest.approx(11.0)
    assert table["SR at 5 m"].value == 0.5
    assert table["SR at 20 m"].value == 1.0
    assert table["CT"].value == pytest.approx(195.0)


def test_casr_as_the_paper_has_it():
    # SR = 2/3; I = 1 - 600/1800, 1 - 900/1800, and 0 for the mission over time: CASR = 2/3 · (2/3 + 1/2 + 0)/3.
    times = {"a": (100.0, 500.0), "b": (400.0, 500.0), "c": (1000.0, 900.0)}
    table = aggregate(
        [scored(k, computing_s=ct_s, travelling_s=tt_s, planner_computing_s=0.0) for k, (ct_s, tt_s) in times.items()]
    )
    assert table["SR"].value == pytest.approx(2 / 3)
    assert table["CASR"].value == pytest.approx(2 / 3 * (2 / 3 + 1 / 2) / 3)
    assert table["CASR per mission"].value == pytest.approx((2 / 3 + 1 / 2) / 3)


def test_the_order_of_the_figures_is_fixed():
    names = [metric.name for metric in aggregate([scored()]).metrics]
    assert names == [
        *("SR", "OSR", "OSR-seen", "SPL", "soft-SPL", "CASR", "CASR per mission", "CASR paper-style"),
        *("SR at 5 m", "SR at 20 m", "nDTW", "CT", "TT", "path length", "distance to goal"),
    ]


def test_ndtw_is_the_mean_of_the_missions_that_have_one():
    scores = [
        scored("a", level=3, ndtw=0.5),
        scored("b", level=3, ndtw=0.25),
        scored("c", level=3, reference_length_m=math.inf),
        scored("d"),
    ]
    assert aggregate(scores)["nDTW"].value == 0.375
    assert aggregate(scores)["nDTW"].count == 2
    none = aggregate([scores[3]])["nDTW"]
    assert (math.isnan(none.value), none.count, none.interval) == (True, 0, "none")


def test_a_fast_false_halt_raises_the_papers_casr_and_not_the_one_per_mission():
    def slow_or_fast(seconds):
        return aggregate(
            [scored("a"), scored("b", **FAILED, computing_s=0.0, travelling_s=seconds, planner_computing_s=0.0)]
        )

    slow, fast = slow_or_fast(1500.0), slow_or_fast(10.0)
    assert fast["CASR"].value > slow["CASR"].value
    assert fast["CASR per mission"].value == slow["CASR per mission"].value


def test_missions_without_a_reference_way_are_counted():
    table = aggregate([scored("a"), scored("b", reference_length_m=math.inf)])
    assert table.unreachable == 1
    assert table["SPL"].value == 0.25


def test_without_any_goal_the_distance_is_no_number():
    metric = aggregate([scored("a", distance_to_goal_m=math.inf)])["distance to goal"]
    assert math.isnan(metric.value)
    assert metric.count == 0


def test_the_table_does_not_depend_on_the_order():
    ids, places = in_places(3, 4)
    scores = [scored(name, path_length_m=100.0 + 37 * i, in_place=i % 3 > 0) for i, name in enumerate(ids)]
    assert aggregate(scores) == aggregate(scores[::-1])
    assert aggregate(scores, places=places) == aggregate(scores[::-1], places=dict(reversed(places.items())))
    other = [scored(name, in_place=i % 2 > 0) for i, name in enumerate(ids)]
    turned = compare(scores[::-1], other[3:] + other[:3], places=places)
    assert compare(scores, other, places=places) == turned
    assert pickle.loads(pickle.dumps(turned)) == turned  # noqa: S301


def test_intervals_hold_the_value_and_narrow_with_missions():
    few = [scored(f"{i:03}", in_place=i % 2 == 0) for i in range(10)]
    many = [scored(f"{i:03}", in_place=i % 2 == 0) for i in range(200)]
    for name in ("SR", "SPL", "CASR", "CASR per mission"):
        wide, narrow = aggregate(few)[name], aggregate(many)[name]
        assert wide.low <= wide.value <= wide.high
        assert narrow.high - narrow.low < wide.high - wide.low


def test_levels_have_tables_of_their_own():
    tables = by_level([scored("a", level=1), scored("b", level=4, **FAILED)], places={"a": "park", "b": "campus"})
    assert {level: table["SR"].value for level, table in tables.items()} == {1: 1.0, 4: 0.0, None: 0.5}


# Which interval.


def test_missions_of_a_place_are_drawn_together():
    ids, places = in_places(12, 6)
    # What a place is like decides.
    scores = [scored(name, in_place=int(places[name]) % 2 == 0) for name in ids]
    apart, together = aggregate(scores), aggregate(scores, places=places)
    assert (apart["SR"].interval, apart["SPL"].interval) == ("Wilson", "bootstrap")
    for name in ("SR", "SPL", "CASR"):
        assert together[name].interval == "clustered bootstrap"
        assert together[name].value == apart[name].value
        assert together[name].high - together[name].low > 1.7 * (apart[name].high - apart[name].low)


def test_with_one_place_missions_are_drawn():
    ids, places = in_places(1, 8)
    table = aggregate([scored(name, in_place=i % 2 == 0) for i, name in enumerate(ids)], places=places)
    assert (table["SR"].interval, table["SPL"].interval) == ("Wilson", "bootstrap")
    assert table["SR"] == aggregate([scored(name, in_place=i % 2 == 0) for i, name in enumerate(ids)])["SR"]


def test_a_share_that_never_varies_is_not_certain():
    ids, places = in_places(5, 4)
    none = aggregate([scored(name, **FAILED) for name in ids], places=places)["SR"]
    assert (none.interval, none.low, none.high) == ("Wilson", *wilson_interval(0, 20))
    # Half of the missions of every place: no resample differs from any other.
    half = aggregate([scored(name, in_place=i % 2 == 0) for i, name in enumerate(ids)], places=places)["SR"]
    assert (half.interval, half.low, half.high) == ("Wilson", *wilson_interval(10, 20))


def test_a_mission_without_a_place_is_refused():
    with pytest.raises(InputError, match="'b' has none"):
        aggregate([scored("a"), scored("b")], places={"a": "park"})


def test_the_seed_decides():
    scores = [scored(f"{i:02}", path_length_m=100.0 + 37 * i) for i in range(20)]
    assert aggregate(scores, seed=1)["SPL"] == aggregate(scores, seed=1)["SPL"]
    assert aggregate(scores, seed=1)["SPL"].low != aggregate(scores, seed=2)["SPL"].low


# Comparisons.


def test_a_paired_comparison_sees_what_two_intervals_do_not():
    # The second method needs 5 % longer ways, on missions that differ widely.
    first = [scored(str(i), path_length_m=110.0 + 40 * i) for i in range(30)]
    second = [scored(str(i), path_length_m=1.05 * (110.0 + 40 * i)) for i in range(30)]
    difference = compare(first, second)["SPL"]
    assert difference.low > 0.0
    assert difference.p == 1e-4  # the smallest that there is
    assert aggregate(first)["SPL"].low < aggregate(second)["SPL"].high
    same = compare(first, first)
    assert [metric.name for metric in same.metrics] == list(COMPARED)
    assert all((metric.value, metric.low, metric.high, metric.p) == (0.0, 0.0, 0.0, 1.0) for metric in same.metrics)


def test_the_p_of_a_difference_by_hand():
    # In three places the first method succeeds once more; swapped in all or in none: 2 of 2³.
    ids, places = in_places(3, 2)
    first = [scored(name) for name in ids]
    second = [scored(name, in_place=name.endswith("0")) for name in ids]
    difference = compare(first, second, places=places)["SR"]
    assert difference.value == 0.5
    assert difference.p == 2 / 8
    # Missions of their own: the three that differ, the same 2 of 2³.
    assert compare(first, second)["SR"].p == 2 / 8


def test_casr_is_swapped_as_a_product():
    # Differences of CASR are 1 · .5 - 1 · .75 over missions; s̄ = 1 and t̄ = .625 leave s̄ · Δt = -.25 for each.
    slow = [scored(str(i)) for i in range(4)]
    fast = [scored(str(i), computing_s=0.0, travelling_s=450.0, planner_computing_s=0.0) for i in range(4)]
    assert paired_differences(slow, fast, name="CASR") == {str(i): -0.25 for i in range(4)}
    assert compare(slow, fast)["CASR"].value == -0.25
    assert compare(slow, fast)["CASR"].p == 2 / 16
    with pytest.raises(InputError, match="no figure 'CT'"):
        paired_differences(slow, fast, name="CT")


@given(st.lists(st.tuples(OUTCOMES, OUTCOMES), min_size=1, max_size=8), st.sampled_from(COMPARED))
def test_what_missions_add_to_a_difference_is_the_difference(pairs, name):
    first, second = (
        [score(replace(came, mission_id=str(i))) for i, came in enumerate(side)] for side in zip(*pairs, strict=True)
    )
    parts = paired_differences(first, second, name=name)
    assert sum(parts.values()) / len(parts) == pytest.approx(compare(first, second)[name].value, abs=1e-12)


def test_what_must_not_be_pooled_is_refused_at_once():
    scores = [scored("a"), scored("b", vehicle="go1", time_limit_s=900.0)]
    with pytest.raises(InputError) as caught:
        aggregate(scores, confidence=1.0)
    assert len(caught.value.faults) == 3
    with pytest.raises(InputError, match="no mission"):
        aggregate([])


def test_only_the_same_missions_are_compared():
    with pytest.raises(InputError, match="not in every set"):
        compare([scored("a")], [scored("b")])
    with pytest.raises(InputError, match="twice"):
        compare([scored("a")] * 2, [scored("a")])
    with pytest.raises(InputError, match="differ"):
        compare([scored("a")], [scored("a", vehicle="go1")])


# Headroom.


def with_successes(ids, hits):
    return [scored(name, in_place=i < hits) for i, name in enumerate(ids)]


def test_the_share_of_headroom_by_hand():
    # SR .5 between .3 and .8: (.5 - .3)/(.8 - .3).
    ids, _ = in_places(20, 1)
    closed = headroom_closed(*(with_successes(ids, hits) for hits in (10, 6, 16)))
    assert closed.value == pytest.approx(0.4)
    assert closed.low < 0.4 < closed.high
    assert (closed.count, closed.interval, closed.name) == (20, "bootstrap", "headroom closed (SR)")
    worse = headroom_closed(*(with_successes(ids, hits) for hits in (2, 6, 16)), name="SPL")
    assert worse.value == pytest.approx(-0.4)


def test_where_the_bound_is_not_above_the_baseline_there_is_no_headroom():
    ids, _ = in_places(20, 1)
    assert headroom_closed(*(with_successes(ids, hits) for hits in (10, 6, 6))) is None
    assert headroom_closed(*(with_successes(ids, hits) for hits in (10, 6, 5))) is None


def test_hardly_any_headroom_leaves_the_share_open():
    # One mission of 20 more: a third of the resamples do not hold it, and have no share.
    ids, places = in_places(20, 1)
    closed = headroom_closed(*(with_successes(ids, hits) for hits in (7, 6, 7)), places=places)
    assert closed.value == pytest.approx(1.0)
    assert (closed.low, closed.high) == (-math.inf, math.inf)
    assert closed.interval == "clustered bootstrap"


@given(st.lists(OUTCOMES, min_size=1, max_size=12))
def test_a_table_is_bounded_by_its_success_rate(outcomes):
    table = aggregate([score(came) for came in outcomes])
    tiny = 1e-12
    for name in ("SPL", "CASR", "CASR per mission", "CASR paper-style"):
        assert 0.0 <= table[name].value <= table["SR"].value + tiny
        assert 0.0 <= table[name].low <= table[name].high <= 1.0 + tiny
    assert table["SPL"].value <= table["soft-SPL"].value + tiny
    assert table["OSR"].value >= max(table["SR"].value, table["OSR-seen"].value)
