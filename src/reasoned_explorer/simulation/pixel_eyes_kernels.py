"""What a picture of depth and ids shows, in one call at machine speed.

The picture is coarser than the camera's own: its pixels are called coarse here, the camera's fine. What fills many
coarse pixels is counted in them. What fills few is drawn alone at the camera's resolution, and each of its samples is
held against the depth of the coarse pixel that it lies in: so a thing of two by six pixels is seen as surely as in the
camera's own picture, and only the edges of what hides it are coarse.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.projection import Projection
from reasoned_explorer.rendering.scene import Instances
from reasoned_explorer.rendering.silhouette_kernels import Sheet, draw_on_sheet, farthest_on_sheet, place_on_sheet
from reasoned_explorer.simulation.eyes_kernels import GROUND_AHEAD_M, GROUND_BEARINGS, WALL_RAYS
from reasoned_explorer.world.compiling import kernel, part
from reasoned_explorer.world.sight_kernels import AREA, BUILDING, FIRST, LAST, OBJECT, SHAPE, FloatArray, Targets

_GROUND_ID = 1
_FIRST_BUILDING_ID = 2
#: From so many coarse pixels on they are counted as they are.
_MANY = 6
#: What has more than this is drawn alone in as much detail as what has so many: its outline needs no more.
_DETAILED = 48.0
#: A sample is hidden by what is nearer by more than this: a share of its depth, and metres.
_NEARER_SHARE, _NEARER_M = 0.01, 0.05
#: A place stands on the wall of its building, which at a slant seems nearer; of two places on one spot, one is drawn
#: over the other, metres.
_WALL_M, _SPOT_M = 1.0, 0.1
#: Rows below the horizon in which ground is looked at row by row; farther down every second one is.
_FINE_ROWS = 24
#: Fewer fine pixels of a building than this tell nothing of it.
_LEAST_WALL_PX = 8


class Stage(NamedTuple):
    """What does not change from view to view.

    Attributes:
        targets: What can be looked for.
        stands: Instance of each object, or -1 where nothing is drawn of it, shape (objects,), int32.
        walls: Id in pictures of the building that a place belongs to, or -1, likewise.
        solid: Whether one can collide with it, likewise, uint8.
        codes: Codes of the ground, shape (rows, columns), uint8.
        frame: West and south edge of these and side of a cell, metres, shape (3,).
    """

    targets: Targets
    stands: NDArray[np.int32]
    walls: NDArray[np.int32]
    solid: NDArray[np.uint8]
    codes: NDArray[np.uint8]
    frame: FloatArray


class Tally(NamedTuple):
    """Room for what is found in a coarse picture.

    Attributes:
        counts: Coarse pixels, shape (ids,), int64.
        nearest: Least horizontal distance, metres, shape (ids,).
        asides: Sum of the tangents of their bearings, likewise.
        columns: Of each column of the picture the tangent of its bearing, and how much longer than the depth its
            distances are, shape (width, 2).
        corners: Corners of an area, ahead and to the right, metres, shape (n, 2).
        crossings: Where a row of the picture crosses an outline, shape (n,).
        row: Of one thing: pixels, silhouette, distance, tangent of the bearing; shape (4,).
        seen: What is seen, nearest first: object, bearing, distance, width, height, visible share, visible pixels of
            the camera; shape (objects, 7).
        told: The ground along rays, shape (3, 6), as `eyes_kernels.see_ground` returns it.
        walls: Distance and place of each building that is seen, shape (buildings, 2).
    """

    counts: NDArray[np.int64]
    nearest: FloatArray
    asides: FloatArray
    columns: FloatArray
    corners: FloatArray
    crossings: FloatArray
    row: FloatArray
    seen: FloatArray
    told: FloatArray
    walls: FloatArray


@part
def _count(depth: NDArray[np.float32], ids: NDArray[np.int32], coarse: Projection, tally: Tally) -> None:
    counts, all_nearest, asides, columns = tally.counts, tally.nearest, tally.asides, tally.columns
    counts[:] = 0
    for x in range(depth.shape[1]):
        aside = (x + 0.5 - coarse.centre_x) / coarse.focal
        columns[x, 0], columns[x, 1] = aside, math.sqrt(1.0 + aside * aside)
    for y in range(depth.shape[0]):
        for x in range(depth.shape[1]):
            thing = ids[y, x]
            if thing <= _GROUND_ID:
                continue
            distance = depth[y, x] * columns[x, 1]
            if counts[thing] == 0:
                all_nearest[thing], asides[thing] = distance, 0.0
            counts[thing] += 1
            all_nearest[thing] = min(all_nearest[thing], distance)
            asides[thing] += columns[x, 0]


@part
def _shows(
    walls: NDArray[np.int32], first_object: int, found: int, depth_m: float, own: int, own_depth_m: float
) -> bool:
    """Whether a coarse pixel that shows ``found`` would show a sample of ``own``. Flat ground hides nothing."""
    if found <= _GROUND_ID or found == own:
        return True
    slack_m = _NEARER_M + _NEARER_SHARE * own_depth_m
    wall = walls[own - first_object]
    if wall >= 0:
        if found == wall:
            slack_m = _WALL_M
        elif found >= first_object and walls[found - first_object] >= 0:
            slack_m = -_SPOT_M
    return depth_m >= own_depth_m - slack_m


@part
def _may_show(
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    ratio: float,
    rectangle: NDArray[np.int32],
    own: int,
    own_depth_m: float,
    walls: NDArray[np.int32],
    first_object: int,
) -> bool:
    """Whether anything in a rectangle of fine pixels is not nearer than the thing."""
    for y in range(int(rectangle[0, 2] * ratio), int((rectangle[0, 3] + 0.5) * ratio) + 1):
        for x in range(int(rectangle[0, 0] * ratio), int((rectangle[0, 1] + 0.5) * ratio) + 1):
            if _shows(walls, first_object, ids[y, x], depth[y, x], own, own_depth_m):
                return True
    return False


@part
def _is_free(
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    rectangle: NDArray[np.int32],
    own: int,
    farthest_m: float,
) -> bool:
    """Whether nothing in a rectangle of coarse pixels could hide a thing that reaches as far as ``farthest_m``."""
    for y in range(rectangle[0, 2], rectangle[0, 3] + 1):
        for x in range(rectangle[0, 0], rectangle[0, 1] + 1):
            if depth[y, x] < farthest_m and ids[y, x] != own and ids[y, x] > _GROUND_ID:
                return False
    return True


@part
def _see_large(
    library: Library,
    instances: Instances,
    i: int,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    coarse: Projection,
    fine: Projection,
    density: float,
    sheet: Sheet,
    own: int,
    tally: Tally,
    seen: FloatArray,
) -> None:
    """Set pixels, silhouette, distance and tangent of the bearing of a thing by its coarse pixels."""
    total, count = 0, tally.counts[own]
    near = place_on_sheet(library, instances, i, coarse, sheet)
    farthest_m = farthest_on_sheet(library, instances, i, sheet)
    if near > 0.0 and not _is_free(depth, ids, sheet.rectangle, own, farthest_m):
        draw_on_sheet(library, instances, i, coarse, density * min(1.0, _DETAILED / count), sheet)
        rectangle, owners = sheet.rectangle, sheet.canvas.owners
        for y in range(rectangle[0, 2], rectangle[0, 3] + 1):
            for x in range(rectangle[0, 0], rectangle[0, 1] + 1):
                total += owners[y, x] + 1
    scale = (fine.width / coarse.width) ** 2
    seen[0], seen[1] = count * scale, max(total, count) * scale
    seen[2], seen[3] = tally.nearest[own], tally.asides[own] / count


@part
def _see_small(
    library: Library,
    instances: Instances,
    i: int,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    fine: Projection,
    ratio: float,
    density: float,
    sheet: Sheet,
    own: int,
    walls: NDArray[np.int32],
    first_object: int,
    seen: FloatArray,
) -> None:
    """Set the same by samples at the camera's resolution; no pixels where it is out of the picture or all hidden."""
    seen[0] = 0.0
    near = place_on_sheet(library, instances, i, fine, sheet)
    rectangle = sheet.rectangle
    if near <= 0.0 or not _may_show(depth, ids, ratio, rectangle, own, 1.0 / near, walls, first_object):
        return
    draw_on_sheet(library, instances, i, fine, density, sheet)
    owners, nearness = sheet.canvas.owners, sheet.canvas.nearness
    total, count, distance, asides = 0, 0, math.inf, 0.0
    for y in range(rectangle[0, 2], rectangle[0, 3] + 1):
        row = int((y + 0.5) * ratio)
        for x in range(rectangle[0, 0], rectangle[0, 1] + 1):
            if owners[y, x] < 0:
                continue
            total += 1
            column, own_depth_m = int((x + 0.5) * ratio), 1.0 / nearness[y, x]
            if _shows(walls, first_object, ids[row, column], depth[row, column], own, own_depth_m):
                aside = (x + 0.5 - fine.centre_x) / fine.focal
                count += 1
                distance = min(distance, own_depth_m * math.sqrt(1.0 + aside * aside))
                asides += aside
    if count > 0:
        seen[0], seen[1], seen[2], seen[3] = count, total, distance, asides / count


