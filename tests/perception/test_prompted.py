"""Pictures in, words out: what is asked, what comes of answers, and tiny models of random weights from end to end."""

import asyncio
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.local import LocalModel, LocalSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Goal, PartError, SettingsError, Undescribed, View
from reasoned_explorer.perception.caption_prompt import caption_prompt
from reasoned_explorer.perception.prompted import PromptedCaptioner, captioner_for

GOAL = Goal("Find me a bench")


@dataclass
class Answering:
    """Gives the answers that it was given, in order, once all questions of a look are asked."""

    answers: Sequence[ChatAnswer]
    requests: list[ChatRequest] = field(default_factory=list)

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        place = len(self.requests)
        self.requests.append(request)
        async with asyncio.timeout(30.0):
            while len(self.requests) < len(self.answers):  # would never end for views asked one by one
                await asyncio.sleep(0)
        return self.answers[place]


def view(number: int, *, width: int = 48, height: int = 32) -> View:
    pixels = np.random.default_rng(number).integers(0, 256, (4, 4, 3), dtype=np.uint8)
    return View((7, 0, number), Pose(0.0, 0.0), image=pixels.repeat(height // 4, axis=0).repeat(width // 4, axis=1))


def described(captioner: PromptedCaptioner, views: Sequence[View]) -> Sequence[str | Undescribed]:
    return asyncio.run(captioner.describe(GOAL, views))


def test_all_views_are_asked_about_at_once_each_with_its_picture() -> None:
    model = Answering([ChatAnswer(f"view {number}") for number in range(3)])
    views = [view(number) for number in range(3)]
    captioner = PromptedCaptioner(model, name="openai:eyes", lossless=True)
    assert described(captioner, views) == ["view 0", "view 1", "view 2"]
    assert [request.key for request in model.requests] == [(7, 0, 0), (7, 0, 1), (7, 0, 2)]
    for request, seen in zip(model.requests, views, strict=True):
        (image,) = request.images
        np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(image))), seen.image)
        assert request.role == "caption"
        assert request.prompt == "caption/1"
        assert (request.temperature, request.seed) == (0.0, 0)
    assert captioner.label == "openai:eyes (prompt caption/1)"


def test_pictures_that_travel_are_packed_and_still_show_what_they_show() -> None:
    model = Answering([ChatAnswer("a bench")])
    seen = view(1, width=224, height=224)
    described(PromptedCaptioner(model, name="openai:eyes"), [seen])
    (image,) = model.requests[0].images
    with Image.open(io.BytesIO(image)) as opened:
        assert opened.format == "JPEG"
        assert opened.size == (224, 224)
        assert np.abs(np.asarray(opened).astype(int) - seen.image).mean() < 8.0
    assert len(image) < seen.image.nbytes / 4


def test_what_is_asked_does_not_depend_on_the_goal() -> None:
    asked = []
    for goal in (GOAL, Goal("I am thirsty")):
        model = Answering([ChatAnswer("a bench")])
        asyncio.run(PromptedCaptioner(model, name="x").describe(goal, [view(1)]))
        asked.append(model.requests)
    assert asked[0] == asked[1]


#: What may come back, and what is made of it.
LOST: dict[str, tuple[ChatAnswer, str]] = {
    "a fault": (ChatAnswer(fault="timeout after 30 s"), "timeout after 30 s"),
    "nothing": (ChatAnswer(" \n "), "the model said nothing"),
    "an apology": (ChatAnswer("I'm sorry, but I can't help with that."), "the model refused: I'm sorry, but I can't"),
    "a refusal": (ChatAnswer("I cannot describe this picture."), "the model refused"),
    "no eyes": (ChatAnswer("As an AI language model, I can't see pictures."), "the model refused"),
}


@pytest.mark.parametrize("what", LOST)
def test_a_view_that_gets_no_description_says_why_and_the_others_are_kept(what: str) -> None:
    answer, why = LOST[what]
    captioner = PromptedCaptioner(Answering([ChatAnswer("a bench"), answer, ChatAnswer("a tree")]), name="x")
    first, second, third = described(captioner, [view(number) for number in range(3)])
    assert (first, third) == ("a bench", "a tree")
    assert isinstance(second, Undescribed)
    assert second.fault.startswith(why)


