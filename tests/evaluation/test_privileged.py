"""Bounds on one role: foresight beyond frontiers, and the perfect halt."""

from dataclasses import replace

import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.evaluation.mission import Mission, MissionSettings, run_mission, traveller_of
from reasoned_explorer.evaluation.privileged import Foresight
from reasoned_explorer.evaluation.truth import OracleTruth
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import Ledger, MindContext, latency_profile, make_minds
from reasoned_explorer.model import Scene, SettingsError
from reasoned_explorer.planning.registry import make_planner
from reasoned_explorer.planning.without_models import path_score
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.generator import generate_world
from tests.world.worlds import field

DRONE = PROFILES["drone"]
PATH = "A path leads straight ahead."
WALL = "The wall of a building fills most of the view and blocks the way ahead."
FORESIGHT = MissionSettings(planner="llm-as-eval", evaluator="foresight-60m", captioner="perfect")


@pytest.fixture(scope="module")
def truth() -> OracleTruth:
    """A fountain at (150, 100) on an open field: success within 15 m of its rim."""
    atlas = Atlas(field(("fountain", 150.0, 100.0), size_m=200.0))
    judge = Judge(atlas, read_goal("Find me a fountain"), traveller=traveller_of(DRONE), camera_height_m=1.5)
    return OracleTruth(atlas, judge, DRONE, ExplorerSettings())


@pytest.fixture(scope="module")
def plaza() -> Atlas:
    return Atlas(generate_world("plaza", seed=3, size_m=220.0))


def _scene(x_m: float, text: str = PATH, *, fault: str | None = None) -> Scene:
    """Return a look eastwards, towards the fountain."""
    here = Pose(x_m, 100.0, 1.5, 1.5707963267948966)
    return Scene(text, (0, 0, 0), here.ahead(5.0), 0, fault, here)


def _assess(truth: OracleTruth, horizon_m: float, *scenes: Scene):
    return VirtualClock().run(Foresight(truth, horizon_m).evaluate(truth.judge.spec.goal, scenes))


def test_what_is_within_the_horizon_is_worth_4_to_5_rising_with_nearness(truth: OracleTruth) -> None:
    # From x the frontier is 5 to 20 m on, and success begins at 132.5.
    far, middle, near, there = _assess(truth, 60.0, *(_scene(x_m) for x_m in (40.0, 80.0, 110.0, 126.0)))
    assert far.score == pytest.approx(path_score(PATH))
    assert 4.0 < middle.score < near.score < there.score <= 5.0
    assert not any(answer.blocked for answer in (far, middle, near, there))


def test_a_shorter_horizon_sees_less(truth: OracleTruth) -> None:
    (within,), (beyond,) = _assess(truth, 60.0, _scene(80.0)), _assess(truth, 30.0, _scene(80.0))
    assert within.score > 4.0
    assert beyond.score == pytest.approx(path_score(PATH))


def test_what_is_foreseen_is_known_and_of_the_rest_the_text_tells(truth: OracleTruth) -> None:
    beyond, within = _assess(truth, 30.0, _scene(40.0, WALL), _scene(110.0, WALL))
    assert beyond.blocked
    assert not within.blocked  # there is no wall
    (lost,) = _assess(truth, 30.0, _scene(110.0, fault="camera"))
    assert lost.score is None
    assert lost.fault == "camera"


def test_without_foresight_it_is_follow_paths(plaza: Atlas) -> None:
    """The same way, to the leg, where nothing is foreseen: all that is won is foresight's."""

    def legs_of(planner: str, horizon_m: float | None) -> list[object]:
        settings = replace(FORESIGHT, planner=planner, evaluator=None, seed=4)
        mission = Mission("Find me a public toilet", plaza, settings)
        if horizon_m is not None:
            truth = OracleTruth(plaza, mission.judge, DRONE, settings.explorer)
            minds = replace(mission.explorer.parts.planner._minds, evaluator=Foresight(truth, horizon_m))
            mission.explorer.parts = replace(mission.explorer.parts, planner=make_planner(planner, minds))
        return [leg.target for step in mission.run().record.steps for leg in step.legs]

    paths = legs_of("follow-paths", None)
    assert legs_of("llm-as-eval", 0.0) == paths
    assert legs_of("llm-as-eval", 1000.0) != paths


def test_foresight_takes_no_time_and_says_what_it_is(plaza: Atlas) -> None:
    result = run_mission("Find me a bench", plaza, replace(FORESIGHT, seed=2))
    assert "evaluator" not in result.summary.calls
    assert result.summary.plan_s == 0.0
    assert "a bound" in result.record.header.minds
    assert "checker: embedded" in result.record.header.minds


@pytest.mark.parametrize("name", ["foresight-30m", "foresight-60m", "perfect-halt"])
def test_where_no_truth_is_known_there_is_no_bound(name: str) -> None:
    context = MindContext(VirtualClock(), latency_profile("instant"), Ledger())
    with pytest.raises(SettingsError, match=name):
        make_minds(context, checker=name)


def test_roles_that_a_bound_does_not_fill_answer_with_a_fault(truth: OracleTruth) -> None:
    context = MindContext(VirtualClock(), latency_profile("instant"), Ledger(), 0, truth)
    halt, foresight = (make_minds(context, name) for name in ("perfect-halt", "foresight-30m"))
    goal = truth.judge.spec.goal

    async def ask():
        return (
            [answer.fault for answer in await halt.evaluator.evaluate(goal, [_scene(110.0)])],
            [child.fault for child in (await halt.visionary.imagine(goal, [_scene(110.0)], count=2))[0]],
            [(answer.found, answer.fault) for answer in await foresight.checker.check(goal, [_scene(140.0)])],
        )

    assessed, imagined, checked = VirtualClock().run(ask())
    assert assessed == ["perfect-halt is a bound on the checker alone"]
    assert imagined == ["perfect-halt is a bound on the checker alone"] * 2
    assert checked == [(False, "foresight-30m is a bound on the evaluator alone")]


def test_the_perfect_halt_is_charged_like_the_embedded_checker(truth: OracleTruth) -> None:
    scenes = [replace(_scene(x_m), key=(3, 0, place)) for place, x_m in enumerate((40.0, 131.0, 140.0))]
    ledgers, ended_s, found = [], [], []
    for name in ("embedded-words", "perfect-halt"):
        clock, ledger = VirtualClock(), Ledger()
        minds = make_minds(MindContext(clock, latency_profile("gpt-2023"), ledger, 11, truth), checker=name)
        found.append([v.found for v in clock.run(minds.checker.check(truth.judge.spec.goal, scenes))])
        ledgers.append([(call.role, call.key, call.started_s, call.latency_s, call.fault) for call in ledger.calls])
        ended_s.append(clock.now_s())
    assert ledgers[0] == ledgers[1]
    assert ended_s[0] == ended_s[1] > 0.0
    assert found[1] == [False, False, True]


def test_with_a_perfect_halt_no_halt_is_false(plaza: Atlas) -> None:
    sampling = SamplingSettings(camera_height_m=DRONE.camera_height_m)
    episodes = sample_episodes(plaza, count=8, seed=9, traveller=traveller_of(DRONE), settings=sampling)
    declared = 0
    for episode in episodes:
        settings = replace(FORESIGHT, evaluator="oracle", checker="perfect-halt", seed=episode.seed)
        summary = run_mission(episode.spec.text, plaza, settings, start=episode.start).summary
        declared += summary.declared
        # Whether shunned ground was walked on before is no matter of the halt.
        if summary.compliant is not False:
            assert summary.success == summary.declared, (episode.spec.text, summary.judge)
    assert declared >= 4
