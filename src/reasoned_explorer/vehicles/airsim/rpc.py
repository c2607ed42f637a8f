"""The client's end of AirSim's wire: MessagePack-RPC over TCP.

A request is ``[0, id, method, arguments]``, its answer ``[1, id, error, result]``. Answers come in any order: that of a
flight comes when the flight is over. Everything here runs in one event loop, the process's live loop for the driver.
"""

import asyncio
import contextlib
from dataclasses import dataclass, field
from typing import Any

from reasoned_explorer.model.errors import PartError
from reasoned_explorer.vehicles.airsim.codec import MALFORMED, new_packer, new_unpacker

REQUEST, ANSWER, NOTE = 0, 1, 2
#: Of one message: a picture of 4096 × 4096 floats, 9 bytes each, and some.
_MAX_BYTES = 1 << 28
_MAX_ITEMS = 1 << 24
_CHUNK = 1 << 16
_PART = "AirSim"


@dataclass(slots=True, eq=False)
class Pending:
    """A call whose answer may not have come yet.

    Attributes:
        method: What was called.
        answer: Done once the answer has come, or the link is lost.
        answered: Whether it has come; safe to read from another thread. Answers count in the order in which they come:
            whoever has got a later answer sees here that this one came before.
    """

    method: str
    answer: "asyncio.Future[Any]" = field(repr=False)
    answered: bool = False

    def settle(self, error: BaseException | None, result: object = None) -> None:
        """Note what came."""
        self.answered = True
        if self.answer.done():
            return
        if error is None:
            self.answer.set_result(result)
        else:
            self.answer.set_exception(error)
            self.answer.exception()  # whoever waits gets it; where nobody does, that is no news


class RpcClient:
    """Calls methods of a server; connects with the first call, and again with the next one after the link was lost.

    Args:
        host: Of the server.
        port: Likewise.
        deadline_s: How long an answer may take where a call does not say otherwise, seconds.
    """

    def __init__(self, host: str, port: int, *, deadline_s: float = 10.0) -> None:
        self.host, self.port, self.deadline_s = host, port, deadline_s
        self._pack = new_packer()
        self._writer: asyncio.StreamWriter | None = None
        self._reading: asyncio.Task[None] | None = None
        self._pending: dict[int, Pending] = {}
        self._next_id = 0
        self._connecting = asyncio.Lock()

    async def call(self, method: str, *args: object, deadline_s: float | None = None) -> Any:
        """Call a method and return its result.

        Raises:
            PartError: If the link cannot be made or is lost, the answer is late, or the server refuses.
        """
        return await self.outcome(await self.begin(method, *args, deadline_s=deadline_s), deadline_s=deadline_s)

    async def begin(self, method: str, *args: object, deadline_s: float | None = None) -> Pending:
        """Send a call and return at once what will hold its answer.

        Raises:
            PartError: If the link cannot be made or is lost, or takes nothing within the deadline.
        """
        limit_s = self.deadline_s if deadline_s is None else deadline_s
        try:
            async with asyncio.timeout(limit_s):
                writer = await self._connected()
                number, self._next_id = self._next_id, (self._next_id + 1) % (1 << 31)
                pending = Pending(method, asyncio.get_running_loop().create_future())
                self._pending[number] = pending
                writer.write(self._pack([REQUEST, number, method, list(args)]))
                await writer.drain()
        except TimeoutError as error:
            raise PartError(_PART, f"{self._where} takes nothing within {limit_s:g} s ({method})") from error
        except OSError as error:
            raise PartError(_PART, f"no link to {self._where}: {error}") from error
        return pending

    async def outcome(self, pending: Pending, *, deadline_s: float | None = None) -> Any:
        """Wait for the answer to a call that was begun.

        Raises:
            PartError: If the link is lost, the answer is late, or the server refuses.
        """
        limit_s = self.deadline_s if deadline_s is None else deadline_s
        try:
            async with asyncio.timeout(limit_s):
                return await pending.answer
        except TimeoutError as error:
            raise PartError(_PART, f"no answer to {pending.method} within {limit_s:g} s") from error

    async def close(self) -> None:
        """Hang up. Safe to call twice."""
        if self._reading is not None:
            self._reading.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._reading
        self._hang_up(PartError(_PART, "the link was closed"))

    @property
    def _where(self) -> str:
        return f"{self.host}:{self.port}"

    async def _connected(self) -> asyncio.StreamWriter:
        async with self._connecting:
            if self._writer is None:
                reader, self._writer = await asyncio.open_connection(self.host, self.port)
                self._reading = asyncio.get_running_loop().create_task(self._read(reader))
            return self._writer

    async def _read(self, reader: asyncio.StreamReader) -> None:
        unpacker = new_unpacker(max_bytes=_MAX_BYTES, max_items=_MAX_ITEMS)
        lost = f"the link to {self._where} is lost"
        try:
            while chunk := await reader.read(_CHUNK):
                unpacker.feed(chunk)
                for message in unpacker:
                    self._take(message)
        except OSError as error:
            lost = f"{lost}: {error}"
        except MALFORMED as error:
            lost = f"{self._where} does not speak MessagePack-RPC: {error}"
        self._hang_up(PartError(_PART, lost))

    def _take(self, message: object) -> None:
        if not isinstance(message, list) or not message or message[0] not in {ANSWER, NOTE} or message[0] is True:
            raise ValueError(f"{str(message)[:60]!r} is no answer")
        if message[0] == NOTE:
            return
        if len(message) != 4 or type(message[1]) is not int:
            raise ValueError(f"an answer of {len(message)} parts")
        pending = self._pending.pop(message[1], None)
        if pending is None:
            return  # the answer to a call that nobody waits for any more
        error = message[2]
        refused = None if error is None else PartError(_PART, f"{pending.method} was refused: {_told(error)}")
        pending.settle(refused, message[3])

    def _hang_up(self, why: PartError) -> None:
        writer, self._writer = self._writer, None
        if writer is not None:
            writer.close()
        lost, self._pending = self._pending, {}
        for pending in lost.values():
            pending.settle(why)


def _told(error: object) -> str:
    text = " ".join(str(error).encode("utf-8", "replace").decode().split())
    return text if len(text) <= 300 else text[:300] + "…"
