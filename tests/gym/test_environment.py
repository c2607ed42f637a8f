"""The task as a Gymnasium environment."""

import asyncio
import hashlib
import math
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.mission_settings import MissionSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import GoalError, InputError, SettingsError, StartError, UnknownNameError, WorldError
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world
from tests.world.worlds import courtyard

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.error import ResetNeeded  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.wrappers import FilterObservation  # noqa: E402

from reasoned_explorer.gym.environment import OutdoorEnv  # noqa: E402

NAME = "reasoned_explorer.gym:reasoned_explorer/Outdoor-v0"
WORLD = "plaza:3@200"
SMALL: dict[str, Any] = {"world": WORLD, "goal": "Find me a bench", "image_px": 16, "views": 2}
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    return Atlas(open_world(WORLD))


def _env(**changes: Any) -> OutdoorEnv:
    return OutdoorEnv(**{**SMALL, **changes})


def _digest(env: Any, seed: int, steps: int = 4) -> str:
    """A sum over everything that an episode shows."""
    env.action_space.seed(seed)
    seen = hashlib.sha256()
    observation, info = env.reset(seed=seed)
    outcomes: list[Any] = [(observation, 0.0, False, False, info)]
    for _ in range(steps):
        action = env.action_space.sample()
        action[2] = -1.0
        outcomes.append(env.step(action))
    for observation, *rest in outcomes:
        for value in observation.values():
            seen.update(value.tobytes() if isinstance(value, np.ndarray) else value.encode())
        seen.update(repr(rest).encode())
    return seen.hexdigest()


# It is an environment.


def test_it_passes_gymnasiums_checks_without_a_warning() -> None:
    env = gymnasium.make(NAME, render_mode="rgb_array", **SMALL)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)
    env.close()


def test_its_name_alone_is_enough_in_a_new_process() -> None:
    code = f"import gymnasium; env = gymnasium.make({NAME!r}); print(type(env.unwrapped).__name__)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "OutdoorEnv"


def test_importing_the_room_registers_it_and_loads_no_world() -> None:
    code = (
        "import reasoned_explorer.gym, gymnasium, sys\n"
        "print(gymnasium.spec(reasoned_explorer.gym.OUTDOOR_ID).id, 'numba' in sys.modules)"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.split() == ["reasoned_explorer/Outdoor-v0", "False"]


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_several_run_side_by_side(mode: str) -> None:
    # Gymnasium reads texts from shared memory once, before there are any: they are to be sent.
    extra = {"vector_kwargs": {"context": "spawn", "shared_memory": False}} if mode == "async" else {}
    envs = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode=mode, **extra, **SMALL)
    try:
        observation, _ = envs.reset(seed=[3, 4])
        assert observation["images"].shape == (2, 2, 16, 16, 3)
        assert tuple(observation["goal"]) == ("Find me a bench", "Find me a bench")
        actions = np.array([[0.0, 0.1, -1.0], [-1.0, 0.0, 1.0]], np.float32)
        observation, _, terminated, truncated, info = envs.step(actions)
        assert terminated.tolist() == [False, True]
        assert truncated.tolist() == [False, False]
        assert info["steps"].tolist() == [1, 1]
        alone = _env()
        alone.reset(seed=3)
        assert (alone.step(actions[0])[0]["images"] == observation["images"][0]).all()
    finally:
        envs.close()


def test_numbers_travel_through_shared_memory() -> None:
    envs = gymnasium.make_vec(NAME, num_envs=1, vectorization_mode="async", vector_kwargs={"context": "spawn"}, **SMALL)
    try:
        observation, _ = envs.reset(seed=3)
        expected, _ = _env().reset(seed=3)
        for name in ("images", "depth_m", "pose", "time_left_s"):
            assert (observation[name][0] == expected[name]).all()
    finally:
        envs.close()


def test_the_goal_can_be_left_out_for_trainers_that_know_no_text() -> None:
    env = FilterObservation(gymnasium.make(NAME, **SMALL), ["images", "depth_m", "pose", "time_left_s"])
    observation, _ = env.reset(seed=1)
    assert "goal" not in observation
    assert all(isinstance(space, gymnasium.spaces.Box) for space in env.observation_space.values())


def test_it_works_where_an_event_loop_runs_already() -> None:
    async def cell() -> int:
        env = _env()
        env.reset(seed=1)
        return int(env.step(env.action_of(3.0, 0.0))[4]["steps"])

    assert asyncio.run(cell()) == 1


# It is the same each time.


