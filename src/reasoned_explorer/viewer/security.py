"""Who may ask the server what: one layer round every answer.

A page on another site can make a browser ask this server for anything. Therefore the name that it was asked by must be
one of its own (no other name may be bound to its address by somebody else's DNS), nothing can be read by other origins,
and what changes something asks for a secret that only our own page can read. Whoever listens beyond this machine gives
a token to those who may come in.
"""

import hmac
import ipaddress
import json
import logging
import secrets
import socket
from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlencode, urlsplit

from reasoned_explorer.model import Fault, SettingsError

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Asgi = Callable[[Scope, Receive, Send], Awaitable[None]]

TOKEN_VARIABLE = "REX_VIEW_TOKEN"  # noqa: S105 - the name of a variable
CSRF_HEADER = "x-rex-csrf"
#: A token that a person chose must not be guessed.
SHORTEST_TOKEN = 16
LOOPBACK_NAMES = ("127.0.0.1", "::1", "localhost")
_SAFE_METHODS = frozenset({"GET", "HEAD"})
_METHODS = _SAFE_METHODS | {"POST", "PUT"}
_POLICY = (
    b"default-src 'self'; img-src 'self' data: blob:; style-src 'self'; script-src 'self'; connect-src 'self'; "
    b"object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)
_HEADERS = (
    (b"content-security-policy", _POLICY),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cross-origin-opener-policy", b"same-origin"),
)
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Guard:
    """What is asked of everybody who asks the server.

    Attributes:
        names: Host names and addresses that the server may be asked by, in lower case, IPv6 without brackets.
        any_address: Whether every IP address will do as its name: it listens on all of them. An address is nothing that
            somebody else's DNS can answer.
        token: What lets somebody in; None where only this machine can ask.
        csrf: What our own page sends along when it changes something.
    """

    names: frozenset[str] = frozenset(LOOPBACK_NAMES)
    any_address: bool = False
    token: str | None = field(default=None, repr=False)
    csrf: str = field(default_factory=lambda: secrets.token_urlsafe(32), repr=False)

    @classmethod
    def of(cls, host: str, environment: Mapping[str, str]) -> "Guard":
        """Return the guard of a server that listens on an address: beyond this machine it asks for a token.

        Args:
            host: Address or name that it listens on.
            environment: Where ``REX_VIEW_TOKEN`` may name the token; one is drawn where it does not.

        Raises:
            SettingsError: If the address is none, or the token that was chosen is too short.
        """
        address = host.strip().strip("[]").lower()
        if is_loopback(address):
            return cls(frozenset({*LOOPBACK_NAMES, address}))
        token = environment.get(TOKEN_VARIABLE) or secrets.token_urlsafe(24)
        faults = []
        if not address or any(char.isspace() or char in "/@" for char in address):
            faults.append(Fault(f"{host!r:.60}", "an address of this machine, e.g. 192.168.1.5 or 0.0.0.0"))
        if len(token) < SHORTEST_TOKEN or not token.isascii() or not token.isprintable():
            expected = f"at least {SHORTEST_TOKEN} plain characters"
            faults.append(
                Fault(f"{TOKEN_VARIABLE} has {len(token)} characters", expected, "leave it out: one is drawn")
            )
        if faults:
            raise SettingsError("--host", faults)
        everywhere = _is_unspecified(address)
        names = {socket.gethostname().lower(), *LOOPBACK_NAMES} if everywhere else {address}
        return cls(frozenset(names), any_address=everywhere, token=token)

    @property
    def cookie_name(self) -> str:
        """Of the cookie that holds the token; a machine's ports share their cookies, so each token has its own."""
        return "rex-view-" + blake2b((self.token or "").encode(), digest_size=4).hexdigest()

    @property
    def cookie_value(self) -> str:
        """What the cookie holds: made of the token, which it does not tell."""
        return blake2b((self.token or "").encode(), digest_size=32, person=b"rex-view").hexdigest()

    def protects(self, app: Asgi) -> Asgi:
        """Return an application that answers only those who may ask, and whose every answer has the safe headers."""
        return _Guarded(app, self)

    def knows(self, host: str) -> bool:
        """Return whether a ``Host`` header names this server. Any port will do: people tunnel."""
        name = urlsplit(f"//{host}").hostname or "" if _is_plain_host(host) else ""
        return name in self.names or (self.any_address and _is_address(name))

    def lets_in(self, headers: Mapping[str, str]) -> bool:
        """Return whether a request carries the token: in its cookie or as a bearer."""
        if self.token is None:
            return True
        kind, _, bearer = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer" and _same(bearer.strip(), self.token):
            return True
        pairs = (pair.strip().partition("=") for pair in headers.get("cookie", "").split(";"))
        return any(name == self.cookie_name and _same(value, self.cookie_value) for name, _, value in pairs)

    def may_change(self, headers: Mapping[str, str]) -> bool:
        """Return whether a request that changes something comes from our own page."""
        site, origin = headers.get("sec-fetch-site"), headers.get("origin")
        if site is None and origin is None:
            return False
        if site not in {None, "same-origin"}:
            return False
        if origin is not None and urlsplit(origin).netloc.lower() != headers.get("host", "").lower():
            return False
        return _same(headers.get(CSRF_HEADER, ""), self.csrf)


class _Guarded:
    """An ASGI application behind a guard."""

    def __init__(self, app: Asgi, guard: Guard) -> None:
        self._app, self._guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return  # nothing here speaks over web sockets
        begun = ended = False

        async def safely(message: Message) -> None:
            nonlocal begun, ended
            ended = message["type"] == "http.response.body" and not message.get("more_body", False)
            if message["type"] == "http.response.start":
                begun = True
                given = {name.lower() for name, _ in message.get("headers", ())}
                extra = [pair for pair in _HEADERS if pair[0] not in given]
                if b"cache-control" not in given:
                    extra.append((b"cache-control", b"no-store"))
                message = {**message, "headers": [*message.get("headers", ()), *extra]}
            await send(message)

        refusal = self._refusal(scope)
        if refusal is not None:
            await _answer(safely, *refusal)
            return
        try:
            await self._app(scope, receive, safely)
        except Exception as error:
            # What went wrong is for whoever runs the server, not for whoever asks.
            _log.exception("%s %s failed", scope["method"], scope["path"])
            if ended:
                return
            if begun:
                raise
            await _answer(
                safely, 500, {"error": f"the server failed at this ({type(error).__name__}); its log says why"}
            )

    def _refusal(self, scope: Scope) -> tuple[int, dict[str, str], list[tuple[bytes, bytes]]] | None:
        """Return the answer to a request that is not let through."""
        guard, headers = self._guard, _headers_of(scope)
        if not guard.knows(headers.get("host", "")):
            return 421, {"error": "this server is not known by that name"}, []
        method = scope["method"]
        if method not in _METHODS:
            return 405, {"error": f"{method} is not answered here"}, [(b"allow", b"GET, HEAD, POST, PUT")]
        if guard.token is not None and method in _SAFE_METHODS:
            query = parse_qsl(scope.get("query_string", b"").decode("latin-1"), keep_blank_values=True)
            if _same(dict(query).get("token", ""), guard.token):
                return 303, {}, self._welcome(scope["path"], [pair for pair in query if pair[0] != "token"])
        if not guard.lets_in(headers):
            said = "a token is needed: open the address that was printed where the server was started"
            return 401, {"error": said}, [(b"www-authenticate", b"Bearer")]
        if method not in _SAFE_METHODS and not guard.may_change(headers):
            return 403, {"error": "only the page of this server may change something"}, []
        return None

    def _welcome(self, path: str, query: list[tuple[str, str]]) -> list[tuple[bytes, bytes]]:
        """Return the headers that put the token into a cookie and take it out of the address."""
        # One slash at the front: two would name another server.
        place = "/" + path.lstrip("/\\")
        target = urlsplit(place).path if place.isascii() and place.isprintable() else "/"
        target += f"?{urlencode(query)}" if query else ""
        cookie = f"{self._guard.cookie_name}={self._guard.cookie_value}; Path=/; HttpOnly; SameSite=Strict"
        return [(b"location", target.encode("ascii")), (b"set-cookie", cookie.encode("ascii"))]


def is_loopback(host: str) -> bool:
    """Return whether only this machine reaches an address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def within(root: Path, path: Path) -> Path | None:
    """Return where a path really leads, or None where that is nowhere or outside of a folder.

    Args:
        root: The folder, resolved already.
        path: Inside it as it is written; links may lead elsewhere.
    """
    try:
        real = path.resolve(strict=True)
    except (OSError, RuntimeError):  # before Python 3.13, links that lead in circles are a RuntimeError
        return None
    return real if real.is_relative_to(root) else None


def _headers_of(scope: Scope) -> dict[str, str]:
    """Return the headers of a request; of a header that was sent twice nothing that could be used is left."""
    headers: dict[str, str] = {}
    pairs: Iterable[tuple[bytes, bytes]] = scope.get("headers", ())
    for name, value in pairs:
        key = name.decode("latin-1").lower()
        headers[key] = f"{headers[key]}, {value.decode('latin-1')}" if key in headers else value.decode("latin-1")
    return headers


def _is_plain_host(host: str) -> bool:
    return bool(host) and not any(char.isspace() or char in "/?#@\\," for char in host)


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _is_unspecified(address: str) -> bool:
    return _is_address(address) and ipaddress.ip_address(address).is_unspecified


def _same(given: str, wanted: str) -> bool:
    # In a time that does not tell how much of it is right.
    return hmac.compare_digest(given.encode("utf-8", "replace"), wanted.encode())


async def _answer(send: Send, status: int, body: dict[str, str], headers: Iterable[tuple[bytes, bytes]] = ()) -> None:
    payload = json.dumps(body).encode() if body else b""
    length = (b"content-length", str(len(payload)).encode())
    kind = (b"content-type", b"application/json")
    await send({"type": "http.response.start", "status": status, "headers": [kind, length, *headers]})
    await send({"type": "http.response.body", "body": payload})
