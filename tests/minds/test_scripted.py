import pytest

from reasoned_explorer.minds.scripted import Delayed, Fail, Scripts, broken, make_minds
from reasoned_explorer.model import Assessment, Goal, PartError, SettingsError, Verdict
from tests.minds.helpers import mind_context, scene

GOAL = Goal("Find me a bench")


def _run(context, work):
    return context.clock.run(work)


def test_without_scripts_the_defaults_are_answered():
    context = mind_context()
    minds = make_minds(context)

    async def mission():
        return (
            await minds.evaluator.evaluate(GOAL, [scene("a")]),
            await minds.visionary.imagine(GOAL, [scene("a")], count=2),
            await minds.checker.check(GOAL, [scene("a")]),
        )

    assessments, imagined, verdicts = _run(context, mission())
    assert assessments[0].score == pytest.approx(3.0)
    assert [child.key for child in imagined[0]] == [(0, 0, 0, 0), (0, 0, 0, 1)]
    assert imagined[0][0].depth == 1
    assert not verdicts[0].found


def test_rules_by_key_by_text_and_by_call():
    context = mind_context()
    minds = make_minds(
        context,
        Scripts(
            evaluator={(0, 0, 1): 5.0, "bench": 4.0},
            visionary=lambda goal, seen: [f"{seen.text} {goal.text}", "another"],
            checker={"bench": True},
        ),
    )

    async def mission():
        scenes = [scene("a bench", 0, 0, 0), scene("a bench", 0, 0, 1), scene("a wall", 0, 0, 2)]
        return (
            await minds.evaluator.evaluate(GOAL, scenes),
            await minds.visionary.imagine(GOAL, scenes, count=3),
            await minds.checker.check(GOAL, scenes),
        )

    assessments, imagined, verdicts = _run(context, mission())
    assert [round(a.score) for a in assessments] == [4, 5, 3]
    assert [child.text for child in imagined[0]] == ["a bench Find me a bench", "another", "a bench Find me a bench"]
    assert [v.found for v in verdicts] == [True, True, False]


def test_missing_answers_are_values_and_broken_parts_raise():
    context = mind_context()
    minds = make_minds(
        context,
        Scripts(evaluator=Fail("refused"), visionary={"wall": Fail("refused")}, checker=broken("checker", "link lost")),
    )

    async def mission():
        (assessment,) = await minds.evaluator.evaluate(GOAL, [scene("a")])
        imagined = await minds.visionary.imagine(GOAL, [scene("wall")], count=1)
        with pytest.raises(PartError, match="link lost"):
            await minds.checker.check(GOAL, [scene("a")])
        return assessment, imagined

    assessment, imagined = _run(context, mission())
    assert assessment == Assessment(None, fault="refused")
    assert imagined[0][0].fault == "refused"
    assert context.ledger.totals()["checker"].faults == 1


def test_a_batch_takes_as_long_as_its_slowest_answer():
    context = mind_context()
    minds = make_minds(
        context, Scripts(checker={"slow": Delayed(True, 7.0), "fast": Delayed(Verdict(False, 0.2), 1.0)})
    )

    async def mission():
        await minds.checker.check(GOAL, [scene("fast"), scene("slow")])
        return context.clock.now_s()

    assert _run(context, mission()) == pytest.approx(7.0)


@pytest.mark.parametrize(("role", "answer"), [("evaluator", 9.0), ("checker", "yes"), ("visionary", 3)])
def test_an_answer_that_is_none_is_told(role, answer):
    context = mind_context()
    minds = make_minds(context, Scripts(**{role: answer}))

    async def mission():
        if role == "evaluator":
            await minds.evaluator.evaluate(GOAL, [scene("a")])
        elif role == "checker":
            await minds.checker.check(GOAL, [scene("a")])
        else:
            await minds.visionary.imagine(GOAL, [scene("a")], count=1)

    with pytest.raises(SettingsError, match=f"script of the {role}"):
        _run(context, mission())
