"""Models on this machine, from question to answer, on tiny ones of random weights."""

import asyncio
import io
import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.local import LocalModel, LocalSettings

Local = Callable[..., LocalModel]
SEEING = ("kosmos-2", "idefics3", "smolvlm")
TALKING = ("llama", "llama, no system", "llama, no template")


def picture(number: int, patch_px: int = 20) -> bytes:
    """A PNG of sixteen patches, different for each number."""
    patches = np.random.default_rng(number).integers(0, 256, (4, 4, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(patches.repeat(patch_px, axis=0).repeat(patch_px, axis=1)).save(file, "PNG")
    return file.getvalue()


def question(number: int = 0, **settings: Any) -> ChatRequest:
    request = ChatRequest("caption", (0, 0, number), "Be brief.", "Describe this image in detail:", "test/1")
    return replace(request, max_tokens=8, **settings) if "max_tokens" not in settings else replace(request, **settings)


def looked_at(number: int, **settings: Any) -> ChatRequest:
    return question(number, images=(picture(number),), **settings)


def ask(model: LocalModel, requests: Sequence[ChatRequest]) -> list[ChatAnswer]:
    async def together() -> list[ChatAnswer]:
        return await asyncio.gather(*(model.ask(request) for request in requests))

    return asyncio.run(together())


def likelihoods(answer: ChatAnswer) -> list[float]:
    return [logprob for token in answer.tokens for _, logprob in token.alternatives]


@pytest.mark.parametrize("kind", SEEING)
def test_views_are_captioned_in_one_batch_as_they_are_one_by_one(local: Local, kind: str) -> None:
    # Three fill a batch up, which is then not held up, however long one would wait for more.
    model, singly = local(kind, LocalSettings(most=3, linger_s=1.0)), local(kind, LocalSettings(most=1))
    assert model.sees
    assert model.family == kind
    requests = [looked_at(number, top_logprobs=3) for number in range(3)]
    before, before_singly = len(model.batches), len(singly.batches)
    together, apart = ask(model, requests), ask(singly, requests)
    assert model.batches[before:] == [3]
    assert singly.batches[before_singly:] == [1, 1, 1]
    for one, other in zip(together, apart, strict=True):
        assert one.fault is None
        assert one.text == other.text != ""
        assert (one.tokens_in, one.tokens_out) == (other.tokens_in, other.tokens_out)
        np.testing.assert_allclose(likelihoods(one), likelihoods(other), atol=1e-3)


@pytest.mark.parametrize("kind", SEEING)
@pytest.mark.parametrize("views", [3, 5, 8])
def test_all_views_go_through_the_network_together(local: Local, kind: str, views: int) -> None:
    model = local(kind, LocalSettings(most=views, linger_s=1.0))
    rows: list[int] = []

    def count(_layer: Any, _arguments: Any, logits: Any) -> None:
        rows.append(len(logits))

    # Kosmos-2 writes with a part of itself; the layer that chooses words is used by every kind.
    hook = model._generator.model.get_output_embeddings().register_forward_hook(count)
    try:
        answers = ask(model, [looked_at(number) for number in range(views)])
    finally:
        hook.remove()
    assert [answer.fault for answer in answers] == [None] * views
    # One pass for the pictures and the first word, and one for each further word, each of all views.
    assert rows == [views] * max(answer.tokens_out for answer in answers)


@pytest.mark.parametrize("kind", SEEING)
def test_what_is_said_depends_on_the_picture(local: Local, kind: str) -> None:
    one, other = ask(local(kind), [looked_at(number, top_logprobs=3) for number in (1, 2)])
    assert one.tokens_in == other.tokens_in
    assert not np.allclose(likelihoods(one)[:3], likelihoods(other)[:3], atol=1e-3)


@pytest.mark.parametrize("kind", ["idefics3", "smolvlm"])
def test_a_small_picture_is_not_cut_into_tiles(local: Local, kind: str) -> None:
    small, large = [question(images=(picture(1, patch_px),)) for patch_px in (8, 20)]  # 32 pixels are one tile, 80 more
    fewer, more = [ask(local(kind), [request])[0].tokens_in for request in (small, large)]
    assert more - fewer > 16  # four tiles beside the whole, of four tokens each, and their marks


@pytest.mark.parametrize("kind", TALKING)
def test_questions_of_different_length_are_answered_together_as_they_are_alone(local: Local, kind: str) -> None:
    model = local(kind)
    assert not model.sees
    requests = [
        question(number, user="Is there a bench? " * (number + 1), max_tokens=6 + number) for number in range(4)
    ]
    together = ask(model, requests)
    assert [answer.text for answer in together] == [ask(model, [request])[0].text for request in requests]
    counts = [answer.tokens_in for answer in together]
    assert counts == sorted(set(counts))
    assert all(answer.tokens_out <= request.max_tokens for answer, request in zip(together, requests, strict=True))


@pytest.mark.parametrize("kind", ["llama", "llama, no system", "llama, no template"])
def test_what_the_system_says_is_told_to_every_kind_of_model(local: Local, kind: str) -> None:
    brief, long = ask(local(kind), [question(system="Be brief."), question(system="Be as long as you like.")])
    assert long.tokens_in - brief.tokens_in == len("Be as long as you like.") - len("Be brief.")


def test_log_probabilities_are_those_of_the_likeliest_tokens(local: Local) -> None:
    (answer,) = ask(local("llama"), [question(top_logprobs=5)])
    assert len(answer.tokens) > 0
    for place in answer.tokens:
        logprobs = [logprob for _, logprob in place.alternatives]
        assert len(logprobs) == 5
        assert logprobs == sorted(logprobs, reverse=True)
        assert sum(map(math.exp, logprobs)) <= 1.0 + 1e-6
        assert place.token == place.alternatives[0][0]  # nothing was sampled
    assert ask(local("llama"), [question()])[0].tokens == ()


def test_a_sample_follows_from_its_seed_whoever_is_asked_beside_it(local: Local) -> None:
    model = local("llama")
    requests = [question(temperature=1.0, seed=seed, max_tokens=24) for seed in (1, 2, 1)]
    before = len(model.batches)
    one, other, again = ask(model, requests)
    assert model.batches[before:] == [1, 1, 1]
    assert one.text == again.text != other.text


def test_a_question_that_is_too_long_is_a_fault_and_costs_the_others_nothing(local: Local) -> None:
    model = local("llama, short")
    fits, too_long, fits_too = ask(
        model, [question(user="a"), question(user="bench " * 20), question(user="b", max_tokens=4)]
    )
    assert fits.fault is None
    assert fits_too.fault is None
    assert fits_too.tokens_out <= 4
    assert "too long" in str(too_long.fault)
    assert "64 together" in str(too_long.fault)


def test_a_broken_picture_is_a_fault_and_costs_the_others_nothing(local: Local) -> None:
    model = local("idefics3")
    well, broken, well_too = ask(model, [looked_at(1), question(images=(b"not a picture",)), looked_at(2)])
    assert "UnidentifiedImageError" in str(broken.fault)
    assert well.text == ask(model, [looked_at(1)])[0].text
    assert well_too.text == ask(model, [looked_at(2)])[0].text


def test_a_model_says_what_it_cannot_read(local: Local) -> None:
    assert ask(local("llama"), [looked_at(1)])[0].fault == "this model reads no pictures"
    assert ask(local("kosmos-2"), [question()])[0].fault == "this model reads one picture a call, not 0"
    # A model that sees can be asked about text, too.
    assert ask(local("idefics3"), [question()])[0].fault is None


def test_a_cancelled_call_ends_the_writing(local: Local) -> None:
    model = local("llama")
    network = model._generator.model
    started, steps = threading.Event(), []

    def count(*_: Any) -> None:
        steps.append(1)
        started.set()

    async def give_up() -> ChatAnswer:
        task = asyncio.ensure_future(model.ask(question(max_tokens=900)))
        await asyncio.to_thread(started.wait, 60.0)
        task.cancel()
        await asyncio.wait([task])
        return await model.ask(question(max_tokens=2))

    hook = network.register_forward_hook(count)
    # It would never end by itself: what it likes to say most is not the end.
    try:
        answer = asyncio.run(give_up())
    finally:
        hook.remove()
    assert answer.fault is None
    assert len(steps) < 900


def test_memory_that_does_not_suffice_for_all_is_used_for_fewer(local: Local, monkeypatch: pytest.MonkeyPatch) -> None:
    import torch

    model = local("llama")
    network = model._generator.model
    generate = network.generate

    def small(**inputs: Any) -> Any:
        if len(inputs["input_ids"]) > 1 or inputs["max_new_tokens"] > 100:
            raise torch.OutOfMemoryError("CUDA out of memory. Tried to allocate 80.00 GiB.")
        return generate(**inputs)

    monkeypatch.setattr(network, "generate", small)
    *well, much = ask(model, [question(user=letter) for letter in "abc"] + [question(max_tokens=200)])
    assert [answer.fault for answer in well] == [None] * 3
    assert "out of memory" in str(much.fault)
