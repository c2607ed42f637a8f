"""Vehicles that a person names by where they are reached, such as ``airsim://127.0.0.1:41451``."""

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol
from urllib.parse import urlsplit

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.looking import Content
from reasoned_explorer.vehicles.mavlink.address import Address
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.vehicle import Vehicle

if TYPE_CHECKING:
    from reasoned_explorer.vehicles.airsim.place import ServedPlace

_AIRSIM_PORT = 41451
_FORM = "airsim://HOST:PORT or mavlink:CONNECTION, as in mavlink:udpin:0.0.0.0:14550; PROFILE@ may stand before it"
_ADDRESS = re.compile(r"^(?:(?P<profile>[^@:/]+)@)?(?P<scheme>[a-z0-9]+):(?P<rest>.*)$", re.IGNORECASE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class Errand:
    """What a vehicle is wanted for.

    Attributes:
        clock: The mission's.
        start: Where it stands, in the world's frame.
        pictures: Whether pictures are taken.
        content: Says what its cameras show, for simulated captioners of a world that both ends know.
        may_move: Whether a machine that may be real may be made to move.
    """

    clock: Clock
    start: Pose
    pictures: bool = True
    content: Content | None = None
    may_move: bool = False


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
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"airsim://{host}:{self.port}"

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
            home=replace(errand.start, z_m=0.0),
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
    """

    connection: Address
    profile: str = "drone"

    def __str__(self) -> str:
        return f"mavlink:{self.connection}"

    @property
    def may_be_real(self) -> bool:
        """Nobody can tell by an address."""
        return True

    @property
    def has_camera(self) -> bool:
        """They do not come over this wire."""
        return False

    @property
    def looks_ahead(self) -> bool:
        """Only where there is a distance sensor, which nobody can tell by an address."""
        return False

    def vehicle(self, profile: VehicleProfile, errand: Errand) -> Vehicle:
        """Return the driver."""
        from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
        from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle

        return MavlinkVehicle(
            profile,
            clock=errand.clock,
            address=str(self.connection),
            home=replace(errand.start, z_m=0.0),
            settings=DriverSettings(arms=errand.may_move, settle_s=0.0),
            content=errand.content,
        )

    async def place(self) -> "ServedPlace | None":
        """Return None: an autopilot knows no world."""
        return None


def vehicle_address(text: str) -> VehicleAddress | None:
    """Return the address in a vehicle's name; None where it is the name of a profile.

    Args:
        text: ``airsim://HOST:PORT`` (the port may be left out) or ``mavlink:CONNECTION`` as MAVLink's tools write it,
            with ``PROFILE@`` before it for another profile than ``drone``.

    Raises:
        SettingsError: If it is neither, or the profile's machine does not fly where it has to.
        UnknownNameError: If there is no such profile.
    """
    match = _ADDRESS.match(text.strip())
    if match is None:
        return None
    profile, scheme = match["profile"] or "drone", match["scheme"].lower()
    if scheme == "airsim" and match["rest"].startswith("//"):
        host, port = _host_and_port(text, match["rest"])
        if not vehicle_profile(profile).flies:
            raise SettingsError("vehicle", [Fault(f"{profile!r} does not fly", "the profile of a flyer", "e.g. drone")])
        return AirSimAddress(host, _AIRSIM_PORT if port is None else port, profile)
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


def start_at(place: "ServedPlace | None", digest: str, address: VehicleAddress) -> Pose:
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
    return place.start
