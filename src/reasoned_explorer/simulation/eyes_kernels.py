"""One view of a world in one call at machine speed."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reasoned_explorer.world.sight_kernels import (
    AREA,
    BUILDING,
    CENTRE_X,
    CENTRE_Y,
    HEIGHT,
    SHAPE,
    FloatArray,
    Grid,
    IntArray,
    Targets,
    bearing,
    clip_bearings,
    extent,
    first_hit,
    target_share,
)

#: Directions in which a view is searched for walls.
WALL_RAYS = 21
#: Directions along which the ground is told, and how far ahead.
GROUND_BEARINGS = (-math.pi / 6.0, 0.0, math.pi / 6.0)
GROUND_AHEAD_M = (3.0, 8.0, 18.0)
# Seen through a crack: what shows less than this share of itself is taken as hidden.
_LEAST_SHARE = 0.05
_ARC_STEPS = 8


@njit(cache=True)
def _picture_height(
    target: FloatArray, near: float, far: float, middle: float, z: float, focal_px: float, half_px: float
) -> float:
    """Apparent height in pixels of a target on level ground, clipped to the picture."""
    flattening = math.cos(middle)
    depth = max(near * flattening, 0.05)
    below = min(focal_px * z / depth, half_px)
    if target[SHAPE] == AREA:
        return float(max(below - min(focal_px * z / max(far * flattening, 0.05), half_px), 0.0))
    above = min(max(focal_px * (target[HEIGHT] - z) / depth, -half_px), half_px)
    return float(max(above + below, 0.0))


@njit(cache=True)
def _window(header: FloatArray, x: float, y: float, heading: float, half_fov: float, range_m: float) -> IntArray:
    """First and last column and row of the cells that a view can reach into; no rows where it reaches into none.

    The grid spans only what stands somewhere: a view may well look past all of it.
    """
    west = east = x
    south = north = y
    for step in range(_ARC_STEPS + 1):
        direction = heading + half_fov * (2.0 * step / _ARC_STEPS - 1.0)
        end_x, end_y = x + range_m * math.sin(direction), y + range_m * math.cos(direction)
        west, east, south, north = min(west, end_x), max(east, end_x), min(south, end_y), max(north, end_y)
    # Between two steps the arc bulges beyond its chord.
    bulge = range_m * (1.0 - math.cos(half_fov / _ARC_STEPS)) + 1.0
    window = np.empty(4, np.int64)
    window[0] = max(math.floor((west - bulge - header[0]) / header[2]), 0)
    window[1] = min(math.floor((east + bulge - header[0]) / header[2]), int(header[3]) - 1)
    window[2] = max(math.floor((south - bulge - header[1]) / header[2]), 0)
    window[3] = min(math.floor((north + bulge - header[1]) / header[2]), int(header[4]) - 1)
    if window[1] < window[0]:
        window[3] = window[2] - 1
    return window


@njit(cache=True)
def in_view(
    seats: Grid,
    targets: Targets,
    x: float,
    y: float,
    z: float,
    heading: float,
    half_fov: float,
    width_px: float,
    height_px: float,
    range_m: float,
    min_px: float,
) -> FloatArray:
    """Return what a view would show if nothing hid anything, in no particular order, shape (n, 7).

    Columns: object, leftmost and rightmost bearing within the view, bearing of its middle, least distance, width and
    height (px). ``seats`` holds each target as a disc around its footprint.
    """
    header, table = seats.header, targets.table
    sin_h, cos_h = math.sin(heading), math.cos(heading)
    focal_px = 0.5 * width_px / math.tan(half_fov)
    columns = int(header[3])
    window = _window(header, x, y, heading, half_fov, range_m)
    if window[0] > window[1]:  # the view looks past the grid: these columns are none
        window[3] = window[2] - 1
    count = 0
    for j in range(window[2], window[3] + 1):
        count += seats.starts[j * columns + window[1] + 1] - seats.starts[j * columns + window[0]]
    found = np.empty((count, 7))
    count = 0
    for j in range(window[2], window[3] + 1):
        for i in range(window[0], window[1] + 1):
            for place in range(seats.starts[j * columns + i], seats.starts[j * columns + i + 1]):
                k = seats.members[place]
                seat_x, seat_y, reach = seats.items[k, 1], seats.items[k, 2], seats.items[k, 3]
                dx, dy = seat_x - x, seat_y - y
                if dx * sin_h + dy * cos_h < -reach or dx * dx + dy * dy > (range_m + reach) ** 2:
                    continue
                # What lies in many cells is seen in the one where it first meets the window.
                first_i = max(math.floor((seat_x - reach - 0.01 - header[0]) / header[2]), window[0])
                first_j = max(math.floor((seat_y - reach - 0.01 - header[1]) / header[2]), window[2])
                if i != first_i or j != first_j:
                    continue
                target = table[k]
                low, high, near, far = extent(target, targets.corners, x, y, sin_h, cos_h)
                if high < low or near > range_m:
                    continue
                low, high = clip_bearings(low, high, half_fov)
                if high < low:
                    continue
                if target[SHAPE] == AREA:
                    middle = 0.5 * (low + high)
                else:
                    middle = bearing(target[CENTRE_X] - x, target[CENTRE_Y] - y, sin_h, cos_h)
                    middle = min(max(middle, low), high)
                wide = focal_px * (math.tan(high) - math.tan(low))
                tall = _picture_height(target, near, far, middle, z, focal_px, 0.5 * height_px)
                if wide * tall < min_px * min_px:
                    continue
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = k, low, high, middle
                found[count, 4], found[count, 5], found[count, 6] = near, wide, tall
                count += 1
    return found[:count]


@njit(cache=True)
def see_objects(
    hiding: Grid,
    seats: Grid,
    targets: Targets,
    x: float,
    y: float,
    z: float,
    heading: float,
    half_fov: float,
    width_px: float,
    height_px: float,
    range_m: float,
    min_px: float,
) -> FloatArray:
    """Return what is seen, nearest first, shape (n, 6): object, bearing, distance, width, height (px), visible share.

    How finely a thing is probed for being hidden goes by its size in the picture: one ray for a speck, five by three
    for what is wide and high.
    """
    shown = in_view(seats, targets, x, y, z, heading, half_fov, width_px, height_px, range_m, min_px)
    seen = np.empty((shown.shape[0], 6))
    count = 0
    for row in range(shown.shape[0]):
        k, low, high, middle = int(shown[row, 0]), shown[row, 1], shown[row, 2], shown[row, 3]
        near, wide, tall = shown[row, 4], shown[row, 5], shown[row, 6]
        rays = 1 if wide < 6.0 else (3 if wide < 48.0 else 5)
        levels = 1 if tall < 8.0 else (2 if tall < 64.0 else 3)
        share = target_share(hiding, targets, k, x, y, z, heading, low, high, near, rays, levels)
        if share < _LEAST_SHARE or wide * tall * share < min_px * min_px:
            continue
        rank = count
        while rank > 0 and (near < seen[rank - 1, 2] or (near == seen[rank - 1, 2] and k < seen[rank - 1, 0])):
            seen[rank] = seen[rank - 1]
            rank -= 1
        seen[rank, 0], seen[rank, 1], seen[rank, 2] = k, middle, near
        seen[rank, 3], seen[rank, 4], seen[rank, 5] = wide, tall, share
        count += 1
    return seen[:count]


@njit(cache=True)
def see_walls(
    hiding: Grid, x: float, y: float, z: float, heading: float, half_fov: float, range_m: float
) -> FloatArray:
    """Return (distance, building) of the first wall in evenly spread directions, shape (WALL_RAYS, 2); -1 for none."""
    walls = np.empty((WALL_RAYS, 2))
    for k in range(WALL_RAYS):
        direction = heading + half_fov * (2.0 * (k + 0.5) / WALL_RAYS - 1.0)
        distance, item = first_hit(hiding, x, y, z, math.sin(direction), math.cos(direction), range_m, BUILDING)
        walls[k, 0] = distance
        walls[k, 1] = hiding.owners[item, 1] if item >= 0 else -1
    return walls


@njit(cache=True)
def see_ground(
    solid: Grid,
    codes: NDArray[np.uint8],
    frame: FloatArray,
    x: float,
    y: float,
    z: float,
    heading: float,
    range_m: float,
    unknown: int,
    building: int,
) -> FloatArray:
    """Return the ground along rays, shape (3, 6): three grounds, the free distance, kind and place of what ends it.

    ``frame`` is the raster's west and south edge and its cell's side, metres.
    """
    told = np.empty((3, 6))
    for k in range(3):
        direction = heading + GROUND_BEARINGS[k]
        sin_r, cos_r = math.sin(direction), math.cos(direction)
        free, item = first_hit(solid, x, y, z, sin_r, cos_r, range_m, 0)
        told[k, 3] = free
        told[k, 4] = solid.owners[item, 0] if item >= 0 else 0
        told[k, 5] = solid.owners[item, 1] if item >= 0 else -1
        for step in range(3):
            ahead = GROUND_AHEAD_M[step]
            if told[k, 4] == BUILDING and free <= ahead:
                told[k, step] = building
                continue
            column = math.floor((x + ahead * sin_r - frame[0]) / frame[2])
            row = math.floor((y + ahead * cos_r - frame[1]) / frame[2])
            within = 0 <= row < codes.shape[0] and 0 <= column < codes.shape[1]
            told[k, step] = codes[row, column] if within else unknown
    return told


@njit(cache=True)
def covered_by(covers: Grid, xs: FloatArray, ys: FloatArray, heights: FloatArray) -> IntArray:
    """Return, for each point, the row of the nearest disc over it that reaches higher than it, or -1."""
    header = covers.header
    found = np.full(len(xs), -1, np.int64)
    for k in range(len(xs)):
        i, j = math.floor((xs[k] - header[0]) / header[2]), math.floor((ys[k] - header[1]) / header[2])
        if i < 0 or j < 0 or i >= header[3] or j >= header[4]:
            continue
        cell, best = j * int(header[3]) + i, np.inf
        for place in range(covers.starts[cell], covers.starts[cell + 1]):
            row = covers.members[place]
            distance = math.hypot(covers.items[row, 1] - xs[k], covers.items[row, 2] - ys[k])
            if distance <= covers.items[row, 3] and distance < best and covers.items[row, 6] > heights[k]:
                best, found[k] = distance, row
    return found
