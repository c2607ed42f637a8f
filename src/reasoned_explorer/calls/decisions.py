"""The wire form of typed decisions: questions with typed answers and probabilities, where an endpoint offers them.

``POST /decisions`` of OpenAI's API, as its SDK 3.57 types it: a predicate comes back with its probability, a score with
the probability of each of its levels. What comes back is put into the words that a model without such answers is asked
for, a JSON object and the log-probabilities of its values, so that whoever reads answers need not know the difference.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from reasoned_explorer.calls.chat import ChatRequest, DecisionQuestion, TokenChoice
from reasoned_explorer.calls.completion import Reading, data_url, fault_of_body

#: Probabilities of the levels may add up to 1 but for so much.
_ROUNDING = 0.02


class _Wire(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True)


class _Level(_Wire):
    label: str
    probability: float = Field(ge=0.0, le=1.0)


class _Answer(_Wire):
    type: Literal["predicate", "score", "refusal"]
    probability: float | None = Field(default=None, ge=0.0, le=1.0)
    probabilities: list[_Level] = []


class _Usage(_Wire):
    input_tokens: int = 0
    output_tokens: int = 0


class _Decision(_Wire):
    answers: list[_Answer]
    model: Any = None


class _UsageOnly(_Wire):
    usage: _Usage | None = None


def decision_parameters(request: ChatRequest, model: str) -> dict[str, Any]:
    """Return what is sent for a request with questions.

    Args:
        request: What is asked; its length, temperature and seed have no meaning here and are left out.
        model: By the server's name.
    """
    content: str | list[dict[str, Any]] = request.user
    if request.images:
        pictures = [{"type": "input_image", "image_url": data_url(each)} for each in request.images]
        content = [{"type": "input_text", "text": request.user}, *pictures]
    told = [{"type": "message", "role": "system", "content": request.system}] if request.system else []
    return {
        "model": model,
        "input": [*told, {"type": "message", "role": "user", "content": content}],
        "questions": [_question(each) for each in request.questions],
    }


def _question(question: DecisionQuestion) -> dict[str, Any]:
    asked: dict[str, Any] = {"name": question.name, "instructions": question.instructions}
    if not question.levels:
        return {**asked, "type": "predicate"}
    return {**asked, "type": "score", "levels": [{"label": label} for label in question.levels]}


def read_decision(body: bytes, questions: Sequence[DecisionQuestion]) -> Reading:
    """Return what the body of an answer says, as a JSON object with one key for each question.

    A predicate is true or false, whichever is likelier; a score is its likeliest level, counted from 1. Kinds of faults
    are those of `completion.read_completion`; an answer in which one question was refused is refused.

    Args:
        body: Of an answer of status 200.
        questions: That were asked.
    """
    try:
        usage = _UsageOnly.model_validate_json(body).usage
    except ValidationError:
        usage = None
    counts = (max(0, usage.input_tokens), max(0, usage.output_tokens)) if usage is not None else (0, 0)

    def spent(**found: Any) -> Reading:
        return Reading(tokens_in=counts[0], tokens_out=counts[1], counted=usage is not None, **found)

    try:
        decision = _Decision.model_validate_json(body)
    except ValidationError as error:
        return spent(fault=fault_of_body(error, body), again=True)
    name = decision.model if isinstance(decision.model, str) else ""
    if len(decision.answers) != len(questions):
        what = f"{len(decision.answers)} answers to {len(questions)} questions"
        return spent(fault=f"wrong types: answers: {what}", again=True, model=name)
    refused = [q.name for q, answer in zip(questions, decision.answers, strict=True) if answer.type == "refusal"]
    if refused:
        return spent(fault=f"refused: {', '.join(refused)}", model=name)
    chances = [_chances(q, answer) for q, answer in zip(questions, decision.answers, strict=True)]
    unread = [q.name for q, each in zip(questions, chances, strict=True) if each is None]
    if unread:
        what = f"no probabilities that fit {', '.join(unread)}"
        return spent(fault=f"wrong types: answers: {what}", again=True, model=name)
    tokens = _tokens([(q.name, each) for q, each in zip(questions, chances, strict=True) if each is not None])
    return spent(text="".join(token.token for token in tokens), tokens=tokens, model=name)


def _chances(question: DecisionQuestion, answer: _Answer) -> Mapping[str, float] | None:
    """Return the probability of each value by its JSON, in the order of the values; None where they do not fit."""
    if not question.levels:
        yes = answer.probability if answer.type == "predicate" else None
        return None if yes is None else {"true": yes, "false": 1.0 - yes}
    told = {each.label: each.probability for each in answer.probabilities}
    if answer.type != "score" or set(told) != set(question.levels):
        return None
    total = math.fsum(told.values())
    if abs(total - 1.0) > _ROUNDING:
        return None
    return {f"{number}": told[label] / total for number, label in enumerate(question.levels, 1)}


def _tokens(answers: Sequence[tuple[str, Mapping[str, float]]]) -> tuple[TokenChoice, ...]:
    """Return a JSON object in pieces: each value is one, with what else it could have been."""
    found: list[TokenChoice] = []
    for place, (name, chances) in enumerate(answers):
        ranked = sorted(chances, key=lambda value: -chances[value])  # of equals the first
        alternatives = tuple((value, math.log(chances[value])) for value in ranked if chances[value] > 0.0)
        found.append(TokenChoice(("{" if place == 0 else ", ") + json.dumps(name) + ": "))
        found.append(TokenChoice(ranked[0], alternatives))
    return (*found, TokenChoice("}"))
