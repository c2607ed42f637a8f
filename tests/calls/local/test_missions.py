"""Whole missions whose views a model on this machine describes: of random weights, so that what it says is nonsense."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.calls.local import LocalModel
from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.record_file import read_record

FAST = ["--world", "plaza:3@200", "--seed", "1", "--no-map", "--t-max", "1", "--planner", "nearest-frontier"]

Local = Callable[..., LocalModel]


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.mark.parametrize("kind", ["kosmos-2", "smolvlm"])
def test_all_views_of_a_look_are_described_in_one_batch(kind: str, local: Local, tmp_path: Path) -> None:
    model = local(kind)
    before = len(model.batches)
    code, shown = _rex("run", "Find me a bench", *FAST, "--captioner", model.name, "--out", str(tmp_path / "run"))
    assert code in {0, 1}, shown
    record = read_record(tmp_path / "run")
    captions = [call for step in record.steps for call in step.calls if call.role == "caption"]
    assert {call.model for call in captions} == {model.name}
    # After what it can do was found out, three views a look.
    looks = model.batches[before:][-len(captions) // 3 :]
    assert max(looks) == 3  # on a busy machine a call may come too late for the batch of its look
    assert Counter(looks).most_common(1) == [(3, looks.count(3))]
    assert all(call.usd == 0.0 and call.latency_s > 0.0 for call in captions)
    code, shown = _rex(
        *("run", "Find me a bench", *FAST, "--captioner", model.name, "--out", str(tmp_path / "again")),
        *("--replay", str(tmp_path / "run" / "calls.tape")),
    )
    assert code in {0, 1}, shown
    assert (tmp_path / "again" / "record.jsonl").read_bytes() == (tmp_path / "run" / "record.jsonl").read_bytes()


def test_what_only_describes_is_no_mind_and_says_so(local: Local, tmp_path: Path) -> None:
    model = local("kosmos-2")
    code, shown = _rex("run", "Find me a bench", *FAST, "--minds", model.name, "--out", str(tmp_path / "run"))
    assert code == 2, shown
    assert "describes pictures only" in shown
    code, shown = _rex("minds", "check", model.name)
    assert code == 0, shown
    assert "pictures             yes" in shown
