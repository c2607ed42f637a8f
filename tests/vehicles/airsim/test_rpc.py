import asyncio
from collections.abc import Awaitable, Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.airsim.codec import new_packer
from reasoned_explorer.vehicles.airsim.rpc import RpcClient

pytest.importorskip("msgpack")

Talk = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


def against(server: Talk, script, **more):
    """Run a script with a client of a server that behaves as it likes."""

    async def served(reader, writer):
        try:
            await server(reader, writer)
        except ConnectionError:
            pass
        finally:
            writer.close()

    async def run():
        listening = await asyncio.start_server(served, "127.0.0.1", 0)
        client = RpcClient("127.0.0.1", listening.sockets[0].getsockname()[1], **more)
        try:
            return await script(client)
        finally:
            await client.close()
            listening.close()

    return asyncio.run(run())


def answering(*answers: object) -> Talk:
    """A server that sends so many answers once it has got a request, whatever it asked."""
    pack = new_packer()

    async def talk(reader, writer):
        await reader.read(1 << 16)
        for answer in answers:
            writer.write(answer if isinstance(answer, bytes) else pack(answer))
        await writer.drain()
        await reader.read()

    return talk


async def ask(client):
    return await client.call("ping")


def test_a_call_returns_what_is_answered():
    assert against(answering([1, 0, None, {"x_val": 1.5}]), ask) == {"x_val": 1.5}


def test_answers_come_in_any_order_and_notes_are_passed_over():
    async def two(client):
        slow, fast = await client.begin("slow"), await client.begin("fast")
        return await client.outcome(fast), await client.outcome(slow)

    answers = [2, "note", []], [1, 1, None, "fast"], [1, 0, None, "slow"]
    assert against(answering(*answers), two) == ("fast", "slow")


def test_whoever_has_a_later_answer_sees_that_an_earlier_one_came():
    async def two(client):
        flight, step = await client.begin("flight"), await client.begin("step")
        await client.outcome(step)
        return flight.answered

    assert against(answering([1, 0, None, True], [1, 1, None, None]), two) is True
    assert against(answering([1, 1, None, None]), two) is False


def test_text_that_is_none_keeps_its_bytes():
    from reasoned_explorer.vehicles.airsim.codec import as_bytes

    # msgpack's old "raw" type, which old servers send pictures as
    raw = b"\x94\x01\x00\xc0\xa4\x89PNG"
    assert as_bytes(against(answering(raw), ask)) == b"\x89PNG"


def test_a_refusal_is_told():
    with pytest.raises(PartError, match="ping was refused: no such method"):
        against(answering([1, 0, "no such method", None]), ask)


def test_a_late_answer_is_told():
    async def silent(reader, writer):
        await reader.read()

    with pytest.raises(PartError, match=r"no answer to ping within 0\.05 s"):
        against(silent, ask, deadline_s=0.05)


def test_a_lost_link_fails_all_calls_and_is_made_again_by_the_next():
    calls = []

    async def hangs_up_once(reader, writer):
        calls.append(await reader.read(1 << 16))
        if len(calls) > 1:
            writer.write(new_packer()([1, 1, None, True]))
            await writer.drain()

    async def twice(client):
        with pytest.raises(PartError, match="is lost"):
            await client.call("ping")
        return await client.call("ping")

    assert against(hangs_up_once, twice) is True


def test_nobody_there_is_told():
    async def run():
        client = RpcClient("127.0.0.1", 9, deadline_s=2.0)
        await client.call("ping")

    with pytest.raises(PartError, match=r"no link to 127\.0\.0\.1:9"):
        asyncio.run(run())


@pytest.mark.parametrize(
    "answer",
    [b"\xc1", b"\xff\xff", [0, 0, "ping", []], [1, 0, None], [1, "0", None, 1], {"a": 1}, 7, [True, 0, None, 1], []],
)
def test_what_is_no_answer_is_a_lost_link_and_no_crash(answer):
    with pytest.raises(PartError, match="does not speak MessagePack-RPC"):
        against(answering(answer), ask)


@settings(max_examples=60)
@given(st.binary(max_size=200))
def test_no_bytes_whatever_crash_the_client(noise):
    async def script(client):
        with pytest.raises(PartError):
            await client.call("ping", deadline_s=0.05)

    async def talk(reader, writer):
        await reader.read(1 << 16)
        writer.write(noise)

    against(talk, script)
