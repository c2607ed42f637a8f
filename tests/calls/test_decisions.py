"""Typed decisions: what is sent, and what may come back."""

import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.calls.chat import ChatRequest, DecisionQuestion
from reasoned_explorer.calls.decisions import decision_parameters, read_decision
from reasoned_explorer.calls.stored import parts_of

LEVELS = ("very unlikely", "unlikely", "possible", "likely", "very likely")
QUESTIONS = (DecisionQuestion("blocked", "It is blocked."), DecisionQuestion("level", "How promising?", LEVELS))


def _request(**changes: Any) -> ChatRequest:
    return ChatRequest(**{"role": "evaluator", "key": (0,), "system": "You rate.", "user": "A wall.", "prompt": "p/1",
                          "questions": QUESTIONS, **changes})  # fmt: skip


def _body(*answers: dict[str, Any], **more: Any) -> bytes:
    usage = {"input_tokens": 40, "output_tokens": 2}
    return json.dumps({"answers": list(answers), "model": "m-1", "usage": usage, **more}).encode()


def _yes(probability: float) -> dict[str, Any]:
    return {"type": "predicate", "name": "blocked", "probability": probability}


def _score(*probabilities: float, labels: tuple[str, ...] = LEVELS) -> dict[str, Any]:
    told = [
        {"label": label, "probability": p, "value": n}
        for n, (label, p) in enumerate(zip(labels, probabilities, strict=True))
    ]
    return {"type": "score", "name": "level", "score": 0.0, "confidence": 1.0, "probabilities": told}


def test_each_question_is_sent_with_its_type() -> None:
    sent = decision_parameters(_request(images=(b"\x89PNG",)), "m")
    assert [each["type"] for each in sent["questions"]] == ["predicate", "score"]
    assert [each["label"] for each in sent["questions"][1]["levels"]] == list(LEVELS)
    assert sent["input"][0] == {"type": "message", "role": "system", "content": "You rate."}
    assert [part["type"] for part in sent["input"][1]["content"]] == ["input_text", "input_image"]
    assert not {"temperature", "seed", "max_tokens"} & set(sent)


def test_what_is_likeliest_is_the_answer_and_what_else_it_could_be_stands_beside_it() -> None:
    reading = read_decision(_body(_yes(0.25), _score(0.0, 0.1, 0.2, 0.6, 0.1)), QUESTIONS)
    assert json.loads(reading.text) == {"blocked": False, "level": 4}
    assert (reading.tokens_in, reading.tokens_out, reading.counted, reading.model) == (40, 2, True, "m-1")
    level = reading.tokens[3]
    assert dict(level.alternatives) == pytest.approx(
        {"4": math.log(0.6), "3": math.log(0.2), "2": math.log(0.1), "5": math.log(0.1)}
    )


@pytest.mark.parametrize(
    ("body", "fault", "again"),
    [
        (b"<html>", "malformed: the answer is no JSON", True),
        (b"[]", "wrong types: the whole", True),
        (_body(_yes(0.5)), "wrong types: answers: 1 answers to 2 questions", True),
        (_body(_yes(1.5), _score(1, 0, 0, 0, 0)), "wrong types: answers.0.probability", True),
        (_body(_yes(0.5), _score(0.5, 0.1, 0.1, 0.1, 0.1)), "no probabilities that fit level", True),
        (_body(_yes(0.5), _score(0.5, 0.5, labels=LEVELS[:2])), "no probabilities that fit level", True),
        (_body(_score(1.0, 0, 0, 0, 0), _yes(0.5)), "no probabilities that fit blocked, level", True),
        (_body({"type": "refusal", "name": "blocked"}, _score(1.0, 0, 0, 0, 0)), "refused: blocked", False),
        (_body({"type": "essay"}, _yes(0.5)), "wrong types: answers.0.type", True),
    ],
)
def test_what_is_no_answer_is_a_fault(body: bytes, fault: str, *, again: bool) -> None:
    reading = read_decision(body, QUESTIONS)
    assert reading.fault is not None
    assert fault in reading.fault
    assert (reading.text, reading.again) == ("", again)


@given(st.lists(st.floats(0.0, 1.0), min_size=5, max_size=5).filter(lambda each: sum(each) > 0.01), st.floats(0.0, 1.0))
def test_probabilities_stay_probabilities(weights: list[float], yes: float) -> None:
    total = sum(weights)
    reading = read_decision(_body(_yes(yes), _score(*(each / total for each in weights))), QUESTIONS)
    assert reading.fault is None
    assert json.loads(reading.text)["level"] == 1 + max(range(5), key=lambda place: weights[place] / total)
    for token in reading.tokens:
        if token.alternatives:
            assert math.fsum(math.exp(chance) for _, chance in token.alternatives) == pytest.approx(1.0)
            assert token.token == token.alternatives[0][0]


@given(st.binary(max_size=200))
def test_no_body_breaks_the_reader(body: bytes) -> None:
    assert read_decision(body, QUESTIONS).fault is not None


def test_other_questions_are_another_request() -> None:
    plain, asked = _request(questions=()), _request()
    other = _request(questions=QUESTIONS[:1])
    digests = {parts_of("model", each).digest for each in (plain, asked, other)}
    assert len(digests) == 3
