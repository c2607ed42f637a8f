"""What the README tells people to type is run, word for word; the benchmark alone by sight lines, in half the time."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.DOTALL | re.MULTILINE)


def _rex_commands(*, with_models: bool = False) -> list[str]:
    lines = [line for block in _blocks("sh") for line in block.splitlines()]
    commands = [line.split("#")[0].strip() for line in lines if line.startswith("rex ")]
    return [command for command in commands if ("openai:" in command) == with_models]


def test_there_is_something_to_test() -> None:
    assert len(_rex_commands()) >= 5
    assert len(_blocks("python")) == 1


def test_the_commands_work_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for command in _rex_commands():
        sooner = ["--eyes", "lines"] if command.startswith("rex bench --split") else []
        result = CliRunner().invoke(app, [*shlex.split(command)[1:], *sooner])
        # A mission may end without finding its goal; anything else is a command that does not work.
        assert result.exit_code in (0, 1), f"{command}\n{result.output}"


def test_the_commands_with_a_model_work_where_a_model_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("openai")
    pytest.importorskip("aiohttp")
    from tests.calls.stub_server import Behaviour, StubServer, sober

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-planted")
    with StubServer(Behaviour(answer=sober)) as server:
        monkeypatch.setenv("OPENAI_BASE_URL", server.base_url)
        for command in _rex_commands(with_models=True):
            typed = command.replace("http://localhost:8000/v1", server.base_url)
            result = CliRunner().invoke(app, shlex.split(typed)[1:])
            assert result.exit_code in (0, 1), f"{command}\n{result.output}"


def test_the_python_example_works(tmp_path: Path) -> None:
    code = _blocks("python")[0]
    shown = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert shown.returncode == 0, shown.stderr
    assert "CASR" in shown.stdout
    assert (tmp_path / "nap.png").stat().st_size > 10_000


def test_its_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        if not target.startswith("http"):
            assert (ROOT / target).exists(), target


def test_the_make_targets_that_it_names_are_there() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in set(re.findall(r"`?make ([a-z]+)`?", README)):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target
