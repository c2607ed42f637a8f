"""From what people type to values; every fault of a text is told at once."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import Fault, SettingsError, StartError, WorldError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.world.world import World

#: lon0, lat0, lon1, lat1.
BoxDeg = tuple[float, float, float, float]
#: A camera stands so high above the ground, metres.
_HEIGHT_RANGE_M = (0.05, 9000.0)


def parse_bbox(text: str | None) -> BoxDeg | None:
    """Return lon0, lat0, lon1, lat1 in degrees; what they must satisfy is the importer's to say.

    Raises:
        WorldError: If the text is not four numbers.
    """
    if text is None:
        return None
    numbers, faults = _numbers(text, 4)
    if faults:
        raise WorldError(f"bounding box {text!r} (expected lon0,lat0,lon1,lat1 in degrees)", faults)
    return numbers[0], numbers[1], numbers[2], numbers[3]


def check_start_form(text: str | None) -> None:
    """Check what can be known of a start before its world is there: two or three finite numbers, a sound heading.

    Raises:
        StartError: If it is not.
    """
    faults = [] if text is None else _start_numbers(text)[1]
    if faults:
        form = "lat,lon,heading in degrees in a real place, x,y,heading in metres and degrees elsewhere"
        raise StartError(f"start {text!r} (expected {form})", faults)


def parse_start(text: str | None, world: World) -> Pose | None:
    """Return the start pose that a person means.

    Args:
        text: ``lat,lon,heading`` (degrees) where the world lies on earth, else ``x,y,heading`` (metres, degrees); the
            heading may be left out and is then north.
        world: Whose frame it is.

    Raises:
        StartError: If the text is not two or three finite numbers, the heading is none, no such place is on earth, or
            it is off the map.
    """
    if text is None:
        return None
    form = "x,y,heading in metres and degrees" if world.origin is None else "lat,lon,heading in degrees"
    numbers, faults = _start_numbers(text)
    if not faults and world.origin is not None:
        if not -90.0 <= numbers[0] <= 90.0:
            faults.append(Fault(f"latitude {numbers[0]}", "-90 to 90", "latitude comes first"))
        if not -180.0 <= numbers[1] <= 180.0:
            faults.append(Fault(f"longitude {numbers[1]}", "-180 to 180"))
    if faults:
        raise StartError(f"start {text!r} (expected {form})", faults)
    x_m, y_m = numbers[0], numbers[1]
    if world.origin is not None:
        east_m, north_m = world.origin.enu_from_geodetic_m(numbers[0], numbers[1])
        x_m, y_m = float(east_m), float(north_m)
        if not world.bounds.contains(x_m, y_m):
            what = f"{numbers[0]:g}, {numbers[1]:g} is off {world.name}"
            raise StartError("start", [Fault(what, _extent_deg(world), "leave --start out for a random one")])
    heading_deg = numbers[2] if len(numbers) == 3 else 0.0
    return Pose(x_m, y_m, 0.0, normalise_heading_rad(math.radians(heading_deg)))


def check_view_form(text: str | None) -> None:
    """Check what can be known of a viewpoint before its world is there; see `parse_view`.

    Raises:
        StartError: If it is not two to four finite numbers, or its heading or height is none.
    """
    if text is None:
        return
    count = text.count(",") + 1
    rest, _, faults = _without_height(text)
    if count in {2, 3, 4}:
        faults = [*_start_numbers(rest)[1], *faults]
    else:
        faults = [Fault(f"{count} values", "2 to 4 values with commas between them"), *_numbers(text, count)[1]]
    if faults:
        form = "lat,lon,z,heading in a real place, x,y,z,heading elsewhere: metres and degrees"
        raise StartError(f"viewpoint {text!r} (expected {form})", faults)


def parse_view(text: str, world: World, *, height_m: float) -> Pose:
    """Return where a camera stands and which way it looks.

    Args:
        text: As `parse_start` reads it, with metres above the ground before the heading where there are four numbers.
        world: Whose frame it is.
        height_m: Above the ground where the text says nothing of it.

    Raises:
        StartError: If it is not two to four finite numbers, its heading or height is none, or it is off the map.
    """
    check_view_form(text)
    rest, given_m, _ = _without_height(text)
    try:
        pose = parse_start(rest, world)
    except StartError as error:
        # What a start may do instead, a viewpoint may not: there is no random one.
        raise StartError("viewpoint", [replace(fault, remedy="") for fault in error.faults]) from error
    if pose is None:
        raise AssertionError  # there is a text
    if not world.bounds.contains(pose.x_m, pose.y_m):
        bounds = world.bounds
        extent = f"x {bounds.min_x_m:g} to {bounds.max_x_m:g}, y {bounds.min_y_m:g} to {bounds.max_y_m:g} metres"
        raise StartError("viewpoint", [Fault(f"{pose.x_m:g}, {pose.y_m:g} is off {world.name}", extent)])
    return replace(pose, z_m=height_m if given_m is None else given_m)


def parse_size(text: str) -> tuple[int, int]:
    """Return width and height of a picture, pixels, from ``WIDTHxHEIGHT``.

    Raises:
        SettingsError: If it is not two whole numbers with an x between them.
    """
    parts = [part.strip() for part in text.lower().replace("×", "x").split("x")]
    if len(parts) != 2 or not all(part.isascii() and part.isdecimal() and len(part) <= 9 for part in parts):
        raise SettingsError("--size", [Fault(f"{text!r:.60}", "two whole numbers with an x between them, as 1024x768")])
    return int(parts[0]), int(parts[1])


def _without_height(text: str) -> tuple[str, float | None, list[Fault]]:
    """Return a viewpoint without its height, the height, metres, and what is wrong with it."""
    parts = text.split(",")
    if len(parts) != 4:
        return text, None, []
    numbers, faults = _numbers(parts.pop(2), 1)
    low, high = _HEIGHT_RANGE_M
    if numbers and not faults and not low <= numbers[0] <= high:
        faults.append(Fault(f"height {numbers[0]:g}", f"{low:g} to {high:,g} metres above the ground"))
    return ",".join(parts), numbers[0] if numbers else None, faults


def _start_numbers(text: str) -> tuple[list[float], list[Fault]]:
    """Return the numbers of a start; a heading beyond a full turn is more likely a slip than meant."""
    numbers, faults = _numbers(text, 3 if text.count(",") != 1 else 2)
    if not faults and len(numbers) == 3 and not -360.0 <= numbers[2] <= 360.0:
        faults.append(Fault(f"heading {numbers[2]:g}", "-360 to 360 degrees, clockwise from north"))
    return numbers, faults


def parse_levels(text: str) -> tuple[int, ...]:
    """Return the levels that a person means, sorted, each once; none for an empty text.

    Raises:
        SettingsError: If something is no level.
    """
    parts = [part.strip() for part in text.split(",")] if text.strip() else []
    faults = [Fault(f"level {part!r}", "1, 2, 3 or 4") for part in parts if part not in {"1", "2", "3", "4"}]
    if faults:
        raise SettingsError("--levels", faults)
    return tuple(sorted({int(part) for part in parts}))


def parse_planners(text: str) -> list[str]:
    """Return the names of planners between the commas; what is a setting belongs to the name before it."""
    names: list[str] = []
    for part in (part.strip() for part in text.split(",")):
        if names and "=" in part and ":" not in part and ":" in names[-1]:
            names[-1] += f",{part}"
        elif part:
            names.append(part)
    return names


def parse_worlds(texts: Sequence[str]) -> tuple[str, ...]:
    """Return the worlds between the commas of each text; a file whose name has commas in it is one world."""
    worlds: list[str] = []
    for text in texts:
        named = [text] if is_there(Path(text)) else [part.strip() for part in text.split(",")]
        worlds.extend(name for name in named if name)
    return tuple(worlds) if worlds or not texts else tuple(texts)


def parse_seeds(text: str) -> tuple[int, ...]:
    """Return the seeds that a person means.

    Raises:
        SettingsError: If something is no whole number from 0, or there is none.
    """
    parts = [part.strip() for part in text.split(",")]
    faults = [
        Fault(f"{part!r}", "whole numbers from 0 with commas between them")
        for part in parts
        if not (part.isascii() and part.isdecimal())
    ]
    if faults:
        raise SettingsError("--seeds", faults)
    return tuple(int(part) for part in parts)


def _extent_deg(world: World) -> str:
    """Return in words which latitudes and longitudes a world covers."""
    bounds, origin = world.bounds, world.origin
    if origin is None:
        return "a place in the world"
    south_deg, west_deg = origin.geodetic_from_enu_deg(bounds.min_x_m, bounds.min_y_m)
    north_deg, east_deg = origin.geodetic_from_enu_deg(bounds.max_x_m, bounds.max_y_m)
    return f"latitude {south_deg:.4f} to {north_deg:.4f}, longitude {west_deg:.4f} to {east_deg:.4f}"


def _numbers(text: str, count: int) -> tuple[list[float], list[Fault]]:
    parts = [part.strip() for part in text.split(",")]
    faults = [] if len(parts) == count else [Fault(f"{len(parts)} values", f"{count} values with commas between them")]
    numbers = []
    for part in parts:
        try:
            number = float(part)
        except ValueError:
            faults.append(Fault(f"{part!r}", "a number"))
            continue
        if not math.isfinite(number):
            faults.append(Fault(f"{part!r}", "a finite number"))
        numbers.append(number)
    return numbers, faults
