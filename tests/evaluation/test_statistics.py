import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation import statistics
from reasoned_explorer.evaluation.statistics import (
    FLIPS,
    RESAMPLES,
    bootstrap_sums,
    group_sums,
    groups_of,
    holm,
    kendall_tau_b,
    missions_needed,
    percentile_interval,
    sign_flip_test,
    wilson_interval,
)
from reasoned_explorer.model import InputError
from reasoned_explorer.model.draws import normal


def interval_of_mean(values, groups, *, seed=0):
    sums = group_sums([(value, 1.0) for value in values], groups)
    drawn = bootstrap_sums(sums, seed=seed)
    return percentile_interval(drawn[:, 0] / drawn[:, 1])


def test_wilson_by_hand():
    # 8 of 10 at z = 1.96: centre (0.8 + 0.19208)/1.38416, half width 1.96·√(0.016 + 0.009604)/1.38416.
    low, high = wilson_interval(8, 10)
    assert low == pytest.approx(0.4902, abs=2e-4)
    assert high == pytest.approx(0.9433, abs=2e-4)
    assert wilson_interval(0, 10)[0] == 0.0
    assert wilson_interval(10, 10)[1] == 1.0


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_wilson_holds_the_share(pair):
    successes, count = pair
    low, high = wilson_interval(successes, count)
    assert 0.0 <= low <= successes / count <= high <= 1.0


@pytest.mark.parametrize(("successes", "count", "confidence"), [(0, 0, 0.95), (3, 2, 0.95), (-1, 2, 0.95), (1, 2, 1.0)])
def test_wilson_refuses_what_is_no_share(successes, count, confidence):
    with pytest.raises(InputError):
        wilson_interval(successes, count, confidence=confidence)


# The clustered bootstrap.


def test_sums_by_group():
    assert group_sums([(1, 10), (2, 20), (4, 40)], [1, 0, 1]).tolist() == [[2, 20], [5, 50]]


def test_places_are_grouped_in_the_order_of_their_names():
    assert groups_of(["a", "b", "c"], {"a": "park", "b": "campus", "c": "park"}).tolist() == [1, 0, 1]
    assert groups_of(["a", "b"], None).tolist() == [0, 1]
    with pytest.raises(InputError, match="'c'"):
        groups_of(["a", "c"], {"a": "park"})


def test_two_groups_are_drawn_in_four_ways():
    # Sums 0 and 1: both twice the first, mixed, both twice the second, with shares 1/4, 1/2, 1/4.
    drawn = bootstrap_sums(np.array([[0.0], [1.0]]), seed=3)[:, 0]
    assert sorted(set(drawn.tolist())) == [0.0, 1.0, 2.0]
    assert np.mean(drawn == 1.0) == pytest.approx(0.5, abs=0.04)
    assert len(drawn) == RESAMPLES


def test_the_bootstrap_has_the_spread_of_a_mean():
    # 400 values, half 0 and half 1: σ of the mean is √(.25/400) = .025, the interval ± 1.96 of it.
    low, high = interval_of_mean([0.0, 1.0] * 200, range(400))
    assert low == pytest.approx(0.5 - 0.049, abs=0.004)
    assert high == pytest.approx(0.5 + 0.049, abs=0.004)


def test_places_in_which_all_missions_end_alike_count_once():
    # 40 places of 10 missions: as uncertain as 40 missions, σ = √(.25/40) = .079.
    values = [float(place % 2) for place in range(40) for _ in range(10)]
    low, high = interval_of_mean(values, [place for place in range(40) for _ in range(10)])
    assert high - low == pytest.approx(2 * 1.96 * 0.079, abs=0.02)


def test_the_clustered_interval_holds_the_truth_where_the_one_over_missions_does_not():
    # Places differ by a normal draw with σ = 1, missions in them by one with σ = 1; the true mean is 0.
    trials, places, each = 60, 25, 8
    held = {"places": 0, "missions": 0}
    groups = [place for place in range(places) for _ in range(each)]
    for trial in range(trials):
        values = [
            normal(trial, "place", place) + normal(trial, "mission", place, k)
            for place in range(places)
            for k in range(each)
        ]
        for name, drawn in (("places", groups), ("missions", range(places * each))):
            low, high = interval_of_mean(values, drawn, seed=trial)
            held[name] += low <= 0.0 <= high
    assert held["places"] / trials > 0.88
    assert held["missions"] / trials < 0.75


def test_a_bootstrap_depends_on_its_seed_only():
    sums = np.array([[float(k), 1.0] for k in range(30)])
    assert (bootstrap_sums(sums, seed=1) == bootstrap_sums(sums, seed=1)).all()
    assert (bootstrap_sums(sums, seed=1) != bootstrap_sums(sums, seed=2)).any()
    # What is drawn does not depend on what else is drawn with it.
    wide = np.concatenate((sums, sums * 3.0, sums * 7.0), axis=1)
    assert (bootstrap_sums(wide, seed=1)[:, :2] == bootstrap_sums(sums, seed=1)).all()


