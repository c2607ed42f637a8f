"""Buildings: footprints, heights, entrances."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.model.draws import uniform
from reasoned_explorer.world.osm.features import Feature
from reasoned_explorer.world.osm.shapes import clip, polygon_of, polygons_of, rings_of
from reasoned_explorer.world.osm.tags import (
    Tags,
    clean_text,
    is_below_ground,
    is_gone,
    is_set,
    parse_count,
    parse_length_m,
)
from reasoned_explorer.world.world import Bounds, Building

_LEVEL_M = 3.0
_MIN_HEIGHT_M, _MAX_HEIGHT_M = 1.0, 900.0
_MIN_AREA_M2 = 1.0
_MIN_COURTYARD_M2 = 4.0
_ENTRANCE_REACH_M = 1.0
_ROOF_THICKNESS_M = 0.4
# Headroom of a passage through a building: that of a gateway for delivery vans (assumed).
_PASSAGE_HEIGHT_M = 3.5
#: A building whose underside is higher than this can be walked under.
WALK_UNDER_M = 2.0
_ROOFS = frozenset({"roof", "carport", "canopy"})
_NO_WAY_IN = frozenset({"no", "emergency", "exit", "fire_exit", "garage", "window"})

# Where the map gives no height: lowest and highest of a seeded default by type, metres. Assumed, not measured.
_DEFAULT_HEIGHT_M = {
    **dict.fromkeys(("house", "detached", "semidetached_house", "terrace", "bungalow", "cabin", "farm"), (5.5, 8.5)),
    **dict.fromkeys(("garage", "garages", "shed", "hut", "kiosk", "carport", "roof", "canopy", "service", "toilets",
                     "greenhouse", "bunker", "container"), (2.8, 3.6)),
    **dict.fromkeys(("apartments", "residential", "hotel", "dormitory"), (12.0, 21.0)),
    **dict.fromkeys(("office", "commercial", "government", "public", "civic", "hospital", "university"), (12.0, 24.0)),
    **dict.fromkeys(("retail", "supermarket", "school", "college", "kindergarten", "industrial", "warehouse",
                     "train_station", "sports_hall"), (6.0, 14.0)),
    **dict.fromkeys(("church", "chapel", "mosque", "temple", "synagogue"), (10.0, 18.0)),
    **dict.fromkeys(("cathedral", "stadium", "tower"), (25.0, 40.0)),
}  # fmt: skip
_OTHER_HEIGHT_M = (9.0, 18.0)
_SMALL_AREA_M2, _SMALL_HEIGHT_M = 40.0, (2.8, 4.0)


@dataclass(frozen=True, slots=True)
class Heights:
    """How high a building reaches, where it begins, and how that is known; metres."""

    top_m: float
    bottom_m: float
    source: str


def is_building(tags: Tags) -> bool:
    """Return whether an area is a building, or part of one, that stands above the ground."""
    if is_gone(tags) or is_below_ground(tags):
        return False
    if tags.get("building") in {"construction", "ruins", "collapsed"}:
        return tags["building"] == "ruins"
    return is_set(tags, "building") or is_set(tags, "building:part")


def heights_of(tags: Tags, *, area_m2: float, seed: int, key: int) -> Heights:
    """Return how high a building is: by its height, else by its levels, else by a seeded default of its type.

    Args:
        tags: Its tags.
        area_m2: Of its footprint; small ones of unknown type are low.
        seed: Of the defaults.
        key: What tells this building from others.
    """
    kind = tags.get("building", "yes")
    is_roof = kind in _ROOFS or tags.get("building:part") == "roof"
    bottom_m = _underside_m(tags)
    top_m = parse_length_m(tags.get("height", tags.get("building:height")))
    source = "height"
    if top_m is None or not _MIN_HEIGHT_M <= top_m <= _MAX_HEIGHT_M:
        levels = parse_count(tags.get("building:levels", tags.get("levels")))
        roof_levels = parse_count(tags.get("roof:levels")) or 0.0
        if levels is not None and 0.0 < levels + roof_levels <= _MAX_HEIGHT_M / _LEVEL_M:
            top_m, source = max((levels + min(roof_levels, 10.0)) * _LEVEL_M, _LEVEL_M), "levels"
        else:
            low_m, high_m = _DEFAULT_HEIGHT_M.get(
                kind, _SMALL_HEIGHT_M if area_m2 < _SMALL_AREA_M2 else _OTHER_HEIGHT_M
            )
            top_m, source = low_m + (high_m - low_m) * uniform(seed, "height", key), "default"
            top_m = max(top_m, bottom_m + _LEVEL_M)
    if is_roof and bottom_m == 0.0:
        bottom_m = max(top_m - _ROOF_THICKNESS_M, 0.0)
    return Heights(top_m, bottom_m if bottom_m < top_m else 0.0, source)


def _underside_m(tags: Tags) -> float:
    bottom_m = parse_length_m(tags.get("min_height", tags.get("building:min_height")))
    if bottom_m is not None:
        return bottom_m
    below = parse_count(tags.get("building:min_level", tags.get("min_level")))
    return 0.0 if below is None else min(below, 300.0) * _LEVEL_M


@dataclass(frozen=True, slots=True, eq=False)
class BuildingSet:
    """Buildings, with their footprints for questions.

    Attributes:
        buildings: In the order of the world.
        footprints: Their polygons.
        tree: Over the footprints of those that one cannot walk under.
        standing: Places in ``buildings`` of what the tree holds.
        counts: For the report.
        courtyards: Their courtyards, as polygons.
    """

    buildings: tuple[Building, ...]
    footprints: tuple[Any, ...]
    tree: Any
    standing: NDArray[np.intp]
    counts: dict[str, int]
    courtyards: tuple[Any, ...] = ()

    def containing(self, points: Any) -> NDArray[np.intp]:
        """Return for each point the place of the building it lies in (the first of several), or -1."""
        found = np.full(len(points), len(self.buildings), dtype=np.intp)
        if len(points):
            point, hit = self.tree.query(points, predicate="intersects")
            np.minimum.at(found, point, self.standing[hit])
        found[found == len(self.buildings)] = -1
        return found

    def nearest(self, points: Any, *, reach_m: float) -> NDArray[np.intp]:
        """Return for each point the place of the nearest building within reach, or -1."""
        found = np.full(len(points), len(self.buildings), dtype=np.intp)
        if len(points) and len(self.standing):
            point, hit = self.tree.query_nearest(points, max_distance=reach_m)
            np.minimum.at(found, point, self.standing[hit])
        found[found == len(self.buildings)] = -1
        return found


def buildings_of(
    areas: Sequence[Feature], doors: Sequence[Feature], passages: Sequence[Any], bounds: Bounds, *, seed: int
) -> BuildingSet:
    """Make the buildings of a map's areas and entrances.

    Passages, polygons, lead through them: what is above is a building of its own that one can walk under.

    Where an outline has parts (building:part) that stand on the ground, the parts carry its heights and the outline
    only what they leave over, so that nothing stands there twice; parts higher up are put on top of it.
    """
    outlines = [area for area in areas if is_building(area.tags) and not is_set(area.tags, "building:part")]
    parts = [area for area in areas if is_building(area.tags) and is_set(area.tags, "building:part")]
    grounded = [part for part in parts if _underside_m(part.tags) <= WALK_UNDER_M]
    pieces = _without_parts(outlines, grounded) + [(part, part.shape) for part in parts]
    built: list[Building] = []
    footprints: list[Any] = []
    courtyards: list[Any] = []
    if pieces:
        shapes = clip([shape for _, shape in pieces], bounds)
        courtyards = _courtyards(shapes)
        for (feature, _), (shape, above) in zip(pieces, _cut_through(shapes, passages), strict=True):
            for polygon in polygons_of(shape, min_area_m2=_MIN_AREA_M2):
                built.append(_building(feature, polygon, seed))
                footprints.append(polygon)
            for polygon in polygons_of(above, min_area_m2=_MIN_AREA_M2):
                arch = _building(feature, polygon, seed)
                if arch.height_m > _PASSAGE_HEIGHT_M + _ROOF_THICKNESS_M:
                    built.append(replace(arch, min_height_m=max(arch.min_height_m, _PASSAGE_HEIGHT_M)))
                    footprints.append(polygon)
    buildings = _with_entrances(built, footprints, doors)
    standing = np.array([at for at, one in enumerate(buildings) if one.min_height_m <= WALK_UNDER_M], dtype=np.intp)
    counts = {"building outlines": len(outlines), "building parts": len(parts), "buildings": len(buildings)}
    for source in ("height", "levels", "default"):
        counts[f"buildings with height from {source}"] = sum(one.height_source == source for one in buildings)
    tree = shapely.STRtree([footprints[at] for at in standing])
    return BuildingSet(buildings, tuple(footprints), tree, standing, counts, tuple(courtyards))


def _cut_through(shapes: Any, passages: Sequence[Any]) -> list[tuple[Any, Any]]:
    """Return for each footprint what passages leave of it, and what lies above them (or None)."""
    found: list[tuple[Any, Any]] = [(shape, None) for shape in shapes]
    if not len(passages):
        return found
    at, passage = shapely.STRtree(passages).query(np.asarray(shapes, dtype=object), predicate="intersects")
    for place in np.unique(at).tolist():
        corridor = shapely.union_all([passages[index] for index in passage[at == place]])
        whole = shapely.make_valid(shapes[place])
        found[place] = shapely.difference(whole, corridor), shapely.intersection(whole, corridor)
    return found


def _without_parts(outlines: Sequence[Feature], parts: Sequence[Feature]) -> list[tuple[Feature, Any]]:
    if not parts or not outlines:
        return [(outline, outline.shape) for outline in outlines]
    part_shapes = np.array([part.shape for part in parts], dtype=object)
    outline_at, part_at = shapely.STRtree(part_shapes).query(
        np.array([outline.shape for outline in outlines], dtype=object), predicate="intersects"
    )
    pieces: list[tuple[Feature, Any]] = []
    for at, outline in enumerate(outlines):
        own = part_shapes[np.sort(part_at[outline_at == at])]
        shape = outline.shape
        if len(own):
            covered = shapely.union_all(shapely.make_valid(own))
            # A part that reaches in from next door is no reason to cut this one.
            if shapely.intersection(shape, covered).area > 0.05 * shape.area:
                # Slivers between outline and parts are drawing errors, not houses.
                rest = shapely.difference(shape, shapely.buffer(covered, 0.3, join_style="mitre"))
                shape = shapely.MultiPolygon(list(polygons_of(rest, min_area_m2=4.0)))
        pieces.append((outline, shape))
    return pieces


def _building(feature: Feature, polygon: Any, seed: int) -> Building:
    tags = feature.tags
    heights = heights_of(tags, area_m2=polygon.area, seed=seed, key=feature.osm_id)
    outer, holes = rings_of(polygon)
    kind = tags.get("building", tags.get("building:part", "yes"))
    return Building(
        outer=outer,
        height_m=heights.top_m,
        holes=holes,
        kind=clean_text(kind) or "yes",
        name=clean_text(tags.get("name", "")),
        min_height_m=heights.bottom_m,
        height_source=heights.source,
    )


def _with_entrances(
    built: Sequence[Building], footprints: Sequence[Any], doors: Sequence[Feature]
) -> tuple[Building, ...]:
    usable = [door for door in doors if _is_way_in(door.tags)]
    if not built or not usable:
        return tuple(built)
    points = np.array([door.shape for door in usable], dtype=object)
    door_at, building_at = shapely.STRtree([shapely.boundary(shape) for shape in footprints]).query_nearest(
        points, max_distance=_ENTRANCE_REACH_M
    )
    by_building: dict[int, list[int]] = {}
    for door, building in sorted(zip(door_at.tolist(), building_at.tolist(), strict=True)):
        by_building.setdefault(building, []).append(door)
    places = shapely.get_coordinates(points)
    main = [door.tags.get("entrance") != "main" for door in usable]
    return tuple(
        replace(one, entrances=places[sorted(by_building[at], key=lambda door: (main[door], door))])
        if at in by_building
        else one
        for at, one in enumerate(built)
    )


def _is_way_in(tags: Tags) -> bool:
    kind = tags.get("entrance") or ("yes" if tags.get("building") == "entrance" else None)
    if kind is None and is_set(tags, "door"):
        kind = "yes"
    return kind is not None and kind not in _NO_WAY_IN


def _courtyards(shapes: Sequence[Any]) -> list[Any]:
    """Return the courtyards of footprints, those that a passage leads into among them."""
    holes = [polygon_of(rings_of(polygon)[1][at]) for shape in shapes for polygon in polygons_of(shape)
             for at in range(len(polygon.interiors))]  # fmt: skip
    return [hole for hole in holes if hole.area >= _MIN_COURTYARD_M2]
