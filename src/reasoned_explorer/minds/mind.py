"""The three questions that minds answer. They read a scene's text and key, never its waypoint or a view."""

from collections.abc import Sequence
from typing import Protocol

from reasoned_explorer.model import Assessment, Goal, Scene, Verdict


class Evaluator(Protocol):
    """How promising is a scene for a goal? (paper, section IV-B: V(G, S) → v)."""

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:
        """Return one assessment per scene, in order.

        A batch is asked at once and takes as long as its slowest answer. A missing answer is an `Assessment` with a
        fault, not an exception.
        """
        ...


class Visionary(Protocol):
    """What would one see about ten metres further on? (paper, section IV-B: L(S_t) → S_{t+1})."""

    async def imagine(self, goal: Goal, scenes: Sequence[Scene], *, count: int) -> Sequence[Sequence[Scene]]:
        """Return ``count`` imagined scenes for each scene, in order.

        The key of an imagined scene is its parent's with (child,) appended, its depth one more than its parent's. A
        missing answer is a `Scene` with a fault.
        """
        ...


class GoalChecker(Protocol):
    """Is the goal in a scene, within reach?"""

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        """Return one verdict per scene, in order. A missing answer is a `Verdict` with a fault, never "found"."""
        ...
