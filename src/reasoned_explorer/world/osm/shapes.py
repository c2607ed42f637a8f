"""Small helpers between shapely's geometries and the world's rings."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.world.world import Bounds, Ring


def polygons_of(geometry: Any, *, min_area_m2: float = 0.0) -> Iterator[Any]:
    """Yield the valid polygons of any geometry that are larger than ``min_area_m2``."""
    if geometry is None or geometry.is_empty:
        return
    whole = geometry if geometry.is_valid else shapely.make_valid(geometry)
    for part in _leaves(whole):
        if part.geom_type == "Polygon" and part.area > min_area_m2:
            yield part


def lines_of(geometry: Any, *, min_length_m: float = 0.0) -> Iterator[Any]:
    """Yield the lines of any geometry that are longer than ``min_length_m``."""
    if geometry is None or geometry.is_empty:
        return
    for part in _leaves(geometry):
        if part.geom_type in {"LineString", "LinearRing"} and part.length > min_length_m:
            yield part


def _leaves(geometry: Any) -> Iterator[Any]:
    if hasattr(geometry, "geoms"):
        for part in geometry.geoms:
            yield from _leaves(part)
    else:
        yield geometry


def ring_of(line: Any) -> Ring:
    """Return a closed line's points, shape (n, 2), without the closing one repeated."""
    return np.ascontiguousarray(shapely.get_coordinates(line)[:-1])


def rings_of(polygon: Any) -> tuple[Ring, tuple[Ring, ...]]:
    """Return a polygon's outer ring and its holes."""
    return ring_of(polygon.exterior), tuple(ring_of(hole) for hole in polygon.interiors)


def polygon_of(outer: Ring, holes: Iterable[Ring] = ()) -> Any:
    """Return the polygon of a ring and its holes."""
    return shapely.Polygon(outer, list(holes))


def box_of(bounds: Bounds) -> Any:
    """Return bounds as a polygon."""
    return shapely.box(bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)


def clip(geometries: Any, bounds: Bounds) -> Any:
    """Return an array of geometries, each cut off at the bounds; those inside are left as they are."""
    geometries = np.asarray(geometries, dtype=object)
    extent = shapely.bounds(geometries)
    limits = np.array([bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m])
    with np.errstate(invalid="ignore"):
        inside = (extent[:, :2] >= limits[:2]).all(axis=1) & (extent[:, 2:] <= limits[2:]).all(axis=1)
        outside = (extent[:, :2] > limits[2:]).any(axis=1) | (extent[:, 2:] < limits[:2]).any(axis=1)
    clipped = geometries.copy()
    clipped[outside] = shapely.Polygon()
    cut = ~inside & ~outside
    if cut.any():
        clipped[cut] = shapely.intersection(geometries[cut], box_of(bounds))
    return clipped
