import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import Assessment, likert_from_score


@given(st.floats(1, 5))
def test_level_probabilities_have_the_score_as_their_expectation(score: float) -> None:
    levels = likert_from_score(score)
    assert sum(levels) == pytest.approx(1.0)
    assert Assessment(levels).score == pytest.approx(score)


@pytest.mark.parametrize(("given_score", "kept"), [(-3.0, 1.0), (9.0, 5.0)])
def test_scores_beyond_the_scale_are_clipped(given_score: float, kept: float) -> None:
    assert Assessment(likert_from_score(given_score)).score == pytest.approx(kept)


def test_a_missing_answer_has_no_score() -> None:
    assert Assessment(None, fault="no answer").score is None
