"""`rex run --captioner openai:…`: pictures for a model, against a server of this machine that is no model (a fake)."""

import base64
import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import typer
from PIL import Image
from typer.testing import CliRunner

from reasoned_explorer.calls import endpoint
from reasoned_explorer.cli import bench_models, consent
from reasoned_explorer.cli.answers import answering
from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import SettingsError
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import open_world

pytest.importorskip("openai")
pytest.importorskip("aiohttp")

from tests.calls.stub_server import Behaviour, StubServer, sober

FAST = ["--seed", "1", "--no-map", "--t-max", "1", "--planner", "nearest-frontier", "--picture-px", "96"]
GOAL = "Find me a bench"


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-planted-0123456789abcdef")
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)


@pytest.fixture
def server() -> Iterator[StubServer]:
    with StubServer(Behaviour(answer=sober)) as running:
        yield running


@pytest.fixture
def real_place() -> str:
    """A world that says where on earth it lies."""
    save_world(replace(open_world("plaza:3@200"), origin=GeoOrigin(48.1, 11.6), name="a square"), Path("real.rexworld"))
    return "real.rexworld"


def _rex(*arguments: str, typed: str | None = None) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments), input=typed)
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


def _run(server: StubServer, *arguments: str, world: str = "plaza:3@200", out: str = "run") -> tuple[int, str]:
    there = ("--captioner", "openai:fake", "--base-url", server.base_url, "--world", world)
    return _rex("run", GOAL, *FAST, *there, "--out", out, *arguments)


def _pictures(server: StubServer) -> list[Image.Image]:
    """Return the pictures that were sent, without those of the check of what the model can do."""
    found = []
    for each in server.received:
        for message in each.body.get("messages", ()):
            parts = message["content"] if isinstance(message["content"], list) else []
            for part in parts:
                if part["type"] == "image_url":
                    data = part["image_url"]["url"].partition("base64,")[2]
                    found.append(Image.open(io.BytesIO(base64.b64decode(data))))
    return [picture for picture in found if picture.width != 64]


def test_a_model_is_sent_the_pictures_of_every_look(server: StubServer) -> None:
    code, shown = _run(server, "--images")
    assert code in {0, 1}, shown
    record = read_record(Path("run"))
    captions = [call for step in record.steps for call in step.calls if call.role == "caption"]
    assert {call.model for call in captions} == {"openai:fake"}
    assert record.header.captioner.startswith("openai:fake (prompt caption")
    sent = _pictures(server)
    assert len(sent) == len(captions) > 0
    assert {picture.size for picture in sent} == {(96, 96)}
    kept = sorted(Path("run/pictures").iterdir())
    assert len(kept) == len(captions)
    # Some are of a wall that the vehicle stands before.
    assert any(len(Image.open(path).convert("RGB").getcolors(10_000) or range(10_000)) > 500 for path in kept)
    view = record.steps[0].views[0]
    assert "steps long" in view.caption


def test_a_mission_with_pictures_is_replayed_bit_for_bit(server: StubServer) -> None:
    assert _run(server)[0] in {0, 1}
    asked = len(server.received)
    code, shown = _run(server, "--replay", "run/calls.tape", out="again")
    assert code in {0, 1}, shown
    assert len(server.received) == asked
    assert Path("again/record.jsonl").read_bytes() == Path("run/record.jsonl").read_bytes()
    code, shown = _run(server, "--replay", "run/calls.tape", "--conditions", "fog", out="fog")
    assert code == 2
    assert "settings.conditions is 'fog'" in shown


def test_a_view_whose_call_is_lost_is_left_out_and_the_record_says_why() -> None:
    behaviour = Behaviour(answer=sober, fault_share=0.3, faults=("refusal",))
    with StubServer(behaviour) as server:
        code, shown = _run(server)
    assert code in {0, 1}, shown
    views = [view for step in read_record(Path("run")).steps for view in step.views]
    assert any(view.caption_fault for view in views)
    assert any(view.caption for view in views)


