"""The planners by name."""

import inspect
from collections.abc import Callable, Mapping
from typing import Any

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.model import Fault, InputError, SettingsError
from reasoned_explorer.planning.controls import LlmAsEvalMatched, echoing, shuffling
from reasoned_explorer.planning.fresh_ground import FreshGround, FreshGroundSettings
from reasoned_explorer.planning.llm_mcts import LlmMcts, LlmMctsSettings
from reasoned_explorer.planning.llm_rrt import LlmRrt, LlmRrtSettings
from reasoned_explorer.planning.planner import Planner
from reasoned_explorer.planning.without_models import FollowPaths, NearestFrontier, ObjectDensity, RandomFrontier
from reasoned_explorer.registry import Entry, Registry

_HERE = "reasoned_explorer.planning.registry"

PLANNERS = Registry(
    "planner",
    "planners",
    (
        Entry("llm-rrt", f"{_HERE}:make_llm_rrt", "the paper's: imagined scenes beyond each frontier, scored"),
        Entry(
            "llm-rrt-authors",
            f"{_HERE}:make_llm_rrt_authors",
            "the authors' code: rollouts restart, checks afterwards one by one, straight legs",
        ),
        Entry("llm-mcts", f"{_HERE}:make_llm_mcts", "the paper's second baseline: tree search, call after call"),
        Entry("llm-as-eval", f"{_HERE}:make_llm_as_eval", "the evaluator scores each frontier's scene itself (L = 0)"),
        Entry("nearest-frontier", f"{_HERE}:make_nearest_frontier", "no model: the nearest frontier"),
        Entry("follow-paths", f"{_HERE}:make_follow_paths", "no model: where paths and pavements lead"),
        Entry("object-density", f"{_HERE}:make_object_density", "no model: where most things stand close together"),
        Entry("random", f"{_HERE}:make_random", "no model: a frontier by chance"),
        Entry(
            "fresh-ground",
            f"{_HERE}:make_fresh_ground",
            "ours: llm-as-eval that looks around and prefers new ground unless the thing is in sight",
        ),
        Entry("llm-rrt-echo", f"{_HERE}:make_llm_rrt_echo", "control: llm-rrt, what is imagined is what is seen"),
        Entry("llm-rrt-shuffled", f"{_HERE}:make_llm_rrt_shuffled", "control: llm-rrt, imagined from another view"),
        Entry(
            "llm-as-eval-matched",
            f"{_HERE}:make_llm_as_eval_matched",
            "control: llm-as-eval, each scene scored as often as llm-rrt scores",
        ),
    ),
)


def make_planner(name: str, minds: Minds, settings: Mapping[str, Any] | None = None) -> Planner:
    """Return the planner that is registered under a name.

    A planner's factory is called as ``factory(minds, **settings)``.

    Raises:
        UnknownNameError: If there is no such planner.
        SettingsError: If it has no such settings, or their values are out of range.
    """
    factory = PLANNERS.load(name)
    given = dict(settings or {})
    unknown = _unknown_settings(factory, given)
    if unknown:
        known = ", ".join(_settings_of(factory)) or "none"
        faults = [Fault(f"no setting {key!r}", f"one of: {known}") for key in unknown]
        try:
            factory(minds, **{key: value for key, value in given.items() if key not in unknown})
        except InputError as error:
            faults += error.faults
        raise SettingsError(f"settings of the planner {name}", faults)
    planner: Planner = factory(minds, **given)
    return planner


def _settings_of(factory: Callable[..., Any]) -> list[str]:
    return list(inspect.signature(factory).parameters)[1:]


def _unknown_settings(factory: Callable[..., Any], given: Mapping[str, Any]) -> list[str]:
    parameters = inspect.signature(factory).parameters.values()
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return []
    return sorted(set(given) - set(_settings_of(factory)))


def make_llm_rrt(
    minds: Minds,
    *,
    children: int = 3,
    depth: int = 2,
    include_own_score: bool = False,
    depth_weight: float = 1.0,
    restart: bool = False,
) -> Planner:
    """Return LLM-RRT; the settings are those of `LlmRrtSettings`."""
    return LlmRrt(minds, LlmRrtSettings(children, depth, include_own_score, depth_weight, restart))


def make_llm_rrt_authors(minds: Minds, *, children: int = 3, depth: int = 2) -> Planner:
    """Return LLM-RRT as the authors published it (their code at commit 868d1be), as far as a planner reaches.

    A rollout begins where the one before began instead of where it ended; the checker is asked when planning is over,
    one view after the other; a remote frontier is flown to straight. Their tree of length 1 has an expansion and one
    rollout for each child: depth 2 here, where nothing restarts yet and the tree is LLM-RRT's.
    """
    settings = LlmRrtSettings(children, depth, restart=True)
    agent = {"check_after_planning": True, "straight_legs": True}
    return LlmRrt(minds, settings, name="llm-rrt-authors", explorer=agent)


def make_llm_mcts(
    minds: Minds,
    *,
    iterations: int = 10,
    children: int = 3,
    depth: int = 3,
    exploration: float = 1.0,
    visit_power: float = 3.0,
) -> Planner:
    """Return LLM-MCTS; the settings are those of `LlmMctsSettings`."""
    return LlmMcts(minds, LlmMctsSettings(iterations, children, depth, exploration, visit_power))


def make_llm_as_eval(minds: Minds) -> Planner:
    """Return LLM-as-Eval (Chen et al., 2023; the paper's first baseline): LLM-RRT with L = 0."""
    return LlmRrt(minds, LlmRrtSettings(depth=0), name="llm-as-eval")


def make_nearest_frontier(minds: Minds) -> Planner:  # noqa: ARG001 - every factory is handed minds
    """Return the nearest-frontier planner."""
    return NearestFrontier()


def make_follow_paths(minds: Minds) -> Planner:  # noqa: ARG001
    """Return the follow-paths planner."""
    return FollowPaths()


def make_object_density(minds: Minds) -> Planner:  # noqa: ARG001
    """Return the object-density planner."""
    return ObjectDensity()


def make_random(minds: Minds) -> Planner:
    """Return the random planner; it draws by the minds' seed."""
    return RandomFrontier(minds)


def make_fresh_ground(
    minds: Minds,
    *,
    hint: float = 0.4,
    known_radius_m: float = 25.0,
    step_max_m: float = 30.0,
    views: int = 5,
) -> Planner:
    """Return Fresh-Ground; the settings are those of `FreshGroundSettings`."""
    return FreshGround(minds, FreshGroundSettings(hint, known_radius_m, step_max_m, views))


def make_llm_rrt_echo(minds: Minds, *, children: int = 3, depth: int = 2) -> Planner:
    """Return LLM-RRT with a visionary that echoes; see `EchoVisionary`."""
    return LlmRrt(echoing(minds), LlmRrtSettings(children, depth), name="llm-rrt-echo")


def make_llm_rrt_shuffled(minds: Minds, *, children: int = 3, depth: int = 2) -> Planner:
    """Return LLM-RRT with a visionary whose answers belong to other views; see `ShuffledVisionary`."""
    return LlmRrt(shuffling(minds), LlmRrtSettings(children, depth), name="llm-rrt-shuffled")


def make_llm_as_eval_matched(minds: Minds, *, children: int = 3, depth: int = 2) -> Planner:
    """Return LLM-as-Eval with as many evaluator calls as LLM-RRT of these settings has."""
    return LlmAsEvalMatched(minds, LlmRrtSettings(children, depth))
