"""Who does what in a mission, and everything that can be wrong with it before anything is made."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.clock import Clock, MixedClock, RealClock, VirtualClock
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.minds.context import MindContext
from reasoned_explorer.minds.latency import latency_profile
from reasoned_explorer.minds.registry import MINDS, check_roles, make_minds
from reasoned_explorer.model import Fault, Gathering, InputError, SettingsError, UnknownNameError
from reasoned_explorer.perception.registry import CAPTIONERS
from reasoned_explorer.planning import Planner
from reasoned_explorer.planning.registry import make_planner
from reasoned_explorer.simulation.painter import faults_of_pictures
from reasoned_explorer.task.judge import faults_of_radius
from reasoned_explorer.vehicles.registry import vehicle_profile

CLOCKS: Mapping[str, Callable[[], Clock]] = {"virtual": VirtualClock, "mixed": MixedClock, "real": RealClock}
#: Who carries a mission out: the method's agent, or the bound that knows the shortest compliant way.
AGENTS = ("explorer", "guide")
#: What the simulator's eyes go by, and what that means.
EYES: Mapping[str, str] = {
    "lines": "sight lines between outlines and heights",
    "pixels": "what has pixels in a picture of the view is seen",
}
#: Behind the label of a captioner whose eyes go by pixels.
THROUGH_PIXELS = " through pixels"
_MIND_ROLES = ("minds", "visionary", "evaluator", "checker")


@dataclass(frozen=True, slots=True)
class MissionSettings:
    """Who does what in a mission, by name, and how.

    Attributes:
        planner: A registered planner.
        planner_settings: Of that planner.
        minds: Registered minds, or a model such as ``openai:gpt-4o-mini``; they fill every role that has no name of its
            own.
        visionary: Who imagines.
        evaluator: Who scores.
        checker: Who notices the goal.
        captioner: A registered captioner, or a model that reads pictures such as ``hf:microsoft/kosmos-2-patch14-224``.
        vehicle: A registered vehicle profile.
        latency: A latency profile: how long modelled calls take.
        clock: ``virtual``, ``mixed`` or ``real``; where a model is called, one of the last two.
        explorer: How the agent explores.
        success_radius_m: R of the judge, metres, in [1, 50].
        seed: Of the mission: everything that is drawn is keyed by it; in [0, 2^64).
        agent: One of `AGENTS`; the guide asks no planner, mind or captioner.
        picture_px: Side of the pictures that are taken, pixels, in [16, 4096].
        conditions: Time of day and weather in them: ``clear``, ``overcast``, ``dusk``, ``fog`` or ``rain``.
        eyes: One of `EYES`: what simulated captioners know to be in a view.

    A planner may bring settings of the agent with it (`planning.Planner`); a mission's own ``settings`` are those that
    are in force. Names and numbers are checked by whoever uses them, together with the rest of its input (`errors_of`).
    """

    planner: str = "llm-rrt"
    planner_settings: Mapping[str, Any] = field(default_factory=dict)
    minds: str = "embedded"
    visionary: str | None = None
    evaluator: str | None = None
    checker: str | None = None
    captioner: str = "noisy"
    vehicle: str = "drone"
    latency: str = "gpt-2023"
    clock: str = "virtual"
    explorer: ExplorerSettings = field(default_factory=ExplorerSettings)
    success_radius_m: float = 15.0
    seed: int = 0
    agent: str = "explorer"
    picture_px: int = 448
    conditions: str = "clear"
    eyes: str = "pixels"


def errors_of(settings: MissionSettings) -> tuple[InputError, ...]:
    """Return everything that is wrong with a mission's settings: all names, all numbers, the planner's own settings.

    Nothing that takes long is made for it. One error says all that is wrong with one thing.
    """
    if not isinstance(settings, MissionSettings):
        return (SettingsError("mission settings", [Fault(f"{settings!r:.60}", "a value of type MissionSettings")]),)
    found = Gathering()
    faults = [
        Fault(f"{name} is {value!r:.60}", expected)
        for name, value, expected, sound in _typed(settings)
        if not sound(value)
    ]
    wrong = {fault.what.partition(" is ")[0] for fault in faults}
    if "success_radius_m" not in wrong:
        faults += faults_of_radius(settings.success_radius_m)
    faults += faults_of_pictures(settings.picture_px, settings.conditions)
    if faults:
        found.add(SettingsError("mission settings", faults))
    for name, check in _name_checks(settings):
        if name not in wrong:
            found.check(check)
    if not wrong & {"minds", "visionary", "evaluator", "checker"}:
        found.check(partial(check_roles, **minds_of(settings)))
        if not wrong & {"clock", "captioner"}:
            found.check(partial(_check_clock, settings))
    if not wrong & {"planner", "planner_settings", "explorer"}:
        found.check(lambda: with_overrides(settings.explorer, _planner_on_trial(settings)))
    return tuple(found.errors)


def minds_of(settings: MissionSettings) -> dict[str, str]:
    """Return who fills each role of a mind."""
    return {
        "visionary": settings.visionary or settings.minds,
        "evaluator": settings.evaluator or settings.minds,
        "checker": settings.checker or settings.minds,
    }


def _typed(settings: MissionSettings) -> list[tuple[str, Any, str, Callable[[Any], bool]]]:
    """Return each setting with what it must be."""

    def is_name(value: Any) -> bool:
        return isinstance(value, str)

    def is_whole(value: Any) -> bool:
        return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 64

    def is_number(value: Any) -> bool:
        return isinstance(value, int | float) and not isinstance(value, bool)

    names = ("planner", "minds", "captioner", "vehicle", "latency", "clock", "agent", "eyes")
    roles = ("visionary", "evaluator", "checker")
    rows: list[tuple[str, Any, str, Callable[[Any], bool]]] = [
        (name, getattr(settings, name), "a name", is_name) for name in names
    ]
    rows += [
        (name, getattr(settings, name), "a name or None", lambda value: value is None or is_name(value))
        for name in roles
    ]
    return [
        *rows,
        ("planner_settings", settings.planner_settings, "names with values", lambda v: isinstance(v, Mapping)),
        ("explorer", settings.explorer, "ExplorerSettings", lambda value: isinstance(value, ExplorerSettings)),
        ("success_radius_m", settings.success_radius_m, "metres", is_number),
        ("seed", settings.seed, "a whole number from 0 to 2^64 - 1", is_whole),
    ]


def _name_checks(settings: MissionSettings) -> list[tuple[str, Callable[[], object]]]:
    """Return what looks each name up, by the name's setting."""
    checks: list[tuple[str, Callable[[], object]]] = [
        (role, partial(_check_mind, name)) for role in _MIND_ROLES if (name := getattr(settings, role)) is not None
    ]
    return [
        *checks,
        ("captioner", partial(_check_captioner, settings.captioner)),
        ("vehicle", partial(vehicle_profile, settings.vehicle)),
        ("latency", partial(latency_profile, settings.latency)),
        ("clock", partial(_check_listed, "clock", settings.clock, tuple(CLOCKS))),
        ("agent", partial(_check_listed, "agent", settings.agent, AGENTS)),
        ("eyes", partial(_check_listed, "eyes", settings.eyes, tuple(EYES))),
    ]


