"""How fast the served AirSim answers: pose calls, pictures, and a flight as fast as asked.

Run ``python benchmarks/bench_airsim.py``. The client, a plain socket that waits for each answer before the next call,
runs in a process of its own. Besides the wall's time the server's processor time is told, so that a busy machine
matters less: "on a core" is what one core of its own would give.
"""

import argparse
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import msgpack

from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

#: What is promised: calls and pictures a second on one core, seconds of wall time for a flight of 6 s.
POSES_PER_S, PICTURES_PER_S, FLIGHT_S = 3000.0, 60.0, 1.0
_START = Pose(55.0, 35.0)


class _Plain:
    """The shortest client that there is."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._unpacker = msgpack.Unpacker(raw=False, max_buffer_size=1 << 28)
        self._number = 0

    def call(self, method: str, *arguments: object) -> Any:
        self._number += 1
        self._socket.sendall(msgpack.packb([0, self._number, method, list(arguments)]))
        while True:
            for answer in self._unpacker:
                if answer[2] is not None:
                    raise RuntimeError(answer[2])
                return answer[3]
            self._unpacker.feed(self._socket.recv(1 << 18))


def _poses(client: _Plain, count: int) -> None:
    for _ in range(count):
        client.call("simGetVehiclePose", "")


def _pictures(client: _Plain, count: int) -> None:
    wanted = [{"camera_name": "front_center", "image_type": 0, "pixels_as_float": False, "compress": False}]
    for turn in range(count):
        client.call("rotateToYaw", 10.0 * turn, 3e38, 5.0, "")
        client.call("simGetImages", wanted, "")


def _flight(client: _Plain, count: int) -> None:
    # Out and back, 14 m each: about 6 s at 3 m/s.
    still = {"is_rate": True, "yaw_or_rate": 0.0}
    for turn in range(count):
        north_m = 14.0 if turn % 2 == 0 else 0.0
        if client.call("moveToPosition", north_m, 0.0, -3.0, 3.0, 3e38, 0, still, -1, 1, "") is not True:
            raise RuntimeError("the flight did not come about")


_WORK: dict[str, Callable[[_Plain, int], None]] = {"poses": _poses, "pictures": _pictures, "flight": _flight}


def _as_client(work: str, port: int, count: int) -> None:
    """Do some work and print the wall's seconds that it took."""
    client = _Plain(port)
    client.call("enableApiControl", *[True, ""])
    client.call("armDisarm", *[True, ""])
    client.call("takeoff", 20.0, "")
    _WORK[work](client, 2)
    print("ready", flush=True)
    sys.stdin.readline()
    begun = time.perf_counter()
    _WORK[work](client, count)
    print(time.perf_counter() - begun, flush=True)


def _measured(work: str, port: int, count: int) -> tuple[float, float]:
    """Return the wall's and this process's processor seconds of some work of a client."""
    command = [sys.executable, __file__, "--as-client", work, "--port", str(port), "--count", str(count)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as client:
        if client.stdout is None or client.stdin is None:
            raise RuntimeError
        client.stdout.readline()
        used = time.process_time()
        client.stdin.write("\n")
        client.stdin.flush()
        wall_s = float(client.stdout.readline())
        return wall_s, time.process_time() - used


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", default="park:7")
    parser.add_argument("--poses", type=int, default=6000)
    parser.add_argument("--pictures", type=int, default=120)
    parser.add_argument("--as-client", choices=sorted(_WORK))
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--count", type=int, default=1)
    chosen = parser.parse_args()
    if chosen.as_client:
        _as_client(chosen.as_client, chosen.port, chosen.count)
        return 0
    atlas = Atlas(open_world(chosen.world))
    start = _meadow(atlas)
    kept = []
    with BackgroundServer(lambda: AirSimServer(atlas, start, speed=AS_FAST_AS_ASKED)) as served:
        for work, count, least in (
            ("poses", chosen.poses, POSES_PER_S),
            ("pictures", chosen.pictures, PICTURES_PER_S),
        ):
            wall_s, used_s = _measured(work, served.port, count)
            rate = count / used_s
            print(f"{work:9} {count / wall_s:8.0f} a second, {rate:8.0f} on a core (at least {least:.0f})")
            kept.append(rate >= least)
        wall_s, used_s = _measured("flight", served.port, 10)
        print(f"flight    {wall_s / 10:8.3f} s for about 6 s, {used_s / 10:.3f} s on a core (at most {FLIGHT_S:g} s)")
        kept.append(used_s / 10 <= FLIGHT_S)
    return 0 if all(kept) else 1


def _meadow(atlas: Atlas) -> Pose:
    """Return a place with nothing solid around."""
    bounds = atlas.world.bounds
    for step in range(40 * 40):
        x_m = bounds.min_x_m + (0.1 + 0.02 * (step % 40)) * bounds.width_m
        y_m = bounds.min_y_m + (0.1 + 0.02 * (step // 40)) * bounds.height_m
        near = atlas.sight.obstacles_near(x_m, y_m, x_m, y_m, z_m=3.0, margin_m=16.0)
        if not len(near.walls) and not len(near.discs):
            return Pose(x_m, y_m)
    return _START


if __name__ == "__main__":
    sys.exit(main())
