"""What decides how promising each frontier is."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from reasoned_explorer.model import Assessment, Goal, Scene


@dataclass(frozen=True, slots=True)
class FrontierScore:
    """What a plan says of one frontier.

    Attributes:
        q: Its worth on the Likert scale, [1, 5]; None where no answer could be had.
        blocked: The way there is blocked.
        forbidden: The ground there is shunned by the goal.
        fault: Why there is no answer, or None.
    """

    q: float | None
    blocked: bool = False
    forbidden: bool = False
    fault: str | None = None


@dataclass(frozen=True, slots=True)
class ImaginedNode:
    """A node of the imagined tree: a scene and what the evaluator said of it, or None where it was not asked."""

    scene: Scene
    assessment: Assessment | None


@dataclass(frozen=True, slots=True)
class Plan:
    """Scores, one per scene in order, and the tree that they come from (empty for planners without one)."""

    scores: tuple[FrontierScore, ...]
    tree: tuple[ImaginedNode, ...] = ()


class Planner(Protocol):
    """Scores the frontiers that lie one step ahead of each described scene.

    Attributes:
        name: As registered.
        label: What its results are called, minds included.

    A planner may also have an attribute ``explorer``, a ``Mapping[str, Any]``: settings of the agent
    (`exploration.settings.ExplorerSettings`) that belong to the method and override a mission's. It is optional, and
    read with ``getattr``.
    """

    name: str
    label: str

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Return a score for each scene. May be cancelled at any await; it then leaves nothing behind."""
        ...
