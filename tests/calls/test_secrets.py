import pytest

from reasoned_explorer.calls.secrets import HIDDEN, scrub


@pytest.mark.parametrize(
    "name", ["OPENAI_API_KEY", "SOME_VENDOR_APIKEY", "HF_TOKEN", "AWS_SECRET_ACCESS_KEY", "DB_PASSWORD", "my_api_key"]
)
def test_what_stands_in_a_variable_for_keys_is_hidden(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, "sk-planted-1")
    assert scrub("Bearer sk-planted-1 is wrong") == f"Bearer {HIDDEN} is wrong"


def test_a_key_that_begins_like_another_is_hidden_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("A_API_KEY", "sk-planted")
    monkeypatch.setenv("B_API_KEY", "sk-planted-and-longer")
    assert scrub("sk-planted-and-longer sk-planted") == f"{HIDDEN} {HIDDEN}"


def test_ordinary_values_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LOCAL_API_KEY", "EMPTY")  # what servers without keys are given
    monkeypatch.setenv("KEYBOARD", "qwertzuiop")
    assert scrub("EMPTY qwertzuiop") == "EMPTY qwertzuiop"
