import asyncio
import json
from pathlib import Path

import pytest

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.chat import ANY_OBJECT, ChatAnswer, ChatRequest
from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.minds.context import Minds
from reasoned_explorer.minds.prompted import PromptedMinds, PromptedSettings, prompted_minds
from reasoned_explorer.model import Goal, Scene, SettingsError
from reasoned_explorer.planning.llm_rrt import LlmRrt
from tests.minds.helpers import scene
from tests.minds.prompted.fakes import (
    NOT_UNDERSTOOD,
    UNDERSTOOD,
    Fake,
    fair,
    fair_json,
    fair_lines,
    in_turn,
    inside,
    lines,
    with_logprobs,
)

GOAL = Goal("Find me a bench")
WITH = "The image shows a park. In the foreground, close to the viewer, a bench stands under a tree."
WITHOUT = "The image shows a street. Cars are parked on the right."
BEST = Abilities(json_schema=True, json_object=True, top_logprobs=10)


def run(call):
    return asyncio.run(call)


@pytest.mark.parametrize("abilities", [Abilities(), Abilities(json_object=True), BEST])
@pytest.mark.parametrize("way", UNDERSTOOD)
def test_what_a_model_says_clearly_counts_however_it_says_it(way: str, abilities: Abilities):
    fake = Fake(UNDERSTOOD[way])
    minds = PromptedMinds(fake, abilities)
    scenes = [scene(WITH, 0, 0, 0), scene(WITHOUT, 0, 0, 1)]
    high, low = run(minds.evaluate(GOAL, scenes))
    assert (high.level_probabilities, low.level_probabilities) == ((0, 0, 0, 0, 1), (0, 1, 0, 0, 0))
    yes, no = run(minds.check(GOAL, scenes))
    assert (yes.found, no.found) == (True, False)
    assert yes.confidence > 0.5 > no.confidence
    ((child,), _) = run(minds.imagine(GOAL, scenes, count=1))
    assert child.text.startswith("A footpath leads on")
    assert [answer.fault for answer in (high, low, yes, no, child)] == [None] * 5
    assert len(fake.asked) == 6
    assert not any(tally.asked_again or tally.missing for tally in minds.tallies.values())


@pytest.mark.parametrize("way", NOT_UNDERSTOOD)
def test_what_cannot_be_understood_is_asked_for_once_more_and_then_missing(way: str):
    fake = Fake(NOT_UNDERSTOOD[way])
    minds = PromptedMinds(fake)
    (assessment,) = run(minds.evaluate(GOAL, [scene(WITH)]))
    assert (assessment.level_probabilities, assessment.score) == (None, None)
    assert assessment.fault is not None
    assert assessment.fault.startswith("not understood: ")
    (verdict,) = run(minds.check(GOAL, [scene(WITH)]))
    assert (verdict.found, verdict.confidence) == (False, 0.0)
    assert verdict.fault is not None
    assert len(fake.asked) == 4
    first, second = fake.asked[:2]
    assert second.user.startswith(first.user)
    assert "could not be used: it " in second.user
    assert minds.tallies["evaluator"].asked_again == minds.tallies["checker"].missing == 1


@pytest.mark.parametrize("way", ["is cut off", "declines", "says nothing", "has wrong types", "says several things"])
def test_a_scene_that_cannot_be_understood_is_missing(way: str):
    fake = Fake(NOT_UNDERSTOOD[way])
    ((child,),) = run(PromptedMinds(fake).imagine(GOAL, [scene(WITH, 1, 0, 2)], count=1))
    assert (child.text, child.key, child.depth) == ("", (1, 0, 2, 0), 1)
    assert child.fault is not None
    assert len(fake.asked) == 2


def test_a_second_answer_that_is_understood_counts():
    fake = Fake(in_turn(["It is a nice park.", "LEVEL: 4"]))
    minds = PromptedMinds(fake)
    (assessment,) = run(minds.evaluate(GOAL, [scene(WITH)]))
    assert (assessment.score, assessment.fault) == (4.0, None)
    assert (minds.tallies["evaluator"].asked_again, minds.tallies["evaluator"].missing) == (1, 0)


@pytest.mark.parametrize("fault", ["timeout: after 30 s", "refused: I cannot", "empty: no text (asked 3 times)"])
def test_a_fault_of_the_way_there_is_not_asked_again_here(fault: str):
    fake = Fake(lambda request: ChatAnswer(fault=fault))
    (assessment,) = run(PromptedMinds(fake).evaluate(GOAL, [scene(WITH)]))
    assert (assessment.level_probabilities, assessment.fault) == (None, fault)
    assert len(fake.asked) == 1