@part
def _crossings_of(corners: FloatArray, count: int, ahead: float, scale: float, centre: float, room: FloatArray) -> int:
    """Set where a line across the view, so far ahead, crosses a ring: columns, sorted. Returns how many."""
    found = 0
    before = count - 1
    for k in range(count):
        here, there = corners[before, 0], corners[k, 0]
        if (here > ahead) != (there > ahead):
            aside = corners[before, 1] + (corners[k, 1] - corners[before, 1]) * (ahead - here) / (there - here)
            column, rank = centre + scale * aside, found
            while rank > 0 and room[rank - 1] > column:
                room[rank] = room[rank - 1]
                rank -= 1
            room[rank] = column
            found += 1
        before = k
    return found


@part
def _see_area(
    target: FloatArray,
    outline: FloatArray,
    ids: NDArray[np.int32],
    coarse: Projection,
    fine: Projection,
    range_m: float,
    own: int,
    tally: Tally,
    seen: FloatArray,
) -> None:
    """Set pixels, silhouette, distance and tangent of the bearing of a stretch of ground, in fine pixels.

    It has no pixels of its own but those of the ground inside its outline: each row of the picture is a line across
    the ground, and what of it lies inside is found from where it crosses the outline.
    """
    eye, axes, corners, crossings = fine.eye, fine.axes, tally.corners, tally.crossings
    first, last = int(target[FIRST]), int(target[LAST])
    for k in range(first, last):
        dx, dy = outline[k, 0] - eye[0], outline[k, 1] - eye[1]
        corners[k - first, 0] = dx * axes[2, 0] + dy * axes[2, 1]
        corners[k - first, 1] = dx * axes[0, 0] + dy * axes[0, 1]
    ratio = coarse.width / fine.width
    total, count, distance, asides = 0.0, 0.0, math.inf, 0.0
    row = math.floor(fine.centre_y)
    horizon = row
    while row < fine.height:
        step = 1 if row < horizon + _FINE_ROWS else 2
        below = row + 0.5 * step - fine.centre_y
        ahead = fine.focal * eye[2] / below if below > 0.0 else math.inf
        first_row, row = row, row + step
        if ahead > range_m:
            continue
        coarse_row = min(int((first_row + 0.5 * step) * ratio), coarse.height - 1)
        met = _crossings_of(corners, last - first, ahead, coarse.focal / ahead, coarse.centre_x, crossings)
        lower_m = fine.focal * eye[2] / (below + 0.5 * step)
        weight = step / ratio
        for pair in range(0, met - 1, 2):
            left = max(math.ceil(crossings[pair] - 0.5), 0)
            right = min(math.ceil(crossings[pair + 1] - 0.5), coarse.width)
            for column in range(left, right):
                total += weight
                found = ids[coarse_row, column]
                if found != _GROUND_ID and found != own:  # noqa: PLR1714 - a set would be made at each pixel
                    continue
                aside = (column + 0.5 - coarse.centre_x) / coarse.focal
                count += weight
                asides += weight * aside
                distance = min(distance, lower_m * math.sqrt(1.0 + aside * aside))
    if count == 0.0 and tally.counts[own] > 0:  # what stands on it, above other ground
        count, distance, asides = tally.counts[own] / ratio**2, tally.nearest[own], tally.asides[own] / ratio**2
    seen[0], seen[1], seen[2] = count, max(total, count), distance
    seen[3] = asides / count if count > 0.0 else 0.0


