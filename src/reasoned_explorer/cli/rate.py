"""``rex rate``."""

import secrets
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.parsing import parse_levels, parse_planners
from reasoned_explorer.cli.view import PageOptions, serve_until_stopped
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.ratings import RatingStore, rater_name
from reasoned_explorer.model import Fault, Gathering, SettingsError
from reasoned_explorer.viewer.rating_desk import Choice, RatingDesk
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import import_web


@dataclass(frozen=True, slots=True)
class RateOptions:
    """What a person typed; see ``rex rate --help``."""

    rater: str | None = None
    seed: int = 0
    methods: str = ""
    levels: str = ""
    count: int | None = None
    declared: bool = False
    page: PageOptions = field(default_factory=PageOptions)

    def checked(self, run: Path) -> tuple[str | None, Choice, Guard]:
        """Return who rates, which missions, and the page's guard.

        Raises:
            InputError: With everything that is wrong.
        """
        found = Gathering()
        with RunStore.read(run) as store:
            known = store.plan.methods
        methods = tuple(parse_planners(self.methods))
        none: tuple[int, ...] = ()
        levels = found.take(lambda: parse_levels(self.levels), none)
        faults = [Fault(name, f"one of {', '.join(known)}") for name in methods if name not in known]
        if faults:
            found.add(SettingsError("--methods", faults))
        if self.count is not None and self.count < 1:
            found.add(SettingsError("--count", [Fault(f"{self.count}", "at least 1")]))
        name = self.rater
        rater = None if name is None else found.take(lambda: rater_name(name), None)
        guard = found.take(self.page.guard, Guard())
        found.finish("rex rate")
        return rater, Choice(methods, levels, self.count, self.declared), guard


def rate_run(run: Path, options: RateOptions) -> None:
    """Serve the page on which people judge the missions of a run, until a person ends it.

    Raises:
        InputError: If an option is wrong, or the run has nothing to rate or cannot be written to.
        MissingDependencyError: If the extra ``view`` is not installed.
        KeyboardInterrupt: When a person ends it.
    """
    rater, choice, guard = options.checked(run)
    import_web("fastapi")
    from reasoned_explorer.viewer.app import guarded
    from reasoned_explorer.viewer.rating_routes import create_rating_app

    with RatingStore(run) as store:
        desk = RatingDesk(
            store, now=lambda: datetime.now(UTC), secret=secrets.token_bytes(32), seed=options.seed, choice=choice
        )
        if desk.left_out:
            said = f"{desk.left_out:,} missions are left out: their records were not kept"
            Output().print(said, markup=False, soft_wrap=True)
        app = guarded(create_rating_app(desk, guard=guard, rater=rater), guard)
        serve_until_stopped(app, guard, options.page, lambda url: f"{desk.count:,} missions are rated at {url}")
