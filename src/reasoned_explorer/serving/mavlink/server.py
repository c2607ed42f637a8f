"""The embedded simulator as an autopilot that ground stations and drivers can talk to over UDP or TCP."""

import asyncio
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError, UnknownNameError
from reasoned_explorer.serving.airsim.drone import Drone
from reasoned_explorer.serving.airsim.timeline import Timeline
from reasoned_explorer.serving.mavlink.inbox import Inbox, Reply
from reasoned_explorer.serving.mavlink.pilot import Pilot
from reasoned_explorer.serving.mavlink.steps import Steps
from reasoned_explorer.serving.mavlink.teller import FRESH, Teller
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind, Mishaps
from reasoned_explorer.simulation.sensors import SensorNoise
from reasoned_explorer.vehicles.mavlink.dialect import Packer, Parser, dialect
from reasoned_explorer.vehicles.mavlink.flavours import FLAVOURS
from reasoned_explorer.vehicles.profile import PROFILES, VehicleProfile

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

#: As fast as asked: time jumps to whatever is waited for.
AS_FAST_AS_ASKED = math.inf
#: Where ArduPilot's simulator listens, and where ground stations do.
TCP_PORT, UDP_PORT = 5760, 14550
_TICK_S = 0.02
_CHUNK = 4096
_MOST_UNSENT = 262_144
#: Whoever sent nothing for so long hears nothing more; so many are heard at once, seconds.
_FORGOTTEN_S, _MOST_PEERS = 30.0, 16
_COMPONENT = 1


