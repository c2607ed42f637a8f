"""What a person says about a vehicle that is somewhere else, and ``rex vehicle check``."""

import asyncio
import math
import queue
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace

import typer

from reasoned_explorer.cli.answers import ExitCode, complain
from reasoned_explorer.cli.console import Output
from reasoned_explorer.clock import RealClock
from reasoned_explorer.evaluation.equipment import read_equipment
from reasoned_explorer.evaluation.guarding import Guarding
from reasoned_explorer.evaluation.vehicle_address import Errand, VehicleAddress, equipped, vehicle_address
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, Gathering, PartError, SettingsError
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, limited_profile
from reasoned_explorer.vehicles.safety.operator_stop import STOP_KEYS, KeyboardListener, OperatorStop
from reasoned_explorer.vehicles.safety.preflight import CheckItem, CheckVerdict, preflight

#: A machine with a camera beside its wire stops where that is silent for longer, seconds.
_PICTURE_AGE_S = 3.0
_MARKS = {CheckVerdict.OK: "ok", CheckVerdict.UNKNOWN: "??", CheckVerdict.FAULT: "NO"}


@dataclass(frozen=True, slots=True)
class VehicleOptions:
    """What a person typed; see ``rex run --help``."""

    vehicle: str
    fence_m: float | None = None
    max_speed_mps: float | None = None
    dry_run: bool = False
    confirm: bool = False
    move: bool = False
    gps: str | None = None
    ntrip: str | None = None
    camera: str | None = None
    camera_fov_deg: float | None = None

    @property
    def address(self) -> VehicleAddress | None:
        """Where the vehicle is, with what it has beside its wire; None for the embedded simulator's.

        Raises:
            InputError: If it is neither an address nor the name of a profile, or its equipment is wrong.
        """
        found = Gathering()
        address = self._address(found)
        found.finish("vehicle")
        return address

    def _address(self, found: Gathering) -> VehicleAddress | None:
        """Return that as far as it is sound; what is wrong is kept in ``found``."""
        faults = Gathering()
        equipment = read_equipment(
            faults,
            gps=self.gps,
            ntrip=self.ntrip,
            camera=self.camera,
            camera_fov_deg=self.camera_fov_deg,
            say=lambda text: complain(f"note: {text}"),
        )
        found.add(*faults.errors)
        address = found.take(lambda: vehicle_address(self.vehicle), None)
        if address is None or faults.errors:
            return address
        return found.take(lambda: equipped(address, equipment), address)

    def check(self, found: Gathering, *, asks_to_move: bool = True) -> None:
        """Keep what is wrong with it.

        Args:
            found: Where it is kept.
            asks_to_move: Whether the vehicle is to go anywhere.
        """
        address = self._address(found)
        given = {
            "--fence": self.fence_m is not None,
            "--max-speed": self.max_speed_mps is not None,
            "--dry-run": self.dry_run,
            "--confirm": self.confirm,
            "--move": self.move,
            "--gps": self.gps is not None,
            "--ntrip": self.ntrip is not None,
            "--camera": self.camera is not None,
        }
        if address is not None:
            found.check(lambda: Guarding(address, self._limits(), fence_m=self.fence_m))
            if self.confirm and not _is_terminal():
                found.add(SettingsError("--confirm", [Fault("nobody can be asked", "a terminal", "or leave it out")]))
            if address.may_be_real and asks_to_move and not (self.move or self.dry_run):
                fault = Fault(f"a real machine may be at {address}", "--move, if it may move; or --dry-run")
                found.add(SettingsError("--vehicle", [fault]))
        elif ":" not in self.vehicle and any(given.values()):
            named = ", ".join(name for name, is_given in given.items() if is_given)
            fault = Fault(f"{named} with {self.vehicle!r:.60}", "a vehicle at an address, such as airsim://HOST:41451")
            found.add(SettingsError("--vehicle", [fault]))

    @contextmanager
    def guarding(self, *, is_real: bool) -> Iterator[Guarding | None]:
        """Have the keyboard listened to within a ``with`` block; gives the guard's orders, None where there is none.

        Args:
            is_real: Whether the mission's time is real time, which goes on while a person thinks.
        """
        address = self.address
        if address is None:
            yield None
            return
        stop, keys = OperatorStop(), queue.SimpleQueue[str]()

        def ask(here: Pose, aim: Pose) -> bool:
            way = f"{here.distance_to_m(aim.x_m, aim.y_m):.1f} m to ({aim.x_m:.1f}, {aim.y_m:.1f})"
            typer.echo(f"go {way}, then face {math.degrees(aim.heading_rad):.0f}°? y or n: ", nl=False, err=True)
            while True:
                try:
                    key = keys.get(timeout=0.1).lower()
                except queue.Empty:
                    if stop.pressed:
                        return False
                    continue
                if key in "yn":
                    typer.echo(key, err=True)
                    return key == "y"

        async def confirm(here: Pose, aim: Pose) -> bool:
            return await asyncio.to_thread(ask, here, aim) if is_real else ask(here, aim)

        orders = Guarding(
            address,
            self._limits(),
            fence_m=self.fence_m,
            dry_run=self.dry_run,
            confirm=confirm if self.confirm else None,
            stop=stop,
            may_move=self.move,
        )
        if not _is_terminal():
            yield orders
            return
        with KeyboardListener(stop, on_key=keys.put):
            named = {" ": "space", "\x1b": "Esc"}
            typer.echo(f"{', '.join(named.get(key, key) for key in STOP_KEYS)}: stop the vehicle", err=True)
            yield orders

    def _limits(self) -> SafetyLimits:
        picture_age_s = None if self.camera is None else _PICTURE_AGE_S
        return SafetyLimits(speed_mps=self.max_speed_mps, picture_age_s=picture_age_s)


