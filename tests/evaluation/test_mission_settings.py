"""What is wrong with a mission is told at once, before anything is made."""

import math
from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.methods import GROUPS, method
from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.mission_settings import MissionSettings, errors_of
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import GoalError, InputError, SettingsError, StartError, UnknownNameError
from reasoned_explorer.planning.without_models import NearestFrontier
from tests.world.worlds import courtyard

WRONG = MissionSettings(
    planner="llm-rtt",
    minds="embeded",
    visionary="dreamer",
    captioner="nosy",
    vehicle="dron",
    latency="gpt-2024",
    clock="virtul",
    success_radius_m=math.nan,
    seed=-1,
    agent="exploder",
    eyes="pixel",
)


def test_sound_settings_have_no_faults() -> None:
    assert errors_of(MissionSettings()) == ()


@pytest.mark.parametrize("name", GROUPS["all"])
def test_the_settings_of_every_method_are_sound(name: str) -> None:
    assert errors_of(method(name).settings(MissionSettings())) == ()


def test_everything_that_is_wrong_with_a_mission_is_told_at_once() -> None:
    with pytest.raises(InputError) as raised:
        Mission("Find me a bench near a blorp", courtyard(), WRONG, start=Pose(math.nan, 0.0))
    text = str(raised.value)
    for word in ("blorp", "llm-rtt", "did you mean llm-rrt", "embeded", "dreamer", "nosy", "dron", "gpt-2024", "virtul",
                 "exploder", "did you mean pixels", "success_radius_m is nan", "seed is -1",
                 "finite coordinates"):  # fmt: skip
        assert word in text
    assert len(raised.value.faults) == 13


def test_a_single_fault_is_an_error_of_its_own_kind() -> None:
    world, start = courtyard(), Pose(50.0, 45.0)
    with pytest.raises(GoalError):
        Mission("", world, start=start)
    with pytest.raises(UnknownNameError, match="did you mean virtual"):
        Mission("Find me a bench", world, MissionSettings(clock="virtul"), start=start)
    with pytest.raises(SettingsError, match="seed is nan"):
        Mission("Find me a bench", world, MissionSettings(seed=math.nan), start=start)  # type: ignore[arg-type]
    with pytest.raises(StartError, match="off the world"):
        Mission("Find me a bench", world, start=Pose(500.0, 0.0))


def test_nothing_is_looked_up_in_the_world_where_something_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def expensive(*_: object, **__: object) -> None:
        raise AssertionError("the world was looked into")

    monkeypatch.setattr("reasoned_explorer.evaluation.mission.Judge", expensive)
    with pytest.raises(SettingsError):
        Mission("Find me a bench", courtyard(), MissionSettings(success_radius_m=0.0))


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (MissionSettings(planner_settings={"depth": -1}), "depth is -1"),
        (MissionSettings(planner_settings={"dept": 1}), "no setting 'dept'"),
        (MissionSettings(planner="random", planner_settings={"depth": 1}), "no setting 'depth'"),
        (MissionSettings(planner_settings=[("depth", 1)]), "planner_settings is"),  # type: ignore[arg-type]
        (MissionSettings(planner=3), "planner is 3"),  # type: ignore[arg-type]
        (MissionSettings(evaluator=3), "evaluator is 3"),  # type: ignore[arg-type]
        (MissionSettings(explorer={"views": 3}), "explorer is"),  # type: ignore[arg-type]
        (MissionSettings(success_radius_m="15"), "success_radius_m is '15'"),  # type: ignore[arg-type]
        (MissionSettings(success_radius_m=50.5), "success_radius_m is 50.5"),
        (MissionSettings(seed=1 << 64), "2^64"),
        (MissionSettings(seed=True), "seed is True"),
        ({"planner": "llm-rrt"}, "MissionSettings"),
    ],
)
def test_what_each_setting_must_be(settings: MissionSettings, told: str) -> None:
    (error,) = errors_of(settings)
    assert told in str(error)


def test_agent_settings_that_a_planner_brings_are_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(NearestFrontier, "explorer", {"straight_leg": True}, raising=False)
    (error,) = errors_of(MissionSettings(planner="nearest-frontier"))
    assert "straight_leg" in str(error)


def test_settings_of_the_agent_check_themselves() -> None:
    with pytest.raises(SettingsError) as raised:
        replace(ExplorerSettings(), views=0, t_max_s=math.nan)
    assert len(raised.value.faults) == 2


def test_an_unknown_setting_of_a_planner_hides_no_wrong_one() -> None:
    (error,) = errors_of(MissionSettings(planner_settings={"depth": "x", "foo": 3}))
    assert "no setting 'foo'" in str(error)
    assert "depth is 'x'" in str(error)