class MavlinkServer:
    """A drone or a rover in a world, served as an autopilot.

    Used as an asynchronous context manager, or by `start` and `close`. It believes whoever reaches its port: it listens
    on this machine alone unless told otherwise.

    Args:
        atlas: Of the world.
        start: Where the machine stands at first: home, and the origin of its local frame.
        flavour: As which autopilot: a name of `FLAVOURS`.
        profile: What the machine can do; by default a drone or a quadruped of ours.
        wire: Whether it waits for clients on UDP or on TCP.
        station: Where a ground station listens (UDP) that is told from the start, or None.
        speed: Simulated seconds in a real one, or `AS_FAST_AS_ASKED`.
        noise: How the sensors err by which the machine steers.
        seed: Of all draws.
        system: The machine's number on the wire.
        mishaps: What befalls it, on its own seconds, which begin with 0. While its link is lost it neither hears nor
            says anything, and acts as its failsafes say. It has no camera: pictures come by another way.

    Raises:
        SettingsError: If a setting is out of range.
        StartError: If the machine cannot stand at the start.
        UnknownNameError: If there is no such flavour or preset of noise.
        MissingDependencyError: If pymavlink is not installed.
    """

    def __init__(
        self,
        atlas: "Atlas",
        start: Pose,
        *,
        flavour: str = "arducopter",
        profile: VehicleProfile | None = None,
        wire: Literal["udp", "tcp"] = "udp",
        station: tuple[str, int] | None = None,
        speed: float = 1.0,
        noise: SensorNoise | str = "none",
        seed: int = 0,
        system: int = 1,
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        if flavour not in FLAVOURS:
            raise UnknownNameError("autopilot", flavour, tuple(FLAVOURS))
        which = FLAVOURS[flavour]
        profile = profile or PROFILES["drone" if which.flies else "go1"]
        faults = []
        if profile.flies != which.flies:
            faults.append(Fault(f"{profile.name} as {which.name}", "a flyer for a drone, a walker for a rover"))
        if wire not in {"udp", "tcp"}:
            faults.append(Fault(f"wire {wire!r:.40}", "udp or tcp"))
        if not isinstance(system, int) or not 1 <= system <= 255:
            faults.append(Fault(f"system {system!r:.40}", "a whole number from 1 to 255"))
        if faults:
            raise SettingsError("served autopilot", faults)
        self._dialect = dialect()
        self._wire, self._station = wire, station
        self._loop = asyncio.get_running_loop()
        self.timeline = Timeline(speed)
        drone = Drone(atlas, profile, start, noise=noise, seed=seed)
        befalls = Mishaps(tuple(mishaps))
        self.pilot = Pilot(drone, self.timeline, which, say=self._say, real_s=self._loop.time, mishaps=befalls)
        self.teller = Teller(self.pilot, self._dialect, noise=noise if isinstance(noise, str) else "")
        self._inbox = Inbox(self.pilot, self.teller, self._dialect, system=system)
        self._steps = Steps(self.pilot, self._dialect, tell=self._tell_fresh, on_hold=self._look_ahead)
        self._packer = Packer(system, _COMPONENT)
        self._due_s: dict[str, float] = {}
        self._udp: asyncio.DatagramTransport | None = None
        self._tcp: asyncio.Server | None = None
        self._peers: dict[Any, _Peer] = {}
        self._ticking: asyncio.Task[None] | None = None
        self._connections: set[asyncio.Task[None]] = set()
        self._malformed = 0
        self._looks_ahead = False
        #: Where it listens; None before `start`.
        self.port: int | None = None

    @property
    def malformed(self) -> int:
        """How often something came that is no message."""
        return self._malformed + sum(peer.parser.malformed for peer in self._peers.values())

    async def start(self, host: str = "127.0.0.1", port: int | None = None) -> int:
        """Listen; return the port.

        Args:
            host: On which address.
            port: On which port: 0 for a free one, None for 14550 (UDP) or 5760 (TCP).

        Raises:
            OSError: If that cannot be listened on.
        """
        if self._wire == "tcp":
            self._tcp = await asyncio.start_server(self._serve, host, TCP_PORT if port is None else port)
            self.port = int(self._tcp.sockets[0].getsockname()[1])
        else:
            at = (host, UDP_PORT if port is None else port)
            self._udp, _ = await self._loop.create_datagram_endpoint(lambda: _Datagrams(self), local_addr=at)
            self.port = int(self._udp.get_extra_info("sockname")[1])
            if self._station is not None:
                self._peers[self._station] = _Peer(None, math.inf)
        self._ticking = self._loop.create_task(self._tick())
        return self.port

    async def close(self) -> None:
        """Hang up on everybody and stop. Safe to call twice."""
        ticking, self._ticking = self._ticking, None
        tasks = [*self._connections, *([ticking] if ticking else [])]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        udp, self._udp = self._udp, None
        if udp is not None:
            udp.close()
        tcp, self._tcp = self._tcp, None
        if tcp is not None:
            tcp.close()
            await tcp.wait_closed()
        self._peers.clear()

    async def __aenter__(self) -> Self:
        await self.start(port=0)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def warm_up(self) -> None:
        """Have compiled what moves the body: a minute or two on a fresh installation, else a few seconds."""
        drone = self.pilot.drone
        trial = Drone(drone.atlas, drone.profile, drone.start)
        there = Pose(drone.start.x_m, drone.start.y_m + 0.5, 1.0, 1.0)
        trial.fly(0.0, [there], speed_mps=drone.profile.speed_mps, face=True)
        trial.turn(60.0, 2.0)

    # Sending.

    @property
    def _is_cut_off(self) -> bool:
        return self.pilot.mishaps.at(MishapKind.LINK_LOSS, self.pilot.now_s) is not None

    def _look_ahead(self) -> None:
        """Have the link get lost in time that is held, too: its failsafes would rest for good otherwise."""
        lost_s = self.pilot.mishaps.next_s(MishapKind.LINK_LOSS, self.pilot.now_s)
        if lost_s < math.inf and not self._looks_ahead:
            self._looks_ahead = True
            self.timeline.at(lost_s, self._lose_link)

    def _lose_link(self) -> None:
        if self.timeline.is_stepped:
            self.pilot.lose_link()

    def _tell_fresh(self, reply: Reply) -> None:
        """Tell one who holds time what has come about since, in messages no older than the report that follows."""
        for name in FRESH:
            if name in self.teller.rates_hz:
                reply(self.teller.make(name))

    def _say(self, severity: int, text: str) -> None:
        self._tell_all(self._dialect.MAVLink_statustext_message(severity, text.encode()[:50]))

    def _tell_all(self, message: Any) -> None:
        if self._peers:
            data = self._packer.pack(message)
            for key, peer in list(self._peers.items()):
                self._send(key, peer, data)

    def _send(self, key: Any, peer: "_Peer", data: bytes) -> None:
        if self._is_cut_off:
            return
        if peer.writer is not None:
            if peer.writer.transport.get_write_buffer_size() < _MOST_UNSENT:
                peer.writer.write(data)
        elif self._udp is not None:
            self._udp.sendto(data, key)

    async def _tick(self) -> None:
        while True:
            now_s = self._loop.time()
            self._forget(now_s)
            self.pilot.watch_links()
            if self._peers:
                for name, rate_hz in list(self.teller.rates_hz.items()):
                    if rate_hz > 0.0 and now_s >= self._due_s.get(name, 0.0):
                        self._due_s[name] = now_s + 1.0 / rate_hz
                        self._tell_all(self.teller.make(name))
            await asyncio.sleep(_TICK_S)

    # Hearing.

    def take(self, key: Any, data: bytes) -> None:
        """Take in bytes of somebody."""
        if self._is_cut_off:
            return
        peer = self._peers.get(key)
        if peer is None:
            if len(self._peers) >= _MOST_PEERS:
                return
            peer = self._peers[key] = _Peer(None, 0.0)
        if peer.heard_s < math.inf:
            peer.heard_s = self._loop.time()

        def reply(message: Any) -> None:
            self._send(key, peer, self._packer.pack(message))

        for message in peer.parser.feed(data):
            if message.get_type() == "TUNNEL":
                self._steps.take(message, key, reply)
            else:
                self._inbox.take(message, reply)

    def _forget(self, now_s: float) -> None:
        for key, peer in list(self._peers.items()):
            if peer.writer is None and now_s - peer.heard_s > _FORGOTTEN_S:
                self._malformed += self._peers.pop(key).parser.malformed

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        if task is None or len(self._peers) >= _MOST_PEERS:
            writer.close()
            return
        self._connections.add(task)
        self._peers[writer] = _Peer(writer, math.inf)
        try:
            while data := await reader.read(_CHUNK):
                self.take(writer, data)
        except (OSError, asyncio.CancelledError):
            pass  # it hung up, or the server closes
        finally:
            self._malformed += self._peers.pop(writer).parser.malformed
            self._connections.discard(task)
            writer.close()


class _Peer:
    """Somebody who hears and is heard."""

    def __init__(self, writer: asyncio.StreamWriter | None, heard_s: float) -> None:
        self.writer, self.heard_s = writer, heard_s
        self.parser = Parser(datagrams=writer is None)


class _Datagrams(asyncio.DatagramProtocol):
    def __init__(self, server: MavlinkServer) -> None:
        self._server = server

    def datagram_received(self, data: bytes, addr: Any) -> None:
        self._server.take(addr, data)

    def error_received(self, exc: Exception) -> None:
        """Somebody is gone: they are forgotten before long."""
