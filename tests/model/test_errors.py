from reasoned_explorer.model import Fault, InputError, MissingDependencyError, UnknownNameError


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
