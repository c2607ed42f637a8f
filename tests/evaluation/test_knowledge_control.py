"""With permuted labels the advantage of knowing places vanishes: a control that has to hold, whoever wins elsewhere.

At a small scale, so the intervals are wide: what is shown is that nothing as large as what perfect knowledge is worth
on the same missions is left. Whole tables are a benchmark's.
"""

from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.metrics import MissionScore, compare
from reasoned_explorer.evaluation.mission import MissionSettings, run_mission, traveller_of
from reasoned_explorer.task.episode import Episode
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

WORLDS = ("downtown:12@300~permuted:1", "park:11@300~permuted:1", "campus:14@300~permuted:1")
KNOWING = MissionSettings(planner="llm-as-eval", minds="embedded", captioner="perfect")
UNKNOWING = replace(KNOWING, minds="embedded-unknowing")
ALL_KNOWING = replace(KNOWING, evaluator="oracle")


@pytest.fixture(scope="module")
def missions() -> list[tuple[Atlas, Episode]]:
    profile = PROFILES["drone"]
    sampling = SamplingSettings(camera_height_m=profile.camera_height_m, max_m=150.0)
    return [
        (atlas, episode)
        for atlas in map(Atlas, map(open_world, WORLDS))
        for episode in sample_episodes(atlas, count=8, seed=3, traveller=traveller_of(profile), settings=sampling)
    ]


def _scores(missions: list[tuple[Atlas, Episode]], settings: MissionSettings) -> list[MissionScore]:
    return [
        replace(
            run_mission(episode.spec.text, atlas, replace(settings, seed=episode.seed), start=episode.start).score,
            mission_id=episode.id,
        )
        for atlas, episode in missions
    ]


def test_knowledge_of_places_is_worth_nothing_where_labels_are_permuted(missions: list[tuple[Atlas, Episode]]) -> None:
    unknowing = _scores(missions, UNKNOWING)
    knowledge = compare(_scores(missions, KNOWING), unknowing)
    truth = compare(_scores(missions, ALL_KNOWING), unknowing)
    for name in ("SR", "SPL"):
        assert knowledge[name].low <= 0.0 <= knowledge[name].high, knowledge[name]
    # The same missions tell a real advantage from none.
    assert truth["SPL"].low > 0.0
    assert knowledge["SPL"].high < truth["SPL"].value
