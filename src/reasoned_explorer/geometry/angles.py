"""Headings and bearings (the convention stands in the package's docstring)."""

import math

TAU = 2.0 * math.pi


def normalise_heading_rad(angle_rad: float) -> float:
    """Return the same direction as a heading in [0, 2π)."""
    heading_rad = math.fmod(angle_rad, TAU)
    if heading_rad < 0.0:
        heading_rad += TAU
    # A tiny negative angle plus 2π rounds to 2π itself, which is outside the range.
    return 0.0 if heading_rad >= TAU else heading_rad


def normalise_bearing_rad(angle_rad: float) -> float:
    """Return the same turn as a bearing in [-π, π), positive to the right."""
    bearing_rad = normalise_heading_rad(angle_rad + math.pi) - math.pi
    return -math.pi if bearing_rad >= math.pi else bearing_rad


def heading_towards_rad(from_x_m: float, from_y_m: float, to_x_m: float, to_y_m: float) -> float:
    """Return the heading, in [0, 2π), in which the second point lies as seen from the first.

    The heading from a point to itself is 0.
    """
    return normalise_heading_rad(math.atan2(to_x_m - from_x_m, to_y_m - from_y_m))


def bearing_between_rad(heading_rad: float, target_heading_rad: float) -> float:
    """Return the turn, in [-π, π), that leads from one heading to another; positive is clockwise."""
    return normalise_bearing_rad(target_heading_rad - heading_rad)
