"""How many calls at once the models of a mission are sent."""

import asyncio

import pytest

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.chat import ChatAnswer, ChatModel, ChatRequest
from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.evaluation.model_desk import ModelDesk, _most_at_once

pytest.importorskip("openai")
pytest.importorskip("aiohttp")

from tests.calls.stub_server import Behaviour, StubServer


def asked(model: ChatModel, count: int) -> list[ChatAnswer]:
    async def together() -> list[ChatAnswer]:
        return await asyncio.gather(
            *(model.ask(ChatRequest("evaluator", (n,), "", f"Scene {n}.", "evaluator/1")) for n in range(count))
        )

    return asyncio.run(together())


def test_a_server_of_this_machine_that_answers_one_by_one_is_not_sent_all_at_once() -> None:
    # All at once, the last would wait for 40 times 0.1 s in the server's line, and its one try lasts for 2 s.
    asking = AskingSettings(try_s=2.0, tries=1)
    with StubServer(Behaviour(latency_s=0.1, at_once=1)) as server:
        (known,) = ModelDesk(base_url=server.base_url, asking=asking).prepare(["openai:tiny"])
        server.most_at_once = 0
        answers = asked(known.model, 40)
    assert [answer.fault for answer in answers] == [None] * 40
    assert server.most_at_once <= 4


@pytest.mark.parametrize(("seen", "most"), [(1.0, 2), (1.1, 3), (4.0, 8), (5.9, 12), (6.0, None), (8.0, None)])
def test_twice_as_many_are_sent_as_go_on_at_once(seen: float, most: int | None) -> None:
    assert _most_at_once(Abilities(parallel=seen)) == most
