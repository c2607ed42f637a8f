"""Who is answered what, asked of a real server."""

import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi import FastAPI

from reasoned_explorer.model import SettingsError
from reasoned_explorer.viewer.app import add_error_answers, page_routes
from reasoned_explorer.viewer.security import Guard, within
from reasoned_explorer.viewer.serving import Server
from tests.viewer.asking import ask

TOKEN = "a-token-that-is-long-enough"  # noqa: S105
EVERYWHERE = "0.0.0.0"  # noqa: S104
CHANGE = {"Sec-Fetch-Site": "same-origin", "X-Rex-CSRF": "the secret"}


def _app() -> FastAPI:
    app = FastAPI(openapi_url=None)
    add_error_answers(app)
    changed: list[str] = []

    @app.post("/change")
    @app.put("/change")
    def change() -> dict[str, int]:
        changed.append("once")
        return {"changed": len(changed)}

    @app.get("/changed")
    def how_often() -> int:
        return len(changed)

    @app.get("/broken")
    def broken() -> None:
        raise ZeroDivisionError("a path of this machine: /root/secret")

    app.include_router(page_routes())
    return app


@pytest.fixture
def open_server() -> Iterator[Server]:
    guard = Guard(csrf="the secret")
    with Server(guard.protects(_app())) as server:
        yield server


@pytest.fixture
def closed_server() -> Iterator[Server]:
    """One that asks for a token, as one beyond this machine does; it listens on loopback all the same."""
    guard = Guard(token=TOKEN, csrf="the secret")
    with Server(guard.protects(_app())) as server:
        yield server


@pytest.mark.parametrize("path", ["/", "/changed", "/broken", "/nothing", "/pages/index.html", "/pages/none.js"])
def test_every_answer_forbids_what_no_page_of_ours_needs(open_server: Server, path: str) -> None:
    headers = ask(open_server, path).headers
    policy = headers["content-security-policy"]
    for part in (
        "default-src 'self'",
        "script-src 'self'",
        "style-src 'self'",
        "frame-ancestors 'none'",
        "base-uri 'none'",
    ):
        assert part in policy
    assert "unsafe" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert "access-control-allow-origin" not in headers
    assert "server" not in headers


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "evil.example:80",
        "127.0.0.1.evil.example",
        "localhost.evil",
        "",
        "10.0.0.5",
        "a b",
        "127.0.0.1@evil.example",
        "127.0.0.1, evil.example",
    ],
)
def test_asked_by_another_name_it_does_not_answer(open_server: Server, host: str) -> None:
    """As it is when somebody else's DNS gives their name this machine's address."""
    answer = ask(open_server, "/changed", headers={"Host": host})
    assert answer.status in {400, 421}
    assert b"error" in answer.body or answer.status == 400


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LOCALHOST:1234", "[::1]:99", "127.0.0.1:8470"])
def test_by_its_own_names_it_answers_through_any_tunnel(open_server: Server, host: str) -> None:
    assert ask(open_server, "/changed", headers={"Host": host}).status == 200


def test_what_fails_says_so_without_saying_how(open_server: Server, caplog: pytest.LogCaptureFixture) -> None:
    answer = ask(open_server, "/broken")
    assert answer.status == 500
    assert set(answer.json) == {"error"}
    for word in (b"root", b"Traceback", b"ZeroDivision"):
        assert word not in answer.body
    until = time.monotonic() + 10.0  # it is noted once the answer is on its way
    while "ZeroDivisionError" not in caplog.text and time.monotonic() < until:
        time.sleep(0.01)
    assert "ZeroDivisionError" in caplog.text
    assert ask(open_server, "/changed").status == 200


@pytest.mark.parametrize(
    "path",
    [
        "/pages/../app.py",
        "/pages/%2e%2e/app.py",
        "/pages/..%2fapp.py",
        "/pages/....//app.py",
        "/pages//etc/passwd",
        "/pages/%2fetc%2fpasswd",
        "/pages/vendor/../../security.py",
        "/pages/index.html%00.js",
        "/pages/..\\app.py",
        "/pages/",
        "/pages/vendor",
        "//etc/passwd",
        "/../../../../etc/passwd",
    ],
)
def test_no_name_leads_out_of_the_folder_of_pages(open_server: Server, path: str) -> None:
    answer = ask(open_server, path)
    assert answer.status == 404
    assert set(answer.json) == {"error"}


def test_what_changes_something_needs_the_secret_and_our_own_origin(open_server: Server) -> None:
    here = f"http://127.0.0.1:{open_server.port}"
    refused = (
        {},
        {"X-Rex-CSRF": "the secret"},
        {"Sec-Fetch-Site": "same-origin"},
        {"Origin": here},
        {"Origin": here, "X-Rex-CSRF": "another"},
        {"Origin": here, "X-Rex-CSRF": ""},
        {"Origin": "http://evil.example", "X-Rex-CSRF": "the secret"},
        {"Origin": "null", "X-Rex-CSRF": "the secret"},
        {"Origin": f"http://127.0.0.1:{open_server.port + 1}", "X-Rex-CSRF": "the secret"},
        {"Sec-Fetch-Site": "cross-site", "X-Rex-CSRF": "the secret"},
        {"Sec-Fetch-Site": "same-site", "X-Rex-CSRF": "the secret"},
        {"Sec-Fetch-Site": "same-origin", "Origin": "http://evil.example", "X-Rex-CSRF": "the secret"},
    )
    for method in ("POST", "PUT"):
        for headers in refused:
            assert ask(open_server, "/change", method=method, headers=headers).status == 403, headers
    assert ask(open_server, "/changed").json == 0
    assert ask(open_server, "/change", method="POST", headers=CHANGE).json == {"changed": 1}
    assert ask(open_server, "/change", method="PUT", headers={"Origin": here, "X-Rex-CSRF": "the secret"}).status == 200