def test_an_answer_that_was_cut_off_is_given_more_room():
    fake = Fake(in_turn([ChatAnswer(fault="cut off: the tokens that were allowed did not do"), "LEVEL: 3"]))
    (assessment,) = run(PromptedMinds(fake).evaluate(GOAL, [scene(WITH)]))
    assert assessment.score == 3.0
    first, second = fake.asked
    assert second.max_tokens == 2 * first.max_tokens


def test_scenes_without_a_description_are_not_asked_about():
    fake = fair_lines()
    minds = PromptedMinds(fake)
    scenes = [scene("  "), scene(WITH, fault="the camera is broken")]
    faults = ["the scene has no description", "the camera is broken"]
    assert [answer.fault for answer in run(minds.evaluate(GOAL, scenes))] == faults
    assert [answer.fault for answer in run(minds.check(GOAL, scenes))] == faults
    assert [[child.fault for child in row] for row in run(minds.imagine(GOAL, scenes, count=2))] == [
        [fault] * 2 for fault in faults
    ]
    assert fake.asked == []


def test_log_probabilities_make_an_expectation_of_a_level_and_a_confidence_of_a_finding():
    def says(request: ChatRequest) -> ChatAnswer:
        assert request.top_logprobs == 10
        if request.role == "checker":
            return with_logprobs(
                ("FOUND:", {}), (" yes", {" yes": 0.6, " no": 0.2, "yes": 0.0}), ("\n", {}), ("CONFIDENCE: 1.0", {})
            )
        return with_logprobs(("LEVEL:", {}), (" ", {}), ("4", {"4": 0.5, "4.": 0.1, "3": 0.2}))

    minds = PromptedMinds(Fake(says), BEST)
    (assessment,) = run(minds.evaluate(GOAL, [scene(WITH)]))
    assert assessment.score == pytest.approx(3.75)
    (verdict,) = run(minds.check(GOAL, [scene(WITH)]))
    assert (verdict.found, verdict.confidence) == (True, 0.75)
    careful = PromptedMinds(Fake(says), BEST, PromptedSettings(halt_from=0.8))
    (verdict,) = run(careful.check(GOAL, [scene(WITH)]))
    assert (verdict.found, verdict.confidence) == (False, 0.75)


def test_a_no_is_never_a_halt_however_likely_a_yes_was():
    said = with_logprobs(("FOUND: ", {}), ("no", {"no": 0.1, "yes": 0.9}))
    (verdict,) = run(PromptedMinds(Fake(lambda request: said), BEST).check(GOAL, [scene(WITH)]))
    assert (verdict.found, verdict.confidence) == (False, 0.9)


def test_an_endpoint_is_asked_in_the_best_form_that_it_can_answer_in():
    def schemas(abilities: Abilities) -> dict[str, object]:
        fake = Fake(lambda request: json.dumps(fair(request)) if request.schema else lines(fair(request)))
        minds = PromptedMinds(fake, abilities)
        for call in (minds.evaluate, minds.check):
            run(call(GOAL, [scene(WITH)]))
        run(minds.imagine(GOAL, [scene(WITH)], count=1))
        for request in fake.asked:
            assert ("JSON" in request.user) == (request.schema is not None)
        return {request.role: request.schema for request in fake.asked}

    assert schemas(Abilities()) == {"evaluator": None, "checker": None, "visionary": None}
    assert schemas(Abilities(json_object=True)) == {"evaluator": ANY_OBJECT, "checker": ANY_OBJECT, "visionary": None}
    strict = schemas(BEST)
    assert all(
        isinstance(schema, dict)
        and sorted(schema["required"]) == sorted(schema["properties"])
        and not schema["additionalProperties"]
        for schema in strict.values()
    )


def test_children_differ_by_what_is_asked_and_views_share_their_draws():
    fake = fair_lines()
    minds = PromptedMinds(fake, seed=3)
    rows = run(minds.imagine(GOAL, [scene(WITH, 0, 0, view) for view in range(2)], count=3))
    assert [[child.key for child in row] for row in rows] == [
        [(0, 0, view, child) for child in range(3)] for view in range(2)
    ]
    assert [request.key for request in fake.asked] == [child.key for row in rows for child in row]
    seeds = [request.seed for request in fake.asked]
    assert seeds[:3] == seeds[3:]
    assert len(set(seeds)) == 3
    assert len({request.user for request in fake.asked}) == 3
    assert all(0 <= seed < 2**31 and request.temperature > 0 for seed, request in zip(seeds, fake.asked, strict=True))
    assert not any("goal" in inside(request.user) for request in fake.asked)
    other = fair_lines()
    run(PromptedMinds(other, seed=4).imagine(GOAL, [scene(WITH)], count=3))
    assert not {request.seed for request in other.asked} & set(seeds)


