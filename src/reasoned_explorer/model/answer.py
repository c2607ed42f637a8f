"""What minds answer."""

from dataclasses import dataclass

LIKERT_LEVELS = (1, 2, 3, 4, 5)


@dataclass(frozen=True, slots=True)
class Assessment:
    """An evaluator's answer to one scene (paper, section IV-B: V(G, S) → v on a Likert scale of 1 to 5).

    Attributes:
        level_probabilities: Probabilities of the levels 1 to 5, summing to 1, or None where the answer is missing.
        blocked: The way ahead is blocked: an answer of its own, never a number hidden in a mean.
        forbidden: The ground ahead is what the goal says to shun.
        fault: Why the answer is missing, or None.
    """

    level_probabilities: tuple[float, float, float, float, float] | None
    blocked: bool = False
    forbidden: bool = False
    fault: str | None = None

    @property
    def score(self) -> float | None:
        """The expected level, in [1, 5], or None where the answer is missing."""
        if self.level_probabilities is None:
            return None
        one, two, three, four, five = self.level_probabilities
        # Written out: sum() adds floats in another way from Python 3.12 on, and scores are asked for in the inner loop.
        return one + 2 * two + 3 * three + 4 * four + 5 * five


@dataclass(frozen=True, slots=True)
class Verdict:
    """A goal checker's answer to one scene: is the goal in it, within reach?

    Attributes:
        found: Whether it is.
        confidence: That the answer is right about the goal being there, in [0, 1].
        evidence: The words of the scene that speak for it, for people and records.
        fault: Why the answer is missing, or None; a missing answer is never "found".
    """

    found: bool
    confidence: float
    evidence: str = ""
    fault: str | None = None


def likert_from_score(score: float) -> tuple[float, float, float, float, float]:
    """Return level probabilities whose expectation is ``score``, split over the two nearest levels.

    Scores outside [1, 5] are clipped to it.
    """
    clipped = min(5.0, max(1.0, score))
    below = min(4, int(clipped))
    levels = [0.0] * 5
    levels[below - 1] = 1.0 - (clipped - below)
    levels[below] = clipped - below
    return (levels[0], levels[1], levels[2], levels[3], levels[4])