@pytest.mark.parametrize(
    "text",
    [
        'A sign says "I am sorry, closed". The ground ahead is paved.',
        "I see a bench close on the left.",
        "A stall that I cannot name stands in the distance.",
    ],
)
def test_a_description_is_not_taken_for_a_refusal(text: str) -> None:
    assert described(PromptedCaptioner(Answering([ChatAnswer(text)]), name="x"), [view(0)]) == [text]


def test_a_look_of_which_nothing_is_described_is_a_fault_of_the_part() -> None:
    captioner = PromptedCaptioner(Answering([ChatAnswer(fault="timeout"), ChatAnswer(fault="timeout")]), name="x")
    with pytest.raises(PartError, match=r"no view is described: timeout$"):
        described(captioner, [view(0), view(1)])
    assert described(PromptedCaptioner(Answering([]), name="x"), []) == []


@pytest.mark.parametrize(
    ("image", "why"),
    [
        (None, "has no picture"),
        (np.zeros((8, 8), np.uint8), r"shape \(8, 8\)"),
        (np.zeros((8, 8, 4), np.uint8), r"shape \(8, 8, 4\)"),
        (np.zeros((8, 8, 3)), "float64"),
        (np.zeros((0, 8, 3), np.uint8), r"shape \(0, 8, 3\)"),
    ],
)
def test_what_is_no_picture_is_refused_before_anything_is_asked(image: Any, why: str) -> None:
    model = Answering([])
    with pytest.raises(PartError, match=why):
        described(PromptedCaptioner(model, name="x"), [view(0), View((0, 0, 1), Pose(0.0, 0.0), image=image)])
    assert model.requests == []


def test_descriptions_come_in_one_line() -> None:
    captioner = PromptedCaptioner(Answering([ChatAnswer(" A bench.\n\n  A tree.\n")]), name="x")
    assert described(captioner, [view(0)]) == ["A bench. A tree."]


def test_kosmos_2_is_asked_in_its_own_way_and_all_others_in_words() -> None:
    kosmos = caption_prompt("kosmos-2")
    assert kosmos.question.startswith("<grounding>")
    assert kosmos.system == ""
    assert caption_prompt("idefics3") == caption_prompt() == caption_prompt("a kind of tomorrow")
    assert caption_prompt().id == "caption/1"


@pytest.mark.parametrize("kind", ["kosmos-2", "idefics3", "smolvlm"])
def test_a_model_on_this_machine_describes_a_look_in_one_batch(local: Callable[..., LocalModel], kind: str) -> None:
    model = local(kind, LocalSettings(most=4, linger_s=1.0))
    captioner = captioner_for(model, model)
    assert captioner.prompt == caption_prompt(kind)
    before = len(model.batches)
    told = described(captioner, [view(number, width=224, height=224) for number in range(4)])
    assert model.batches[before:] == [4]
    assert len(told) == 4
    assert all(isinstance(text, str) and text for text in told)
    assert not any("<" in str(text) and "patch_index" in str(text) for text in told)
    assert len(set(told)) > 1


def test_a_model_that_reads_text_only_is_refused_before_a_mission_begins(local: Callable[..., LocalModel]) -> None:
    model = local("llama")
    with pytest.raises(SettingsError, match="reads text only"):
        captioner_for(model, model)


def test_an_endpoint_is_asked_in_words_and_sent_packed_pictures() -> None:
    @dataclass
    class Endpoint(Answering):
        name: str = "openai:eyes"
        fingerprint: str = "eyes"
        is_local: bool = False

    model = Endpoint([ChatAnswer("a bench")])
    described(captioner_for(model, model, temperature=0.5, seed=3), [view(1)])
    (request,) = model.requests
    assert (request.prompt, request.temperature, request.seed) == ("caption/1", 0.5, 3)
    assert request.images[0].startswith(b"\xff\xd8")  # a JPEG
