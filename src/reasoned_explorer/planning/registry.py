"""The planners by name."""

import inspect
from collections.abc import Callable, Mapping
from typing import Any

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.planning.llm_rrt import LlmRrt, LlmRrtSettings
from reasoned_explorer.planning.planner import Planner
from reasoned_explorer.planning.without_models import FollowPaths, NearestFrontier
from reasoned_explorer.registry import Entry, Registry

_HERE = "reasoned_explorer.planning.registry"

PLANNERS = Registry(
    "planner",
    "planners",
    (
        Entry("llm-rrt", f"{_HERE}:make_llm_rrt", "the paper's: imagined scenes beyond each frontier, scored"),
        Entry("llm-as-eval", f"{_HERE}:make_llm_as_eval", "the evaluator scores each frontier's scene itself (L = 0)"),
        Entry("nearest-frontier", f"{_HERE}:make_nearest_frontier", "no model: the nearest frontier"),
        Entry("follow-paths", f"{_HERE}:make_follow_paths", "no model: where paths and pavements lead"),
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
        raise SettingsError(
            f"settings of the planner {name}", [Fault(f"no setting {key!r}", f"one of: {known}") for key in unknown]
        )
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


def make_llm_as_eval(minds: Minds) -> Planner:
    """Return LLM-as-Eval (Chen et al., 2023; the paper's first baseline): LLM-RRT with L = 0."""
    return LlmRrt(minds, LlmRrtSettings(depth=0), name="llm-as-eval")


def make_nearest_frontier(minds: Minds) -> Planner:  # noqa: ARG001 - every factory is handed minds
    """Return the nearest-frontier planner."""
    return NearestFrontier()


def make_follow_paths(minds: Minds) -> Planner:  # noqa: ARG001
    """Return the follow-paths planner."""
    return FollowPaths()
