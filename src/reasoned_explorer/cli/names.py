"""``rex names``."""

from rich.console import Console

from reasoned_explorer.cli.console import Output
from reasoned_explorer.evaluation.methods import GROUPS, PLANNER_METHODS
from reasoned_explorer.evaluation.mission_settings import EYES
from reasoned_explorer.minds import LATENCY_PROFILES, latency_profile
from reasoned_explorer.minds.registry import MINDS
from reasoned_explorer.perception.registry import CAPTIONERS
from reasoned_explorer.planning.registry import PLANNERS
from reasoned_explorer.registry import Entry, Registry
from reasoned_explorer.vehicles.registry import VEHICLES
from reasoned_explorer.world.generator import DISTRICTS
from reasoned_explorer.world.opening import WORLDS

_ROWS = (
    Entry("oracle", "", "a bound: goes the shortest compliant way and stops"),
    Entry("foresight-30m", "", "a bound: imagines perfectly what lies 30 m beyond each frontier"),
    Entry("foresight-60m", "", "likewise, 60 m"),
    Entry("X+perfect-halt", "", "a bound: planner X with the judge in the checker's place"),
    Entry("X:depth=1", "", "planner X with settings of its own"),
    Entry("X@A/B", "", "planner X with A as visionary and B as evaluator, e.g. llm-rrt@openai:small/openai:large"),
    Entry("X@A", "", "planner X with A as both, e.g. llm-as-eval@openai:large, which needs no visionary"),
)
_MODEL_FORMS = (
    Entry("openai:MODEL", "", "a language model behind an OpenAI-compatible endpoint (--base-url)"),
    Entry("hf:NAME", "", "a language model on this machine: a name on the Hugging Face hub, or a folder"),
)
_WORLD_FORMS = (
    Entry("X:7@600", "", "district X from seed 7, 600 m across"),
    Entry("X.osm.pbf", "", "a real place: .osm, .osm.gz, .osm.bz2, .osm.pbf; or a kept world: .rexworld"),
    Entry("X~permuted:1", "", "any of these, who stands where dealt anew by seed 1: a control"),
)


def _shown(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of a group; planners of which it has all are not named once more."""
    if names == GROUPS["halts"]:
        return ("each of planners with +perfect-halt",)
    if set(PLANNER_METHODS) < set(names):
        of = [group for group in ("planners", "bounds", "controls", "halts") if set(GROUPS[group]) <= set(names)]
        return (f"{' + '.join(of)}",)
    return names


def print_names() -> None:
    """Print every registered name with its summary, and who brought it."""
    console = Output()
    registries: tuple[tuple[str, Registry], ...] = (
        ("planners", PLANNERS),
        ("minds", MINDS),
        ("captioners", CAPTIONERS),
        ("vehicles", VEHICLES),
    )
    for title, registry in registries:
        _print(console, title, registry.entries())
        if registry is PLANNERS:
            _print(console, "rows of rex bench --planners beside these", _ROWS)
            groups = tuple(Entry(name, "", ", ".join(_shown(names))) for name, names in GROUPS.items())
            _print(console, "groups of rex bench --planners", groups)
        if registry is MINDS:
            _print(console, "models as minds", _MODEL_FORMS)
    _print(console, "eyes", tuple(Entry(name, "", summary) for name, summary in EYES.items()))
    districts = tuple(Entry(name, "", summary) for name, summary in DISTRICTS.items())
    _print(console, "worlds", (*districts, *WORLDS.entries(), *_WORLD_FORMS))
    _print(
        console, "latency profiles", tuple(Entry(name, "", latency_profile(name).label) for name in LATENCY_PROFILES)
    )


def _print(console: Console, title: str, entries: tuple[Entry, ...]) -> None:
    console.print(title, style="bold")
    for entry in entries:
        console.print(f"  {entry.name:18s} {entry.summary}", markup=False, soft_wrap=True)
