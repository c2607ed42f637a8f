"""Compare planners on the same missions: who finds what, how fast, and how the others end.

Samples episodes of levels 1 to 4 in each world, runs every method on the same episodes, and prints tables with 95 %
intervals, paired differences to the first method, and ways of ending. The same arguments print the same tables,
whatever ``--jobs`` is. Time is modelled (see ``--latency``); no result here is of a language model unless its label
says so.

A method is ``PLANNER``, ``PLANNER/MINDS`` or ``PLANNER/MINDS/CHECKER``: ``llm-rrt/oracle`` is the upper bound (the
oracle knows the world), ``llm-rrt/embedded/oracle`` searches with the embedded minds and halts by the truth.

A world is a name from the table of places below, or anything that ``rex run --world`` takes (``park:7@400``, a file),
a file optionally with ``#lon0,lat0,lon1,lat1`` behind it. Munich and Helsinki are what the embedded minds' statistics
and the generator were fitted to: they are no places to test in.

Examples::

    python benchmarks/compare_planners.py --worlds uvic monaco-port --count 40
    python benchmarks/compare_planners.py --worlds park:11@400 campus:11@400 --planners llm-rrt nearest-frontier
    python benchmarks/compare_planners.py --worlds uvic --count 40 --rows rows.jsonl    # keep one line per mission
    python benchmarks/compare_planners.py --from rows.jsonl                             # the tables again
"""

import argparse
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from reasoned_explorer.evaluation.metrics import MetricTable, by_level, compare
from reasoned_explorer.evaluation.mission import Mission, MissionSettings, traveller_of
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.model import LegOutcome
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.model.errors import ReasonedExplorerError
from reasoned_explorer.task.episode import Episode
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

OSM = Path(__file__).resolve().parents[1] / ".." / "shared" / "osm"
#: Neighbourhoods of the places that development is measured on: file, and lon0, lat0, lon1, lat1 in degrees.
PLACES = {
    "uvic": ("uvic-campus.osm.pbf", (-123.3165, 48.4602, -123.3077, 48.4661)),
    "monaco-port": ("monaco-2025.osm.pbf", (7.4140, 43.7290, 7.4250, 43.7365)),
    "monte-carlo": ("monaco-2025.osm.pbf", (7.4215, 43.7365, 7.4325, 43.7445)),
    "fontvieille": ("monaco-2025.osm.pbf", (7.4090, 43.7235, 7.4200, 43.7310)),
}
METHODS = ("llm-rrt", "llm-as-eval", "nearest-frontier", "follow-paths", "llm-rrt/oracle")
SHOWN = ("SR", "OSR", "SPL", "CASR", "CASR per mission", "CASR paper-style")
DIFFERENCES = ("SR", "OSR", "SPL", "CASR", "CASR per mission")


@dataclass(frozen=True, slots=True)
class Row:
    """One mission of one method; one line of a file of rows."""

    method: str
    place: str
    episode: str
    goal: str
    seed: int
    minds: str
    captioner: str
    ct_label: str
    attribution: str
    end: str
    reason: str
    judge: str
    declared: bool
    steps: int
    collisions: int
    understood: tuple[str, ...]
    score: dict[str, Any]

    @property
    def scored(self) -> MissionScore:
        """Its metrics."""
        plain = dict(self.score)
        plain["success_at"] = tuple((float(radius_m), bool(hit)) for radius_m, hit in plain["success_at"])
        for name in ("reference_length_m", "distance_to_goal_m"):
            plain[name] = math.inf if plain[name] is None else plain[name]
        return MissionScore(**plain)

    def as_json(self) -> str:
        """Return the line."""
        return json.dumps(asdict(self), sort_keys=True, allow_nan=False)


def plain_score(score: MissionScore) -> dict[str, Any]:
    """Return a score as JSON can keep it: what is infinite becomes None."""
    return {
        name: None if isinstance(value, float) and math.isinf(value) else value for name, value in asdict(score).items()
    }


def open_place(place: str) -> Atlas:
    """Return the atlas of a place by what was typed."""
    if place in PLACES:
        name, box = PLACES[place]
        return Atlas(open_world(str(OSM / name), bbox=box))
    file, _, sides = place.partition("#")
    if not sides:
        return Atlas(open_world(place))
    lon0, lat0, lon1, lat1 = (float(side) for side in sides.split(","))
    return Atlas(open_world(file, bbox=(lon0, lat0, lon1, lat1)))