@part
def _see_objects(
    stage: Stage,
    library: Library,
    instances: Instances,
    coarse: Projection,
    fine: Projection,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    density: float,
    shown: FloatArray,
    range_m: float,
    min_px: float,
    first_object: int,
    tally: Tally,
    sheet: Sheet,
) -> int:
    """Set what is seen, nearest first; returns how many."""
    ratio = coarse.width / fine.width
    seen, row = tally.seen, tally.row
    count = 0
    for place in range(shown.shape[0]):
        k, near = int(shown[place, 0]), shown[place, 4]
        i, own = stage.stands[k], first_object + k
        if stage.targets.table[k, SHAPE] == AREA:
            _see_area(stage.targets.table[k], stage.targets.corners, ids, coarse, fine, range_m, own, tally, row)
            row[2] = max(row[2], near) if near > 0.0 else 0.0
        elif i < 0:
            continue
        elif tally.counts[own] >= _MANY:
            _see_large(library, instances, i, depth, ids, coarse, fine, density, sheet, own, tally, row)
        else:
            _see_small(
                library, instances, i, depth, ids, fine, ratio, density, sheet, own, stage.walls, first_object, row
            )
        if row[0] < min_px or row[0] == 0.0 or row[2] > range_m:
            continue
        distance = row[2]
        rank = count
        while rank > 0 and (distance < seen[rank - 1, 2] or (distance == seen[rank - 1, 2] and k < seen[rank - 1, 0])):
            for column in range(7):
                seen[rank, column] = seen[rank - 1, column]
            rank -= 1
        seen[rank, 0], seen[rank, 1], seen[rank, 2] = k, math.atan(row[3]), distance
        seen[rank, 3], seen[rank, 4] = shown[place, 5], shown[place, 6]
        seen[rank, 5], seen[rank, 6] = row[0] / row[1], row[0]
        count += 1
    return count


