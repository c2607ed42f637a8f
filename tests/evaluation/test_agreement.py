"""Krippendorff's alpha against worked examples that were published."""

import builtins
import importlib.util
from typing import Any

import pytest

from reasoned_explorer.evaluation.agreement import Scale, agreement
from reasoned_explorer.model import MissingDependencyError

needs_nltk = pytest.mark.skipif(
    importlib.util.find_spec("nltk") is None, reason="NLTK is not installed: pip install 'reasoned-explorer[rate]'"
)


def table(**lines: str) -> dict[str, dict[str, int]]:
    """Return ratings by unit from a line of values for each rater; a dot is a gap."""
    units: dict[str, dict[str, int]] = {}
    for rater, line in lines.items():
        for place, value in enumerate(line.split()):
            if value != ".":
                units.setdefault(f"unit {place}", {})[rater] = int(value)
    return units


#: Krippendorff (2011), part C: four observers, twelve units, gaps; the last unit has one value only.
FOUR_OBSERVERS = table(
    A="1 2 3 3 2 1 4 1 2 . . .",
    B="1 2 3 3 2 2 4 1 2 5 . 3",
    C=". 3 3 3 2 3 4 2 2 5 1 .",
    D="1 2 3 3 2 4 4 1 2 5 1 .",
)
#: Krippendorff (2011), part A: two observers, ten units, 0 and 1, no gap.
TWO_OBSERVERS = table(A="0 1 0 0 0 0 0 0 1 0", B="1 1 1 0 0 1 0 0 0 0")


@needs_nltk
@pytest.mark.parametrize(
    ("ratings", "scale", "published"),
    [
        (FOUR_OBSERVERS, Scale.NOMINAL, 0.743),
        (FOUR_OBSERVERS, Scale.ORDINAL, 0.815),
        (FOUR_OBSERVERS, Scale.INTERVAL, 0.849),
        (TWO_OBSERVERS, Scale.NOMINAL, 0.095),
    ],
)
def test_alpha_is_that_of_the_published_example(
    ratings: dict[str, dict[str, int]], scale: Scale, published: float
) -> None:
    found = agreement(ratings, scale)
    assert found.alpha == pytest.approx(published, abs=0.0005)
    assert found.why_not == ""


@needs_nltk
def test_who_agrees_on_everything_has_one_and_who_says_the_contrary_less_than_chance() -> None:
    assert agreement(table(A="1 2 3", B="1 2 3"), Scale.ORDINAL).alpha == 1.0
    contrary = agreement(table(A="1 3 1 3", B="3 1 3 1"), Scale.ORDINAL).alpha
    assert contrary is not None
    assert contrary < 0.0


@needs_nltk
def test_what_one_rater_alone_saw_says_nothing() -> None:
    both = table(A="1 2 3 2", B="1 3 3 2")
    more = {**both, "alone": {"A": 1}, "alone too": {"B": 3}}
    assert agreement(more, Scale.ORDINAL) == agreement(both, Scale.ORDINAL)
    assert agreement(more, Scale.ORDINAL).units == 4


@needs_nltk
def test_only_the_order_of_ordinal_values_counts() -> None:
    near, far = table(A="1 2 3 1", B="1 2 3 2"), table(A="1 2 9 1", B="1 2 9 2")
    assert agreement(near, Scale.ORDINAL).alpha == agreement(far, Scale.ORDINAL).alpha
    assert agreement(near, Scale.INTERVAL).alpha != agreement(far, Scale.INTERVAL).alpha


@pytest.mark.parametrize(
    ("ratings", "why"),
    [
        ({}, "nobody rated"),
        (table(A="1 2 3"), "one rater only"),
        (table(A="1 2 . .", B=". . 1 2"), "no mission was rated by two"),
        (table(A="2 2 2", B="2 2 ."), "all ratings are the same: without variation there is no alpha"),
    ],
)
def test_what_is_not_defined_is_said_in_words(ratings: dict[str, dict[str, int]], why: str) -> None:
    found = agreement(ratings, Scale.ORDINAL)
    assert found.alpha is None
    assert found.why_not == why


@needs_nltk
def test_the_order_of_units_and_raters_does_not_matter() -> None:
    turned = {unit: dict(reversed(given.items())) for unit, given in reversed(FOUR_OBSERVERS.items())}
    assert agreement(turned, Scale.ORDINAL) == agreement(FOUR_OBSERVERS, Scale.ORDINAL)


def test_a_missing_library_names_the_command_that_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.startswith("nltk"):
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[rate\]'"):
        agreement(TWO_OBSERVERS, Scale.NOMINAL)
