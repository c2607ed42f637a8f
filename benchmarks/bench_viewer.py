"""How fast the page is: opening a run of 10,000 missions, filtering it, and dragging through a mission of 150 steps.

Run ``python benchmarks/bench_viewer.py``. The runs are made here: the list is that of a run's store with 10,000 rows,
the mission one of 150 steps with as many views and imagined scenes as the planner makes. The browser is Chromium, which
Playwright drives; frames are counted by ``requestAnimationFrame`` in the page while the pointer drags through the whole
time line. The page and the browser share this machine's processors.
"""

import argparse
import tempfile
import threading
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

from playwright.sync_api import sync_playwright

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.record_file import RecordWriter
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord, StepRecord
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds
from reasoned_explorer.viewer.app import create_app, guarded
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from reasoned_explorer.world.opening import open_world

#: What is promised.
MISSIONS, OPENING_S, STEPS, PICTURES_PER_S = 10_000, 1.0, 150, 30.0
#: How long a drag through the time line takes, seconds: a flick, and a look.
DRAGS_S = (1.0, 4.0)
_DRAG = """(seconds) => new Promise((done) => {
  const strip = document.querySelector('.strip');
  const box = strip.getBoundingClientRect();
  const captured = [strip.setPointerCapture, strip.hasPointerCapture];
  strip.setPointerCapture = () => {};
  strip.hasPointerCapture = () => true;
  const move = (kind, share) => strip.dispatchEvent(new PointerEvent(kind, {
    clientX: box.left + box.width * Math.min(1, share), clientY: box.top + 5, pointerId: 1, bubbles: true }));
  const gaps = [];
  move('pointerdown', 0);
  let start = null, before = null;
  const frame = (now) => {
    start ??= now;
    if (before !== null) gaps.push(now - before);
    before = now;
    const share = (now - start) / 1000 / seconds;
    move('pointermove', share);
    if (share < 1) requestAnimationFrame(frame);
    else {
      [strip.setPointerCapture, strip.hasPointerCapture] = captured;
      const sum = gaps.reduce((a, b) => a + b, 0);
      done([1000 * gaps.length / sum, Math.max(...gaps)]);
    }
  };
  requestAnimationFrame(frame);
})"""
_SHOWN = "Number(document.querySelector('.strip').getAttribute('aria-valuenow'))"


def make_list(folder: Path, count: int) -> None:
    """Leave a run of so many missions: real rows of one place, each under many names."""
    places = places_of_worlds(["park:5@300", "plaza:5@300"])
    split = make_split("many", places, share=Share(), dealing=Dealing(3, time_limit_s=60.0))
    settings = MissionSettings(explorer=ExplorerSettings(t_max_s=60.0))
    plan = BenchPlan(replace(split, episodes=split.episodes[:4]), ("nearest-frontier", "random"), base=settings)
    rows = [(task, MissionRow.from_json(str(run_task(plan, task).row))) for task in plan.tasks()]
    with RunStore.create(folder, plan, {}) as store:
        for number in range(count):
            task, row = rows[number % len(rows)]
            name = f"{row.mission_id}/{number // len(rows)}"
            line = replace(row, mission_id=name).as_json()
            store.add(replace(task, mission_id=name), line, trace=None, wall_s=0.0)


def make_mission(folder: Path, steps: int) -> None:
    """Leave a mission of so many steps: a real one whose steps go on from each other until there are enough."""
    settings = MissionSettings(planner="llm-rrt", explorer=ExplorerSettings(t_max_s=1800.0))
    record = Mission("Find me a church", open_world("park:5@500"), settings).run().record
    with RecordWriter(folder) as file:
        file.header(record.header)
        for step in _longer(record, steps):
            file.step(step)
        if record.summary is not None:
            file.summary(replace(record.summary, steps=steps))


