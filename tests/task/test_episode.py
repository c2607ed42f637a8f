import json
import math

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import InputError
from reasoned_explorer.task.episode import Episode
from reasoned_explorer.task.reading import read_goal

EPISODE = Episode(
    "a/L1/bench/0", "park:7", read_goal("Find me a bench, avoid the grass"), Pose(1.5, -2.5, 0.0, 3.0), 42, 81.25
)


def test_an_episode_survives_a_file():
    assert Episode.from_dict(json.loads(json.dumps(EPISODE.as_dict()))) == EPISODE


def test_an_unreachable_goal_survives_too():
    endless = Episode("a", "w", EPISODE.spec, EPISODE.start, 1, math.inf)
    assert Episode.from_dict(json.loads(json.dumps(endless.as_dict(), allow_nan=False))) == endless


def test_the_robot_gets_the_sentence_and_nothing_else():
    assert EPISODE.goal.text == "Find me a bench, avoid the grass"


def test_all_faults_are_told_at_once():
    with pytest.raises(InputError) as caught:
        Episode("a", "w", EPISODE.spec, Pose(math.nan, 0.0, math.inf), 1, math.nan, time_limit_s=0.0)
    assert len(caught.value.faults) == 4


def test_a_broken_file_is_refused():
    with pytest.raises(InputError) as caught:
        Episode.from_dict({**EPISODE.as_dict(), "start": [1, 2], "seed": "x"})
    assert len(caught.value.faults) == 2
