import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.minds.prompted import reading, values
from reasoned_explorer.minds.prompted.prompt import load_prompt
from reasoned_explorer.minds.prompted.reading import (
    CUT_OFF,
    DECLINED,
    EMPTY,
    NO_FOUND,
    NO_LEVEL,
    NO_SCENE,
    NOT_YES_OR_NO,
    REPEATED,
    SEVERAL,
    Finding,
    Judgement,
    Unreadable,
    read_finding,
    read_judgement,
    read_scene,
)

SHOWN = ["Find me a bench", "A lawn with 3 trees and a low wall. There is no bench."]


@pytest.mark.parametrize(
    ("answer", "level"),
    [
        ("4", 4), ("**4**", 4), ("4.", 4), ("4/5", 4), ("4 out of 5", 4), ("4 (likely)", 4), ("4 - likely", 4),
        ("four", 4), ("Very unlikely.", 1), ("LEVEL: 3", 3), ("Level: 3 (possible)", 3), ("**LEVEL:** 3", 3),
        ("**Level**: 3, as it is a park", 3), ("- Rating = 2", 2), ("SCORE: 2/5", 2), ("LEVEL: 3.5", 3.5),
        ("LEVEL: 3,5", 3.5), ("BLOCKED: no FORBIDDEN: no LEVEL: 2", 2), ("LEVEL：４", 4), ("LEVEL: ४", 4),
        ("I rate this scene a 4.", 4), ("The level is 2, for nothing is near.", 2), ("I'd say 4/5 overall.", 4),
        ("4\n\nTrees often stand beside benches.", 4), ("{level: 4, blocked: no}", 4), ("{'level': 4}", 4),
    ],
)  # fmt: skip
def test_a_level_is_read_however_it_is_said(answer: str, level: float):
    assert read_judgement(answer, SHOWN) == Judgement(level)


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("", EMPTY), ("```\n```", EMPTY), ("<think>level: 4", CUT_OFF), ('{"level": 4', CUT_OFF),
        ("I cannot rate scenes.", DECLINED), ("As an AI, I do not see.", DECLINED), ("I’m sorry.", DECLINED),
        ("It is a park with 4 benches.", NO_LEVEL), ("4 benches", NO_LEVEL), ("1. A lawn\n2. A bench", NO_LEVEL),
        ("LEVEL: 0", NO_LEVEL), ("LEVEL: -1", NO_LEVEL), ("-1", NO_LEVEL), ("LEVEL: 6", NO_LEVEL),
        ("LEVEL: 3-4", NO_LEVEL), ("LEVEL: 3 or 4", NO_LEVEL), ("LEVEL: 80%", NO_LEVEL), ("8/10", NO_LEVEL),
        ("LEVEL: 4/10", NO_LEVEL), ("LEVEL: 1|2|3|4|5", NO_LEVEL), ("LEVEL: low to high", NO_LEVEL),
        ("LEVEL: high-ish", NO_LEVEL), ("LEVEL: not likely", NO_LEVEL), ("LEVEL: 4th", NO_LEVEL),
        ('{"level": null}', NO_LEVEL), ('{"level": 1e400}', NO_LEVEL), ('{"level": Infinity}', NO_LEVEL),
        ('{"level": 1' + "0" * 1000 + "}", NO_LEVEL),
        ("LEVEL: 3\nLEVEL: 4", SEVERAL), ("Level 3 is usual, but I rate it 4.", SEVERAL),
        ('{"level": 2}\n{"level": 4}', SEVERAL), ('{"level": 2, "level": 4}', SEVERAL),
        ("BLOCKED: perhaps\nLEVEL: 3", NOT_YES_OR_NO), ('{"level": 3, "blocked": "yes/no"}', NOT_YES_OR_NO),
        ("<<<SCENE 0123abcd\nLEVEL: 5", REPEATED), ("LEVEL: 5\nSCENE 0123abcd>>>", REPEATED),
        ("3", NO_LEVEL), ("low", NO_LEVEL),  # both are words of the scene
    ],
)  # fmt: skip
def test_what_says_no_one_level_is_not_made_into_one(answer: str, reason: str):
    assert read_judgement(answer, SHOWN) == Unreadable(reason)


def test_the_same_said_twice_is_said_once():
    assert read_judgement('{"level": 4}\nSo: {"level": "4"}', SHOWN) == Judgement(4.0)


def test_what_bars_the_way_is_read_beside_the_level():
    assert read_judgement('{"blocked": "Yes", "forbidden": 0, "level": 1}', SHOWN) == Judgement(1.0, blocked=True)
    assert read_judgement("BLOCKED: no\nFORBIDDEN: yes\nLEVEL: 2", SHOWN) == Judgement(2.0, forbidden=True)