def models_of(settings: MissionSettings) -> tuple[str, ...]:
    """Return the models that a mission calls, each once."""
    names = (*minds_of(settings).values(), settings.captioner)
    return tuple(dict.fromkeys(name for name in names if is_model_name(name)))


def _check_mind(name: str) -> None:
    if not is_model_name(name):
        MINDS.load(name)
    else:
        _check_model("minds", name)


def _check_model(role: str, name: str) -> None:
    if not name.partition(":")[2].strip():
        raise SettingsError(role, [Fault(f"{name!r}", "a model's name behind the colon, e.g. openai:gpt-4o-mini")])


def _check_captioner(name: str) -> None:
    if is_model_name(name):
        _check_model("captioner", name)
    else:
        CAPTIONERS.load(name)


def _check_clock(settings: MissionSettings) -> None:
    models = models_of(settings)
    if models and settings.clock == "virtual":
        fault = Fault(f"the clock virtual with {', '.join(models)}", "mixed or real", "a real call takes real seconds")
        raise SettingsError("clock", [fault])


def _check_listed(kind: str, name: str, known: tuple[str, ...]) -> None:
    if name not in known:
        raise UnknownNameError(kind, name, known)


def _planner_on_trial(settings: MissionSettings) -> Planner:
    """Return the planner with minds that answer from a script: whether its settings are sound shows when it is made."""
    context = MindContext(VirtualClock(), latency_profile("instant"), Ledger())
    return make_planner(settings.planner, make_minds(context, "scripted"), settings.planner_settings)


def with_overrides(settings: ExplorerSettings, planner: Planner) -> ExplorerSettings:
    """Return the agent's settings with those that belong to a planner.

    Raises:
        SettingsError: If the agent has no such settings, or their values are out of range.
    """
    overrides: Mapping[str, Any] = getattr(planner, "explorer", {})
    known = {each.name for each in fields(settings)}
    unknown = [Fault(f"no setting {key!r}", "a setting of the agent") for key in sorted(set(overrides) - known)]
    if unknown:
        raise SettingsError(f"agent settings of the planner {planner.name}", unknown)
    return replace(settings, **overrides)
