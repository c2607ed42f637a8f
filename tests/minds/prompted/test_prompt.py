import hashlib
import json
from pathlib import Path

import pytest

from reasoned_explorer.minds.prompted.decisions import load_decisions
from reasoned_explorer.minds.prompted.prompt import ROLES, Form, load_prompt
from reasoned_explorer.minds.prompted.reading import Finding, Judgement, read_finding, read_judgement, read_scene
from reasoned_explorer.model import SettingsError
from tests.minds.prompted.fakes import inside, lines

#: What each version says. A change of a prompt is a new version: records and stores tell answers apart by it.
DIGESTS = {"evaluator/1": "d38538ed5d8a", "checker/1": "2183af054400", "visionary/1": "cce77bbedd50"}
VALID = """
name = "checker"
version = 4
system = "s"
question = "{goal} {scene}"
as_json = "j"
as_text = "t"
[schema.properties.found]
type = "boolean"
"""


@pytest.mark.parametrize("role", ROLES)
def test_a_changed_prompt_has_a_new_version(role: str):
    prompt = load_prompt(role)
    data = {"goal": "G", "scene": "S", "which": "W"}
    forms = (Form.JSON, Form.TEXT)  # typed questions have a file and a version of their own
    told = [prompt.told(form) for form in forms]
    asked = [prompt.asked(data, form, again=again) for form in forms for again in ("", "R")]
    said = "\n".join([*told, *asked, json.dumps(prompt.answer_schema)])
    digest = hashlib.sha256(said.encode()).hexdigest()[:12]
    assert DIGESTS.get(prompt.id) == digest, f"{prompt.id} says something new ({digest}): give it a new version"


@pytest.mark.parametrize("role", ROLES)
def test_examples_are_answered_in_both_forms_as_they_are_read(role: str):
    prompt = load_prompt(role)
    assert prompt.examples
    for example in prompt.examples:
        for answer in (json.dumps(example.answer), lines(dict(example.answer))):
            assert answer in prompt.told(Form.JSON) + prompt.told(Form.TEXT)
            shown = [example.goal, example.scene]
            if role == "evaluator":
                assert read_judgement(answer, shown) == Judgement(**example.answer)  # type: ignore[arg-type]
            elif role == "checker":
                said = example.answer
                assert read_finding(answer, shown) == Finding(said["found"], said["confidence"], said["evidence"])  # type: ignore[arg-type]
            else:
                assert read_scene(answer, shown) == example.answer["scene"]


def test_examples_are_fenced_as_questions_are():
    told = load_prompt("checker").told(Form.TEXT)
    assert len(inside(told)) == 2
    assert told.count("<<<SCENE ") == len(load_prompt("checker").examples)


def test_the_visionary_is_told_no_goal():
    prompt = load_prompt("visionary")
    assert "{goal}" not in prompt.question
    assert not any(example.goal for example in prompt.examples)
    assert list(inside(prompt.asked({"goal": "Find me a bench", "scene": "A road.", "which": ""}, Form.TEXT))) == [
        "scene"
    ]


def test_a_prompt_of_ones_own_is_read_from_a_folder(tmp_path: Path):
    (tmp_path / "checker.toml").write_text(VALID, encoding="utf-8")
    assert load_prompt("checker", tmp_path).id == "checker/4"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name = ", "a TOML file"),
        (VALID.replace("version = 4", "version = 0"), "version: Input should be greater than or equal to 1"),
        (VALID.replace('system = "s"', ""), "system: Field required"),
        (VALID.replace('"checker"', '"evaluator"'), "its name is 'evaluator'; expected 'checker'"),
        (VALID.replace("{scene}", "{sceen}"), "its question has no {scene}"),
        (VALID.replace("{scene}", "{sceen}"), "its question has {sceen}"),
        (VALID + '[[examples]]\nscene = "A road."\nanswer = { level = 3 }', "example 1 answers level"),
        ('surprise = 1\n' + VALID, "surprise: Extra inputs are not permitted"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_prompt_is_refused_with_all_its_faults(text: str, said: str, tmp_path: Path):
    (tmp_path / "checker.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SettingsError) as refused:
        load_prompt("checker", tmp_path)
    assert said in str(refused.value)


def test_changed_decisions_have_a_new_version():
    decisions = load_decisions()
    said = repr(sorted(decisions.by_role.items()))
    digest = hashlib.sha256(said.encode()).hexdigest()[:12]
    assert (decisions.id, digest) == ("decisions/1", "76cd550325c7")


def test_a_decision_is_asked_about_fenced_data_alone():
    prompt = load_prompt("evaluator")
    told, asked = prompt.told(Form.DECISION), prompt.asked({"goal": "G", "scene": "S"}, Form.DECISION)
    assert "Example" not in told
    assert not any(word in told + asked for word in ("JSON", "LEVEL:"))
    assert "<<<GOAL" in asked


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("version = 1", "evaluator: Field required"),
        ("version = ", "a TOML file"),
        ('version = 1\n[[evaluator]]\nname = "level"\ninstructions = "?"\n[[checker]]\nname = "x"\ninstructions = "?"',
         "checker asks x; expected found"),
    ],
)  # fmt: skip
def test_own_decisions_are_what_the_roles_need(text: str, wrong: str, tmp_path: Path):
    (tmp_path / "decisions.toml").write_text(text)
    with pytest.raises(SettingsError, match=wrong):
        load_decisions(tmp_path)


def test_a_folder_of_own_prompts_need_not_have_decisions(tmp_path: Path):
    assert load_decisions(tmp_path).id == load_decisions().id
