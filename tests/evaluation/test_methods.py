from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.methods import (
    GROUPS,
    method,
    methods,
    minds_called,
    models_called,
    sound_methods,
)
from reasoned_explorer.evaluation.mission import MissionSettings
from reasoned_explorer.evaluation.mission_settings import errors_of
from reasoned_explorer.model import InputError, SettingsError, UnknownNameError

BASE = MissionSettings(minds="embedded", checker=None, seed=5)


def test_a_planner_is_a_method() -> None:
    settings = method("follow-paths").settings(BASE)
    assert (settings.planner, settings.minds, settings.checker, settings.seed) == ("follow-paths", "embedded", None, 5)
    assert not method("follow-paths").is_bound


def test_settings_minds_and_halt_are_written_into_the_name() -> None:
    settings = method("llm-rrt:depth=1,children=2@embedded/oracle+perfect-halt").settings(BASE)
    assert settings.planner == "llm-rrt"
    assert settings.planner_settings == {"depth": 1, "children": 2}
    assert (settings.visionary, settings.evaluator, settings.checker) == ("embedded", "oracle", "perfect-halt")


def test_bounds_have_names_of_their_own() -> None:
    assert method("oracle").settings(BASE).agent == "guide"
    assert method("foresight-30m").settings(BASE).evaluator == "foresight-30m"
    assert all(method(name).is_bound for name in (*GROUPS["bounds"], *GROUPS["halts"]))


def test_every_group_can_be_made() -> None:
    for name, members in GROUPS.items():
        assert tuple(each.name for each in methods([name])) == members


def test_names_and_groups_stand_once() -> None:
    names = [each.name for each in methods(["llm-rrt", "planners", "llm-rrt"])]
    assert names[0] == "llm-rrt"
    assert len(set(names)) == len(names)


def test_all_names_that_are_wrong_are_told_at_once() -> None:
    with pytest.raises(InputError) as raised:
        methods(["llm-rtt", "oracle:depth=1", "llm-rrt@embedded/"])
    text = str(raised.value)
    assert "did you mean llm-rrt" in text
    assert "a bound as it is" in text
    assert "visionary/evaluator" in text
    with pytest.raises(UnknownNameError):
        method("")
    with pytest.raises(InputError, match="at least one"):
        methods([])
    with pytest.raises(SettingsError):
        method("llm-rrt:depth")


def test_whose_minds_read_the_truth_is_a_bound_and_no_mind_has_a_role_that_it_does_not_fill() -> None:
    assert method("llm-rrt@embedded/oracle").is_bound
    assert not method("llm-rrt@embedded/embedded").is_bound
    (error,) = errors_of(method("llm-rrt@perfect-halt/foresight-30m").settings(MissionSettings()))
    assert "perfect-halt as visionary" in str(error)
    assert errors_of(MissionSettings(evaluator="foresight-30m", checker="perfect-halt")) == ()


def test_methods_that_can_be_read_are_told_from_those_that_cannot() -> None:
    names = ["llm-rrt:depth", "random", "nope"]
    assert [item.name for item in sound_methods(names)] == ["random"]
    with pytest.raises(InputError, match=r"llm-rrt:depth: 'depth'; expected name=value(.|\n)*'nope'"):
        methods(names)


@pytest.mark.parametrize(
    ("roles", "visionary", "evaluator"),
    [
        ("openai:gpt-4o-mini/openai:gpt-4o", "openai:gpt-4o-mini", "openai:gpt-4o"),
        ("hf:org/small/embedded", "hf:org/small", "embedded"),
        ("embedded/hf:org/large", "embedded", "hf:org/large"),
        ("openai:org/one/openai:org/other", "openai:org/one", "openai:org/other"),
        ("openai:gpt-4o", "openai:gpt-4o", "openai:gpt-4o"),
        ("hf:org/small", "hf:org/small", "hf:org/small"),
    ],
)
def test_models_stand_behind_the_at_sign_whatever_slashes_they_have(roles: str, visionary: str, evaluator: str) -> None:
    settings = method(f"llm-rrt:depth=1@{roles}+perfect-halt").settings(BASE)
    assert (settings.visionary, settings.evaluator) == (visionary, evaluator)
    called = models_called([f"llm-rrt@{roles}"], BASE)
    assert called == tuple(dict.fromkeys(name for name in (visionary, evaluator) if ":" in name))
    # The captioner is a model that is called, and no mind.
    seeing = replace(BASE, captioner="openai:seeing")
    assert models_called([f"llm-rrt@{roles}"], seeing) == (*called, "openai:seeing")
    assert minds_called([f"llm-rrt@{roles}"], seeing) == called


def test_one_name_behind_the_at_sign_is_visionary_and_evaluator_and_leaves_the_checker_alone() -> None:
    settings = method("llm-as-eval@oracle").settings(replace(BASE, checker="embedded-words"))
    assert (settings.visionary, settings.evaluator, settings.checker) == ("oracle", "oracle", "embedded-words")
    (error,) = errors_of(method("llm-as-eval@embeded").settings(BASE))
    assert "did you mean embedded" in str(error)
    for roles in ("", "/", "embedded/", "/embedded"):
        with pytest.raises(SettingsError, match="or one name for both"):
            method(f"llm-rrt@{roles}")