@pytest.mark.parametrize("method", ["OPTIONS", "DELETE", "PATCH", "TRACE", "CONNECT"])
def test_other_methods_are_not_answered(open_server: Server, method: str) -> None:
    answer = ask(open_server, "/change", method=method, headers=CHANGE)
    assert answer.status in {400, 405}


def test_without_the_token_nothing_is_answered(closed_server: Server) -> None:
    wrong = ({}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"}, {"Cookie": "rex=1; ; =;"})
    for headers in wrong:
        for path in ("/", "/changed", "/pages/index.html", "/nothing", "/?token=wrong", "/?token="):
            answer = ask(closed_server, path, headers=headers)
            assert answer.status == 401
            assert TOKEN.encode() not in answer.body
    assert ask(closed_server, "/change", method="POST", headers=CHANGE).status == 401
    assert ask(closed_server, f"/change?token={TOKEN}", method="POST", headers=CHANGE).status == 401


def test_the_token_becomes_a_cookie_and_leaves_the_address(closed_server: Server) -> None:
    answer = ask(closed_server, f"/changed?a=1&token={TOKEN}&b=2")
    assert answer.status == 303
    assert answer.headers["location"] == "/changed?a=1&b=2"
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert TOKEN not in cookie
    kept = {"Cookie": f"other=x; {cookie.split(';')[0]}"}
    assert ask(closed_server, "/changed", headers=kept).json == 0
    assert ask(closed_server, "/change", method="POST", headers={**kept, **CHANGE}).json == {"changed": 1}
    assert ask(closed_server, "/change", method="POST", headers=kept).status == 403
    assert ask(closed_server, "/changed", headers={"Authorization": f"Bearer {TOKEN}"}).json == 1


def test_the_token_sends_nobody_to_another_server(closed_server: Server) -> None:
    for path in ("//evil.example/", "/\\evil.example", "///evil.example", "/%5cevil.example", "/%0d%0aSet-Cookie:x=1"):
        answer = ask(closed_server, f"{path}?token={TOKEN}")
        if answer.status == 303:
            assert answer.headers["location"].startswith("/")
            assert not answer.headers["location"].startswith(("//", "/\\"))
            assert "x=1" not in answer.headers.get("set-cookie", "")


def test_beyond_this_machine_a_token_is_demanded() -> None:
    assert Guard.of("127.0.0.1", {}).token is None
    assert Guard.of("localhost", {"REX_VIEW_TOKEN": TOKEN}).token is None
    drawn = Guard.of(EVERYWHERE, {})
    assert drawn.token is not None
    assert len(drawn.token) >= 32
    assert drawn.token != Guard.of(EVERYWHERE, {}).token
    assert Guard.of("192.168.1.5", {"REX_VIEW_TOKEN": TOKEN}).token == TOKEN
    assert TOKEN not in repr(Guard.of("192.168.1.5", {"REX_VIEW_TOKEN": TOKEN}))


@pytest.mark.parametrize(
    ("host", "token"), [(EVERYWHERE, "short"), (EVERYWHERE, "ü" * 20), ("a host", TOKEN), ("/", "x")]
)
def test_a_bad_address_or_token_is_told(host: str, token: str) -> None:
    with pytest.raises(SettingsError):
        Guard.of(host, {"REX_VIEW_TOKEN": token})


def test_who_listens_everywhere_is_known_by_every_address_but_by_no_foreign_name() -> None:
    guard = Guard.of(EVERYWHERE, {})
    for name in ("192.168.1.5:8470", "[fe80::1]:80", "localhost", socket.gethostname()):
        assert guard.knows(name), name
    assert not guard.knows("evil.example")
    one = Guard.of("192.168.1.5", {})
    assert one.knows("192.168.1.5")
    assert not one.knows("192.168.1.6")


def test_a_link_that_leads_out_of_a_folder_leads_nowhere(tmp_path: Path) -> None:
    root, outside = tmp_path / "root", tmp_path / "outside"
    root.mkdir()
    outside.mkdir()
    (outside / "secret").write_text("x")
    (root / "there").write_text("x")
    (root / "out").symlink_to(outside)
    (root / "in").symlink_to(root / "there")
    (root / "round").symlink_to(root / "round")
    assert within(root, root / "there") == root / "there"
    assert within(root, root / "in") == root / "there"
    for name in ("out/secret", "out", "../outside/secret", "round", "nothing"):
        assert within(root, root / name) is None, name


def test_two_servers_do_not_take_each_others_port() -> None:
    with Server(Guard().protects(_app())) as first, pytest.raises(SettingsError, match="cannot be listened on"):
        Server(Guard().protects(_app()), port=first.port).start()
