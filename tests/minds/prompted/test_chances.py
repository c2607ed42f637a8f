import math

import pytest

from reasoned_explorer.calls.chat import TokenChoice
from reasoned_explorer.minds.prompted.chances import level_chances, yes_chance
from tests.minds.prompted.fakes import with_logprobs


def test_a_level_is_weighed_by_the_tokens_that_say_it_with_spaces_and_dots():
    answer = with_logprobs(
        ("LEVEL", {}), (":", {}), (" 4", {" 4": 0.4, "4": 0.1, "4.": 0.1, " 3": 0.2, "3": 0.1, " a": 0.1})
    )
    assert level_chances(4.0, answer.tokens) == pytest.approx((0, 0, 1 / 3, 2 / 3, 0))


def test_the_level_is_looked_for_after_its_label_and_not_where_other_numbers_are():
    answer = with_logprobs(
        ('{"', {}), ("blocked", {}), ('":', {}), (" 0", {" 0": 0.5, " 1": 0.5}), (', "', {}), ("level", {}), ('":', {}),
        (" ", {" ": 1.0}), ("2", {"2": 0.75, "3": 0.25}), ("}", {}),
    )  # fmt: skip
    assert level_chances(2.0, answer.tokens) == pytest.approx((0, 0.75, 0.25, 0, 0))


def test_a_bare_answer_is_its_first_token():
    assert level_chances(3.0, with_logprobs((" 3", {" 3": 0.6, " 5": 0.2, "\n": 0.2})).tokens) == pytest.approx(
        (0, 0, 0.75, 0, 0.25)
    )


def test_levels_in_words_and_other_digits_are_weighed_too():
    assert level_chances(4.0, with_logprobs(("likely", {"likely": 0.6, "Unlikely": 0.2})).tokens) == pytest.approx(
        (0, 0.25, 0, 0.75, 0)
    )
    assert level_chances(4.0, with_logprobs(("٤", {"٤": 0.5, "٥": 0.5})).tokens) == pytest.approx((0, 0, 0, 0.5, 0.5))


@pytest.mark.parametrize(
    "tokens",
    [
        (),
        (TokenChoice("4"),),
        with_logprobs(("4", {"5": 0.9, "3": 0.1})).tokens,  # what was said is not among them
        with_logprobs(("LEVEL: ", {}), ("4", {"4": 0.5, "1": 0.5}), (" LEVEL: ", {}), ("4", {"4": 1.0})).tokens,
        (TokenChoice("4", (("4", math.nan), ("1", math.nan))),),
        (TokenChoice("4", (("4", 3.0), ("1", 0.5))),),  # no logarithms of probabilities
        with_logprobs(("LEVEL: ", {}), ("2", {"2": 0.5, "4": 0.5})).tokens,  # not what the text says
    ],
)
def test_where_the_tokens_do_not_tell_what_was_said_stands(tokens: tuple[TokenChoice, ...]):
    assert level_chances(4.0, tokens) == (0.0, 0.0, 0.0, 1.0, 0.0)


def test_a_level_between_two_is_split_between_them():
    assert level_chances(3.5, with_logprobs(("3", {"3": 0.9, "1": 0.1}), (".5", {})).tokens) == (0, 0, 0.5, 0.5, 0)


def test_found_is_weighed_by_yes_against_no():
    answer = with_logprobs(("FOUND", {}), (":", {}), (" yes", {" yes": 0.5, "Yes": 0.1, " no": 0.3, " near": 0.1}))
    assert yes_chance(True, answer.tokens) == pytest.approx(2 / 3)
    answer = with_logprobs(('{"found":', {}), ("false", {"false": 0.7, "true": 0.3}), ("}", {}))
    assert yes_chance(False, answer.tokens) == pytest.approx(0.3)
    assert yes_chance(True, answer.tokens) is None
    assert yes_chance(True, ()) is None
