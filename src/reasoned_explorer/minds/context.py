"""What minds are made with, and what they are made into."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.clock import Clock
from reasoned_explorer.minds.latency import LatencyProfile
from reasoned_explorer.minds.mind import Evaluator, GoalChecker, Visionary


@dataclass(frozen=True, slots=True)
class MindContext:
    """What a mind's factory is called with.

    Attributes:
        clock: Modelled answers charge their seconds to it.
        latency: How long a modelled call takes.
        ledger: Every call is written there.
        seed: Of the mission; draws are keyed by it and by scenes' keys.
        truth: What only a privileged mind (the oracle) may read; None for all others.
        model_minds: Makes minds of a model's name, such as ``openai:gpt-4o-mini``; None where no model can be called.
    """

    clock: Clock
    latency: LatencyProfile
    ledger: Ledger
    seed: int = 0
    truth: Any = None
    model_minds: "Callable[[str], Minds] | None" = None


@dataclass(frozen=True, slots=True)
class Minds:
    """The three roles, filled.

    Attributes:
        label: What results made with them are called, e.g. ``"embedded minds, no language model"``.
        evaluator: Scores scenes.
        visionary: Imagines what lies beyond.
        checker: Notices the goal.
        seed: Of the mission; what a planner draws is keyed by it.
    """

    label: str
    evaluator: Evaluator
    visionary: Visionary
    checker: GoalChecker
    seed: int = 0