def test_the_same_question_is_asked_in_the_same_words_so_that_a_store_knows_it():
    first, second = fair_lines(), fair_lines()
    for fake, seed in ((first, 1), (second, 2)):
        minds = PromptedMinds(fake, seed=seed)
        run(minds.evaluate(GOAL, [scene(WITH)]))
        run(minds.check(GOAL, [scene(WITH)]))
    assert first.asked == second.asked
    assert [request.prompt for request in first.asked] == ["evaluator/1", "checker/1"]


def test_all_questions_of_a_batch_are_asked_at_once():
    clock = VirtualClock()
    fake = Fake(lambda request: lines(fair(request)), seconds=1.0)
    minds = prompted_minds(fake, name="fake")

    async def step() -> list[float]:
        times = []
        scenes = [scene(WITH, 0, 0, view) for view in range(8)]
        for call in (minds.visionary.imagine(GOAL, scenes, count=3), minds.evaluator.evaluate(GOAL, scenes)):
            await call
            times.append(clock.now_s())
        return times

    assert clock.run(step()) == pytest.approx([1.0, 2.0])
    assert len(fake.asked) == 32


def test_where_a_call_raises_the_others_end_before_it_comes_out():
    class SpentError(Exception):
        pass

    ended: list[str] = []

    class Breaks:
        async def ask(self, request: ChatRequest) -> ChatAnswer:
            if request.key[-1] == 1:
                raise SpentError
            try:
                await asyncio.Event().wait()
            finally:
                ended.append(request.role)
            raise AssertionError

    with pytest.raises(SpentError):
        run(PromptedMinds(Breaks()).evaluate(GOAL, [scene(WITH, 0, 0, view) for view in range(3)]))
    assert ended == ["evaluator"] * 2


def test_the_waypoint_is_never_read():
    class Untouchable:
        def __getattribute__(self, name: str) -> object:
            raise AssertionError(f"a mind read {name} of the waypoint")

    closed = Scene(WITH, (0, 0, 0), Untouchable())  # type: ignore[arg-type]
    minds = PromptedMinds(fair_lines())
    run(minds.evaluate(GOAL, [closed]))
    run(minds.check(GOAL, [closed]))
    run(minds.imagine(GOAL, [closed], count=2))


def test_a_planner_works_with_what_is_there_where_answers_are_missing():
    def says(request: ChatRequest) -> str:
        if request.key[:3] == (0, 0, 1) or request.key[:4] == (0, 0, 0, 2):
            return "I'm sorry, but I can't help with that."
        return lines(fair(request))

    fake = Fake(says)
    minds = prompted_minds(fake, name="fake")
    plan = run(LlmRrt(minds).plan(GOAL, [scene(WITH, 0, 0, view) for view in range(3)]))
    assert [score.q for score in plan.scores] == [2.0, None, 2.0]
    assert plan.scores[1].fault == "not understood: it declined to answer"


def test_settings_out_of_range_are_told_all_at_once():
    with pytest.raises(SettingsError) as refused:
        PromptedSettings(visionary_temperature=float("nan"), halt_from=2.0, spare_tokens=-1)
    assert len(refused.value.faults) == 3


def test_minds_are_labelled_with_the_model_that_they_ask(tmp_path: Path):
    minds = prompted_minds(fair_json(), name="openai:small", seed=5)
    assert isinstance(minds, Minds)
    assert (minds.label, minds.seed) == ("openai:small", 5)
    with pytest.raises(SettingsError, match="No such file"):
        prompted_minds(fair_json(), name="fake", settings=PromptedSettings(prompts=tmp_path))


def test_models_that_think_aloud_are_given_room():
    plain, roomy = fair_lines(), fair_lines()
    run(PromptedMinds(plain).evaluate(GOAL, [scene(WITH)]))
    run(PromptedMinds(roomy, settings=PromptedSettings(spare_tokens=1000)).evaluate(GOAL, [scene(WITH)]))
    assert roomy.asked[0].max_tokens == plain.asked[0].max_tokens + 1000