def settings_of(method: str, options: argparse.Namespace, seed: int) -> MissionSettings:
    """Return who does what in a mission of a method."""
    planner, minds, checker = (*method.split("/"), "", "")[:3]
    return MissionSettings(
        planner=planner,
        minds=minds or options.minds,
        checker=checker or None,
        captioner=options.captioner,
        vehicle=options.vehicle,
        latency=options.latency,
        seed=seed,
    )


def run_episode(atlas: Atlas, place: str, episode: Episode, method: str, options: argparse.Namespace) -> Row:
    """Run one mission."""
    settings = settings_of(method, options, episode.seed)
    mission = Mission(episode.spec.text, atlas, settings, start=episode.start)
    folder = options.records / method.replace("/", "_") / episode.id.replace("/", "_") if options.records else None
    result = mission.run(folder=folder)
    header, summary, steps = result.record.header, result.summary, result.record.steps
    return Row(
        method=method,
        place=place,
        episode=episode.id,
        goal=episode.spec.text,
        seed=episode.seed,
        minds=header.minds,
        captioner=header.captioner,
        ct_label=header.ct_label,
        attribution=header.attribution,
        end=summary.end.value,
        reason=summary.reason,
        judge=summary.judge,
        declared=summary.declared,
        steps=summary.steps,
        collisions=sum(leg.outcome is LegOutcome.COLLISION for step in steps for leg in step.legs),
        understood=header.understood,
        score=plain_score(replace(result.score, mission_id=f"{place}|{episode.id}")),
    )


def run_place(place: str, options: argparse.Namespace) -> list[Row]:
    """Run all methods on the same episodes in one place."""
    atlas = open_place(place)
    profile = vehicle_profile(options.vehicle)
    episodes = sample_episodes(
        atlas,
        levels=options.levels,
        count=options.count,
        seed=key_of(options.seed, place),
        traveller=traveller_of(profile),
        settings=SamplingSettings(camera_height_m=profile.camera_height_m),
    )
    return [run_episode(atlas, place, episode, method, options) for method in options.planners for episode in episodes]


def run_all(options: argparse.Namespace) -> Iterator[list[Row]]:
    """Run everything, place by place in the order given, whatever the number of processes."""
    work = partial(run_place, options=options)
    if options.jobs == 1 or len(options.worlds) == 1:
        yield from map(work, options.worlds)
        return
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(work, options.worlds)


def run_and_keep(options: argparse.Namespace) -> list[Row]:
    """Run everything; what is finished is in the file of rows at once."""
    rows: list[Row] = []
    if options.rows:
        options.rows.write_text("", encoding="utf-8")
    for made in run_all(options):
        rows += made
        if options.rows:
            with options.rows.open("a", encoding="utf-8") as file:
                file.writelines(row.as_json() + "\n" for row in made)
    return rows


