"""Small runs that the tests of the page look at, made as users make them; and a browser that counts what goes wrong."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.record_file import RecordWriter
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import open_world

SHORT = MissionSettings(explorer=ExplorerSettings(t_max_s=90.0))
MARKUP = '<img src=x onerror="document.title=1"><b>bold</b>'
CHROMIUM = Path("/usr/bin/chromium")


def bench_run(folder: Path) -> Path:
    """Four missions of a minute and a half for each of two planners, with their records."""
    split = make_split(
        "small", places_of_worlds(["park:5@300", "plaza:5@300"]), share=Share(), dealing=Dealing(3, time_limit_s=90.0)
    )
    split = replace(split, episodes=split.episodes[:2] + split.episodes[-2:])
    plan = BenchPlan(split, ("llm-rrt", "nearest-frontier"), base=SHORT)
    with RunStore.create(folder, plan, {}) as store:
        for task in plan.tasks():
            done = run_task(plan, task)
            store.add(task, done.row, trace=done.trace, wall_s=done.wall_s)
    return folder


def mission_of(folder: Path, goal: str = "Find me a bench") -> EpisodeRecord:
    """A mission in a world whose things have names full of markup, the world kept beside where its record goes."""
    world = open_world("plaza:3@200")
    named = tuple(replace(thing, attributes={**thing.attributes, "name": MARKUP}) for thing in world.objects)
    folder.mkdir(parents=True, exist_ok=True)
    save_world(replace(world, objects=named, attribution=MARKUP), folder / "world.rexworld")
    settings = replace(SHORT, planner="llm-rrt")
    return Mission(goal, open_world(str(folder / "world.rexworld")), settings).run().record


def write_record(folder: Path, record: EpisodeRecord) -> None:
    with RecordWriter(folder) as file:
        file.header(record.header)
        for step in record.steps:
            file.step(step)
        if record.summary is not None:
            file.summary(record.summary)


def full_of_markup(record: EpisodeRecord) -> EpisodeRecord:
    """The same mission, with markup wherever a model, a user or a map could have put text."""
    steps = tuple(
        replace(
            step,
            notes=(MARKUP,),
            views=tuple(
                replace(view, caption=MARKUP, evidence=MARKUP, plan_fault=MARKUP, check_fault=MARKUP)
                for view in step.views
            ),
            tree=tuple(replace(node, text=MARKUP) for node in step.tree),
            frontiers=tuple(replace(each, state="given up", reason=MARKUP) for each in step.frontiers),
        )
        for step in record.steps
    )
    goals = tuple((number, MARKUP, x, y, grade) for number, _, x, y, grade in record.header.goal_objects)
    header = replace(
        record.header, goal=MARKUP, planner=MARKUP, attribution=MARKUP, notes=(MARKUP,), goal_objects=goals
    )
    summary = None if record.summary is None else replace(record.summary, judge=MARKUP, reason=MARKUP)
    return EpisodeRecord(header, steps, summary)


@dataclass
class Tab:
    """A page of a real browser, and everything that went wrong in it."""

    page: Any
    url: str
    faults: list[str] = field(default_factory=list)
    strangers: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("console", lambda said: said.type == "error" and self.faults.append(f"console: {said.text}"))
        self.page.on("request", self._asked)

    def _asked(self, request: Any) -> None:
        if not request.url.startswith((self.url, "data:", "blob:")):
            self.strangers.append(request.url)

    def open(self, view: str = "#/") -> Any:
        """Open a view anew, and wait until it shows something."""
        self.page.goto("about:blank")
        self.page.goto(self.url + view)
        self.page.wait_for_selector("main > *")
        return self.page

    def wait(self, script: str, what: str, seconds: float = 20.0) -> None:
        """Wait until a script says true, looking again and again: the page's policy lets nobody else run scripts."""
        until = time.monotonic() + seconds
        while not self.page.evaluate(script):
            assert time.monotonic() < until, f"waited in vain: {what}"
            self.page.wait_for_timeout(50)


@contextmanager
def browser() -> Iterator[Any]:
    """A real browser, or a sentence that says what is missing."""
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="the page is not tested in a browser: pip install playwright"
    )
    if not CHROMIUM.exists():
        pytest.skip(f"the page is not tested in a browser: there is no {CHROMIUM} (apt-get install chromium)")
    with sync_api.sync_playwright() as play:
        made = play.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        try:
            yield made
        finally:
            made.close()