def check_vehicle(options: VehicleOptions) -> None:
    """Go through the list that comes before moving, print it, and exit with 3 where anything on it is wrong.

    Raises:
        InputError: If an option is wrong.
        typer.Exit: If an item is not as it should be.
    """
    found = Gathering()
    options.check(found, asks_to_move=False)
    found.finish("vehicle")
    address = options.address
    if address is None:
        fault = Fault(f"{options.vehicle!r:.60} is a profile", "where a vehicle is, such as airsim://HOST:41451")
        raise SettingsError("vehicle", [fault])
    console = Output()
    items = asyncio.run(_items(options, address))
    for item in items:
        then = f": {item.remedy}" if item.remedy else ""
        console.print(f"{_MARKS[item.verdict]}  {item.name:12s} {item.seen}{then}", markup=False, soft_wrap=True)
    if any(item.verdict is CheckVerdict.FAULT for item in items):
        raise typer.Exit(ExitCode.PART_FAILED)


async def _items(options: VehicleOptions, address: VehicleAddress) -> tuple[CheckItem, ...]:
    stop, start = OperatorStop(), Pose(0.0, 0.0)
    stop.is_reachable = _is_terminal()
    place = None
    with suppress(PartError):
        place = await address.place()
    if place is not None:
        start = place.start
    with options.guarding(is_real=True) as orders:
        if orders is None:
            raise AssertionError
        limits = orders.limits_at(start)
        profile = limited_profile(vehicle_profile(address.profile), limits)
        vehicle = address.vehicle(profile, Errand(RealClock(), start, home=place.home if place else None))
        seen = ""
        try:
            try:
                await vehicle.connect()
            except PartError as fault:
                seen = str(fault)
            link, *rest = await preflight(vehicle, limits, stop=orders.stop or stop)
            # What kept it from connecting says more than that it is not heard.
            return (replace(link, seen=seen) if seen and link.verdict is CheckVerdict.FAULT else link, *rest)
        finally:
            with suppress(PartError):  # the list says what is wrong
                await vehicle.close()


def _is_terminal() -> bool:
    try:
        return sys.stdin is not None and sys.stdin.isatty()
    except ValueError:
        return False
