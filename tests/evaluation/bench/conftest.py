from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.mission import MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.task.split import Split
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds

SHORT = MissionSettings(explorer=ExplorerSettings(t_max_s=120.0))


@pytest.fixture(scope="session")
def small_split() -> Split:
    places = places_of_worlds(["park:5@300", "plaza:5@300"])
    return make_split("small", places, share=Share(), dealing=Dealing(3, time_limit_s=120.0))


@pytest.fixture(scope="session")
def small_plan(small_split: Split) -> BenchPlan:
    """Six missions of two minutes for each of two planners, in two places."""
    episodes = small_split.episodes[:3] + small_split.episodes[-3:]
    split = replace(small_split, episodes=episodes)
    return BenchPlan(split, ("nearest-frontier", "llm-as-eval"), base=SHORT)
