"""``rex serve``."""

import asyncio
import ipaddress
import math
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.cli.answers import complain
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.parsing import BoxDeg, check_start_form, parse_bbox, parse_start
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, Gathering, SettingsError, StartError, UnknownNameError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.model.stopping import on_stop, stop_if_asked
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.airsim.settings import AirSimSettings
from reasoned_explorer.serving.background import Served
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.simulation.sensors import TICK_HZ, sensor_noise
from reasoned_explorer.simulation.vehicle import check_start
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.vehicles.mavlink.flavours import FLAVOURS
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.unitree.messages import HighCommand
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import check_world_name, open_world_with_notes
from reasoned_explorer.world.world import World

#: Whose wires are spoken.
WIRES = ("airsim", "mavlink", "go1")
_PORTS = {"airsim": 41451, "mavlink": 14550, "go1": 8082}
_GPS_PORT = 2947
_SPEEDS = (1e-3, 1e4)
#: A free spot is looked for on rings around the middle, metres.
_RING_M, _FARTHEST_M = 2.0, 400.0


@dataclass(frozen=True, slots=True)
class ServeOptions:
    """What a person typed; see ``rex serve --help``."""

    as_: str
    world: str
    bbox: str | None
    start: str | None
    seed: int
    vehicle: str | None
    host: str
    port: int | None
    speed: str | None
    noise: str
    settings: Path | None
    generation: int
    conditions: str
    flavour: str = "arducopter"
    station: str | None = None
    gps_port: int | None = None

    @property
    def profile(self) -> str:
        """Name of the vehicle's profile."""
        is_rover = self.as_ == "mavlink" and self.flavour in FLAVOURS and not FLAVOURS[self.flavour].flies
        return self.vehicle or ("go1" if is_rover or self.as_ == "go1" else "drone")

    @property
    def receiver_port(self) -> int:
        """Where a Go1's receiver is to listen: gpsd's port, or any that is free where the robot takes any, too."""
        return (0 if self.port == 0 else _GPS_PORT) if self.gps_port is None else self.gps_port

    def checked(self) -> tuple[BoxDeg | None, float | None, AirSimSettings | None, tuple[str, int] | None]:
        """Return bounding box, speed, settings and ground station, once all has been checked that needs no world.

        Raises:
            InputError: With everything that is wrong.
        """
        found = Gathering()
        if self.as_ not in WIRES:
            found.add(SettingsError("--as", [Fault(f"{self.as_!r:.60}", f"one of {', '.join(WIRES)}")]))
        if self.seed < 0:
            found.add(SettingsError("--seed", [Fault(str(self.seed), "0 or more")]))
        for name, port in (("--port", self.port), ("--gps-port", self.gps_port)):
            if port is not None and not 0 <= port <= 65535:
                found.add(SettingsError(name, [Fault(str(port), "a port, 0 to 65535")]))
        bbox = found.take(lambda: parse_bbox(self.bbox), None)
        found.check(lambda: check_world_name(self.world, seed=max(self.seed, 0), bbox=bbox))
        found.check(lambda: check_start_form(self.start))
        profile = found.take(lambda: vehicle_profile(self.profile), None)
        if self.as_ == "go1" and profile is not None and profile.flies:
            found.add(SettingsError("--vehicle", [Fault(f"{self.profile!r} does not walk", "the profile of a walker")]))
        found.check(lambda: sensor_noise(self.noise))
        speed = found.take(lambda: _speed(self.speed), None)
        if self.as_ == "go1" and speed not in {None, 1.0, AS_FAST_AS_ASKED}:
            fault = Fault(f"{self.speed} as go1", "1, or max: as fast as its driver asks")
            found.add(SettingsError("--speed", [fault]))
        path = self.settings
        settings = None if path is None else found.take(lambda: AirSimSettings.read(path), None)
        if self.flavour not in FLAVOURS:
            found.add(UnknownNameError("autopilot", self.flavour, list(FLAVOURS)))
        station = found.take(lambda: _station(self.station), None)
        found.finish("rex serve")
        return bbox, speed, settings, station


