import pickle
import subprocess
import sys
from pathlib import Path

import pytest

from reasoned_explorer.calls.budget import Budget, faults_of_budget
from reasoned_explorer.model import RecordWriteError, SettingsError


def test_without_limits_everything_may_begin() -> None:
    budget = Budget()
    for _ in range(3):
        assert budget.begin() is None
        budget.end(None)
    assert budget.denied is None


def test_money_that_is_spent_lets_no_call_begin() -> None:
    budget = Budget(usd=0.5)
    assert budget.begin() is None
    budget.end(0.25)
    assert budget.begin() is None
    budget.end(0.25)
    assert budget.spent_usd == pytest.approx(0.5)
    assert budget.begin() == "the budget of 0.5 US dollars is spent (0.5000)"
    assert budget.denied == "the budget of 0.5 US dollars is spent (0.5000)"


def test_calls_under_way_count_as_dear_as_the_dearest() -> None:
    budget = Budget(usd=1.0)
    budget.begin()
    budget.end(0.3)
    assert [budget.begin() for _ in range(2)] == [None, None]  # 0.3 and up to 0.6 more: a third might be too much
    assert "2 calls under way" in (budget.begin() or "")


def test_the_first_calls_go_by_what_they_may_well_cost() -> None:
    budget = Budget(usd=1.0)
    assert [budget.begin(0.4), budget.begin(0.4)] == [None, None]
    assert "2 calls under way" in (budget.begin(0.4) or "")
    assert Budget(usd=0.3).begin(0.4) == "the budget of 0.3 US dollars is spent (0.0000, a call may cost 0.4000)"


def test_minutes_are_of_real_time() -> None:
    now_s = [100.0]
    budget = Budget(minutes=2.0, now_s=lambda: now_s[0])
    assert budget.begin() is None
    now_s[0] = 219.9
    assert budget.begin() is None
    now_s[0] = 220.0
    assert budget.begin() == "the budget of 2 minutes is spent"


def test_a_call_that_was_not_answered_counts_as_dear_as_the_dearest_where_its_cost_is_unknown() -> None:
    budget = Budget(usd=1.0)
    for _ in range(3):
        budget.begin()
    budget.end(0.2)
    budget.end(None, answered=False)
    budget.end(0.05, answered=False)
    assert budget.spent_usd == pytest.approx(0.45)


def test_an_answer_of_unknown_cost_ends_a_run_with_a_limit_in_money() -> None:
    budget = Budget(usd=1.0)
    budget.begin()
    budget.end(None, model="openai:new-model")
    assert "openai:new-model did not say what its call cost" in (budget.begin() or "")


def test_everything_wrong_with_a_budget_is_said_before_anything_is_spent() -> None:
    faults = faults_of_budget(-1.0, float("nan"), ["openai:new-model"])
    assert [str(fault).partition(";")[0] for fault in faults] == [
        "the budget is -1.0 US dollars",
        "the budget is nan minutes",
        "the price of openai:new-model is not known",
    ]
    assert "--budget-minutes" in str(faults[2])
    assert faults_of_budget(None, 30, ["openai:new-model"]) == []
    for wrong in (0, "5", True):
        with pytest.raises(SettingsError, match="a finite number above 0"):
            Budget(usd=wrong)  # type: ignore[arg-type]


def test_processes_share_what_they_spend(tmp_path: Path) -> None:
    program = """
import sys
from reasoned_explorer.calls.budget import Budget
budget = Budget(usd=10.0, path=sys.argv[1])
for _ in range(200):
    assert budget.begin() is None
    budget.end(0.01)
"""
    path = tmp_path / "spent"
    processes = [subprocess.Popen([sys.executable, "-c", program, str(path)]) for _ in range(3)]
    assert [process.wait(60) for process in processes] == [0, 0, 0]
    budget = Budget(usd=6.001, path=path)
    assert budget.spent_usd == pytest.approx(6.0)
    assert budget.begin() is None
    copy: Budget = pickle.loads(pickle.dumps(budget))  # noqa: S301 - our own
    copy.begin()
    copy.end(0.02)
    assert budget.spent_usd == pytest.approx(6.02)
    assert "is spent" in (budget.begin() or "")


def test_a_file_that_cannot_be_written_is_said_at_once_or_ends_the_run(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="choose another place"):
        Budget(usd=1.0, path=tmp_path / "no folder" / "spent")
    folder = tmp_path / "run"
    folder.mkdir()
    budget = Budget(usd=1.0, path=folder / "spent")
    budget.begin()
    (folder / "spent").unlink()
    folder.rmdir()
    with pytest.raises(RecordWriteError, match="cannot be written"):
        budget.end(0.1)
