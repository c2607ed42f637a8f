import pytest

from reasoned_explorer.minds import MINDS, make_minds
from reasoned_explorer.model import UnknownNameError
from tests.minds.helpers import mind_context


def test_the_names_that_come_with_the_package():
    assert {"embedded", "embedded-words", "scripted", "oracle"} <= set(MINDS.names())


def test_embedded_minds_say_that_they_are_no_language_model():
    assert "no language model" in make_minds(mind_context()).label
    assert make_minds(mind_context(), "embedded-words").label.endswith("words and lexicon only")


def test_roles_of_different_names_are_put_together_and_labelled():
    minds = make_minds(mind_context(), "embedded-words", checker="scripted")
    assert minds.checker is not minds.evaluator
    assert minds.evaluator is minds.visionary
    assert "checker: scripted minds" in minds.label
    assert "no language model" in minds.label


def test_a_misspelt_name_answers_with_the_near_ones():
    with pytest.raises(UnknownNameError, match="embedded"):
        make_minds(mind_context(), "embeded")
    with pytest.raises(UnknownNameError, match="scripted"):
        make_minds(mind_context(), checker="skripted")
