"""A model that answers what it is told to, after tiny but real waits, and questions for it."""

import asyncio
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest


def _echo(request: ChatRequest) -> ChatAnswer:
    return ChatAnswer(
        f"{request.role} says {request.user}", tokens_in=10, tokens_out=3, usd=0.01, retries=1, model="fake-1"
    )


@dataclass
class FakeModel:
    """Answers by a rule, after the seconds that another rule says; counts who was asked and who was cancelled."""

    rule: Callable[[ChatRequest], Any] = _echo
    delay_s: Callable[[ChatRequest], float] = lambda _: 0.002
    name: str = "fake:model"
    fingerprint: str = "fake:model at home"
    is_local: bool = True
    asked: list[ChatRequest] = field(default_factory=list)
    cancelled: list[ChatRequest] = field(default_factory=list)
    was_cancelled: threading.Event = field(default_factory=threading.Event)

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        self.asked.append(request)
        try:
            await asyncio.sleep(self.delay_s(request))
        except asyncio.CancelledError:
            self.cancelled.append(request)
            self.was_cancelled.set()
            raise
        answer: ChatAnswer = self.rule(request)
        return answer


def question(*key: int, role: str = "evaluator", text: str = "", **changes: Any) -> ChatRequest:
    """Return a question about a scene; its text is the scene's unless another one is given."""
    asked = ChatRequest(role, key or (0, 0, 0), "You score scenes.", text or f"scene {key}", "evaluator/1")
    return replace(asked, **changes)
