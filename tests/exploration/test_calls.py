"""Whole missions of the agent whose parts ask a model: in mixed time, from the tape, and under a budget."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.caller import Caller, end_of
from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.tape import TapePlayer, TapeRecorder
from reasoned_explorer.clock import MixedClock
from reasoned_explorer.exploration.explorer import Exploration
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Goal, Scene, Verdict, View
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.planning import FrontierScore, Plan
from tests.calls.fakes import FakeModel, question
from tests.exploration.fakes import Plane

SETTINGS = ExplorerSettings(t_max_s=120.0, looks_to_confirm=1)


@dataclass
class AskingParts:
    """A captioner, a planner and a checker that ask a model; the planner in two rounds, one after the other."""

    caller: Caller
    name: str = "asking"
    label: str = "asking"

    async def _ask(self, role: str, about: Sequence[tuple[tuple[int, ...], str]]) -> list[ChatAnswer]:
        asked = (question(*key, role=role, text=text) for key, text in about)
        return list(await asyncio.gather(*(self.caller.ask(request) for request in asked)))

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str]:
        about = [(view.key, f"{view.pose.x_m:.0f}, {view.pose.y_m:.0f}") for view in views]
        return [answer.text for answer in await self._ask("caption", about)]

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        imagined = await self._ask("visionary", [((*scene.key, 0), scene.text) for scene in scenes])
        about = [((*scene.key, 0), answer.text or "-") for scene, answer in zip(scenes, imagined, strict=True)]
        answers = await self._ask("evaluator", about)
        return Plan(
            tuple(
                FrontierScore(None, fault=answer.fault) if answer.fault else FrontierScore(float(answer.text))
                for answer in answers
            )
        )

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        answers = await self._ask("checker", [(scene.key, scene.text) for scene in scenes])
        return [Verdict(answer.text == "yes", 0.9, answer.text, answer.fault) for answer in answers]


def _model(*, found_in_step: int = 99) -> FakeModel:
    def rule(request: ChatRequest) -> ChatAnswer:
        score = 1.0 + sum(request.key) % 4
        texts = {
            "caption": f"a path at {request.user}",
            "visionary": f"beyond {request.user}",
            "evaluator": str(score),
            "checker": "yes" if request.key[0] >= found_in_step else "no",
        }
        return ChatAnswer(texts[request.role], tokens_in=9, usd=0.001)

    waits = {"caption": 0.001, "checker": 0.004, "evaluator": 0.02 if found_in_step == 99 else 0.3, "visionary": 0.02}
    return FakeModel(rule, delay_s=lambda request: waits[request.role])


def _run(model: FakeModel, **stores: Any) -> tuple[Exploration, Plane]:
    plane = Plane(settings=SETTINGS, clock=MixedClock())
    parts: Any = AskingParts(Caller(model, clock=plane.clock, ledger=plane.ledger, **stores))
    plane.captioner = plane.planner = plane.checker = parts
    plane.must_end = end_of([parts.caller])
    return plane.run(), plane


@pytest.mark.parametrize("found_in_step", [99, 2], ids=["until time is over", "found while planning"])
def test_a_mission_replayed_from_the_tape_has_the_same_record(found_in_step: int, tmp_path: Path) -> None:
    with TapeRecorder(tmp_path / "tape") as tape:
        ended, plane = _run(_model(found_in_step=found_in_step), tape=tape)
    faults = [call.fault for step in plane.steps for call in step.calls if call.fault]
    assert ended.end is (MissionEnd.FOUND if found_in_step == 2 else MissionEnd.TIME_OVER)
    assert set(faults) == ({"cancelled"} if found_in_step == 2 else set())
    silent = FakeModel()
    ended_again, plane_again = _run(silent, tape=TapePlayer(tmp_path / "tape"))
    assert silent.asked == []
    assert ended_again == ended
    assert plane_again.steps == plane.steps


def test_ct_is_what_the_calls_on_the_critical_path_took() -> None:
    _, plane = _run(_model())
    for step in plane.steps:
        slowest = {
            role: max(call.latency_s for call in step.calls if call.role == role)
            for role in ("caption", "visionary", "evaluator")
        }
        assert step.think_s == pytest.approx(sum(slowest.values()), abs=1e-5)


def test_a_mission_ends_when_the_budget_of_its_run_is_spent_and_travels_no_further() -> None:
    model = _model()
    ended, plane = _run(model, budget=Budget(usd=0.020))  # a step asks 12 calls of 0.001
    assert ended.end is MissionEnd.BUDGET_SPENT
    assert "0.02 US dollars" in ended.reason
    assert len(plane.steps) == 2
    assert plane.steps[-1].legs == ()
    assert len(model.asked) <= 20


def test_a_mission_of_other_settings_than_the_tape_s_ends_and_says_so(tmp_path: Path) -> None:
    with TapeRecorder(tmp_path / "tape") as tape:
        _run(_model(), tape=tape)
    silent = FakeModel(fingerprint="fake:other")
    ended, plane = _run(silent, tape=TapePlayer(tmp_path / "tape"))
    assert ended.end is MissionEnd.FAULT
    assert "model fake:model at home on the tape, fake:other now" in ended.reason
    assert len(plane.steps) == 1
    assert silent.asked == []
