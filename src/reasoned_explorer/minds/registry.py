"""Minds by name, and how roles of different names are put together."""

from collections.abc import Mapping
from dataclasses import replace

from reasoned_explorer.calls.chat import MODEL_FORMS, is_model_name
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.registry import Entry, Registry

#: Every mind that there is. A factory is called with a `MindContext` and returns `Minds`.
MINDS = Registry(
    "mind",
    "minds",
    (
        Entry(
            "embedded",
            "reasoned_explorer.minds.embedded:make_minds",
            "a stand-in without a language model: words, lexicon, place statistics, MiniLM where present",
        ),
        Entry(
            "embedded-words",
            "reasoned_explorer.minds.embedded:make_words_minds",
            "the embedded minds without MiniLM, present or not",
        ),
        Entry(
            "embedded-unknowing",
            "reasoned_explorer.minds.embedded:make_unknowing_minds",
            "the embedded minds without knowledge of places: what they lack is the advantage of knowledge",
        ),
        Entry("scripted", "reasoned_explorer.minds.scripted:make_minds", "answers from rules, for tests"),
        Entry("oracle", "reasoned_explorer.evaluation.oracle:make_minds", "reads the truth: an upper bound, no method"),
        Entry(
            "foresight-30m",
            "reasoned_explorer.evaluation.privileged:make_foresight_30m",
            "an evaluator that knows the way within 30 m beyond each frontier, else footpaths: a bound, no method",
        ),
        Entry(
            "foresight-60m",
            "reasoned_explorer.evaluation.privileged:make_foresight_60m",
            "likewise, 60 m",
        ),
        Entry(
            "perfect-halt",
            "reasoned_explorer.evaluation.privileged:make_perfect_halt",
            "a checker that the judge agrees with, in an ordinary checker's time: a bound, no method",
        ),
    ),
    beside=MODEL_FORMS,
)

#: Minds that fill some roles only; asked in another they answer with a fault. All others fill all.
ROLES_OF: Mapping[str, tuple[str, ...]] = {
    "foresight-30m": ("evaluator",),
    "foresight-60m": ("evaluator",),
    "perfect-halt": ("checker",),
}
#: Minds that read the truth: what they take part in is a bound, no method.
READ_THE_TRUTH = frozenset({"oracle", *ROLES_OF})


def check_roles(*, visionary: str, evaluator: str, checker: str) -> None:
    """Check that each role has a mind that fills it; whether there are such minds is for whoever makes them.

    Raises:
        SettingsError: With every role that would not be filled.
    """
    faults = [
        Fault(
            f"{name} as {role}",
            "a mind that fills that role",
            f"{name} is {' and '.join(ROLES_OF[name])} only: name the {role}, e.g. embedded",
        )
        for role, name in (("visionary", visionary), ("evaluator", evaluator), ("checker", checker))
        if role not in ROLES_OF.get(name, (role,))
    ]
    if faults:
        raise SettingsError("minds", faults)


def make_minds(
    context: MindContext,
    minds: str = "embedded",
    *,
    visionary: str | None = None,
    evaluator: str | None = None,
    checker: str | None = None,
) -> Minds:
    """Return minds by name, each role from a name of its own where one is given.

    Args:
        context: What they are made with.
        minds: Fills every role that is not named.
        visionary: Fills this role.
        evaluator: Likewise.
        checker: Likewise.

    Raises:
        UnknownNameError: If a name is not registered.
        SettingsError: If a model is named where none can be called.
    """
    names = {"evaluator": evaluator or minds, "visionary": visionary or minds, "checker": checker or minds}
    made: dict[str, Minds] = {}
    for name in names.values():
        if name not in made:
            made[name] = _of_model(name, context) if is_model_name(name) else MINDS.load(name)(context)
    if len(made) == 1:
        return replace(made[names["evaluator"]], seed=context.seed)
    label = ", ".join(f"{role}: {made[name].label}" for role, name in names.items())
    return Minds(
        label=label,
        evaluator=made[names["evaluator"]].evaluator,
        visionary=made[names["visionary"]].visionary,
        checker=made[names["checker"]].checker,
        seed=context.seed,
    )


def _of_model(name: str, context: MindContext) -> Minds:
    if context.model_minds is None:
        raise SettingsError("minds", [Fault(f"{name} where no model can be called", "registered minds")])
    return context.model_minds(name)
