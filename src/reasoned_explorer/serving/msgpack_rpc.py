"""The server's end of MessagePack-RPC over TCP.

A request is ``[0, id, method, arguments]``, its answer ``[1, id, error, result]``; a notification ``[2, method,
arguments]`` is obeyed and not answered. What is no such message ends the connection that it came on and does nothing
else; what a method refuses is answered with an error.
"""

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from typing import Any

from reasoned_explorer.model.errors import ReasonedExplorerError
from reasoned_explorer.vehicles.airsim.codec import MALFORMED, new_packer, new_unpacker

REQUEST, ANSWER, NOTE = 0, 1, 2
#: Of one request: a path of 4,096 points is 150 kB. Room for arrays is made before they have come.
_MAX_BYTES, _MAX_ITEMS = 1 << 20, 4096
#: Requests of one connection that may wait for their answers at once.
_MAX_WAITING = 1024
#: A client that does not read its answers is read no further beyond so many bytes.
_MAX_UNREAD = 1 << 26

#: Takes a request's arguments; returns its result, or a future of it where the answer comes later.
Method = Callable[..., Any]


class MethodError(ReasonedExplorerError):
    """What a method answers instead of a result: why it refuses."""


class RpcServer:
    """Answers calls of methods on TCP.

    Args:
        methods: By name. One is called for each request, in the order in which a connection's requests come, with the
            request's arguments; it raises `MethodError` to refuse them and has then done nothing.
    """

    def __init__(self, methods: Mapping[str, Method]) -> None:
        self._methods = dict(methods)
        self._connections: set[_Connection] = set()
        self._server: asyncio.Server | None = None
        self.refused = 0
        new_packer()  # says now, not at the first connection, that the library is missing

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen, and return the port: the one that was asked for, or a free one for 0.

        Raises:
            OSError: If that cannot be listened on.
        """
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(lambda: _Connection(self), host, port)
        listening: int = self._server.sockets[0].getsockname()[1]
        return listening

    async def close(self) -> None:
        """Stop listening and hang up on everybody. Safe to call twice."""
        server, self._server = self._server, None
        if server is not None:
            server.close()
            self.hang_up()
            await server.wait_closed()

    def hang_up(self) -> None:
        """End all connections, and go on listening."""
        for connection in tuple(self._connections):
            connection.abort()

    def answer(self, method: object, arguments: object) -> Any:
        """Return what a method returns.

        Raises:
            MethodError: If there is no such method or it refuses.
        """
        known = self._methods.get(method) if isinstance(method, str) else None
        if known is None:
            raise MethodError(f"there is no method {method!r:.80}")
        if not isinstance(arguments, list):
            raise MethodError(f"the arguments of {method} are no list")
        return known(*arguments)


class _Connection(asyncio.Protocol):
    def __init__(self, server: RpcServer) -> None:
        self._server = server
        self._pack = new_packer()
        self._unpacker = new_unpacker(max_bytes=_MAX_BYTES, max_items=_MAX_ITEMS)
        self._transport: asyncio.Transport | None = None
        self._waiting: set[asyncio.Future[Any]] = set()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, asyncio.Transport):
            raise TypeError
        self._transport = transport
        transport.set_write_buffer_limits(high=_MAX_UNREAD)
        self._server._connections.add(self)

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002 - the protocol's
        self._transport = None
        self._server._connections.discard(self)
        # What flies goes on flying: a lost link does not cancel what it asked for, as with AirSim.

    def pause_writing(self) -> None:
        if self._transport is not None:
            self._transport.pause_reading()

    def resume_writing(self) -> None:
        if self._transport is not None:
            self._transport.resume_reading()

    def data_received(self, data: bytes) -> None:
        try:
            self._unpacker.feed(data)
            for message in self._unpacker:
                self._take(message)
                if self._transport is None:
                    return
        except MALFORMED:
            self._server.refused += 1
            self.abort()

    def abort(self) -> None:
        transport, self._transport = self._transport, None
        if transport is not None:
            transport.abort()

    def _take(self, message: object) -> None:
        """Obey a message.

        Raises:
            ValueError: If it is none.
        """
        kind = message[0] if isinstance(message, list) and message else None
        if (
            type(kind) is not int
            or kind not in {REQUEST, NOTE}
            or len(_listed(message)) != (4 if kind == REQUEST else 3)
        ):
            raise ValueError("no request")
        number = None
        if kind == REQUEST:
            number = _listed(message)[1]
            if type(number) is not int or not 0 <= number < 1 << 32:
                raise ValueError("no request")
        method, arguments = _listed(message)[-2:]
        if len(self._waiting) >= _MAX_WAITING:
            self._send(number, f"more than {_MAX_WAITING} calls are waiting for their answers", None)
            return
        try:
            result = self._server.answer(method, arguments)
        except MethodError as refusal:
            self._server.refused += 1
            self._send(number, str(refusal), None)
            return
        if isinstance(result, asyncio.Future):
            self._waiting.add(result)
            result.add_done_callback(lambda done: self._send_later(number, done))
        else:
            self._send(number, None, result)

    def _send_later(self, number: int | None, done: "asyncio.Future[Any]") -> None:
        self._waiting.discard(done)
        if done.cancelled():
            self._send(number, "the server stops", None)
            return
        error = done.exception()
        if error is not None and not isinstance(error, ReasonedExplorerError):
            self._send(number, f"the server failed: {type(error).__name__}", None)
            raise error
        self._send(number, None if error is None else str(error), None if error is not None else done.result())

    def _send(self, number: int | None, error: str | None, result: Any) -> None:
        if number is not None and self._transport is not None:
            with contextlib.suppress(ConnectionError):
                self._transport.write(self._pack([ANSWER, number, error, result]))


def _listed(message: object) -> list[Any]:
    if not isinstance(message, list):
        raise ValueError("no request")  # noqa: TRY004 - of the wire
    return message
