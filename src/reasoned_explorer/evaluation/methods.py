"""The rows of a table: which planner, whose minds in which role, and what is changed for a bound or a control.

A method is written as a planner's name, with settings of the planner behind a colon, minds of its own for visionary and
evaluator behind an ``@`` (one name for both, or two), and ``+perfect-halt`` at the end where the judge is to do the
halting: ``llm-rrt``, ``llm-rrt:depth=1``, ``llm-rrt@embedded/oracle``, ``llm-as-eval@openai:gpt-4o``,
``llm-rrt@openai:gpt-4o-mini/openai:gpt-4o``, ``follow-paths+perfect-halt``. Bounds have names of their own.
Whatever planner is registered, by this package or another, is a method.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.evaluation.mission_settings import MissionSettings, minds_of, models_of
from reasoned_explorer.minds.registry import MINDS, READ_THE_TRUTH
from reasoned_explorer.model import Fault, InputError, SettingsError, UnknownNameError
from reasoned_explorer.planning.registry import PLANNERS
from reasoned_explorer.planning.setting_pairs import parse_planner_settings

PERFECT_HALT = "perfect-halt"
_HALT_SUFFIX = f"+{PERFECT_HALT}"

#: The paper's method and its kin, what asks no model, and ours.
PLANNER_METHODS = (
    "llm-rrt",
    "llm-rrt-authors",
    "llm-mcts",
    "llm-as-eval",
    "nearest-frontier",
    "follow-paths",
    "object-density",
    "random",
    "fresh-ground",
)
CONTROL_METHODS = ("llm-rrt-echo", "llm-rrt-shuffled", "llm-as-eval-matched")
BOUND_METHODS = ("oracle", "foresight-30m", "foresight-60m")
#: What ``--planners`` takes instead of names.
GROUPS: Mapping[str, tuple[str, ...]] = {
    "planners": PLANNER_METHODS,
    "bounds": BOUND_METHODS,
    "controls": CONTROL_METHODS,
    "halts": tuple(f"{name}{_HALT_SUFFIX}" for name in PLANNER_METHODS),
    "default": (*PLANNER_METHODS, "oracle", "foresight-60m"),
    "all": (
        *PLANNER_METHODS,
        *CONTROL_METHODS,
        *BOUND_METHODS,
        *(f"{name}{_HALT_SUFFIX}" for name in PLANNER_METHODS),
    ),
}


@dataclass(frozen=True, slots=True)
class Method:
    """A row of a table.

    Attributes:
        name: As typed, e.g. ``"llm-rrt:depth=1+perfect-halt"``.
        planner: A registered planner.
        planner_settings: Of the planner.
        visionary: Mind of this role where the method fixes it, or None.
        evaluator: Likewise.
        checker: Likewise.
        agent: See `MissionSettings.agent`.
        is_bound: It reads the truth: no method that a robot could run.
    """

    name: str
    planner: str
    planner_settings: Mapping[str, Any] = field(default_factory=dict)
    visionary: str | None = None
    evaluator: str | None = None
    checker: str | None = None
    agent: str = "explorer"
    is_bound: bool = False

    def settings(self, base: MissionSettings) -> MissionSettings:
        """Return a mission's settings with this method's own put in."""
        return replace(
            base,
            planner=self.planner,
            planner_settings={**self.planner_settings},
            visionary=self.visionary or base.visionary,
            evaluator=self.evaluator or base.evaluator,
            checker=self.checker or base.checker,
            agent=self.agent,
        )


def method(name: str) -> Method:
    """Return the method that a name means.

    Raises:
        UnknownNameError: If there is no such planner or bound.
        SettingsError: If its settings cannot be read.
    """
    stem, halts = (name.removesuffix(_HALT_SUFFIX), PERFECT_HALT) if name.endswith(_HALT_SUFFIX) else (name, None)
    stem, at, roles = stem.partition("@")
    visionary, evaluator = _roles(roles)
    if at and not (visionary and evaluator):
        raise SettingsError(f"planner {name!r}", [Fault(f"minds {roles!r}", _ROLES_EXPECTED)])
    planner, colon, listed = stem.partition(":")
    settings = parse_planner_settings([pair for pair in listed.split(",") if pair]) if colon else {}
    if planner in BOUND_METHODS:
        if settings or halts or at:
            raise SettingsError(f"planner {name!r}", [Fault(f"{planner} with settings", "a bound as it is", planner)])
        if planner == "oracle":
            return Method(name, "nearest-frontier", agent="guide", is_bound=True)
        return Method(name, "llm-as-eval", evaluator=planner, is_bound=True)
    if planner not in PLANNERS.names():
        raise UnknownNameError("planner", planner, [*PLANNERS.names(), *BOUND_METHODS, *GROUPS])
    is_bound = not READ_THE_TRUTH.isdisjoint({visionary, evaluator, halts})
    return Method(name, planner, settings, visionary or None, evaluator or None, halts, is_bound=is_bound)


_ROLES_EXPECTED = "visionary/evaluator behind the @, or one name for both"


def _roles(text: str) -> tuple[str, str]:
    """Return visionary and evaluator of ``visionary/evaluator``, or of one name for both.

    Models' own names may hold slashes, too: what can be read as two names is two.
    """
    pairs = [(text[:at], text[at + 1 :]) for at, sign in enumerate(text) if sign == "/"]
    known = [pair for pair in pairs if all(is_model_name(name) or name in MINDS.names() for name in pair)]
    if not known and (is_model_name(text) or not pairs):
        return text, text
    return known[0] if known else pairs[0]


def methods(names: Sequence[str]) -> tuple[Method, ...]:
    """Return the methods that names and groups of names mean, each once, in order.

    Raises:
        InputError: If names cannot be read, with all of these, or there is none.
    """
    found, faults = _read(names)
    if faults:
        raise InputError("planners", faults)
    return found


def models_called(names: Sequence[str], base: MissionSettings) -> tuple[str, ...]:
    """Return the models that missions of methods call, each once.

    Args:
        names: Methods that can be read.
        base: Who does what where a method does not say otherwise.
    """
    called = (models_of(method(name).settings(base)) for name in names)
    return tuple(dict.fromkeys(model for models in called for model in models))


def minds_called(names: Sequence[str], base: MissionSettings) -> tuple[str, ...]:
    """Return those of `models_called` that are minds, whether they are captioners, too, or not."""
    minds = (mind for name in names for mind in minds_of(method(name).settings(base)).values())
    return tuple(dict.fromkeys(mind for mind in minds if is_model_name(mind)))


def sound_methods(names: Sequence[str]) -> tuple[Method, ...]:
    """Return those of the methods that can be read: what else is wrong with them can be told beside what cannot."""
    return _read(names)[0]


def _read(names: Sequence[str]) -> tuple[tuple[Method, ...], list[Fault]]:
    listed = list(dict.fromkeys(single for name in names for single in GROUPS.get(name, (name,))))
    found: list[Method] = []
    faults: list[Fault] = []
    for name in listed:
        try:
            found.append(method(name))
        except UnknownNameError as error:
            faults += error.faults
        except InputError as error:
            faults += [replace(fault, what=f"{name}: {fault.what}") for fault in error.faults]
    if not listed:
        faults.append(Fault("no planner", f"at least one of {', '.join((*GROUPS, *PLANNERS.names()))}"))
    return tuple(found), faults
