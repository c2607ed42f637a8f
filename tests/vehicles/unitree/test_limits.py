import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.unitree import CommandLimits, HighCommand, Mode

numbers = st.floats()


def test_a_command_within_the_limits_is_left_as_it_is():
    command = HighCommand.walking(forward_mps=0.8, right_mps=-0.1, turn_radps=1.0)
    assert CommandLimits().cut(command) == command


def test_a_velocity_is_cut_and_keeps_its_direction():
    cut = CommandLimits(forward_mps=1.0, sideways_mps=0.4).cut(HighCommand.walking(forward_mps=2.0, right_mps=0.4))
    assert (cut.forward_mps, cut.left_mps) == pytest.approx((1.0, -0.2))


def test_backwards_has_a_limit_of_its_own():
    assert CommandLimits(backward_mps=0.3).cut(HighCommand.walking(forward_mps=-1.0)).forward_mps == pytest.approx(-0.3)


def test_a_turn_is_cut_by_itself():
    cut = CommandLimits(turn_radps=0.5).cut(HighCommand.walking(forward_mps=0.5, turn_radps=2.0))
    assert (cut.forward_mps, cut.yaw_rate_left_radps) == (0.5, -0.5)


@pytest.mark.parametrize("mode", [Mode.WALK_TO_POSITION, Mode.WALK_PATH])
def test_a_robot_that_would_find_its_own_way_stands(mode):
    assert CommandLimits().cut(HighCommand(mode)) == HighCommand.standing()


def test_standing_does_not_walk():
    cut = CommandLimits().cut(HighCommand(Mode.STAND, forward_mps=1.0, yaw_rate_left_radps=1.0))
    assert (cut.mode, cut.forward_mps, cut.yaw_rate_left_radps) == (Mode.STAND, 0.0, 0.0)


@given(numbers, numbers, numbers)
def test_whatever_is_asked_what_is_sent_is_within_the_limits(forward_mps, right_mps, turn_radps):
    limits = CommandLimits()
    cut = limits.cut(HighCommand.walking(forward_mps=forward_mps, right_mps=right_mps, turn_radps=turn_radps))
    room = 1.0 + 1e-12
    assert -limits.backward_mps * room <= cut.forward_mps <= limits.forward_mps * room
    assert abs(cut.left_mps) <= limits.sideways_mps * room
    assert abs(cut.yaw_rate_left_radps) <= limits.turn_radps


def test_all_bad_limits_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        CommandLimits(forward_mps=9.0, turn_radps=0.0, sideways_mps=math.nan)
    assert len(caught.value.faults) == 3