def serve_from_options(options: ServeOptions) -> None:
    """Serve until a person stops it.

    Raises:
        InputError: If an option is wrong, nothing can stand at the start, or the address cannot be listened on.
        KeyboardInterrupt: When a person stops it.
    """
    bbox, speed, settings, station = options.checked()
    console = Output()

    def say(line: str) -> None:
        console.print(line, markup=False, soft_wrap=True)

    atlas = _atlas(options, bbox)
    world, profile = atlas.world, vehicle_profile(options.profile)
    start = parse_start(options.start, world) or free_spot(atlas, profile)

    def server() -> Served:
        if options.as_ == "go1":
            return go1_server(atlas, start, profile, options, is_stepped=speed == AS_FAST_AS_ASKED)
        if options.as_ == "mavlink":
            from reasoned_explorer.serving.mavlink.server import MavlinkServer

            autopilot = MavlinkServer(
                atlas,
                start,
                flavour=options.flavour,
                profile=profile,
                station=station,
                speed=1.0 if speed is None else speed,
                noise=options.noise,
                seed=options.seed,
            )
            autopilot.warm_up()
            return autopilot
        made = AirSimServer(
            atlas,
            start,
            profile=profile,
            settings=settings,
            speed=speed,
            noise=options.noise,
            seed=options.seed,
            generation=options.generation,
            conditions=options.conditions,
        )
        made.warm_up()
        return made

    async def serve() -> None:
        say("getting ready, which takes a minute or two the first time …")
        served = server()
        stop_if_asked()
        loop, over = asyncio.get_running_loop(), asyncio.Event()
        try:
            port = await _listening(served, options, settings)
            for line in _introduction(options, served, port, world, _in_words(start, world)):
                say(line)
            if not _is_loopback(options.host):
                complain("note: whoever reaches that address moves the vehicle")
            if world.attribution:
                say(f"map  {world.attribution}")
            with on_stop(lambda: loop.call_soon_threadsafe(over.set)):
                await over.wait()
        finally:
            await served.close()

    asyncio.run(serve())
    stop_if_asked()


def _atlas(options: ServeOptions, bbox: BoxDeg | None) -> Atlas:
    world, notes = open_world_with_notes(options.world, seed=options.seed, bbox=bbox)
    for note in notes:
        complain(f"note: {note}; choose a part with --bbox")
    stop_if_asked()
    return Atlas(world)


async def _listening(served: Served, options: ServeOptions, settings: AirSimSettings | None) -> int:
    port = options.port
    if port is None:
        port = _PORTS[options.as_] if settings is None else settings.ApiServerPort
    try:
        return await served.start(options.host, port)
    except OSError as error:
        name = "--port"
        if isinstance(served, Go1Server) and served.has_link:
            name, port = "--gps-port", options.receiver_port
        what = f"{_shown(options.host)}:{port} cannot be listened on ({error.strerror or error})"
        fault = Fault(what, "a free port of this machine", f"give another {name}, or {name} 0 for any that is free")
        raise SettingsError("rex serve", [fault]) from error


def go1_server(
    atlas: Atlas, start: Pose, profile: VehicleProfile, options: ServeOptions, *, is_stepped: bool
) -> Go1Server:
    """Return a Go1 with a receiver that speaks gpsd's protocol.

    Args:
        atlas: Of the world.
        start: Where it stands.
        profile: What it can do.
        options: What a person typed.
        is_stepped: Whether its time goes on by commands alone.
    """
    trial = Walker(atlas, profile, start)
    trial.obey(HighCommand.walking(forward_mps=0.1))
    for _ in range(TICK_HZ):  # what moves the body and what its receiver says are compiled now, before anybody listens
        trial.tick()
    walker = Walker(atlas, profile, start, noise=options.noise, seed=options.seed)
    gnss = GnssServer(walker.noise, origin=atlas.world.origin)
    return Go1Server(walker, gnss=gnss, lockstep=is_stepped, gnss_port=options.receiver_port)


