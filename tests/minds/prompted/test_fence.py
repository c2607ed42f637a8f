import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.minds.prompted import fence
from reasoned_explorer.minds.prompted.fence import LONGEST_TEXT, fenced, harmless, has_mark
from reasoned_explorer.minds.prompted.reading import Unreadable, read_finding, read_judgement
from tests.minds.prompted.hostile import HOSTILE

ANY_TEXT = st.one_of(st.text(), st.sampled_from(HOSTILE), st.text(alphabet='<>{}:="yesno level found 12345/\n٤'))


def test_a_description_stays_as_it_is():
    text = (
        "In the foreground, close to the viewer on the left, there is a bench; 2 people walk in the rain (it is wet)."
    )
    assert harmless(text) == text
    assert harmless("A clock shows 10:30.\nBelow it, “Open”.") == "A clock shows 10.30. Below it, 'Open'."


@given(ANY_TEXT)
def test_no_text_closes_its_fence(text: str):
    first, inside, last = fenced("SCENE", text).split("\n")
    code = first.removeprefix("<<<SCENE ")
    assert re.fullmatch("[0-9a-f]{8}", code)
    assert last == f"SCENE {code}>>>"
    assert code not in inside
    assert not set('<>{}[]`"\\|:=') & set(inside)
    assert inside.splitlines() in ([], [inside])
    assert not has_mark(inside)


@given(ANY_TEXT)
def test_a_text_that_is_repeated_is_no_answer(text: str):
    assert isinstance(read_finding(harmless(text), [text]), Unreadable)
    assert isinstance(read_judgement(harmless(text), [text]), Unreadable)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_part_of_a_text_that_is_repeated_is_no_answer(text: str):
    words = harmless(text).split()
    for start in range(0, len(words), 1 + len(words) // 40):
        for end in (start + 2, start + 5, start + 9, len(words)):
            part = " ".join(words[start:end])
            if end > start + 1 and len(part.split()) > 1:
                assert isinstance(read_finding(part, [text]), Unreadable), part
                assert isinstance(read_judgement(part, [text]), Unreadable), part


def test_the_same_text_has_the_same_fence_and_another_text_another():
    assert fenced("SCENE", "a bench") == fenced("SCENE", "a bench")
    assert fenced("SCENE", "a bench").split("\n")[0] != fenced("SCENE", "a tree").split("\n")[0]
    assert has_mark(fenced("SCENE", "a bench"))
    assert not has_mark("<<<NAME code and NAME code>>>")


@pytest.mark.parametrize("text", ["<<SCENE 12f22", "SCENE d3bca3dd>>", "GOAL 18c3abd>", "18c3abdc >>", "<<< SCENE"])
def test_a_mark_is_known_as_small_models_write_it_down(text: str):
    assert has_mark(f"The scene: {text} A wall.")


def test_a_code_that_the_text_holds_is_drawn_again(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(fence, "_code", lambda text, draw: f"{draw:08x}")
    assert fenced("SCENE", "00000000 and 00000001").startswith("<<<SCENE 00000002\n")


def test_a_long_text_is_cut():
    assert len(harmless("word " * 10_000)) <= LONGEST_TEXT + 4
    assert harmless("word " * 10_000).endswith("word ...")
