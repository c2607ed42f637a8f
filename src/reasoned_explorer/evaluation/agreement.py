"""How well raters agree: Krippendorff's alpha, by NLTK.

α = 1 − observed / expected disagreement: 1 is perfect agreement, 0 what chance gives, below 0 worse than chance. It
takes any number of raters, each with gaps, and grades disagreement: yes and no are further apart than yes and partly.

NLTK's is used since its licence (Apache-2.0) is this package's own and since it is kept up; the quickest one, the
package ``krippendorff``, is under the GPL. NLTK knows no ordinal scale; it takes the distance of two values from its
caller, so that the one of Krippendorff (2011) stands here.

Source: K. Krippendorff, "Computing Krippendorff's Alpha-Reliability", University of Pennsylvania, 2011.
"""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from reasoned_explorer.model import MissingDependencyError

#: What installs it.
INSTALL = "pip install 'reasoned-explorer[rate]'"
#: By unit (a mission), then by rater: a value. Who did not rate is not there.
Ratings = Mapping[str, Mapping[str, int]]


class Scale(StrEnum):
    """How far apart two values are."""

    NOMINAL = "nominal"
    ORDINAL = "ordinal"
    INTERVAL = "interval"


@dataclass(frozen=True, slots=True)
class Agreement:
    """How well raters agree, or why that cannot be said.

    Attributes:
        alpha: Krippendorff's; None where it is not defined.
        units: How many units at least two raters rated.
        values: How many ratings these have.
        raters: Who gave them, how many.
        why_not: Why there is no alpha, in words; empty where there is one.
    """

    alpha: float | None
    units: int
    values: int
    raters: int
    why_not: str = ""


def agreement(ratings: Ratings, scale: Scale) -> Agreement:
    """Return how well raters agree. Units that fewer than two raters rated say nothing of it and are left out.

    Args:
        ratings: By unit, then by rater: numbers whose order is that of the scale.
        scale: Of the numbers. On an ordinal scale only their order counts.

    Raises:
        MissingDependencyError: If NLTK is not installed and there is something to compute.
    """
    pairable = {unit: given for unit, given in ratings.items() if len(given) > 1}
    counts = Counter(value for given in pairable.values() for value in given.values())
    raters = {rater for given in pairable.values() for rater in given}
    why_not = _why_not(ratings, counts)
    alpha = None if why_not else _alpha(pairable, _distance(scale, counts))
    return Agreement(alpha, len(pairable), counts.total(), len(raters), why_not)


def _why_not(ratings: Ratings, counts: Counter[int]) -> str:
    """Return why there is no alpha, in words."""
    raters = {rater for given in ratings.values() for rater in given}
    if not raters:
        return "nobody rated"
    if len(raters) == 1:
        return "one rater only"
    if not counts:
        return "no mission was rated by two"
    if len(counts) == 1:
        # Chance would agree as well: 0 of 0.
        return "all ratings are the same: without variation there is no alpha"
    return ""


def _alpha(ratings: Ratings, distance: Callable[[int, int], float]) -> float:
    try:
        from nltk.metrics.agreement import AnnotationTask
    except ImportError as error:
        raise MissingDependencyError("agreement between raters", "nltk", INSTALL) from error
    # In one order, whatever order they come in: sums of floats depend on it.
    triples = [(rater, unit, ratings[unit][rater]) for unit in sorted(ratings) for rater in sorted(ratings[unit])]
    return float(AnnotationTask(data=triples, distance=distance).alpha())


def _distance(scale: Scale, counts: Counter[int]) -> Callable[[int, int], float]:
    """Return the squared difference of two values (Krippendorff 2011, part E)."""
    if scale is Scale.NOMINAL:
        return lambda one, other: float(one != other)
    if scale is Scale.INTERVAL:
        return lambda one, other: float((one - other) ** 2)

    def ordinal(one: int, other: int) -> float:
        low, high = sorted((one, other))
        between = sum(count for value, count in counts.items() if low <= value <= high)
        return float((between - (counts[low] + counts[high]) / 2.0) ** 2)

    return ordinal
