import math
import statistics

import pytest

from reasoned_explorer.minds import LATENCY_PROFILES, LatencyProfile, RoleLatency, latency_profile
from reasoned_explorer.model import SettingsError, UnknownNameError


def test_instant_takes_no_time():
    profile = latency_profile("instant")
    assert profile.duration_s("evaluator", 1, 0, 0, 0) == 0.0
    assert profile.batch_s("visionary", 1, [(0, 0, 0), (0, 0, 1)]) == (0.0, 0.0)


def test_gpt_2023_plans_a_step_of_n3_l1_in_the_seconds_of_the_authors_log():
    profile = latency_profile("gpt-2023")
    steps_s = []
    for step in range(1500):
        children = [(step, 0, view, child) for view in range(3) for child in range(3)]
        steps_s.append(max(profile.batch_s("visionary", 5, children)) + max(profile.batch_s("evaluator", 5, children)))
    deciles = statistics.quantiles(steps_s, n=10)
    assert deciles[0] == pytest.approx(9.0, abs=0.5)
    assert deciles[-1] == pytest.approx(13.5, abs=0.6)


def test_a_call_takes_the_same_time_whatever_else_is_asked():
    profile = latency_profile("gpt-fast")
    alone = profile.duration_s("checker", 3, 4, 0, 1)
    among_others = profile.batch_s("checker", 3, [(4, 0, 0), (4, 0, 1), (4, 0, 2)])
    assert among_others[1] == alone
    assert profile.duration_s("evaluator", 3, 4, 0, 1) != alone
    assert profile.duration_s("checker", 4, 4, 0, 1) != alone


def test_the_median_is_the_median():
    profile = LatencyProfile("mine", "for the test", evaluator=RoleLatency(2.0, 0.5))
    seconds = [profile.duration_s("evaluator", 0, call) for call in range(3000)]
    assert statistics.median(seconds) == pytest.approx(2.0, rel=0.05)
    assert statistics.stdev(math.log(second) for second in seconds) == pytest.approx(0.5, rel=0.05)


def test_every_profile_says_where_its_figures_come_from():
    for name in LATENCY_PROFILES:
        assert latency_profile(name).label


def test_a_misspelt_profile_names_the_near_ones():
    with pytest.raises(UnknownNameError, match="gpt-2023"):
        latency_profile("gpt-2032")
    with pytest.raises(UnknownNameError, match="evaluator"):
        latency_profile("gpt-fast").duration_s("evaluater", 0)


def test_all_faults_of_a_profile_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        LatencyProfile("bad", "", caption=RoleLatency(-1.0, 0.1), checker=RoleLatency(math.nan, 3.0))
    assert len(caught.value.faults) == 3


def test_all_calls_may_take_the_same_seconds() -> None:
    profile = latency_profile("0.8s")
    assert {profile.duration_s(role, 7, 1, 2) for role in ("caption", "visionary", "evaluator", "checker")} == {0.8}
    for wrong in ("0.8", "s", "-1s", "1e3s", "99999s"):
        with pytest.raises(UnknownNameError):
            latency_profile(wrong)