@part
def _see_walls(
    coarse: Projection,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    half_fov: float,
    range_m: float,
    first_object: int,
    least: float,
    tally: Tally,
) -> tuple[float, int]:
    """Set the buildings that are seen; returns the share of directions that show one, and how many they are."""
    met = 0
    for k in range(WALL_RAYS):
        aside = math.tan(half_fov * (2.0 * (k + 0.5) / WALL_RAYS - 1.0))
        column = min(max(int(coarse.centre_x + coarse.focal * aside), 0), coarse.width - 1)
        reach = range_m / math.sqrt(1.0 + aside * aside)
        for y in range(coarse.height):
            if _FIRST_BUILDING_ID <= ids[y, column] < first_object and depth[y, column] <= reach:
                met += 1
                break
    count = 0
    for thing in range(_FIRST_BUILDING_ID, first_object):
        if tally.counts[thing] >= least and tally.nearest[thing] <= range_m:
            tally.walls[count, 0], tally.walls[count, 1] = tally.nearest[thing], thing - _FIRST_BUILDING_ID
            count += 1
    return met / WALL_RAYS, count


@part
def _code_at(stage: Stage, x: float, y: float, unknown: int) -> int:
    column = math.floor((x - stage.frame[0]) / stage.frame[2])
    row = math.floor((y - stage.frame[1]) / stage.frame[2])
    if 0 <= row < stage.codes.shape[0] and 0 <= column < stage.codes.shape[1]:
        return int(stage.codes[row, column])
    return unknown


