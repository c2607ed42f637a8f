"""Where a simulator's vehicle stands, and in which world, as the embedded simulator tells it over AirSim's wire."""

import math
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.airsim.rpc import RpcClient

#: The method that tells it; AirSim has none of that name.
PLACE_METHOD = "rexGetPlace"


@dataclass(frozen=True, slots=True)
class ServedPlace:
    """Where a served vehicle stands.

    Attributes:
        world: Name of the world.
        digest: Of its content, as records have it.
        start: Where the vehicle stands, in the world's frame.
        home: Where it stood at first, where its own frame begins.
    """

    world: str
    digest: str
    start: Pose
    home: Pose


async def place_of(host: str, port: int, *, deadline_s: float = 10.0) -> ServedPlace | None:
    """Ask a simulator where it is; None where it is not the embedded one, which alone can tell.

    Args:
        host: Of the simulator.
        port: Likewise.
        deadline_s: How long each answer may take, seconds.

    Raises:
        PartError: If it cannot be reached, or does not speak AirSim's wire.
    """
    client = RpcClient(host, port, deadline_s=deadline_s)
    try:
        await client.call("ping")
        try:
            told = await client.call(PLACE_METHOD)
        except PartError:
            return None
        return _understood(told)
    finally:
        await client.close()


def _understood(told: Any) -> ServedPlace | None:
    if not isinstance(told, dict):
        return None
    numbers = [told.get(name) for name in ("x_m", "y_m", "heading_rad", "home_x_m", "home_y_m")]
    if not all(isinstance(number, int | float) and math.isfinite(number) for number in numbers):
        return None
    world, digest = told.get("world"), told.get("digest")
    if not isinstance(world, str) or not isinstance(digest, str):
        return None
    x_m, y_m, heading_rad, *home_m = (float(number) for number in numbers if number is not None)
    return ServedPlace(world, digest, Pose(x_m, y_m, 0.0, heading_rad), Pose(*home_m))
