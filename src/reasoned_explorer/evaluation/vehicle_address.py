"""Vehicles that a person names by where they are reached, such as ``airsim://127.0.0.1:41451``."""

import ipaddress
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol
from urllib.parse import urlsplit

from reasoned_explorer.clock import Clock
from reasoned_explorer.evaluation.equipment import Equipment
from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.looking import Content
from reasoned_explorer.vehicles.mavlink.address import Address
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.vehicle import Vehicle

if TYPE_CHECKING:
    from reasoned_explorer.vehicles.airsim.place import ServedPlace

_AIRSIM_PORT = 41451
_GO1_PORT = 8082
_FORM = (
    "airsim://HOST:PORT, go1://HOST:PORT or mavlink:CONNECTION, as in mavlink:udpin:0.0.0.0:14550; "
    "PROFILE@ may stand before it"
)
_ADDRESS = re.compile(r"^(?:(?P<profile>[^@:/]+)@)?(?P<scheme>[a-z0-9]+):(?P<rest>.*)$", re.IGNORECASE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class Errand:
    """What a vehicle is wanted for.

    Attributes:
        clock: The mission's.
        start: Where it stands, in the world's frame.
        home: Where its own frame begins, likewise; None where it stands.
        pictures: Whether pictures are taken.
        content: Says what its cameras show, for simulated captioners of a world that both ends know.
        may_move: Whether a machine that may be real may be made to move.
        origin: Where on earth the origin of the world's frame lies; None where nobody knows: a receiver's first fix is
            then where it starts.
        picture_px: Least width of the pictures of a camera beside the wire, pixels.
    """

    clock: Clock
    start: Pose
    pictures: bool = True
    content: Content | None = None
    may_move: bool = False
    origin: GeoOrigin | None = None
    picture_px: int = 0
    home: Pose | None = None

    @property
    def frame(self) -> Pose:
        """Where on the ground the vehicle's own frame begins."""
        return replace(self.home or self.start, z_m=0.0)


class VehicleAddress(Protocol):
    """A vehicle outside of this process. As text it is what a person types, without a profile."""

    @property
    def profile(self) -> str:
        """Name of the registered profile that says how fast, and how high, it is told to move."""

    @property
    def may_be_real(self) -> bool:
        """Whether a real machine may be there, which moves only when that is asked for."""

    @property
    def has_camera(self) -> bool:
        """Whether pictures come from there."""

    @property
    def looks_ahead(self) -> bool:
        """Whether it tells how far it is to what stands ahead of it."""

    def vehicle(self, profile: VehicleProfile, errand: Errand) -> Vehicle:
        """Return the driver of the vehicle, which connects when it is started.

        Args:
            profile: How fast and how high it is told to move.
            errand: What it is wanted for.

        Raises:
            MissingDependencyError: If the library of its wire is not installed.
        """

    async def place(self) -> "ServedPlace | None":
        """Ask where the vehicle stands; None where it cannot tell.

        Raises:
            PartError: If it cannot be reached.
            MissingDependencyError: If the library of its wire is not installed.
        """


@dataclass(frozen=True, slots=True)
class AirSimAddress:
    """A drone in AirSim, or in what answers as AirSim does; see `VehicleAddress`.

    Attributes:
        host: Of the simulator.
        port: Likewise.
        profile: Of a flyer.
    """

    host: str
    port: int = _AIRSIM_PORT
    profile: str = "drone"

    def __str__(self) -> str:
        return f"airsim://{_bracketed(self.host)}:{self.port}"

    @property
    def may_be_real(self) -> bool:
        """It is a simulator."""
        return False

    @property
    def has_camera(self) -> bool:
        """They come over the wire."""
        return True

    @property
    def looks_ahead(self) -> bool:
        """By depth pictures."""
        return True

    def vehicle(self, profile: VehicleProfile, errand: Errand) -> Vehicle:
        """Return the driver."""
        from reasoned_explorer.vehicles.airsim.settings import DriverSettings
        from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle

        return AirSimVehicle(
            profile,
            clock=errand.clock,
            host=self.host,
            port=self.port,
            home=errand.frame,
            stands=errand.start,
            settings=DriverSettings(
                aims=True, pictures=errand.pictures, settle_s=0.0, range_camera=DriverSettings().cameras[0]
            ),
            content=errand.content,
        )

    async def place(self) -> "ServedPlace | None":
        """Ask where the drone stands."""
        from reasoned_explorer.vehicles.airsim.place import place_of

        return await place_of(self.host, self.port)


@dataclass(frozen=True, slots=True)
class MavlinkAddress:
    """A drone or a rover whose autopilot speaks MAVLink; see `VehicleAddress`.

    Attributes:
        connection: Where the autopilot is reached.
        profile: Of a flyer for a drone, of a walker for a rover.
        equipment: Its camera.
    """

    connection: Address
    profile: str = "drone"
    equipment: Equipment = field(default_factory=Equipment)

    def __str__(self) -> str:
        return f"mavlink:{self.connection}"

    @property
    def may_be_real(self) -> bool:
        """Nobody can tell by an address."""
        return True

    @property
    def has_camera(self) -> bool:
        """They do not come over this wire."""
        return self.equipment.camera is not None

    @property
    def looks_ahead(self) -> bool:
        """Only where there is a distance sensor, which nobody can tell by an address."""
        return False

    def vehicle(self, profile: VehicleProfile, errand: Errand) -> Vehicle:
        """Return the driver; with a camera, which looks ahead, it turns to look."""
        from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
        from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle

        camera = self.equipment.photographer(profile.camera, least_px=errand.picture_px) if errand.pictures else None
        if camera is not None:
            profile = replace(profile, turns_to_look=True)
        return MavlinkVehicle(
            profile,
            clock=errand.clock,
            address=str(self.connection),
            home=errand.frame,
            stands=errand.start,
            settings=DriverSettings(arms=errand.may_move, settle_s=0.0),
            camera=camera,
            content=errand.content,
        )

    async def place(self) -> "ServedPlace | None":
        """Return None: an autopilot knows no world."""
        return None


@dataclass(frozen=True, slots=True)
class Go1Address:
    """A Unitree Go1, or what answers as one; see `VehicleAddress`.

    Attributes:
        host: Of the robot.
        port: Where it listens to high-level commands.
        profile: Of a machine that walks and turns to look.
        equipment: Its receiver and its camera.
    """

    host: str
    port: int = _GO1_PORT
    profile: str = "go1"
    equipment: Equipment = field(default_factory=Equipment)

    def __str__(self) -> str:
        return f"go1://{_bracketed(self.host)}:{self.port}"

    @property
    def may_be_real(self) -> bool:
        """Nobody can tell by an address."""
        return True

    @property
    def has_camera(self) -> bool:
        """They do not come over this wire."""
        return self.equipment.camera is not None

    @property
    def looks_ahead(self) -> bool:
        """Its states hold a distance, but nobody has tried what that is worth."""
        return False

    def vehicle(self, profile: VehicleProfile, errand: Errand) -> Vehicle:
        """Return the driver."""
        from reasoned_explorer.vehicles.unitree.link import LinkSettings
        from reasoned_explorer.vehicles.unitree.vehicle import Go1Vehicle

        start, equipment = replace(errand.start, z_m=0.0), self.equipment
        return Go1Vehicle(
            profile,
            clock=errand.clock,
            host=self.host,
            port=self.port,
            # The robot's own network is one for one program; on this machine there may be several.
            link=LinkSettings(local_port=0) if _is_this_machine(self.host) else None,
            home=start,
            positions=equipment.receiver(start, errand.origin, errand.clock.now_s),
            camera=equipment.photographer(profile.camera, least_px=errand.picture_px) if errand.pictures else None,
            content=errand.content,
        )

    async def place(self) -> "ServedPlace | None":
        """Return None: a robot knows no world."""
        return None


def equipped(address: VehicleAddress, equipment: Equipment) -> VehicleAddress:
    """Return an address with what its machine has beside its wire.

    Raises:
        SettingsError: If it needs something that it does not have, or has no use for something.
    """
    faults = []
    if isinstance(address, Go1Address):
        if equipment.positions is None:
            fault = Fault(
                f"no receiver for {address}",
                "--gps gpsd://HOST:PORT, or --gps serial:/dev/ttyUSB1:38400",
                "a Go1 does not know where it is",
            )
            faults.append(fault)
    elif equipment.positions is not None or equipment.corrections is not None:
        faults.append(Fault(f"--gps or --ntrip for {address}", "neither", "it tells where it is over its own wire"))
    if isinstance(address, AirSimAddress) and equipment.camera is not None:
        faults.append(Fault(f"--camera for {address}", "none", "its pictures come over its own wire"))
    if faults:
        raise SettingsError("--vehicle", faults)
    return replace(address, equipment=equipment) if isinstance(address, MavlinkAddress | Go1Address) else address


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _is_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def vehicle_address(text: str) -> VehicleAddress | None:
    """Return the address in a vehicle's name; None where it is the name of a profile.

    Args:
        text: ``airsim://HOST:PORT``, ``go1://HOST:PORT`` (the port may be left out) or ``mavlink:CONNECTION`` as
            MAVLink's tools write it, with ``PROFILE@`` before it for another profile than ``drone``; of a Go1, ``go1``.

    Raises:
        SettingsError: If it is neither, or the profile's machine does not fly where it has to.
        UnknownNameError: If there is no such profile.
    """
    match = _ADDRESS.match(text.strip())
    if match is None:
        return None
    scheme = match["scheme"].lower()
    profile = match["profile"] or ("go1" if scheme == "go1" else "drone")
    if scheme == "airsim" and match["rest"].startswith("//"):
        host, port = _host_and_port(text, match["rest"])
        if not vehicle_profile(profile).flies:
            raise SettingsError("vehicle", [Fault(f"{profile!r} does not fly", "the profile of a flyer", "e.g. drone")])
        return AirSimAddress(host, _AIRSIM_PORT if port is None else port, profile)
    if scheme == "go1" and match["rest"].startswith("//"):
        host, port = _host_and_port(text, match["rest"])
        machine = vehicle_profile(profile)
        if machine.flies or not machine.turns_to_look:
            fault = Fault(f"{profile!r} does not walk and turn to look", "the profile of a walker", "e.g. go1")
            raise SettingsError("vehicle", [fault])
        return Go1Address(host, _GO1_PORT if port is None else port, profile)
    if scheme == "mavlink" and not match["rest"].startswith("//"):
        connection = Address.read(match["rest"])
        return MavlinkAddress(connection, vehicle_profile(profile).name)
    raise SettingsError("vehicle", [Fault(f"{text!r:.80}", _FORM)])


def _host_and_port(text: str, rest: str) -> tuple[str, int | None]:
    try:
        parts = urlsplit(f"airsim:{rest}")
        port = parts.port
    except ValueError as error:
        raise SettingsError("vehicle", [Fault(f"{text!r:.80}: {error}", _FORM)]) from error
    if not parts.hostname or parts.username or parts.path.strip("/") or parts.query or parts.fragment or port == 0:
        raise SettingsError("vehicle", [Fault(f"{text!r:.80}", _FORM)])
    return parts.hostname, port


def check_place(place: "ServedPlace | None", digest: str, address: VehicleAddress) -> "ServedPlace":
    """Return where a vehicle stands in a mission's world, by what it told.

    Args:
        place: What it told.
        digest: Of the mission's world.
        address: Of the vehicle, for people.

    Raises:
        SettingsError: If it did not tell, or stands in another world.
    """
    if place is None:
        fault = Fault(f"{address} does not tell where its vehicle stands", "--start: where that is in the world")
        raise SettingsError("vehicle", [fault])
    if place.digest != digest:
        fault = Fault(
            f"{address} is in another world, {place.world}",
            "the same world at both ends",
            "give rex run the --world and --seed that rex serve was given",
        )
        raise SettingsError("vehicle", [fault])
    return place
