"""What the page asks for, over a real server."""

import gzip
import io
import shutil
import sqlite3
import urllib.parse
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fastapi import APIRouter
from PIL import Image

from reasoned_explorer import __version__
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.app import create_app, guarded
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.asking import ask, rows_of, showing
from tests.viewer.small_runs import MISSIONS, write_record


def test_a_bench_from_its_list_to_a_view(bench: Path) -> None:
    with showing(bench) as server:
        about = ask(server, "/api/about").json
        assert about == {
            "version": __version__,
            "root": "small",
            "live": False,
            "live_mission": None,
            "token_needed": False,
        }
        (run,) = ask(server, "/api/runs").json
        assert (run["kind"], run["missions"]) == ("bench", MISSIONS)
        rows = rows_of(server, run["id"])
        pairs: dict[str, set[str]] = {}
        for row in rows:
            replay = ask(server, f"/api/runs/{run['id']}/missions/{row['id']}").json
            assert replay["header"]["goal"] == row["goal"]
            assert len(replay["steps"]) == row["steps"]
            assert replay["derived"]["pictures"] == "drawn"
            pairs.setdefault(replay["derived"]["pair_key"], set()).add(str(row["method"]))
        assert all(methods == {"llm-rrt", "nearest-frontier"} for methods in pairs.values())
        mission = f"/api/runs/{run['id']}/missions/{rows[0]['id']}"
        shown = ask(server, f"{mission}/map")
        assert shown.json["buildings"]
        again = ask(server, f"{mission}/map", headers={"If-None-Match": shown.headers["etag"]})
        assert (again.status, again.body) == (304, b"")
        view = ask(server, f"{mission}/views/0/0.png?width=224")
        assert view.headers["content-type"] == "image/png"
        assert view.body.startswith(b"\x89PNG")
        # What a browser looks at need not be right to the last bit: an eighth of the bytes.
        seen = ask(server, f"{mission}/views/0/0.png?width=224", headers={"Accept": "image/webp,image/*"})
        assert seen.headers["content-type"] == "image/webp"
        assert len(seen.body) < len(view.body) / 4
        with Image.open(io.BytesIO(seen.body)) as few, Image.open(io.BytesIO(view.body)) as all_of_it:
            difference = np.asarray(few.convert("RGB"), int) - np.asarray(all_of_it.convert("RGB"), int)
        assert np.abs(difference).mean() < 8.0


def test_missions_of_one_episode_can_be_compared(tmp_path: Path, record: EpisodeRecord) -> None:
    for name in ("a", "b"):
        write_record(tmp_path / name, record)
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        rows = rows_of(server, run["id"])
        assert len({row["mission_id"] for row in rows}) == 1
        keys = {ask(server, f"/api/runs/{run['id']}/missions/{row['id']}").json["derived"]["pair_key"] for row in rows}
        assert len(keys) == 1


@pytest.mark.parametrize(
    "path",
    [
        "/api/nothing",
        "/api/runs/nothing",
        "/api/runs/0000000000000000",
        "/api/runs/..",
        "/api/runs/%2e%2e%2f%2e%2e%2fetc",
        "/api/runs/A",
        "/api/runs/{run}/missions/nothing",
        "/api/runs/{run}/missions/..%2f..%2fetc%2fpasswd",
        "/api/runs/{run}/missions/{mission}/views/999/0.png",
        "/api/runs/{run}/missions/{mission}/views/-1/0.png",
        "/api/runs/{run}/missions/{mission}/../../../../../../etc/passwd",
        "/api/live",
        "/docs",
        "/openapi.json",
        "/redoc",
    ],
)
def test_what_there_is_not_is_not_found(tmp_path: Path, record: EpisodeRecord, path: str) -> None:
    write_record(tmp_path / "m", record)
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        mission = rows_of(server, run["id"])[0]["id"]
        answer = ask(server, path.format(run=run["id"], mission=mission))
        assert answer.status == 404
        assert set(answer.json) == {"error"}


@pytest.mark.parametrize("query", ["width=1", "width=100000", "width=x", "width=224.5", "width=-224"])
def test_a_strange_width_is_refused_in_a_sentence(tmp_path: Path, record: EpisodeRecord, query: str) -> None:
    write_record(tmp_path / "m", record)
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        mission = rows_of(server, run["id"])[0]["id"]
        answer = ask(server, f"/api/runs/{run['id']}/missions/{mission}/views/0/0.png?{query}")
        assert answer.status == 422
        assert "width" in answer.json["error"]


