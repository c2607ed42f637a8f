"""The generator: from a district's name, a seed and a size to a world."""

import math
from typing import get_args

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.affinity import Pull, Statistics
from reasoned_explorer.world.generator.assemble import buildings_of, ground_of, regions_of, rings_of, ways_of
from reasoned_explorer.world.generator.furniture import Furnisher, Thing, standing_size
from reasoned_explorer.world.generator.greenery import plant_bushes, plant_trees
from reasoned_explorer.world.generator.ground import GroundPlan
from reasoned_explorer.world.generator.shapes import Points, heading_of
from reasoned_explorer.world.generator.sites import Sites, find_sites, zone_of
from reasoned_explorer.world.generator.sketch import Sketch, Zone
from reasoned_explorer.world.generator.streets import add_crossings
from reasoned_explorer.world.generator.town import fill_district, fill_town
from reasoned_explorer.world.generator.traffic import park_cars
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, World, WorldObject

Numbers = NDArray[np.float64]
_AREA_CLASS = {"playground": "playground", "pitch": "pitch", "lawn": "lawn", "meadow": "lawn", "picnic": "lawn"}


def build_world(district: str, *, seed: int, size_m: float, statistics: Statistics, pull: Pull | None = None) -> World:
    """Return a generated world; the arguments are taken to be sound (see `generate_world`).

    Args:
        district: A name of `DISTRICTS`.
        seed: Of all draws.
        size_m: Length of the sides.
        statistics: What stands near what in real places.
        pull: How strongly the statistics act, for experiments.
    """
    half = size_m / 2
    sketch = Sketch(shapely.box(-half, -half, half, half), seed)
    if district == "town":
        fill_town(sketch)
    else:
        fill_district(sketch, _zone(district))
    _hang_doors(sketch)
    crossings = add_crossings(sketch)
    ground, ways = ground_of(sketch), ways_of(sketch)
    plan = GroundPlan(
        [patch.area for patch in ground],
        [patch.ground for patch in ground],
        # Nothing may stand on a crossing: while things are placed it is carriageway.
        ways[: len(ways) - len(sketch.crossings)],
        [item.area for item in sketch.footprints],
        sketch.box,
    )
    stop_if_asked()
    sites = find_sites(sketch, plan, crossings)
    furnisher = Furnisher(sketch, plan, sites, statistics=statistics, pull=pull or Pull())
    _stand_areas(sketch, furnisher)
    _equip(sketch)
    _stand_fixtures(sketch, plan, furnisher)
    cars, ways_ahead = park_cars(sketch, plan, crossings)
    _stand_bulk(sketch, furnisher, "car", cars, headings=ways_ahead)
    trees, crowns = plant_trees(sketch, plan)
    _stand_bulk(sketch, furnisher, "tree", trees, headings=np.zeros(len(trees)), widths=crowns)
    _stand_hosts(sketch, furnisher)
    stop_if_asked()
    furnisher.furnish()
    stop_if_asked()
    bushes, widths = plant_bushes(sketch, plan)
    _stand_bulk(sketch, furnisher, "shrub", bushes, headings=np.zeros(len(bushes)), widths=widths)
    objects = tuple(
        WorldObject(
            id=index,
            class_name=thing.class_name,
            x_m=thing.x_m,
            y_m=thing.y_m,
            heading_rad=round(thing.heading_rad, 5),
            size_m=thing.size_m,
            attributes=thing.attributes or {},
            outline=thing.outline,
            building=thing.building,
        )
        for index, thing in enumerate(furnisher.things)
    )
    buildings = _with_entrances(sketch, plan, sites, furnisher.things)
    size = f"{size_m:g}"
    world = World(
        name=f"{district}:{seed}@{size}",
        bounds=Bounds(-half, -half, half, half),
        regions=regions_of(ground),
        ways=ways,
        buildings=buildings,
        objects=objects,
        source=f"generated {district} seed={seed} size={size}",
        seed=seed,
    )
    return rounded(world)


def _zone(district: str) -> Zone:
    return next(zone for zone in get_args(Zone) if zone == district)


