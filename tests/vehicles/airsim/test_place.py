"""Asking a simulator where its vehicle stands."""

import asyncio
from typing import Any

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.airsim.place import PLACE_METHOD, ServedPlace, place_of

pytest.importorskip("msgpack")

TOLD = {
    "world": "plaza:3@200",
    "digest": "abc",
    "x_m": 1.0,
    "y_m": -2,
    "heading_rad": 3.0,
    "home_x_m": 0.5,
    "home_y_m": 0,
}


def asked(methods: dict[str, Any]) -> ServedPlace | None:
    """Ask a server with such methods."""
    from reasoned_explorer.serving.msgpack_rpc import RpcServer

    async def ask() -> ServedPlace | None:
        server = RpcServer(methods)
        port = await server.start("127.0.0.1", 0)
        try:
            return await place_of("127.0.0.1", port)
        finally:
            await server.close()

    return asyncio.run(ask())


def test_the_embedded_simulator_tells() -> None:
    place = asked({"ping": lambda: True, PLACE_METHOD: lambda: TOLD})
    assert place == ServedPlace("plaza:3@200", "abc", Pose(1.0, -2.0, 0.0, 3.0), Pose(0.5, 0.0))


def test_another_simulator_does_not() -> None:
    assert asked({"ping": lambda: True}) is None


@pytest.mark.parametrize("wrong", [None, 7, {}, TOLD | {"x_m": "1"}, TOLD | {"y_m": float("nan")}, TOLD | {"world": 1}])
def test_what_cannot_be_understood_tells_nothing(wrong: Any) -> None:
    assert asked({"ping": lambda: True, PLACE_METHOD: lambda: wrong}) is None


def test_nobody_there_is_a_fault() -> None:
    with pytest.raises(PartError):
        asyncio.run(place_of("127.0.0.1", 1))
