"""What to go through before a machine moves: each item with a verdict, what was seen, and what to do."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from reasoned_explorer.model import InputError, PartError, View
from reasoned_explorer.vehicles.safety.area import AllowedGround
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, limited_profile, stopping_m
from reasoned_explorer.vehicles.safety.operator_stop import OperatorStop
from reasoned_explorer.vehicles.safety.telemetry import Refreshes, Telemetry, telemetry_of
from reasoned_explorer.vehicles.safety.watch import RangeAhead
from reasoned_explorer.vehicles.vehicle import Vehicle

#: A picture narrower or lower than this shows nothing to a model, pixels.
_LEAST_PX = 64
#: One so many times as wide as high, or the other way round, was put together wrongly.
_MOST_ASPECT = 4.0
#: A picture is dark below this brightness, and blank where it varies by less; of 255.
_DARK, _BLANK = 8.0, 1.0
#: A position that is not good yet is waited for by so many looks.
_PATIENT_LOOKS = 5
#: A cruise from which braking takes longer than this is worth a second thought, metres.
_LONG_STOP_M = 10.0


class CheckVerdict(StrEnum):
    """What comes of an item."""

    OK = "ok"
    UNKNOWN = "unknown"
    FAULT = "fault"


@dataclass(frozen=True, slots=True)
class CheckItem:
    """One item of the list.

    Attributes:
        name: What was looked at.
        verdict: Whether the machine may move by it.
        seen: What was seen.
        remedy: What to do; empty where all is well.
    """

    name: str
    verdict: CheckVerdict
    seen: str
    remedy: str = ""


async def preflight(
    vehicle: Vehicle,
    limits: SafetyLimits,
    *,
    stop: OperatorStop,
    keep_out_at: Callable[[float, float], bool] | None = None,
    range_ahead_m: RangeAhead | None = None,
    pictures_vary: bool = False,
) -> tuple[CheckItem, ...]:
    """Go through the list with a machine that is connected or started; nothing is moved but what turns to look ahead.

    Args:
        vehicle: The machine itself, without a guard.
        limits: What it may do.
        stop: The operator's.
        keep_out_at: Says of a point whether it must not be gone to.
        range_ahead_m: Says how far something stands before a pose, where the guard is given that.
        pictures_vary: Whether two pictures from one place differ, as those of real cameras do: equal ones are frozen.
    """
    link = await _link(vehicle)
    if link.verdict is CheckVerdict.FAULT:
        rest = ("position", "camera", "geofence", "obstacles", "battery")
        unseen = tuple(CheckItem(name, CheckVerdict.UNKNOWN, "no link", "mend the link first") for name in rest)
        return (link, *unseen, _limits(vehicle, limits), _stop(stop))
    camera = await _camera(vehicle, pictures_vary=pictures_vary)
    told = await _once_placed(vehicle)
    return (
        link,
        _position(told, limits),
        camera,
        _fence(told, AllowedGround(limits.fence, limits.keep_out, keep_out_at, limits.margin_m)),
        _obstacles(told, range_ahead_m),
        _battery(told, limits),
        _limits(vehicle, limits),
        _stop(stop),
    )


async def _link(vehicle: Vehicle) -> CheckItem:
    try:
        if isinstance(vehicle, Refreshes):
            await vehicle.refresh()
            return CheckItem("link", CheckVerdict.OK, "the machine answers")
        age_s = telemetry_of(vehicle).link_age_s
    except PartError as fault:
        return CheckItem(
            "link", CheckVerdict.FAULT, str(fault), "check address, cable or radio, and the machine's power"
        )
    if age_s is None:
        return CheckItem(
            "link", CheckVerdict.UNKNOWN, "the driver does not tell", "see that it shows the machine's state"
        )
    if age_s > 1.0:
        return CheckItem("link", CheckVerdict.FAULT, f"nothing heard for {age_s:.1f} s", "check cable or radio")
    return CheckItem("link", CheckVerdict.OK, f"heard {age_s:.2f} s ago")


async def _once_placed(vehicle: Vehicle) -> Telemetry:
    """Return what the machine tells once its position is good, or still is not after some looks: they take time."""
    told = telemetry_of(vehicle)
    for _ in range(_PATIENT_LOOKS):
        if told.position is None or told.position.is_good:
            break
        with suppress(PartError):
            await vehicle.look([vehicle.pose.heading_rad])
        told = telemetry_of(vehicle)
    return told


def _position(told: Telemetry, limits: SafetyLimits) -> CheckItem:
    pose, remedy = told.pose, "wait for a fix under open sky, away from metal"
    at = f"({pose.x_m:.1f}, {pose.y_m:.1f}), heading {math.degrees(pose.heading_rad):.0f}°"
    verdict, age_s = told.position, told.position_age_s
    if not all(map(math.isfinite, (pose.x_m, pose.y_m, pose.z_m, pose.heading_rad))):
        return CheckItem("position", CheckVerdict.FAULT, f"{at} is no place", remedy)
    if verdict is not None and not verdict.is_good:
        return CheckItem("position", CheckVerdict.FAULT, f"{verdict.grade.value}: {verdict.reason}", remedy)
    if age_s is not None and age_s > limits.position_age_s:
        return CheckItem("position", CheckVerdict.FAULT, f"no fix for {age_s:.1f} s", remedy)
    if verdict is None and age_s is None:
        return CheckItem("position", CheckVerdict.UNKNOWN, f"{at}; its quality is not told", "compare it with the map")
    return CheckItem("position", CheckVerdict.OK, at)


async def _camera(vehicle: Vehicle, *, pictures_vary: bool) -> CheckItem:
    ahead = [vehicle.pose.heading_rad]
    try:
        (first,) = await vehicle.look(ahead)
        again = (await vehicle.look(ahead))[0] if pictures_vary else None
    except (PartError, InputError) as fault:
        return CheckItem("camera", CheckVerdict.FAULT, str(fault), "check the camera's cable, address and power")
    return _picture(first, again)


def _picture(view: View, again: View | None) -> CheckItem:
    if view.image is None and view.content is not None:
        return CheckItem("camera", CheckVerdict.OK, "a view without a picture, of a simulator")
    seen, remedy = _trouble_with(view.image, None if again is None else again.image)
    return CheckItem("camera", CheckVerdict.FAULT if remedy else CheckVerdict.OK, seen, remedy)


def _trouble_with(given: Any, again: Any) -> tuple[str, str]:
    """Return what a picture is like, and what to do about it; nothing to do where it is fine."""
    if given is None:
        return "no picture", "give it a camera, or switch its pictures on"
    image: Any = np.asarray(given)
    if image.ndim != 3 or image.shape[2] != 3:
        return f"a picture of shape {image.shape}", "set it to colour"
    height, width = image.shape[:2]
    size, short, long = f"{width} × {height} pixels", min(height, width), max(height, width)
    troubles = (
        (short < _LEAST_PX, "", "set a resolution of at least 64 pixels"),
        (long > _MOST_ASPECT * short, "", "set a resolution that is not so long"),
        (bool(image.size) and float(image.max()) < _DARK, ", black", "take the cap off, or wait for light"),
        (bool(image.size) and float(image.std()) < _BLANK, ", all of one colour", "check exposure and lens"),
        (again is not None and np.array_equal(image, again), ", twice the very same picture", "restart the camera"),
    )
    return next(((size + more, remedy) for is_so, more, remedy in troubles if is_so), (size, ""))


def _fence(told: Telemetry, ground: AllowedGround) -> CheckItem:
    clear_m, _ = ground.clearance(told.pose.x_m, told.pose.y_m)
    trouble = ground.trouble(told.pose.x_m, told.pose.y_m, margin_m=ground.margin_m)
    if trouble is not None:
        return CheckItem("geofence", CheckVerdict.FAULT, trouble[1], "carry the machine in, or correct the fence")
    if ground.fence is None:
        return CheckItem("geofence", CheckVerdict.UNKNOWN, "there is none", "set one: it may go anywhere")
    return CheckItem("geofence", CheckVerdict.OK, f"{clear_m:.1f} m to the nearest edge")


def _obstacles(told: Telemetry, range_ahead_m: RangeAhead | None) -> CheckItem:
    ranges = [told.range_ahead_m, None if range_ahead_m is None else range_ahead_m(told.pose)]
    near_m = min((each for each in ranges if each is not None and not math.isnan(each)), default=None)
    if near_m is None:
        seen, remedy = "no range ahead: obstacles are not seen", "watch the way yourself, the stop switch at hand"
        return CheckItem("obstacles", CheckVerdict.UNKNOWN, seen, remedy)
    seen = "nothing in sight ahead" if math.isinf(near_m) else f"something {near_m:.1f} m ahead"
    return CheckItem("obstacles", CheckVerdict.OK, seen)


def _battery(told: Telemetry, limits: SafetyLimits) -> CheckItem:
    if told.battery is None:
        return CheckItem("battery", CheckVerdict.UNKNOWN, "the machine does not tell", "look at its own display")
    seen = f"{100.0 * told.battery:.0f} %"
    if told.battery < limits.battery_low:
        return CheckItem("battery", CheckVerdict.FAULT, seen, f"charge it above {100.0 * limits.battery_low:.0f} %")
    return CheckItem("battery", CheckVerdict.OK, seen)


def _limits(vehicle: Vehicle, limits: SafetyLimits) -> CheckItem:
    profile = vehicle.profile
    try:
        allowed = limited_profile(profile, limits)
    except InputError as fault:
        return CheckItem("limits", CheckVerdict.FAULT, str(fault), "correct the height band or the profile")
    if allowed != profile:
        seen = f"{profile.speed_mps:g} m/s, {math.degrees(profile.turn_rate_radps):.0f} °/s: more than is allowed"
        return CheckItem("limits", CheckVerdict.FAULT, seen, "make its driver with limited_profile(profile, limits)")
    braking_mps2 = limits.braking_mps2 or profile.acceleration_mps2
    stop_m = stopping_m(profile.speed_mps, braking_mps2=braking_mps2, reaction_s=limits.reaction_s)
    seen = f"{profile.speed_mps:g} m/s, stands after {stop_m:.1f} m"
    if stop_m > _LONG_STOP_M:
        return CheckItem("limits", CheckVerdict.FAULT, seen, "lower the speed")
    return CheckItem("limits", CheckVerdict.OK, seen)


def _stop(stop: OperatorStop) -> CheckItem:
    if stop.pressed:
        return CheckItem("stop switch", CheckVerdict.FAULT, f"pressed: {stop.why}", "release it")
    if not stop.is_reachable:
        return CheckItem(
            "stop switch", CheckVerdict.FAULT, "nothing listens", "run it in a terminal, or attach a switch"
        )
    return CheckItem("stop switch", CheckVerdict.OK, "in reach")
