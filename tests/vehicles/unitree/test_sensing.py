import math

import pytest

from reasoned_explorer.vehicles.positioning import CompassReading, Fix, FixQuality, Localizer
from reasoned_explorer.vehicles.unitree import HighCommand, decode_state, encode_state
from reasoned_explorer.vehicles.unitree.sensing import sensed
from tests.vehicles.unitree.fake_go1 import FakeGo1


def test_a_robot_that_is_told_to_turn_right_is_believed_to_turn_right():
    """From the command over the bytes to the filter, no sign is lost."""
    command = HighCommand.walking(forward_mps=0.5, right_mps=0.1, turn_radps=0.2)
    localizer = Localizer()
    localizer.take(CompassReading(0.0, 0.0))
    localizer.take(Fix(0.0, FixQuality.FIXED, x_m=0.0, y_m=0.0))
    for tick in range(1, 201):  # two seconds
        state = decode_state(encode_state(FakeGo1.state_of(command)))
        for measurement in sensed(state, time_s=0.01 * tick):
            localizer.take(measurement)
    estimate = localizer.at(2.0).estimate
    assert estimate is not None
    assert estimate.pose.heading_rad == pytest.approx(0.4, abs=0.02)
    assert estimate.speed_mps == pytest.approx(math.hypot(0.5, 0.1), abs=0.05)
    assert estimate.pose.x_m > 0.2
    assert estimate.pose.y_m > 0.7
