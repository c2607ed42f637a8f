import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.calls.chat import TokenChoice
from reasoned_explorer.calls.completion import read_completion, words_of_error

SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
JSON = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
)


def completion(*, message: Any = None, **choice: Any) -> dict[str, Any]:
    return {"model": "m", "choices": [{"message": {"content": "Yes."} if message is None else message, **choice}]}


def read(body: object, *, wants_structure: bool = False) -> tuple[str, str | None]:
    reading = read_completion(json.dumps(body).encode(), wants_structure=wants_structure)
    return reading.text, reading.fault


@given(st.binary(max_size=40))
def test_any_bytes_are_read_and_none_is_an_answer(body: bytes) -> None:
    assert read_completion(body).fault is not None


@given(JSON, st.sampled_from(["choices", "message", "content", "finish_reason", "logprobs", "usage", "model"]))
def test_whatever_stands_at_any_place_is_either_read_or_a_fault(value: Any, place: str) -> None:
    body: Any = completion()
    match place:
        case "message":
            body["choices"][0]["message"] = value
        case "content":
            body["choices"][0]["message"]["content"] = value
        case "finish_reason" | "logprobs":
            body["choices"][0][place] = value
        case _:
            body[place] = value
    reading = read_completion(json.dumps(body).encode())
    assert bool(reading.text) != (reading.fault is not None)
    assert reading.tokens_in >= 0
    if place in {"logprobs", "usage", "model"}:
        assert reading.text == "Yes."


def test_a_number_is_no_text() -> None:
    assert read(completion(message={"content": 5}))[1] == (
        "wrong types: choices.0.message.content: Input should be a valid string"
    )


def test_text_that_stops_at_its_length_is_text_but_no_structure() -> None:
    body = completion(message={"content": '{"level": 3, "wh'}, finish_reason="length")
    assert read(body) == ('{"level": 3, "wh', None)
    text, fault = read(body, wants_structure=True)
    assert text
    assert fault is not None
    assert fault.startswith("cut off")


def test_tokens_spent_on_nothing_are_cut_off_and_not_empty() -> None:
    body = completion(message={"content": ""}, finish_reason="length") | {
        "usage": {"prompt_tokens": 9, "completion_tokens": 256}
    }
    reading = read_completion(json.dumps(body).encode())
    assert reading.fault is not None
    assert reading.fault.startswith("cut off")
    assert (reading.tokens_in, reading.tokens_out) == (9, 256)


@pytest.mark.parametrize("usage", [None, 3, {"prompt_tokens": None}, {"prompt_tokens": "7"}])
def test_tokens_that_cannot_be_read_are_not_counted(usage: object) -> None:
    reading = read_completion(json.dumps(completion() | {"usage": usage}).encode())
    assert (reading.text, reading.counted, reading.tokens_in) == ("Yes.", False, 0)


def test_log_probabilities() -> None:
    told = {"content": [{"token": "4", "logprob": -0.2, "top_logprobs": [{"token": "4", "logprob": -0.2}]}]}
    reading = read_completion(json.dumps(completion(logprobs=told)).encode())
    assert reading.tokens == (TokenChoice("4", (("4", -0.2),)),)


SAID = {
    "OpenAI, as the SDK hands it on": ({"message": "No such model", "code": "x"}, "No such model"),
    "OpenAI, as it comes": ({"error": {"message": "No such model"}}, "No such model"),
    "Ollama": ({"error": "no such model"}, "no such model"),
    "FastAPI": ({"detail": "Server is pinned to 'a'; requested 'b'."}, "Server is pinned to 'a'; requested 'b'."),
    "FastAPI, of a form": (
        {"detail": [{"loc": ["body", "seed"], "msg": "not permitted", "input": {"temperature": 0}}, 7]},
        "'seed': not permitted",
    ),
    "text": (" Internal Server Error\n", "Internal Server Error"),
    "nothing": (None, ""),
    "a number": ({"error": 5, "detail": {"message": 6}}, ""),
}


@pytest.mark.parametrize("who", SAID)
def test_what_a_server_says_of_an_error(who: str) -> None:
    body, words = SAID[who]
    assert words_of_error(body) == words