def test_pictures_of_a_real_place_stay_here_unless_a_person_agrees(
    server: StubServer, real_place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # This machine's own server is near enough not to be asked about: pretend that it is far away.
    assert _run(server, world=real_place, out="near")[0] in {0, 1}
    monkeypatch.setattr(endpoint, "_is_loopback", lambda _: False)
    before, asked = len(_pictures(server)), len(server.received)
    code, shown = _run(server, world=real_place)
    assert code == 2, shown
    assert "pictures of a square are to be sent to openai:fake at http://127.0.0.1" in shown
    assert "--yes" in shown
    assert not Path("run").exists()
    assert len(server.received) == asked, "not even what it can do is asked before"
    code, shown = _run(server, "--yes", world=real_place)
    assert code in {0, 1}, shown
    assert shown.count("are to be sent to") == shown.count("note: ")  # said once, on each of two outputs
    assert len(_pictures(server)) > before
    # A place that is nowhere on earth is nobody's.
    assert _run(server, out="generated")[0] in {0, 1}


def test_a_benchmark_asks_before_any_call_too(server: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(endpoint, "_is_loopback", lambda _: False)
    monkeypatch.setattr(bench_models, "GENERATED", "")  # pretend that the park is real
    code, shown = _rex(
        *("bench", "--world", "park:5@300", "--per-cell", "1", "--levels", "1", "--planners", "nearest-frontier"),
        *("--captioner", "openai:fake", "--base-url", server.base_url, "--workers", "1", "--out", "run", "-q"),
    )
    assert code == 2, shown
    assert f"pictures of park:5@300 are to be sent to openai:fake at {server.base_url}" in shown
    assert "--yes" in shown
    assert not server.received
    assert not Path("run").exists()


@pytest.mark.parametrize(
    ("answer", "code"), [("y\n", 0), ("n\n", 2), ("\n", 2), pytest.param("", 2, id="end of input")]
)
def test_a_person_at_a_terminal_is_asked(answer: str, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    ended, shown = _asked_for_consent(answer, monkeypatch)
    assert "Send them?" in shown
    assert ended == code, shown
    assert ("--yes" in shown) == (code == 2)
    assert "Aborted" not in shown


def test_a_person_who_stops_at_the_question_has_stopped_and_not_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted_confirm(*_: object, **__: object) -> bool:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt:
            raise typer.Abort from None  # as typer's own does

    monkeypatch.setattr(typer, "confirm", interrupted_confirm)
    ended, shown = _asked_for_consent("", monkeypatch)
    assert ended == 130, shown


def _asked_for_consent(answer: str, monkeypatch: pytest.MonkeyPatch) -> tuple[int, str]:
    asking = typer.Typer()
    # The runner's input is no terminal.
    monkeypatch.setattr(consent, "_is_answered", lambda: True)

    @asking.command()
    @answering
    def ask() -> None:
        consent.agree_to_send("openai:far", ["munich"], yes=False)

    result = CliRunner().invoke(asking, [], input=answer)
    return result.exit_code, result.output


def test_a_program_must_have_asked_too(server: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(endpoint, "_is_loopback", lambda _: False)
    world = replace(open_world("plaza:3@200"), origin=GeoOrigin(48.1, 11.6))
    settings = MissionSettings(captioner="openai:fake", clock="mixed", planner="nearest-frontier")
    with pytest.raises(SettingsError, match="pictures_may_leave=True"):
        Mission(GOAL, world, settings, desk=ModelDesk(base_url=server.base_url))
    Mission(GOAL, world, settings, desk=ModelDesk(base_url=server.base_url, pictures_may_leave=True))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--picture-px", "0"], "picture_px is 0"),
        (["--conditions", "snow"], "conditions are 'snow'"),
        (["--captioner", "openai:"], "a model's name behind the colon"),
        (["--clock", "virtual"], "the clock virtual with openai:fake"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_made(server: StubServer, arguments: list[str], said: str) -> None:
    code, shown = _run(server, *arguments)
    assert code == 2, shown
    assert said in shown
    assert not Path("run").exists()
    assert not server.received
