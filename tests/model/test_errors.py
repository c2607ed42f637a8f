import pickle

import pytest

from reasoned_explorer.model import Fault, Gathering, GoalError, InputError, MissingDependencyError, UnknownNameError
from reasoned_explorer.task.sampling import OutOfRangeError, SamplingSettings


def test_all_faults_are_told_at_once() -> None:
    error = InputError("settings", [Fault("views is 0", "1 to 24"), Fault("k is nan", "a number")])
    assert "views is 0" in str(error)
    assert "k is nan" in str(error)
    assert "2 faults" in str(error)


def test_a_misspelt_name_is_answered_with_the_near_misses() -> None:
    error = UnknownNameError("planner", "llm-rtt", ["llm-rrt", "llm-as-eval", "nearest-frontier"])
    assert "did you mean llm-rrt" in str(error)
    assert "nearest-frontier" in str(error)


def test_a_missing_package_names_the_command_that_installs_it() -> None:
    assert "pip install x" in str(MissingDependencyError("MiniLM", "tokenizers", "pip install x"))


def _refuse(error: InputError) -> int:
    raise error


def test_errors_are_gathered_while_what_is_sound_goes_on() -> None:
    found = Gathering()
    assert found.take(lambda: 3, 0) == 3
    found.finish("input")
    goal = GoalError("goal", [Fault("it is empty", "a sentence")])
    name = UnknownNameError("planner", "x", ["y"])
    assert found.take(lambda: _refuse(goal), 0) == 0
    with pytest.raises(GoalError) as alone:
        found.finish("input")
    assert alone.value is goal
    found.add(name, name)
    with pytest.raises(InputError) as several:
        found.finish("input")
    assert [fault.what for fault in several.value.faults] == ["goal: it is empty", "unknown planner: 'x'"]
    assert type(several.value) is InputError


def test_errors_of_one_type_stay_of_that_type() -> None:
    found = Gathering()
    found.add(*(GoalError("goal", [Fault(what)]) for what in ("one", "two")))
    with pytest.raises(GoalError, match="2 faults"):
        found.finish("goals")


def test_errors_come_out_of_another_process_as_they_went_in() -> None:

    for error in (
        InputError("goal", [Fault("it is empty", "a sentence")]),
        UnknownNameError("planner", "llm-rtt", ("llm-rrt", "random")),
        OutOfRangeError("park", "Find me a bench", SamplingSettings(), [1.0, 900.0]),
    ):
        again = pickle.loads(pickle.dumps(error))  # noqa: S301 - our own
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert again.__dict__ == error.__dict__