def read_rows(path: Path) -> list[Row]:
    """Return the rows of a file."""
    return [Row(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines() if line]


def figure(table: MetricTable, name: str) -> str:
    """Return one figure with its interval."""
    metric = table[name]
    return f"{_short(metric.value)} [{_short(metric.low)}, {_short(metric.high)}]"


def _short(value: float) -> str:
    text = f"{value:.2f}"
    return text.replace("0.", ".", 1) if abs(value) < 0.995 else text


def table_text(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def report(rows: Sequence[Row]) -> str:
    """Return all tables, in Markdown."""
    methods = list(dict.fromkeys(row.method for row in rows))
    scores = {method: [row.scored for row in rows if row.method == method] for method in methods}
    tables = {method: by_level(scores[method]) for method in methods}
    parts = [_about(rows, methods)]
    levels = list(tables[methods[0]])
    lines = []
    for level in reversed(levels):
        for method in methods:
            table = tables[method][level]
            name = "all" if level is None else str(level)
            lines.append([name, f"{table.count}", method, *(figure(table, shown) for shown in SHOWN)])
    parts.append(table_text(["level", "missions", "method", *SHOWN], lines))
    lines = [
        [
            method,
            *(f"{tables[method][None][name].value:.0f}" for name in ("CT", "TT", "path length")),
            *(_short(tables[method][None][f"SR at {radius_m} m"].value) for radius_m in (5, 10, 15, 20)),
        ]
        for method in methods
    ]
    head = ["method", "CT s", "TT s", "path m", "SR at 5 m", "10 m", "15 m", "20 m"]
    parts.append("Means over all missions:\n\n" + table_text(head, lines))
    lines = [
        [f"{method} − {methods[0]}", *(figure(compare(scores[method], scores[methods[0]]), n) for n in DIFFERENCES)]
        for method in methods[1:]
    ]
    if lines:
        parts.append("Paired differences, the same missions:\n\n" + table_text(["methods", *DIFFERENCES], lines))
    parts.append("How missions ended:\n\n" + _endings(rows, methods))
    places = list(dict.fromkeys(row.place for row in rows))
    if len(places) > 1:
        parts.append("SR / OSR by place:\n\n" + _by_place(rows, methods, places))
    return "\n\n".join(parts)


def _about(rows: Sequence[Row], methods: Sequence[str]) -> str:
    first = rows[0]
    label = {method: next(row.minds for row in rows if row.method == method) for method in methods}
    named = ", ".join(dict.fromkeys(row.place for row in rows))
    made = f"{first.captioner}; CT {first.ct_label}; reasoned-explorer {version('reasoned-explorer')}"
    lines = [
        f"{len(rows) // len(methods)} missions a method in {named}; vehicle {first.score['vehicle']}; {made}.",
        *(f"- {method}: minds {label[method]}" for method in methods),
    ]
    thanks = sorted({row.attribution for row in rows} - {""})
    return "\n".join([*lines, *(f"Places: {name}" for name in thanks)])


def _endings(rows: Sequence[Row], methods: Sequence[str]) -> str:
    lines = []
    ends = sorted({row.end for row in rows} - {"found"})
    for method in methods:
        mine = [(row, row.scored) for row in rows if row.method == method]
        count = Counter(row.end for row, _ in mine)
        false = [(row, score) for row, score in mine if row.declared and not score.success]
        missed = sum(score.oracle_success and not row.declared for row, score in mine)
        late = sum(score.oracle_success for _, score in false)
        collided = sum(row.collisions for row, _ in mine) / len(mine)
        steps = sum(row.steps for row, _ in mine) / len(mine)
        right = sum(score.success for _, score in mine)
        cells = [method, f"{right}", f"{len(false)}", f"{late}", f"{missed}", *(f"{count[end]}" for end in ends)]
        lines.append([*cells, f"{collided:.1f}", f"{steps:.0f}"])
    head = ["method", "found rightly", "false halt", "of these had been there", "had been there, never said", *ends]
    return table_text([*head, "collisions a mission", "steps"], lines)


def _by_place(rows: Sequence[Row], methods: Sequence[str], places: Sequence[str]) -> str:
    lines = []
    for method in methods:
        cells = [method]
        for place in places:
            mine = [row.scored for row in rows if row.method == method and row.place == place]
            share = sum(score.success for score in mine) / len(mine)
            oracle = sum(score.oracle_success for score in mine) / len(mine)
            cells.append(f"{_short(share)} / {_short(oracle)} ({len(mine)})")
        lines.append(cells)
    return table_text(["method", *places], lines)


def arguments() -> argparse.Namespace:
    """Return what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="+", default=["uvic", "monaco-port", "monte-carlo"])
    parser.add_argument("--count", type=int, default=40, help="episodes a world, levels in turn")
    parser.add_argument("--levels", type=int, nargs="+", default=[1, 2, 3, 4], choices=(1, 2, 3, 4))
    parser.add_argument("--planners", nargs="+", default=list(METHODS), help="PLANNER[/MINDS[/CHECKER]]")
    parser.add_argument("--captioner", default="noisy")
    parser.add_argument("--minds", default="embedded")
    parser.add_argument("--vehicle", default="drone")
    parser.add_argument("--latency", default="gpt-2023")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, choices=(1, 2))
    parser.add_argument("--rows", type=Path, help="keep one line per mission in this file")
    parser.add_argument("--records", type=Path, help="keep the full records in this folder")
    parser.add_argument("--from", dest="source", type=Path, help="no missions: tables of a file of rows")
    return parser.parse_args()


def main() -> None:
    """Run and print."""
    options = arguments()
    try:
        rows = read_rows(options.source) if options.source else run_and_keep(options)
    except ReasonedExplorerError as error:
        raise SystemExit(f"{error}") from error
    print(report(rows))


if __name__ == "__main__":
    main()
