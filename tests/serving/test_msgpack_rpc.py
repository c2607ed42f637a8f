import asyncio
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.serving.msgpack_rpc import MethodError, RpcServer
from reasoned_explorer.vehicles.airsim.codec import new_packer
from reasoned_explorer.vehicles.airsim.rpc import RpcClient

pytest.importorskip("msgpack")


def refuse(*_):
    raise MethodError("not today")


def served(script, methods=None, raw=None):
    """Run a script with a client of a server; or send it raw bytes first, on another connection."""

    async def run():
        done = []
        known = {"echo": lambda *args: list(args), "refuse": refuse, "note": done.append} | (methods or {})
        server = RpcServer(known)
        port = await server.start()
        client = RpcClient("127.0.0.1", port)
        try:
            if raw is not None:
                reader, writer = await asyncio.open_connection("127.0.0.1", port)
                writer.write(raw)
                writer.write_eof()
                await reader.read()
                writer.close()
            return await script(client), done
        finally:
            await client.close()
            await server.close()

    return asyncio.run(run())


async def echo(client):
    return await client.call("echo", 1, 2.5, "three", [4], {"five": None})


def test_methods_are_called_with_their_arguments():
    assert served(echo)[0] == [1, 2.5, "three", [4], {"five": None}]


@pytest.mark.parametrize(("method", "why"), [("refuse", "not today"), ("fly", "there is no method 'fly'")])
def test_refusals_are_answers(method, why):
    async def script(client):
        with pytest.raises(Exception, match=why):
            await client.call(method)
        return await client.call("echo")

    assert served(script)[0] == []


def test_later_answers_do_not_hold_up_others():
    async def script(client):
        gate = asyncio.get_running_loop().create_future()
        waiting = await client.begin("wait")
        assert await client.call("echo", 1) == [1]
        assert not waiting.answered
        futures[0].set_result("at last")
        del gate
        return await client.outcome(waiting)

    futures = []

    def wait():
        futures.append(asyncio.get_running_loop().create_future())
        return futures[0]

    assert served(script, {"wait": wait})[0] == "at last"


def test_notifications_are_obeyed_and_not_answered():
    assert served(echo, raw=new_packer()([2, "note", ["hello"]]))[1] == ["hello"]


def deep(levels):
    return b"\x91" * levels + b"\xc0"


@pytest.mark.parametrize(
    "raw",
    [
        b"\xc1",
        b"GET / HTTP/1.1\r\n\r\n",
        deep(5000),
        b"\xdd" + struct.pack(">I", 0xFFFFFFFF),  # an array of four billion
        b"\xdf" + struct.pack(">I", 0xFFFFFFFF),
        b"\xc6" + struct.pack(">I", 0x7FFFFFFF),
        new_packer()([0, -1, "note", [1]]),
        new_packer()([0, True, "note", [1]]),
        new_packer()([1, 0, None, 1]),
        new_packer()([0, 0, "note"]),
        new_packer()([[0], 0, "note", [1]]),
        new_packer()([0, 0, ["note"], [1]]),
        new_packer()([0, 0, "note", {"a": 1}]),
        new_packer()({"note": 1}),
        b"\x94\x00\x00\xa4note\xc7\x01\x7f\x00",  # an extension type as arguments
    ],
)
def test_what_is_no_request_does_nothing_and_others_are_served_on(raw):
    answer, done = served(echo, raw=raw)
    assert answer[0] == 1
    assert done == []


@settings(max_examples=80)
@given(st.binary(max_size=300))
def test_no_bytes_whatever_stop_the_server(noise):
    assert served(echo, raw=noise)[0][0] == 1
