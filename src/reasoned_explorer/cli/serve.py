"""``rex serve``."""

import asyncio
import ipaddress
import math
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
from reasoned_explorer.simulation.sensors import sensor_noise
from reasoned_explorer.simulation.vehicle import check_start
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.vehicles.mavlink.flavours import FLAVOURS
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import check_world_name, open_world_with_notes
from reasoned_explorer.world.world import World

#: Whose wires are spoken.
WIRES = ("airsim", "mavlink")
_PORTS = {"airsim": 41451, "mavlink": 14550}
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

    @property
    def profile(self) -> str:
        """Name of the vehicle's profile."""
        is_rover = self.as_ == "mavlink" and self.flavour in FLAVOURS and not FLAVOURS[self.flavour].flies
        return self.vehicle or ("go1" if is_rover else "drone")

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
        if self.port is not None and not 0 <= self.port <= 65535:
            found.add(SettingsError("--port", [Fault(str(self.port), "a port, 0 to 65535")]))
        bbox = found.take(lambda: parse_bbox(self.bbox), None)
        found.check(lambda: check_world_name(self.world, seed=max(self.seed, 0), bbox=bbox))
        found.check(lambda: check_start_form(self.start))
        found.check(lambda: vehicle_profile(self.profile))
        found.check(lambda: sensor_noise(self.noise))
        speed = found.take(lambda: _speed(self.speed), None)
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

    world, notes = open_world_with_notes(options.world, seed=options.seed, bbox=bbox)
    for note in notes:
        complain(f"note: {note}; choose a part with --bbox")
    stop_if_asked()
    atlas, profile = Atlas(world), vehicle_profile(options.profile)
    start = parse_start(options.start, world)
    if start is None:
        start = free_spot(atlas, profile)

    def server() -> Served:
        if options.as_ == "mavlink":
            from reasoned_explorer.serving.mavlink.server import MavlinkServer

            return MavlinkServer(
                atlas,
                start,
                flavour=options.flavour,
                profile=profile,
                station=station,
                speed=1.0 if speed is None else speed,
                noise=options.noise,
                seed=options.seed,
            )
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
            name = "AirSim" if options.as_ == "airsim" else f"an autopilot ({options.flavour}, UDP)"
            say(f"{world.name} answers as {name} at {_shown(options.host)}:{port}; Ctrl-C ends it")
            say(f"{profile.name} stands at {_in_words(start, world)}")
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


async def _listening(served: Served, options: ServeOptions, settings: AirSimSettings | None) -> int:
    port = options.port
    if port is None:
        port = _PORTS[options.as_] if settings is None else settings.ApiServerPort
    try:
        return await served.start(options.host, port)
    except OSError as error:
        what = f"{_shown(options.host)}:{port} cannot be listened on ({error.strerror or error})"
        fault = Fault(what, "a free port of this machine", "give another --port, or --port 0 for any that is free")
        raise SettingsError("rex serve", [fault]) from error


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