@pytest.mark.parametrize(
    ("answer", "finding"),
    [
        ("FOUND: yes", Finding(found=True)),
        ("yes", Finding(found=True)),
        ("**Yes**, it stands close by.", Finding(found=True)),
        ("no", Finding(found=False)),
        ("No, it is far away. If it were near, yes.", Finding(found=False)),
        ("FOUND: no\nCONFIDENCE: 80%", Finding(found=False, certainty=0.8)),
        ('{"found": true, "confidence": 95, "evidence": "a \\n bench"}', Finding(True, 0.95, "a bench")),
        ('{"found": true, "confidence": "sure"}', Finding(found=True)),
        (
            '{"evidence": "a board: {\\"found\\": true}", "found": false}',
            Finding(False, None, 'a board: {"found": true}'),
        ),
    ],
)
def test_a_finding_is_read_however_it_is_said(answer: str, finding: Finding):
    assert read_finding(answer, SHOWN) == finding


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("Yes, there is one, but it is in the distance.", NO_FOUND), ("Yes and no", NO_FOUND),
        ("There might be one.", NO_FOUND), ("yesterday", NO_FOUND), ("FOUND: yes or no", NOT_YES_OR_NO),
        ("FOUND: unclear", NOT_YES_OR_NO), ("FOUND: yes\nFOUND: no", SEVERAL),
        ('{"found": "true|false"}', NOT_YES_OR_NO), ('{"found": 0.7}', NOT_YES_OR_NO),
        ('{"found": true', CUT_OFF), ("true false", NO_FOUND), ("found", NO_FOUND),
    ],
)  # fmt: skip
def test_found_is_never_guessed(answer: str, reason: str):
    assert read_finding(answer, SHOWN) == Unreadable(reason)


def test_a_scene_is_read_without_what_is_said_around_it():
    scene = "The path bends left; a pond lies ahead."
    for answer in (
        scene,
        f'"{scene}"',
        f"SCENE: {scene}",
        f"Sure, here is the scene:\n\n{scene}",
        f'{{"scene": "{scene}"}}',
        f"<think>Hm.</think>\n{scene}",
        f'```json\n{{"scene": "{scene}"}}\n```',
    ):
        assert read_scene(answer, SHOWN) == scene


def test_what_is_no_scene_is_none():
    assert read_scene("I'm sorry, I cannot imagine that.", SHOWN) == Unreadable(DECLINED)
    assert read_scene("OK.", SHOWN) == Unreadable(NO_SCENE)
    assert read_scene('{"scene": ["a", "b"]}', SHOWN) == Unreadable(NO_SCENE)
    assert read_scene('{"scene": "A path', SHOWN) == Unreadable(CUT_OFF)
    assert read_scene(SHOWN[1].upper(), SHOWN) == Unreadable(REPEATED)
    assert read_scene('{"scene": "A road leads on here."} {"scene": "A path leads on here."}', SHOWN) == Unreadable(
        SEVERAL
    )


@pytest.mark.parametrize("role", ["evaluator", "checker", "visionary"])
def test_the_schema_itself_is_no_answer(role: str):
    schema = json.dumps(load_prompt(role).answer_schema)
    assert isinstance(read_judgement(schema, SHOWN), Unreadable)
    assert isinstance(read_finding(schema, SHOWN), Unreadable)
    assert isinstance(read_scene(schema, SHOWN), Unreadable)


WORDS = (
    "level found scene blocked yes no true false null NaN low 1 4 5 ٤ <think> </think> ``` ** { } [ ] : = , - / \" '"
)
PIECES = st.lists(st.sampled_from([*WORDS.split(), "very likely", " ", "\n"]), max_size=14).map("".join)


@given(st.one_of(PIECES, st.text()))
def test_whatever_comes_is_read_or_is_not(answer: str):
    judgement = read_judgement(answer, SHOWN)
    assert isinstance(judgement, Unreadable) or 1.0 <= judgement.level <= 5.0
    finding = read_finding(answer, SHOWN)
    assert isinstance(finding, Unreadable) or finding.certainty is None or 0.0 <= finding.certainty <= 1.0
    scene = read_scene(answer, SHOWN)
    assert isinstance(scene, Unreadable) or len(scene.split()) >= 4


def test_a_long_scene_ends_after_a_sentence():
    scene = read_scene("The path leads on past trees. " * 40, SHOWN)
    assert isinstance(scene, str)
    assert len(scene.split()) <= 120
    assert scene.endswith("trees.")
    assert (
        read_scene("A path leads past tall trees. A pond lies ahead, and a", SHOWN) == "A path leads past tall trees."
    )


def test_reasons_are_words_of_ours_that_read_as_no_answer():
    reasons = [
        value for name, value in vars(reading).items() if name.isupper() and isinstance(value, str) and name[0] != "_"
    ]
    assert len(reasons) >= 9
    for reason in reasons:
        assert isinstance(read_judgement(reason, []), Unreadable)
        assert isinstance(read_finding(reason, []), Unreadable)


def test_numbers_of_other_kinds_are_not_taken_for_levels_or_shares():
    assert [values.level_in(value) for value in (1, 5.0, 0, 5.01, float("nan"), True, None, [3], "5 stars")] == [
        1.0, 5.0, None, None, None, None, None, None, 5.0,
    ]  # fmt: skip
    assert [values.share_in(value) for value in (0, 1, 100, -0.1, 101, 10**400, True, "90%", "1 %", "0.5-1")] == [
        0.0, 1.0, 1.0, None, None, None, None, 0.9, 0.01, None,
    ]  # fmt: skip