def _hang_doors(sketch: Sketch) -> None:
    """Move main entrances onto the outlines of their buildings (of a winged building, the front may lie back)."""
    chosen = [item for item in sketch.footprints if item.entrance is not None]
    if not chosen:
        return
    walls = np.array([item.area.exterior for item in chosen])
    doors = shapely.points(np.array([item.entrance for item in chosen], float))
    at = shapely.line_interpolate_point(walls, shapely.line_locate_point(walls, doors))
    for item, (x, y) in zip(chosen, shapely.get_coordinates(at).tolist(), strict=True):
        item.entrance = (x, y)


def _stand_areas(sketch: Sketch, furnisher: Furnisher) -> None:
    """Make playgrounds, pitches and lawns objects with an outline, and equip the playgrounds."""
    chosen = [patch for patch in sketch.patches if patch.role in _AREA_CLASS]
    if not chosen:
        return
    inside = planar.intersection(np.array([patch.area for patch in chosen]), sketch.box)
    spots = [area.representative_point() for area in inside]
    zones = zone_of(sketch, shapely.get_coordinates(spots))
    for patch, area, spot, zone in zip(chosen, inside, spots, zones.tolist(), strict=True):
        name = _AREA_CLASS[patch.role]
        if not isinstance(area, shapely.Polygon) or area.area < 60.0:
            continue
        min_x, min_y, max_x, max_y = area.bounds
        outline, _ = rings_of(area)
        size = (round(max_x - min_x, 1), round(max_y - min_y, 1), OBJECT_CLASSES[name].size_m[2])
        furnisher.stand(Thing(name, spot.x, spot.y, 0.0, size, outline=outline), zone=zone)


def _equip(sketch: Sketch) -> None:
    """Give playgrounds a slide, a swing and a bench to watch from, pedestrian streets rows of bollards."""
    for index, patch in enumerate(sketch.patches):
        if patch.role != "playground":
            continue
        rng = sketch.rng("playground", index)
        middle, reach = patch.area.representative_point(), math.sqrt(patch.area.area / math.pi)
        turn = float(rng.uniform(0, 2 * math.pi))
        # Equipment and benches are on the map for some playgrounds only; here they stand on most (assumed).
        names = [name for name, share in (("slide", 0.8), ("swing", 0.7), ("bench", 0.3)) if rng.random() < share]
        for place, name in enumerate(names):
            angle = turn + place * 2 * math.pi / len(names)
            far = reach * (0.5 if name != "bench" else 0.85)
            x, y = middle.x + far * math.sin(angle), middle.y + far * math.cos(angle)
            sketch.put(name, x, y, (angle + math.pi) % (2 * math.pi))
    for index, street in enumerate(sketch.streets):
        if street.road_m > 0 or sketch.rng("bollards", index).random() < 0.5:
            continue
        line, far = shapely.LineString(street.line), 11.0
        for where, ahead in ((far, far + 0.5), (line.length - far, line.length - far - 0.5)):
            if line.length < 3 * far:
                continue
            foot, tip = (np.array(line.interpolate(value).coords[0]) for value in (where, ahead))
            step = (tip - foot) / max(float(np.hypot(*(tip - foot))), 1e-6)
            aside = np.array([-step[1], step[0]])
            # A wide gap in the middle lets the fire brigade through.
            for offset in (-3.4, -2.2, 2.2, 3.4):
                x, y = (foot + aside * offset).tolist()
                sketch.put("bollard", x, y, float(math.atan2(*step)) % (2 * math.pi))


def _stand_fixtures(sketch: Sketch, plan: GroundPlan, furnisher: Furnisher) -> None:
    """Stand what belongs to a design, where there is ground for it."""
    if not sketch.fixtures:
        return
    points = np.array([(item.x_m, item.y_m) for item in sketch.fixtures])
    inside = shapely.contains_xy(planar.buffer(sketch.box, -3.0), points)
    inside &= ~np.isin(plan.at(points), [Ground.ROAD, Ground.WATER, Ground.BUILDING])
    zones = zone_of(sketch, points)
    for item, zone, fits in zip(sketch.fixtures, zones.tolist(), inside.tolist(), strict=True):
        size = item.size_m or standing_size(item.class_name)
        if fits and furnisher.room(item.class_name, item.x_m, item.y_m, item.heading_rad, size):
            furnisher.stand(
                Thing(item.class_name, item.x_m, item.y_m, item.heading_rad, size, attributes=item.attributes),
                zone=zone,
            )


