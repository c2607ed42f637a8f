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


def test_an_unknown_mind_answers_with_the_forms_of_models_too():
    with pytest.raises(UnknownNameError, match="or openai:MODEL or hf:NAME"):
        make_minds(mind_context(), "gpt-4o-mini")


def test_unknowing_minds_are_the_embedded_ones_without_knowledge_of_places():
    from reasoned_explorer.minds.embedded import default_senses, unknowing_senses
    from reasoned_explorer.minds.embedded.relevance import relevance_of

    assert make_minds(mind_context(), "embedded-unknowing").label.endswith("without knowledge of places")
    knowing, unknowing = (senses(with_embedder=False) for senses in (default_senses, unknowing_senses))
    goal = "Find me a trash can near a bench"
    assert relevance_of(goal, knowing).context
    assert not relevance_of(goal, unknowing).context
    assert not any(relevance_of(goal, unknowing).ground.values())
    # What a goal says of itself is no knowledge of places.
    assert relevance_of(goal, unknowing).degrees == relevance_of(goal, knowing).degrees
    asked = [[target.words for target in relevance_of(goal, senses).targets] for senses in (knowing, unknowing)]
    assert asked == [["bench"], ["bench"]]
