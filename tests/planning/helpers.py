"""What tests of planners share: a goal, scenes, and scripted minds against a virtual clock."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import LatencyProfile, Ledger, MindContext, Minds, RoleLatency
from reasoned_explorer.minds.embedded import make_words_minds
from reasoned_explorer.minds.scripted import Scripts, make_minds
from reasoned_explorer.model import Goal, Scene
from reasoned_explorer.planning import Plan, Planner

GOAL = Goal("Find me a bench", 1)
ONE_SECOND = LatencyProfile("test", "1 s a call", *(RoleLatency(1.0, 0.0) for _ in range(4)))
PARK = "The image shows a park. In the foreground, on the left, there is a bench under a tree."
STREET = "The image shows a street. A road leads straight ahead. In the distance, there are two cars."
GARDEN = "The image shows a garden. A little further on, there is a fountain. Grass lies straight ahead."


def scenes_of(*texts: str, step: int = 0) -> list[Scene]:
    return [Scene(text, (step, 0, index), Pose(float(index), 0.0)) for index, text in enumerate(texts)]


@dataclass(frozen=True)
class Planned:
    """A plan, what it asked and how long it took, at one second a call."""

    plan: Plan
    ledger: Ledger
    seconds: float


def planned(
    make: Callable[[Minds], Planner], scenes: list[Scene], scripts: Scripts | None = None, *, seed: int = 7
) -> Planned:
    """Plan once, with scripted minds; without scripts with the embedded ones, which answer what the text says."""
    clock, ledger = VirtualClock(), Ledger()
    context = MindContext(clock, ONE_SECOND, ledger, seed)
    minds = replace(make_words_minds(context) if scripts is None else make_minds(context, scripts), seed=seed)

    async def mission() -> tuple[Plan, float]:
        plan = await make(minds).plan(GOAL, scenes)
        return plan, clock.now_s()

    plan, seconds = clock.run(mission())
    return Planned(plan, ledger, seconds)
