import pytest

from reasoned_explorer.model import InputError, UnknownNameError
from reasoned_explorer.registry import Entry, Registry

PARTS = Registry(
    "part",
    "parts-that-nobody-brings",
    (
        Entry("good", "builtins:list", "a list"),
        Entry("gone", "reasoned_explorer.nowhere:make"),
        Entry("empty", "math:no_such_thing"),
        Entry("number", "math:pi"),
    ),
)


def test_a_name_loads_what_it_stands_for() -> None:
    assert PARTS.load("good") is list
    assert PARTS.names() == ("empty", "gone", "good", "number")


def test_an_unknown_name_lists_those_that_there_are() -> None:
    with pytest.raises(UnknownNameError, match="did you mean good"):
        PARTS.load("goood")


def test_what_may_be_said_instead_of_a_name_is_told_beside_the_names() -> None:
    parts = Registry("part", "parts-that-nobody-brings", (Entry("good", "builtins:list"),), beside="a part's number")
    with pytest.raises(UnknownNameError, match="expected one of good, or a part's number"):
        parts.load("bad")


@pytest.mark.parametrize("name", ["gone", "empty", "number"])
def test_an_entry_that_cannot_be_used_says_what_is_wrong_with_it(name: str) -> None:
    with pytest.raises(InputError):
        PARTS.load(name)
