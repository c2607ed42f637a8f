import asyncio
import os
import subprocess
import sys

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import make_minds
from reasoned_explorer.model import Goal, GoalError, Scene
from tests.minds.helpers import STREET, WALL, mind_context, scene

GOAL = Goal("Find me a bench near a trash can")


def test_a_step_costs_two_rounds_of_imagining_and_one_of_judging():
    context = mind_context("gpt-2023", seed=4)
    minds = make_minds(context, "embedded-words")

    async def mission():
        scenes = [scene(STREET, 0, 0, view) for view in range(3)]
        first = await minds.visionary.imagine(GOAL, scenes, count=3)
        imagined_s = context.clock.now_s()
        await minds.evaluator.evaluate(GOAL, [child for row in first for child in row])
        return imagined_s, context.clock.now_s()

    imagined_s, judged_s = context.clock.run(mission())
    calls = context.ledger.calls
    visionary = [call for call in calls if call.role == "visionary"]
    evaluator = [call for call in calls if call.role == "evaluator"]
    assert len(visionary) == len(evaluator) == 9
    assert imagined_s == pytest.approx(max(call.latency_s for call in visionary))
    assert judged_s - imagined_s == pytest.approx(max(call.latency_s for call in evaluator))
    assert evaluator[0].started_s == pytest.approx(imagined_s)
    assert {(call.tokens_in, call.tokens_out, call.usd) for call in calls} == {(0, 0, 0.0)}
    assert len({call.key for call in visionary}) == 9


def test_imagined_scenes_know_where_they_come_from():
    context = mind_context()
    minds = make_minds(context, "embedded-words")

    async def mission():
        (children,) = await minds.visionary.imagine(GOAL, [scene(STREET, 2, 0, 1)], count=3)
        return children, await minds.visionary.imagine(GOAL, children, count=1)

    children, grandchildren = context.clock.run(mission())
    assert [child.key for child in children] == [(2, 0, 1, 0), (2, 0, 1, 1), (2, 0, 1, 2)]
    assert [row[0].key for row in grandchildren] == [(2, 0, 1, 0, 0), (2, 0, 1, 1, 0), (2, 0, 1, 2, 0)]
    assert {row[0].depth for row in grandchildren} == {2}


def test_the_waypoint_is_never_read():
    class Untouchable:
        def __getattribute__(self, name: str) -> object:
            raise AssertionError(f"a mind read {name} of the waypoint")

    context = mind_context()
    minds = make_minds(context, "embedded-words")
    closed = Scene(STREET, (0, 0, 0), Untouchable())  # type: ignore[arg-type]

    async def mission():
        await minds.evaluator.evaluate(GOAL, [closed])
        await minds.checker.check(GOAL, [closed])
        await minds.visionary.imagine(GOAL, [closed], count=2)

    context.clock.run(mission())


def test_scenes_without_a_description_are_faults_of_their_own():
    context = mind_context()
    minds = make_minds(context, "embedded-words")
    scenes = [scene("", 0, 0, 0, fault="captioner: no answer"), scene(" ", 0, 0, 1), scene(STREET, 0, 0, 2)]

    async def mission():
        return (
            await minds.evaluator.evaluate(GOAL, scenes),
            await minds.checker.check(GOAL, scenes),
            await minds.visionary.imagine(GOAL, scenes, count=2),
        )

    assessments, verdicts, imagined = context.clock.run(mission())
    assert [a.fault is None for a in assessments] == [False, False, True]
    assert assessments[0].fault == "captioner: no answer"
    assert [v.found for v in verdicts] == [False, False, True]
    assert [child.fault is None for row in imagined for child in row] == [False, False, False, False, True, True]
    assert context.ledger.totals()["evaluator"].faults == 2


def test_a_cancelled_call_was_made_all_the_same():
    context = mind_context("gpt-2023")
    minds = make_minds(context, "embedded-words")

    async def mission():
        task = asyncio.create_task(minds.evaluator.evaluate(GOAL, [scene(STREET)]))
        await asyncio.sleep(0.1)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    context.clock.run(mission())
    assert context.ledger.totals()["evaluator"].calls == 1


def test_nothing_asked_costs_nothing():
    context = mind_context("gpt-2023")
    minds = make_minds(context, "embedded-words")

    async def mission():
        return (await minds.evaluator.evaluate(GOAL, []), context.clock.now_s())

    assessments, now_s = context.clock.run(mission())
    assert (list(assessments), now_s) == ([], 0.0)


def test_a_goal_without_sense_is_an_error():
    context = mind_context()
    minds = make_minds(context, "embedded-words")

    async def mission():
        await minds.evaluator.evaluate(Goal("hello"), [Scene(WALL, (0, 0, 0), Pose(0.0, 0.0))])

    with pytest.raises(GoalError):
        context.clock.run(mission())


_PROBE = """
from reasoned_explorer.minds.embedded import default_senses
from reasoned_explorer.minds.embedded.checker import verdict_on
from reasoned_explorer.minds.embedded.evaluator import assess
from reasoned_explorer.minds.embedded.lexicon import data_lines
from reasoned_explorer.minds.embedded.visionary import imagine_texts
senses = default_senses(with_embedder=False)
for number, text in enumerate(data_lines("background_scenes")):
    for imagined in imagine_texts(text, seed=3, key=(number, 0, 1), count=2, senses=senses):
        for goal in ("Find me a bench near a tree, avoid the road and the grass", "Find me a shady place to sit"):
            print(imagined, assess(goal, imagined, senses), verdict_on(goal, imagined, senses))
"""


def test_two_processes_think_the_same_thing():
    outputs = [
        subprocess.run(
            [sys.executable, "-c", _PROBE], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2")
    ]
    assert outputs[0] == outputs[1]
    assert outputs[0].count(b"\n") > 200