def test_a_broken_mission_says_what_is_wrong_and_the_others_are_shown(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "sound", record)
    write_record(tmp_path / "broken", record)
    file = tmp_path / "broken" / "record.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(lines[0] + b"no json\n" + b"".join(lines[2:]))
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        answers = [ask(server, f"/api/runs/{run['id']}/missions/{row['id']}") for row in rows_of(server, run["id"])]
        assert sorted(answer.status for answer in answers) == [200, 422]
        (said,) = (answer.json["error"] for answer in answers if answer.status == 422)
        assert "line 2" in said
        assert str(tmp_path) not in said


def test_a_broken_run_says_what_is_wrong(tmp_path: Path, bench: Path) -> None:
    shutil.copytree(bench, tmp_path / "run")
    (tmp_path / "run" / "run.sqlite").write_bytes(b"SQLite format 3\0 and then nothing")
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        assert run["fault"]
        answer = ask(server, f"/api/runs/{run['id']}")
        assert answer.status == 422
        assert "run" in answer.json["error"]
        assert str(tmp_path) not in answer.json["error"] + run["fault"]


def test_text_of_models_and_people_stays_text(tmp_path: Path, record: EpisodeRecord) -> None:
    """It is sent as JSON, which no browser takes for a page."""
    markup = "<script>alert(1)</script>"
    write_record(tmp_path / markup.replace("/", "-"), replace(record, header=replace(record.header, goal=markup)))
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        (row,) = rows_of(server, run["id"])
        answer = ask(server, f"/api/runs/{run['id']}/missions/{row['id']}")
        assert answer.json["header"]["goal"] == markup
        assert answer.headers["content-type"] == "application/json"
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert b"<script>alert" not in ask(server, "/").body
        lost = ask(server, "/api/runs/" + urllib.parse.quote(markup, safe=""))
        assert lost.headers["content-type"] == "application/json"


def test_the_secret_of_the_page_is_its_own(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "m", record)
    with showing(tmp_path) as one, showing(tmp_path) as other:
        first, second = (ask(server, "/api/csrf").json["token"] for server in (one, other))
        assert len(first) >= 32
        assert first != second


def test_others_can_add_routes_behind_the_same_guard(bench: Path) -> None:
    router, guard = APIRouter(), Guard()

    @router.post("/api/rate")
    def rate() -> dict[str, bool]:
        return {"kept": True}

    app = guarded(create_app(Library(bench), guard=guard, extra_routers=[router]), guard)
    with Server(app) as server:
        assert ask(server, "/api/rate", method="POST").status == 403
        secret = ask(server, "/api/csrf").json["token"]
        ours = {"X-Rex-CSRF": secret, "Origin": f"http://127.0.0.1:{server.port}"}
        assert ask(server, "/api/rate", method="POST", headers=ours).json == {"kept": True}


def test_ten_thousand_missions_are_listed_in_few_bytes(tmp_path: Path, bench: Path) -> None:
    shutil.copytree(bench, tmp_path / "run")
    with sqlite3.connect(tmp_path / "run" / "run.sqlite") as connection:
        vehicle, method, _, row, wall_s = connection.execute("SELECT * FROM missions").fetchone()
        many = [(vehicle, method, f"another/{number}", row, wall_s) for number in range(10_000)]
        connection.executemany("INSERT INTO missions VALUES (?, ?, ?, ?, ?)", many)
    connection.close()
    with showing(tmp_path) as server:
        (run,) = ask(server, "/api/runs").json
        assert run["missions"] == 10_000 + MISSIONS
        answer = ask(server, f"/api/runs/{run['id']}")
        assert len(answer.json["rows"]) == 10_000 + MISSIONS
        assert len(answer.body) < 2_000_000
        packed = ask(server, f"/api/runs/{run['id']}", headers={"Accept-Encoding": "gzip"})
        assert packed.headers["content-encoding"] == "gzip"
        assert gzip.decompress(packed.body) == answer.body
        assert len(packed.body) < len(answer.body) / 2


def test_a_run_is_not_written_to(tmp_path: Path, bench: Path) -> None:
    shutil.copytree(bench, tmp_path / "run")
    for path in (tmp_path / "run").rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)
    with showing(tmp_path / "run") as server:
        (run,) = ask(server, "/api/runs").json
        assert len(rows_of(server, run["id"])) == MISSIONS
    with RunStore.read(tmp_path / "run") as store:
        assert len(store.finished()) == MISSIONS