def _introduction(options: ServeOptions, served: Served, port: int, world: World, start: str) -> Iterator[str]:
    """Say what answers where, and what to type."""
    names = {"airsim": "AirSim", "mavlink": f"an autopilot ({options.flavour}, UDP)", "go1": "a Go1 (UDP)"}
    yield f"{world.name} answers as {names[options.as_]} at {_shown(options.host)}:{port}; Ctrl-C ends it"
    yield f"{options.profile} stands at {start}"
    if isinstance(served, Go1Server):
        yield f"its receiver answers as gpsd at {_shown(options.host)}:{served.gnss_port}"
        yield f"try: {_command(options, served, port, start)}"


def _command(options: ServeOptions, served: Go1Server, port: int, start: str) -> str:
    """Return what to type for a mission with a served Go1."""
    host = _shown("127.0.0.1" if options.host == "0.0.0.0" else options.host)  # noqa: S104 - it is compared
    profile = "" if options.profile == "go1" else f"{options.profile}@"
    words = [
        *(
            "rex",
            "run",
            "Find me a bench",
            "--world",
            options.world,
            *(("--bbox", options.bbox) if options.bbox else ()),
        ),
        *("--seed", str(options.seed), *start.split(" ", 1)),
        *("--vehicle", f"{profile}go1://{host}:{port}", "--gps", f"gpsd://{host}:{served.gnss_port}", "--move"),
        *(("--clock", "virtual") if served.is_lockstep else ()),
    ]
    return shlex.join(words)


def _in_words(start: Pose, world: World) -> str:
    """Return a start as ``--start`` takes it."""
    heading_deg = math.degrees(start.heading_rad)
    if world.origin is None:
        return f"--start {start.x_m:g},{start.y_m:g},{heading_deg:g}"
    lat_deg, lon_deg = world.origin.geodetic_from_enu_deg(start.x_m, start.y_m)
    return f"--start {lat_deg:.7f},{lon_deg:.7f},{heading_deg:g}"


def _station(text: str | None) -> tuple[str, int] | None:
    """Return where a ground station listens."""
    if text is None:
        return None
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise SettingsError("--station", [Fault(f"{text!r:.60}", "HOST:PORT")])
    return host.strip("[]"), int(port)


def free_spot(atlas: Atlas, profile: VehicleProfile) -> Pose:
    """Return the spot nearest to the middle of a world, on rings around it, where a vehicle can stand; facing north.

    Raises:
        StartError: If there is none within 400 m.
    """
    bounds = atlas.world.bounds
    x_m, y_m = 0.5 * (bounds.min_x_m + bounds.max_x_m), 0.5 * (bounds.min_y_m + bounds.max_y_m)
    radius_m = 0.0
    while radius_m <= _FARTHEST_M:
        count = max(1, round(math.tau * radius_m / _RING_M))
        for k in range(count):
            bearing_rad = math.tau * k / count
            pose = Pose(x_m + radius_m * math.sin(bearing_rad), y_m + radius_m * math.cos(bearing_rad))
            try:
                check_start(atlas, profile, pose)
            except StartError:
                continue
            return pose
        radius_m += _RING_M
    fault = Fault(f"{atlas.world.name} has no free spot within {_FARTHEST_M:g} m of its middle", "one", "give --start")
    raise StartError("start", [fault])


def _speed(text: str | None) -> float | None:
    """Return simulated seconds in a real one; None for what the settings say."""
    if text is None:
        return None
    if text.strip().lower() == "max":
        return AS_FAST_AS_ASKED
    low, high = _SPEEDS
    try:
        speed = float(text)
    except ValueError:
        speed = math.nan
    if not is_within(speed, low, high):
        raise SettingsError("--speed", [Fault(f"{text!r:.60}", f"a number from {low:g} to {high:g}, or max")])
    return speed


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _shown(host: str) -> str:
    return f"[{host}]" if ":" in host else host