def test_the_same_seed_and_actions_show_the_same_bytes_in_every_process() -> None:
    code = (
        "from tests.gym.test_environment import _digest, _env\nenv = _env(); env.reset(seed=99); print(_digest(env, 5))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert shown.stdout.strip() == _digest(_env(), 5)


def test_without_a_seed_the_next_episode_is_another_but_decided_by_the_last_seed() -> None:
    env = _env()
    env.reset(seed=3)
    following = [env.reset()[1]["seed"] for _ in range(2)]
    env.reset(seed=3)
    assert [env.reset()[1]["seed"] for _ in range(2)] == following
    assert len(set(following)) == 2


def test_a_seed_starts_where_a_mission_with_that_seed_does(atlas: Atlas) -> None:
    _, info = _env(world=atlas).reset(seed=11)
    start = Mission("Find me a bench", atlas, MissionSettings(seed=11)).start
    assert info["start"] == (start.x_m, start.y_m, start.z_m, start.heading_rad)


# What is observed.


def test_an_observation_is_what_the_cameras_see_from_where_the_vehicle_is(atlas: Atlas) -> None:
    env = _env(world=atlas, views=3, depth_range_m=50.0)
    observation, info = env.reset(seed=2)
    assert observation in env.observation_space
    x_m, y_m, z_m, sine, cosine = observation["pose"].tolist()
    assert (x_m, y_m) == pytest.approx(info["start"][:2], abs=0.5)
    assert z_m == pytest.approx(1.5)
    assert math.atan2(sine, cosine) % (2 * math.pi) == pytest.approx(info["start"][3], abs=0.1)
    assert observation["depth_m"].max() == 50.0
    assert 0.0 < observation["depth_m"].min() < 50.0
    # Depth and colour are of the same view: the sky is blue where nothing is near.
    sky = observation["depth_m"][:, :4] == 50.0
    assert sky.any()
    blue = observation["images"][:, :4][sky].astype(int)
    assert (blue[:, 2] >= blue[:, 0]).mean() > 0.9
    assert observation["time_left_s"] == pytest.approx(1800.0)


@pytest.mark.parametrize("vehicle", ["drone", "go1"])
def test_depth_belongs_to_its_view_also_where_the_vehicle_looks_from_the_other_end(vehicle: str, atlas: Atlas) -> None:
    env = _env(world=atlas, views=3, vehicle=vehicle)
    env.reset(seed=2)
    observation = env.step(env.action_of(2.0, 2.5))[0]
    for image, depth_m in zip(observation["images"], observation["depth_m"], strict=True):
        # The ground right before the camera is near, whatever the view.
        assert depth_m[-1].min() < 6.0
        assert image[-1].std() >= 0.0
    assert len({image.tobytes() for image in observation["images"]}) == 3


def test_rendering_shows_the_views_side_by_side() -> None:
    env = _env(render_mode="rgb_array")
    with pytest.raises(ResetNeeded):
        env.render()
    observation, _ = env.reset(seed=1)
    shown = env.render()
    assert shown is not None
    assert shown.shape == (16, 32, 3)
    assert (shown[:, 16:] == observation["images"][1]).all()
    assert _env().render() is None


def test_what_is_handed_out_may_be_changed() -> None:
    env = _env()
    first, _ = env.reset(seed=1)
    kept = first["images"].copy()
    first["images"][:] = 0
    second = env.step(env.action_of(0.0, 0.0, declare=True))[0]
    assert (second["images"] == kept).all()


# What is done.


def test_a_waypoint_is_gone_to() -> None:
    env = _env(step_max_m=20.0)
    first, info = env.reset(seed=6)
    second, _, _, _, after = env.step(env.action_of(5.0, 0.0))
    moved = second["pose"][:2] - first["pose"][:2]
    assert after["leg"] == "arrived"
    assert np.hypot(*moved) == pytest.approx(5.0, abs=0.3)
    heading_rad = info["start"][3]
    assert moved / np.hypot(*moved) == pytest.approx([math.sin(heading_rad), math.cos(heading_rad)], abs=0.1)
    assert after["travelling_s"] > 5.0 / 3.0
    assert second["time_left_s"] == pytest.approx(1800.0 - after["travelling_s"])


def test_a_positive_bearing_is_to_the_right() -> None:
    env = _env(start=(40.0, -40.0, 0.0))
    env.reset(seed=1)
    east = env.step(env.action_of(4.0, math.pi / 2))[0]["pose"]
    assert east[0] - 40.0 == pytest.approx(4.0, abs=0.3)
    assert east[3:] == pytest.approx([1.0, 0.0], abs=0.1)


def test_numbers_out_of_range_are_clipped() -> None:
    beyond, within = _env(step_max_m=3.0), _env(step_max_m=3.0)
    beyond.reset(seed=6)
    within.reset(seed=6)
    a, b = beyond.step([7.0, 0.0, -3.0]), within.step([1.0, 0.0, -1.0])
    assert (a[0]["pose"] == b[0]["pose"]).all()


@pytest.mark.parametrize(
    "action", [[0.0, 0.0], [0.0, float("nan"), 0.0], ["ahead", 0, 0], None, 1.0, [[0.0, 0.0, 0.0]]]
)
def test_an_action_is_three_finite_numbers(action: Any) -> None:
    env = _env()
    env.reset(seed=1)
    with pytest.raises(SettingsError, match="three finite numbers"):
        env.step(action)


# What it is worth, and how it ends.


def _beside_a_bench(atlas: Atlas) -> tuple[float, float]:
    """A place from which a bench is in sight and near."""
    judge = Mission("Find me a bench", atlas, MissionSettings(agent="guide", seed=1)).judge
    for index, _ in judge.satisfying:
        item = atlas.world.objects[index]
        for x_m, y_m in ((item.x_m + 4.0, item.y_m), (item.x_m, item.y_m + 4.0), (item.x_m - 4.0, item.y_m)):
            if judge.success(x_m, y_m).success:
                return x_m, y_m
    raise AssertionError


def test_a_true_declaration_ends_it_and_is_worth_one(atlas: Atlas) -> None:
    env = _env(world=atlas, start=_beside_a_bench(atlas))
    env.reset(seed=1)
    _, reward, terminated, truncated, info = env.step(env.action_of(9.0, 0.0, declare=True))
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert info["success"]
    assert info["spl"] == info["casr"] == 1.0
    assert info["path_length_m"] == 0.0
    with pytest.raises(ResetNeeded):
        env.step(env.action_of(1.0, 0.0))


def test_a_false_declaration_ends_it_and_is_worth_nothing() -> None:
    env = _env()
    env.reset(seed=1)
    _, reward, terminated, _, info = env.step(env.action_of(0.0, 0.0, declare=True))
    assert (reward, terminated) == (0.0, True)
    assert not info["success"]
    assert info["distance_to_goal_m"] > 15.0


def test_what_a_successful_episode_returns_is_its_casr(atlas: Atlas) -> None:
    """Also where looking takes time, and where decisions are charged."""
    x_m, y_m = _beside_a_bench(atlas)
    env = _env(world=atlas, start=(x_m, y_m), vehicle="go1", decision_s=7.0)
    env.reset(seed=1)
    total = 0.0
    for bearing_rad in (0.3, math.pi):
        total += env.step(env.action_of(0.4, bearing_rad))[1]
    _, reward, _, _, info = env.step(env.action_of(0.0, 0.0, declare=True))
    assert info["success"]
    assert total + reward == pytest.approx(info["casr"])
    assert info["computing_s"] == pytest.approx(21.0)
    assert info["casr"] == pytest.approx(1.0 - (info["computing_s"] + info["travelling_s"]) / 1800.0)


def test_a_sparse_reward_is_for_a_true_declaration_alone(atlas: Atlas) -> None:
    env = _env(world=atlas, start=_beside_a_bench(atlas), reward="sparse")
    env.reset(seed=1)
    assert env.step(env.action_of(0.2, 0.0))[1] == 0.0
    assert env.step(env.action_of(0.0, 0.0, declare=True))[1] == 1.0


@pytest.mark.parametrize("limit", [{"t_max_s": 8.0}, {"max_steps": 2}])
def test_time_and_steps_are_limited(limit: dict[str, Any]) -> None:
    env = _env(**limit)
    env.reset(seed=1)
    taken, truncated = 0, False
    while not truncated:
        observation, _, terminated, truncated, info = env.step(env.action_of(3.0, 1.0))
        assert not terminated
        taken += 1
    assert taken >= 2
    assert not info["success"]
    assert observation in env.observation_space
    with pytest.raises(ResetNeeded):
        env.step(env.action_of(1.0, 0.0))


def test_a_declaration_after_t_max_does_not_count(atlas: Atlas) -> None:
    env = _env(world=atlas, start=_beside_a_bench(atlas), t_max_s=5.0, decision_s=6.0)
    env.reset(seed=1)
    _, reward, terminated, _, info = env.step(env.action_of(0.0, 0.0, declare=True))
    assert terminated
    assert not info["success"]
    assert reward == pytest.approx(-6.0 / 5.0)


def test_collisions_are_counted() -> None:
    env = _env(step_max_m=150.0)
    env.reset(seed=1)
    info: dict[str, Any] = {}
    for _ in range(3):
        info = env.step(env.action_of(150.0, 0.8))[4]
        if info["leg"] == "collision":
            break
    assert info["collisions"] >= 1
    assert info["leg_detail"]


def test_how_far_it_still_is_is_there_for_shaping(atlas: Atlas) -> None:
    env = _env(world=atlas)
    with pytest.raises(ResetNeeded):
        env.remaining_m  # noqa: B018
    _, info = env.reset(seed=3)
    assert env.remaining_m == pytest.approx(info["reference_length_m"], abs=2.0)


# Other places, and what cannot be used.


def test_options_hold_for_one_episode() -> None:
    env = _env()
    observation, info = env.reset(
        seed=1, options={"goal": "Find me a tree", "world": "park:1@150", "start": Pose(5.0, 5.0)}
    )
    assert observation["goal"] == info["goal"] == "Find me a tree"
    assert observation in env.observation_space
    assert info["world"].startswith("park")
    assert info["start"][:2] == (5.0, 5.0)
    assert env.reset(seed=1)[0]["goal"] == "Find me a bench"


MISTAKES: dict[str, tuple[type[InputError], dict[str, Any]]] = {
    "an unknown world": (UnknownNameError, {"world": "prak"}),
    "a world that is none": (WorldError, {"world": 7}),
    "a goal that asks for nothing": (GoalError, {"goal": "hello there"}),
    "no goal": (GoalError, {"goal": None}),
    "a goal in other letters": (GoalError, {"goal": "Find me a bench 長椅"}),
    "a start in words": (StartError, {"start": "here"}),
    "a start of one number": (StartError, {"start": (1.0,)}),
    "a start of NaN": (StartError, {"start": (math.nan, 0.0)}),
    "an unknown vehicle": (UnknownNameError, {"vehicle": "dron"}),
    "no views": (SettingsError, {"views": 0}),
    "no step": (SettingsError, {"step_max_m": 0.0}),
    "no time": (SettingsError, {"t_max_s": 0.0}),
    "a radius of NaN": (SettingsError, {"success_radius_m": math.nan}),
    "a decision that gives time back": (SettingsError, {"decision_s": -1.0}),
    "a picture of a pixel": (SettingsError, {"image_px": 1}),
    "no depth": (SettingsError, {"depth_range_m": 0.0}),
    "unknown conditions": (SettingsError, {"conditions": "hail"}),
    "an unknown reward": (SettingsError, {"reward": "dense"}),
    "an unknown way to render": (SettingsError, {"render_mode": "human"}),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_cannot_be_used_is_refused_when_it_is_made(mistake: str) -> None:
    kind, changes = MISTAKES[mistake]
    with pytest.raises(kind):
        _env(**changes)


def test_all_mistakes_are_told_at_once() -> None:
    with pytest.raises(InputError) as raised:
        _env(world="prak", goal="", start="here", views=0, reward="dense", conditions="hail")
    assert len(raised.value.faults) == 6


def test_all_mistakes_of_options_are_told_at_once() -> None:
    env = _env()
    with pytest.raises(InputError) as raised:
        env.reset(options={"goal": "", "start": (1.0,), "wrld": "park"})
    assert len(raised.value.faults) == 3
    with pytest.raises(SettingsError, match="a mapping"):
        env.reset(options=["goal"])  # type: ignore[arg-type]


def test_a_start_inside_a_building_is_refused_when_it_begins() -> None:
    env = OutdoorEnv(courtyard(), "Find me a bench", start=(1e4, 0.0), image_px=16)
    with pytest.raises(StartError):
        env.reset(seed=1)


# The example.


def test_the_example_runs() -> None:
    shown = subprocess.run(
        [sys.executable, "examples/gym_random_walk.py"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "steps," in shown.stdout
    assert "SPL" in shown.stdout


def test_without_gymnasium_it_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['gymnasium'] = None\n"
        "from reasoned_explorer.model import MissingDependencyError\n"
        "try:\n    import reasoned_explorer.gym\nexcept MissingDependencyError as error:\n    print(error)"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install 'reasoned-explorer[gym]'" in shown.stdout
