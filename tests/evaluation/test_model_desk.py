"""How many calls at once the models of a mission are sent, and what is found out before a model is asked."""

import asyncio

import pytest

from reasoned_explorer.calls import endpoint, local
from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.chat import ChatAnswer, ChatModel, ChatRequest
from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.model_desk import ModelDesk, _most_at_once
from reasoned_explorer.model import SettingsError
from reasoned_explorer.world.opening import open_world

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


def test_a_price_that_a_budget_needs_is_looked_up_before_a_call_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(endpoint, "_is_loopback", lambda _: False)  # this machine's own costs nothing
    with StubServer(Behaviour()) as server:
        desk = ModelDesk(base_url=server.base_url, budget=Budget(usd=1.0))
        with pytest.raises(SettingsError, match="the price of openai:tiny is not known"):
            desk.prepare(["openai:tiny"])
        assert not server.received


def test_whether_a_model_is_on_another_machine_is_known_before_it_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    with StubServer(Behaviour()) as server:
        desk = ModelDesk(base_url=server.base_url)
        assert desk.other_machine("openai:tiny") is None
        assert desk.other_machine("hf:org/tiny") is None
        monkeypatch.setattr(endpoint, "_is_loopback", lambda _: False)
        assert desk.other_machine("openai:tiny") == f"openai:tiny at {server.base_url}"
        assert not server.received


def test_what_only_describes_is_refused_as_a_mind_before_it_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local, "only_describes", lambda name: "kosmos" in name)
    monkeypatch.setattr(local, "load_local", lambda name: pytest.fail(f"{name} was loaded"))
    desk = ModelDesk()
    desk.check_minds(["hf:org/llama", "openai:kosmos"])
    with pytest.raises(SettingsError) as raised:
        desk.check_minds(["hf:kosmos-2", "hf:org/llama", "hf:kosmos-2.5", "hf:kosmos-2"])
    assert [fault.what for fault in raised.value.faults] == [
        "hf:kosmos-2 describes pictures only",
        "hf:kosmos-2.5 describes pictures only",
    ]
    settings = MissionSettings(evaluator="hf:kosmos-2", clock="mixed")
    with pytest.raises(SettingsError, match="hf:kosmos-2 describes pictures only"):
        Mission("Find me a bench", open_world("plaza:3@200"), settings, desk=desk)
