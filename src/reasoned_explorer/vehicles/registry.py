"""Vehicles that a person picks by name.

A registered vehicle is a callable without arguments that returns a `VehicleProfile`: what the machine can do. The
embedded simulator drives any profile. Another package adds one through an entry point of the group
``reasoned_explorer.vehicles``; the entry point's name is the name that people use.
"""

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.registry import Entry, Registry
from reasoned_explorer.vehicles.profile import PROFILES, VehicleProfile


def _drone_authors() -> VehicleProfile:
    return PROFILES["drone-authors"]


def _go1_authors() -> VehicleProfile:
    return PROFILES["go1-authors"]


def _drone() -> VehicleProfile:
    return PROFILES["drone"]


def _go1() -> VehicleProfile:
    return PROFILES["go1"]


#: Vehicles by name.
VEHICLES = Registry(
    "vehicle",
    "vehicles",
    tuple(Entry(name, f"{__name__}:_{name.replace('-', '_')}", profile.summary) for name, profile in PROFILES.items()),
)


def vehicle_profile(name: str) -> VehicleProfile:
    """Return the profile of a vehicle.

    Raises:
        UnknownNameError: If there is none of that name; it names the near misses.
        InputError: If another package's vehicle cannot be loaded or is no profile.
    """
    made = VEHICLES.load(name)()
    if not isinstance(made, VehicleProfile):
        what = f"{name!r} gives a value of type {type(made).__name__}"
        raise InputError("vehicle", [Fault(what, "a VehicleProfile", "ask the package that brings it")])
    return made
