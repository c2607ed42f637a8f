"""`rex run --world none`: a served drone whose world nobody tells, and a server that is no model (a fake)."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.record_file import read_record, record_bytes
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.serving.airsim.server import AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

pytest.importorskip("openai")
pytest.importorskip("aiohttp")
pytest.importorskip("msgpack", reason="what AirSim's wire is spoken with is not installed")

from tests.calls.stub_server import Behaviour, StubServer, sober

GOAL = "Find me a bench"
START = Pose(30.0, -20.0, 0.0, 1.0)
FAST = ["--planner", "nearest-frontier", "--max-steps", "2", "--no-map"]


def _sees_a_bench(body: Mapping[str, Any]) -> str:
    return "A wooden bench stands close by, right ahead, within three metres." if _is_caption(body) else sober(body)


def _is_caption(body: Mapping[str, Any]) -> bool:
    return (body.get("response_format") or {}).get("json_schema") is None


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-planted-0123456789abcdef")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A drone that waits at START, ten times as fast as real time."""
    atlas, drone = Atlas(open_world("plaza:3@200")), vehicle_profile("drone")
    with BackgroundServer(lambda: AirSimServer(atlas, START, profile=drone, speed=10.0, seed=1)) as served:
        yield f"airsim://127.0.0.1:{served.port}"


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


def _run(model: StubServer, address: str, *more: str) -> tuple[int, str]:
    there = ("--vehicle", address, "--captioner", "openai:fake", "--base-url", model.base_url)
    return _rex("run", GOAL, "--world", "none", *there, *FAST, "--out", "run", *more)


def test_the_agent_alone_says_that_it_has_arrived_and_nobody_judges(address: str) -> None:
    with StubServer(Behaviour(answer=_sees_a_bench)) as model:
        code, shown = _run(model, address, "--map")
    assert code == 0, shown
    record = read_record("run")
    assert not record.header.is_judged
    assert (record.header.world, record.header.clock) == ("none", "real")
    assert record.header.start[:2] == (0.0, 0.0)
    assert record.header.start[3] == pytest.approx(1.0, abs=0.1)  # where the served drone's compass says it faces
    summary = record.summary
    assert summary is not None
    assert summary.end is MissionEnd.FOUND
    assert summary.declared
    assert (summary.success, summary.oracle_success, summary.spl, summary.casr) == (None, None, None, None)
    assert not Path("run/world.rexworld").exists()
    assert Path("run/map.png").stat().st_size > 10_000
    for said in (shown, _rex("show", "run")[1]):
        assert "declared “Found Goal”; nobody judged: no world is known" in said
        assert "SR, OSR, SPL and CASR are not known" in said
        assert "shortest way not known" in said


def test_its_metres_are_from_where_the_vehicle_stood_and_the_record_comes_back_as_it_was(address: str) -> None:
    with StubServer(Behaviour(answer=sober)) as model:
        code, shown = _run(model, address, "--fence", "12")
    assert code in {1, 3}, shown
    record = read_record("run")
    assert record_bytes(record) == Path("run/record.jsonl").read_bytes()
    track = [point for step in record.steps for leg in step.legs for point in leg.track]
    assert track
    assert all(abs(point.x_m) <= 12.0 and abs(point.y_m) <= 12.0 for point in track)
    assert record.summary is not None
    assert record.summary.path_length_m > 1.0
    assert "not found" in shown
    # The next mission begins where this one ended: its frame is its own.
    with StubServer(Behaviour(answer=_sees_a_bench)) as model:
        code, shown = _run(model, address, "--out", "next")
    assert code == 0, shown
    assert read_record("next").steps[0].pose[:2] == pytest.approx((0.0, 0.0), abs=0.5)


def test_its_time_is_over_on_the_real_clock(address: str) -> None:
    with StubServer(Behaviour(answer=sober)) as model:
        code, shown = _run(model, address, "--t-max", "0.05", "--max-steps", "50")
    assert code == 1, shown
    assert "not found (time over)" in shown


def test_all_that_it_cannot_do_without_a_world_is_told_at_once() -> None:
    code, shown = _rex("run", GOAL, "--world", "none", "--start", "1,2", "--minds", "oracle", "--bbox", "1,2,3,4")
    assert code == 2, shown
    assert "5 faults" in shown
    for what in ("the vehicle 'drone' without", "captioner 'noisy'", "the mind oracle", "--start", "--bbox"):
        assert what in shown
    code, shown = _rex("run", GOAL, "--world", "none", "--vehicle", "mavlink:udpin:127.0.0.1:14599", "--move")
    assert code == 2, shown
    assert "no pictures come from mavlink:udpin:127.0.0.1:14599" in shown
    assert not list(Path().iterdir())


def test_a_vehicle_that_is_not_there_is_told() -> None:
    with StubServer(Behaviour(answer=sober)) as model:
        code, shown = _run(model, "airsim://127.0.0.1:1")
    assert code == 3, shown
    assert "no link to 127.0.0.1:1" in shown
    assert not list(Path().iterdir())


def test_a_report_of_such_a_folder_says_that_it_is_no_benchmark(address: str) -> None:
    with StubServer(Behaviour(answer=_sees_a_bench)) as model:
        assert _run(model, address)[0] == 0
    for command in (["report", "run"], ["compare", "run", "run"]):
        code, shown = _rex(*command)
        assert code == 2, shown
        assert "rex bench" in shown
    header = json.loads(Path("run/record.jsonl").read_text().splitlines()[0])["header"]
    assert any(note.startswith("nobody judged") for note in header["notes"])
