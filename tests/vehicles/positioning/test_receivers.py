import pytest

from reasoned_explorer.vehicles.positioning.fix import FixQuality
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS, ReceiverModel


def test_every_quality_but_none_has_a_model_and_better_ones_are_smaller():
    qualities = [quality for quality in FixQuality if quality is not FixQuality.NONE]
    sigmas = [RECEIVERS[quality].sigma_m for quality in qualities]
    assert sigmas == sorted(sigmas, reverse=True)


def test_a_model_is_scaled_to_what_the_receiver_says_of_itself():
    scaled = ReceiverModel(0.3, 0.4, 100.0).scaled_to(1.0)
    assert (scaled.white_m, scaled.wander_m, scaled.wander_tau_s) == pytest.approx((0.6, 0.8, 100.0))
    assert scaled.sigma_m == pytest.approx(1.0)


@pytest.mark.parametrize(("claimed_m", "believed_m"), [(None, 0.5), (0.5, 0.5), (0.001, 0.25), (1e9, 50.0)])
def test_claims_are_believed_within_reason(claimed_m, believed_m):
    assert ReceiverModel(0.3, 0.4, 100.0).scaled_to(claimed_m).sigma_m == pytest.approx(believed_m)
