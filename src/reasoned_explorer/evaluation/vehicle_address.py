"""Vehicles that a person names by where they are reached, such as ``airsim://127.0.0.1:41451``."""

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.vehicle import Vehicle

if TYPE_CHECKING:
    from reasoned_explorer.vehicles.airsim.place import ServedPlace
    from reasoned_explorer.vehicles.airsim.vehicle import Content

_FORM = "airsim://HOST:PORT, or PROFILE@airsim://HOST:PORT"
_DEFAULT_PORTS = {"airsim": 41451}
_DEFAULT_PROFILES = {"airsim": "drone"}
_ADDRESS = re.compile(r"^(?:(?P<profile>[^@:/]+)@)?(?P<scheme>[a-z0-9]+)://(?P<rest>.*)$", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class VehicleAddress:
    """A vehicle outside of this process.

    Attributes:
        scheme: What it speaks: ``airsim``.
        host: Where it is.
        port: Likewise.
        profile: The registered profile that says how fast, and how high, it is told to move.
    """

    scheme: str
    host: str
    port: int
    profile: str

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}://{host}:{self.port}"

    def vehicle(
        self,
        profile: VehicleProfile,
        *,
        clock: Clock,
        start: Pose,
        pictures: bool = True,
        content: "Content | None" = None,
    ) -> Vehicle:
        """Return the driver of the vehicle, which connects when it is started.

        Args:
            profile: How fast and how high it is told to move.
            clock: The mission's.
            start: Where it stands, in the world's frame.
            pictures: Whether pictures are taken.
            content: Says what its cameras show, for simulated captioners of a world that both ends know.

        Raises:
            MissingDependencyError: If the library of its wire is not installed.
        """
        from reasoned_explorer.vehicles.airsim.settings import DriverSettings
        from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle

        return AirSimVehicle(
            profile,
            clock=clock,
            host=self.host,
            port=self.port,
            home=replace(start, z_m=0.0),
            settings=DriverSettings(aims=True, pictures=pictures, settle_s=0.0),
            content=content,
        )

    async def place(self) -> "ServedPlace | None":
        """Ask where the vehicle stands; None where it cannot tell.

        Raises:
            PartError: If it cannot be reached.
            MissingDependencyError: If the library of its wire is not installed.
        """
        from reasoned_explorer.vehicles.airsim.place import place_of

        return await place_of(self.host, self.port)


def vehicle_address(text: str) -> VehicleAddress | None:
    """Return the address in a vehicle's name; None where it is the name of a profile.

    Args:
        text: ``airsim://HOST:PORT``, with ``PROFILE@`` before it for another profile than ``drone``; the port may be
            left out.

    Raises:
        SettingsError: If it is neither, or the profile's machine does not fly.
        UnknownNameError: If there is no such profile.
    """
    match = _ADDRESS.match(text.strip())
    if match is None:
        return None
    scheme = match["scheme"].lower()
    if scheme not in _DEFAULT_PORTS:
        raise SettingsError("vehicle", [Fault(f"{text!r:.80}", _FORM)])
    try:
        parts = urlsplit(f"{scheme}://{match['rest']}")
        port = parts.port
    except ValueError as error:
        raise SettingsError("vehicle", [Fault(f"{text!r:.80}: {error}", _FORM)]) from error
    if not parts.hostname or parts.username or parts.path.strip("/") or parts.query or parts.fragment or port == 0:
        raise SettingsError("vehicle", [Fault(f"{text!r:.80}", _FORM)])
    profile = match["profile"] or _DEFAULT_PROFILES[scheme]
    if not vehicle_profile(profile).flies:
        raise SettingsError("vehicle", [Fault(f"{profile!r} does not fly", "the profile of a flyer", "e.g. drone")])
    return VehicleAddress(
        scheme,
        parts.hostname,
        _DEFAULT_PORTS[scheme] if port is None else port,
        profile,
    )


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
