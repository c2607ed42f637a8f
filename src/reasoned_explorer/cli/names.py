"""``rex names``."""

from rich.console import Console

from reasoned_explorer.cli.console import Output
from reasoned_explorer.minds import LATENCY_PROFILES, latency_profile
from reasoned_explorer.minds.registry import MINDS
from reasoned_explorer.perception.registry import CAPTIONERS
from reasoned_explorer.planning.registry import PLANNERS
from reasoned_explorer.registry import Entry, Registry
from reasoned_explorer.vehicles.registry import VEHICLES
from reasoned_explorer.world.generator import DISTRICTS
from reasoned_explorer.world.opening import WORLDS


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
    districts = tuple(Entry(name, "", summary) for name, summary in DISTRICTS.items())
    _print(console, "worlds", (*districts, *WORLDS.entries()))
    _print(
        console, "latency profiles", tuple(Entry(name, "", latency_profile(name).label) for name in LATENCY_PROFILES)
    )


def _print(console: Console, title: str, entries: tuple[Entry, ...]) -> None:
    console.print(title, style="bold")
    for entry in entries:
        console.print(f"  {entry.name:18s} {entry.summary}", markup=False, soft_wrap=True)
