"""Small runs for the tests of the server, made as users make them."""

from dataclasses import replace
from pathlib import Path

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds
from reasoned_explorer.world.opening import open_world

#: Of the run that `make_bench` makes.
MISSIONS = 8
SHORT = MissionSettings(explorer=ExplorerSettings(t_max_s=90.0))


def small_plan() -> BenchPlan:
    """Four missions of a minute and a half for each of two planners, in two places."""
    places = places_of_worlds(["park:5@300", "plaza:5@300"])
    split = make_split("small", places, share=Share(), dealing=Dealing(3, time_limit_s=90.0))
    split = replace(split, episodes=split.episodes[:2] + split.episodes[-2:])
    return BenchPlan(split, ("llm-rrt", "nearest-frontier"), base=SHORT)


def make_bench(folder: Path) -> Path:
    """Run that plan; the records are kept."""
    with RunStore.create(folder, small_plan(), {}) as store:
        run_bench(store, Workers())
    return folder


def make_record() -> EpisodeRecord:
    """A mission of a minute and a half in plaza:3@200."""
    return Mission("Find me a bench", open_world("plaza:3@200"), replace(SHORT, planner="llm-rrt")).run().record


def write_record(folder: Path, record: EpisodeRecord) -> None:
    """Keep a record as `rex run` does."""
    folder.mkdir(parents=True)
    (folder / "record.jsonl").write_bytes(record_bytes(record))