@part
def _see_ground(
    stage: Stage,
    coarse: Projection,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    heading: float,
    range_m: float,
    first_object: int,
    unknown: int,
    building: int,
    told: FloatArray,
) -> None:
    """Set the ground along rays.

    A column of the picture is one direction. The free distance is read from the two rows on either side of the
    horizon, which is the camera's own height; the ground from the point that is wanted, or where that is hidden from
    the visible ground nearest to it.
    """
    eye = coarse.eye
    horizon = math.floor(coarse.centre_y)
    for k in range(3):
        aside = math.tan(GROUND_BEARINGS[k])
        slant = math.sqrt(1.0 + aside * aside)
        direction = heading + GROUND_BEARINGS[k]
        sin_r, cos_r = math.sin(direction), math.cos(direction)
        position = coarse.centre_x + coarse.focal * aside
        column = min(max(int(position), 0), coarse.width - 1)
        free, kind, owner = range_m, 0, -1
        for y in range(max(horizon - 1, 0), min(horizon + 1, coarse.height)):
            for x in range(max(int(position - 0.5), 0), min(int(position + 0.5), coarse.width - 1) + 1):
                found, distance = ids[y, x], depth[y, x] * slant
                if found <= _GROUND_ID or distance >= free:
                    continue
                if found < first_object:
                    free, kind, owner = distance, BUILDING, found - _FIRST_BUILDING_ID
                elif stage.walls[found - first_object] >= 0:
                    free, kind, owner = distance, BUILDING, stage.walls[found - first_object] - _FIRST_BUILDING_ID
                elif stage.solid[found - first_object]:
                    free, kind, owner = distance, OBJECT, found - first_object
        told[k, 3], told[k, 4], told[k, 5] = free, kind, owner
        for step in range(3):
            wanted = GROUND_AHEAD_M[step]
            if kind == BUILDING and free <= wanted:
                told[k, step] = building
                continue
            best, at = math.inf, -1.0
            for y in range(horizon, coarse.height):
                if ids[y, column] != _GROUND_ID:
                    continue
                nearest = coarse.focal * eye[2] * slant / (y + 1.0 - coarse.centre_y)
                farthest = coarse.focal * eye[2] * slant / max(y - coarse.centre_y, 1e-9)
                point = min(max(wanted, nearest), farthest)
                if abs(point - wanted) < best:
                    best, at = abs(point - wanted), point
            told[k, step] = _code_at(stage, eye[0] + at * sin_r, eye[1] + at * cos_r, unknown) if at >= 0.0 else unknown


@kernel
def see(
    stage: Stage,
    library: Library,
    instances: Instances,
    coarse: Projection,
    fine: Projection,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    density: float,
    shown: FloatArray,
    heading: float,
    half_fov: float,
    range_m: float,
    min_px: float,
    first_object: int,
    unknown: int,
    building: int,
    tally: Tally,
    sheet: Sheet,
) -> tuple[int, float, int]:
    """Set what a picture shows; returns how many objects, the share of directions that end at buildings, how many.

    Args:
        stage: The world, as eyes know it.
        library: Models of the scene.
        instances: Where they stand.
        coarse: The camera of the picture.
        fine: The camera itself, of the same field of view.
        depth: Of the picture, shape (height, width).
        ids: Likewise.
        density: As in `raster_kernels.draw`.
        shown: What would be seen if nothing hid anything, as `eyes_kernels.in_view` returns it.
        heading: Of both cameras, radians.
        half_fov: Half of their field of view, radians.
        range_m: Nothing farther is seen.
        min_px: Least visible pixels of the camera.
        first_object: Id in pictures of the first object.
        unknown: Code of unknown ground.
        building: Code of ground under buildings.
        tally: Set.
        sheet: Room.
    """
    _count(depth, ids, coarse, tally)
    count = _see_objects(
        stage, library, instances, coarse, fine, depth, ids, density, shown, range_m, min_px, first_object, tally, sheet
    )
    _see_ground(stage, coarse, depth, ids, heading, range_m, first_object, unknown, building, tally.told)
    least = _LEAST_WALL_PX * (coarse.width / fine.width) ** 2
    share, buildings = _see_walls(coarse, depth, ids, half_fov, range_m, first_object, least, tally)
    return count, share, buildings


@kernel
def range_ahead(
    coarse: Projection,
    depth: NDArray[np.float32],
    ids: NDArray[np.int32],
    half_width_m: float,
    lowest_m: float,
    highest_m: float,
) -> float:
    """Return the least depth of anything but the ground in a corridor along the axis, infinite where it is free."""
    least = math.inf
    for y in range(depth.shape[0]):
        down = (y + 0.5 - coarse.centre_y) / coarse.focal
        for x in range(depth.shape[1]):
            ahead = depth[y, x]
            if ids[y, x] <= _GROUND_ID or ahead >= least:
                continue
            aside = abs((x + 0.5 - coarse.centre_x) / coarse.focal) * ahead
            if aside <= half_width_m and lowest_m <= coarse.eye[2] - down * ahead <= highest_m:
                least = ahead
    return least