def _longer(record: EpisodeRecord, count: int) -> list[StepRecord]:
    """Return so many steps; those of the record are gone through again, later and under new numbers."""
    made: list[StepRecord] = []
    length_s = record.steps[-1].ended_s
    for number in range(count):
        turn, place = divmod(number, len(record.steps))
        step, later_s = record.steps[place], turn * length_s
        legs = tuple(
            replace(leg, track=tuple(replace(point, t_s=point.t_s + later_s) for point in leg.track))
            for leg in step.legs
        )
        frontiers = tuple(replace(each, id=each.id + turn * 10_000) for each in step.frontiers)
        made.append(
            replace(
                step,
                step=number,
                started_s=step.started_s + later_s,
                ended_s=step.ended_s + later_s,
                legs=legs,
                frontiers=frontiers,
                choice=step.choice and replace(step.choice, frontier=step.choice.frontier + turn * 10_000),
            )
        )
    return made


def opening_s(page: Any, url: str) -> float:
    """Return the seconds from asking for the address to the frame with rows, as the page's own clock tells them."""
    page.goto("about:blank")
    page.goto(url, wait_until="commit")
    page.wait_for_selector(".rows .line", state="attached")
    page.wait_for_timeout(300)
    return float(page.evaluate("performance.getEntriesByName('rows-shown')[0].startTime")) / 1000.0


def filter_s(page: Any) -> float:
    """Return the seconds from a typed letter to the filtered rows."""
    page.fill("input[type=search]", "")
    page.wait_for_timeout(200)
    script = """() => new Promise((done) => {
      const box = document.querySelector('input[type=search]');
      const start = performance.now();
      box.value = 'park';
      box.dispatchEvent(new Event('input', { bubbles: true }));
      requestAnimationFrame(() => setTimeout(() => done((performance.now() - start) / 1000)));
    })"""
    return float(page.evaluate(script))


def drag(page: Any, seconds: float) -> tuple[float, float]:
    """Drag through the whole time line; return pictures a second and the longest gap, ms.

    The pointer is moved in the page with each of its frames: over the wire it would be the wire that is measured.
    """
    rate, worst_ms = page.evaluate(_DRAG, seconds)
    return float(rate), float(worst_ms)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=MISSIONS)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--runs", type=int, default=5, help="how often the list is opened")
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_list(folder / "list", given.missions)
        make_mission(folder / "missions" / "long", given.steps)
        guard = Guard()
        library = Library(folder)
        # As ``rex view`` does: runs are read while somebody reaches for the browser.
        threading.Thread(target=library.read_ahead, daemon=True).start()
        with Server(guarded(create_app(library, guard=guard), guard)) as server, sync_playwright() as play:
            browser = play.chromium.launch(executable_path=given.chromium, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 720})
            _measure(page, server.url, given.runs)
            browser.close()


def _measure(page: Any, url: str, runs: int) -> None:
    page.goto(url)
    page.wait_for_selector("a.run")
    links = page.locator("a.run").evaluate_all(
        "links => links.map(link => [link.textContent, link.getAttribute('href')])"
    )
    listed = next(href for text, href in links if text.startswith("list"))
    alone = next(href for text, href in links if not text.startswith("list"))
    times = [opening_s(page, url + listed) for _ in range(runs)]
    count = page.inner_text("output.count")
    first, rest = times[0], median(times[1:] or times)
    print(f"{count}: first opening {first:.2f} s, then {rest:.2f} s (median); target {OPENING_S:g} s")
    print(f"filter as one types: {1000.0 * median(filter_s(page) for _ in range(5)):.0f} ms")
    page.goto("about:blank")
    page.goto(url + alone)
    page.wait_for_selector(".rows .line")
    page.click(".rows .line")
    page.wait_for_selector(".step-words")
    page.wait_for_timeout(1500)
    said = page.inner_text(".step-head h2")
    for seconds in DRAGS_S:
        rate, worst_ms = drag(page, seconds)
        page.wait_for_timeout(200)
        print(
            f"{said}, dragged through in {seconds:g} s: {rate:.0f} pictures/s, longest gap {worst_ms:.0f} ms, "
            f"end at {page.evaluate(_SHOWN):.0f} s of mission time; target {PICTURES_PER_S:g} pictures/s"
        )


if __name__ == "__main__":
    main()
