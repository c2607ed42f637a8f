import math
from dataclasses import replace

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control.localization import PoseEstimate
from reasoned_explorer.vehicles.positioning.fix import FixQuality
from reasoned_explorer.vehicles.positioning.verdict import Evidence, Grade, PositionLimits, PositionVerdict, judge

SURE = PoseEstimate(Pose(1.0, 2.0), 0.0, 0.0, 0.02, 0.02, 0.0)
GOOD = Evidence(SURE, "", FixQuality.FIXED, 0.2, 0.0, 0.0, 0.0, 0.02, math.inf)
LIMITS = PositionLimits()


def test_a_position_with_nothing_against_it_is_good():
    assert judge(GOOD, LIMITS) == PositionVerdict(Grade.GOOD)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"fix_age_s": 1.2}, "no believable fix for 1.2 s"),
        ({"fix_refused_s": 0.6, "fix_off_m": 30.0}, "30.0 m off for 0.6 s"),
        ({"quality": FixQuality.NONE}, "the receiver has no fix, single is asked for"),
        ({"compass_refused_s": 0.5}, "compass"),
        ({"imu_age_s": math.inf}, "no turn rate"),
        ({"restart_age_s": 1.0}, "start over 1.0 s ago"),
        ({"estimate": replace(SURE, position_sigma_m=3.5)}, "uncertain by 3.5 m"),
        ({"estimate": replace(SURE, position_sigma_m=math.nan)}, "uncertain"),
        ({"estimate": replace(SURE, heading_sigma_rad=math.radians(11.0))}, "uncertain by 11°"),
    ],
)
def test_anything_against_it_makes_it_poor_and_is_said(wrong, says):
    verdict = judge(replace(GOOD, **wrong), LIMITS)
    assert verdict.grade is Grade.POOR
    assert says in verdict.reason
    assert not verdict.is_good


def test_all_reasons_are_said():
    verdict = judge(replace(GOOD, imu_age_s=1.0, compass_refused_s=1.0), LIMITS)
    assert len(verdict.reason.split("; ")) == 2


def test_a_position_that_is_old_is_stale_whatever_else():
    assert judge(replace(GOOD, fix_age_s=3.1), LIMITS).grade is Grade.STALE


def test_without_a_position_it_says_what_is_missing():
    verdict = judge(replace(GOOD, estimate=None, missing="no fix has come in"), LIMITS)
    assert verdict == PositionVerdict(Grade.STALE, "no position yet: no fix has come in")