def _stand_bulk(
    sketch: Sketch, furnisher: Furnisher, name: str, points: Points, *, headings: Numbers, widths: Numbers | None = None
) -> None:
    """Stand many of a kind that were laid out together, those left out for which there is no room."""
    rng = sketch.rng("bulk", name)
    zones = zone_of(sketch, points).tolist()
    length, depth, height = standing_size(name)
    scales = rng.uniform(0.94, 1.06, (len(points), 2))
    things: list[Thing] = []
    for index, (x, y) in enumerate(points.tolist()):
        if widths is not None:
            wide = float(widths[index])
            size = (wide, wide, round(wide * height / length * float(scales[index, 0]), 1))
        else:
            size = (length, round(depth * float(scales[index, 0]), 2), round(height * float(scales[index, 1]), 2))
        things.append(Thing(name, x, y, float(headings[index]), size))
    furnisher.stand_many(things, zones)


def _stand_hosts(sketch: Sketch, furnisher: Furnisher) -> None:
    """Stand the places that certain buildings certainly hold, at their main entrances."""
    for index, item in enumerate(sketch.footprints):
        if not item.hosts or item.entrance is None:
            continue
        point = np.array([item.entrance])
        zone = int(zone_of(sketch, point)[0])
        centre = item.area.centroid
        outward = point - np.array([[centre.x, centre.y]])
        heading = float(heading_of(outward)[0])
        for place, name in enumerate(item.hosts):
            x, y = item.entrance
            shift = 2.4 * place
            x, y = x + shift * math.cos(heading), y - shift * math.sin(heading)
            furnisher.stand(Thing(name, x, y, heading, OBJECT_CLASSES[name].size_m, index), zone=zone)


def _with_entrances(sketch: Sketch, plan: GroundPlan, sites: Sites, things: list[Thing]) -> tuple[Building, ...]:
    """Return the buildings, each with a main entrance on its best side and one for each place that it holds."""
    doors = np.flatnonzero(sites.buildings >= 0)
    best: dict[int, Points] = {}
    first_rank: dict[int, tuple[float, float]] = {}
    if len(doors):
        outward = np.column_stack([np.sin(sites.headings[doors]), np.cos(sites.headings[doors])])
        before = plan.at(sites.points[doors] + 1.4 * outward)
        rank = np.select([before == Ground.PLAZA, before == Ground.PAVEMENT], [0.0, 1.0], 2.0)
        for place, door in enumerate(doors.tolist()):
            home = int(sites.buildings[door])
            key = (float(rank[place]), float(place))
            if home not in first_rank or key < first_rank[home]:
                first_rank[home], best[home] = key, sites.points[door]
    held: dict[int, list[tuple[float, float]]] = {}
    for thing in things:
        if thing.building >= 0:
            held.setdefault(thing.building, []).append((thing.x_m, thing.y_m))
    wanted: list[tuple[float, float]] = []
    owner: list[int] = []
    for index, item in enumerate(sketch.footprints):
        points = [] if item.entrance is None else [item.entrance]
        if not points and index in best and item.min_height_m == 0:
            points = [(float(best[index][0]), float(best[index][1]))]
        points += [point for point in held.get(index, []) if point not in points]
        wanted += points
        owner += [index] * len(points)
    if not wanted:
        return buildings_of(sketch.footprints, [np.empty((0, 2))] * len(sketch.footprints))
    # Entrances lie on the outline to the millimetre.
    walls = np.array([item.area.exterior for item in sketch.footprints])[owner]
    at = shapely.line_interpolate_point(walls, shapely.line_locate_point(walls, shapely.points(np.array(wanted))))
    snapped = np.round(shapely.get_coordinates(at), 3)
    parts = np.split(snapped, np.searchsorted(owner, np.arange(1, len(sketch.footprints))))
    return buildings_of(sketch.footprints, parts)