def test_a_bootstrap_over_thousands_of_missions_needs_little_memory():
    sums = np.ones((6000, 16))
    tracemalloc.start()
    bootstrap_sums(sums, seed=0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50e6


def test_percentiles_by_hand():
    # 41 draws: 2.5 % at either end leave out one.
    assert percentile_interval(np.arange(41.0)[::-1]) == (1.0, 39.0)
    assert percentile_interval(np.array([5.0])) == (5.0, 5.0)
    # Two draws that could be anything: more than may be left out.
    assert percentile_interval(np.array([*np.arange(39.0), math.nan, math.nan])) == (-math.inf, math.inf)
    assert percentile_interval(np.array([*np.arange(40.0), math.nan])) == (0.0, 39.0)
    with pytest.raises(InputError):
        percentile_interval(np.array([]))
    with pytest.raises(InputError):
        percentile_interval(np.array([1.0]), confidence=0.0)


# Paired tests.


@pytest.mark.parametrize(
    ("differences", "p"),
    [
        ([1.0, 2.0, 3.0], 2 / 8),  # only all or none flipped is as far from 0 as 6
        ([1.0, -1.0, 2.0], 6 / 8),  # ±4, ±2, ±2 are as far as 2; twice 0 is not
        ([5.0], 1.0),  # one place cannot tell
        ([0.0, 0.0], 1.0),
        ([], 1.0),
        ([1.0, 0.0, 2.0, 3.0, 0.0], 2 / 8),
        ([0.1] * 10, 2 / 1024),
        ([0.1, 0.2, -0.3], 1.0),  # 0 but for rounding
    ],
)
def test_flipping_all_signs_by_hand(differences, p):
    assert sign_flip_test(differences, seed=0) == p


def test_random_flips_agree_with_all_flips(monkeypatch):
    differences = [normal(4, k) + 0.6 for k in range(12)]
    exact = sign_flip_test(differences, seed=0)
    monkeypatch.setattr(statistics, "EXACT_GROUPS", 0)
    assert sign_flip_test(differences, seed=0) == pytest.approx(exact, abs=0.01)
    assert 0.0 < exact < 0.5


def test_random_flips_are_never_sure():
    assert sign_flip_test([1.0] * 100, seed=0) == 1 / (1 + FLIPS)


def test_where_there_is_no_difference_small_p_are_as_rare_as_they_say():
    small = [sign_flip_test([normal(trial, k) for k in range(9)], seed=0) <= 0.05 for trial in range(600)]
    assert np.mean(small) == pytest.approx(0.05, abs=0.02)


def test_holm_by_hand():
    # .01 · 3; .03 · 2; .04 · 1 is below .06, and never falls.
    assert holm({"a": 0.01, "b": 0.04, "c": 0.03}) == pytest.approx({"a": 0.03, "b": 0.06, "c": 0.06})
    assert list(holm({"b": 0.5, "a": 0.6}).items()) == [("b", 1.0), ("a", 1.0)]
    assert holm({}) == {}
    with pytest.raises(InputError):
        holm({"a": math.nan})


def test_kendalls_tau_by_hand():
    # 5 pairs in the same order, 1 in the other, of 6.
    assert kendall_tau_b([1, 2, 3, 4], [1, 3, 2, 4]) == pytest.approx(4 / 6)
    # One pair tied in the first: 5/√((6 − 1) · 6).
    assert kendall_tau_b([1, 2, 2, 3], [1, 2, 3, 4]) == pytest.approx(5 / math.sqrt(30))
    assert kendall_tau_b([1, 2, 3], [3, 2, 1]) == -1.0
    assert kendall_tau_b([1, 1, 1], [1, 2, 3]) is None
    assert kendall_tau_b([1], [1]) is None
    with pytest.raises(InputError):
        kendall_tau_b([1, 2], [1])
    with pytest.raises(InputError):
        kendall_tau_b([1, math.nan], [1, 2])


# How many.


def test_how_many_missions_by_hand():
    # Variance 100/99; (1.95996 + .84162)² · 1.0101/.02² = 7.84888 · 1.0101/.0004.
    needed = missions_needed({f"{k:03}": float((-1) ** k) for k in range(100)})
    assert (needed.missions, needed.places, needed.design_effect) == (19821, None, 1.0)
    assert needed.deviation == pytest.approx(math.sqrt(100 / 99))


def test_missions_that_end_alike_in_a_place_are_needed_the_more():
    # 10 places of 10 missions that are all the same: Var of the mean 10/9 · 10 · (10/100)² = .1111, over .0101 is 11.
    ids = [f"{place}/{k}" for place in range(10) for k in range(10)]
    differences = {name: float((-1) ** int(name[0])) for name in ids}
    needed = missions_needed(differences, places={name: name[0] for name in ids})
    assert needed.design_effect == pytest.approx(11.0)
    assert needed.missions == pytest.approx(11 * 19820.4, abs=2)
    assert needed.places == pytest.approx(needed.missions / 10, abs=1)


def test_what_cannot_tell_how_many():
    assert missions_needed({"a": 1.0}) is None
    assert missions_needed({"a": 0.1, "b": 0.1, "c": 0.1}) is None
    alone = missions_needed({"a": 1.0, "b": 0.0}, places={"a": "park", "b": "park"})
    assert (alone.places, alone.design_effect) == (None, 1.0)
    with pytest.raises(InputError) as caught:
        missions_needed({}, effect=0.0, power=1.0, confidence=2.0)
    assert len(caught.value.faults) == 4
