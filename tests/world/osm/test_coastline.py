"""Coastline has the land on its left."""

import pytest
import shapely

from reasoned_explorer.world.osm.coastline import sea_of
from reasoned_explorer.world.world import Bounds

_BOUNDS = Bounds(-100.0, -100.0, 100.0, 100.0)


def _area(*lines: list[tuple[float, float]]) -> float:
    return sum(polygon.area for polygon in sea_of([shapely.LineString(line) for line in lines], _BOUNDS).polygons)


def test_without_coastline_there_is_no_sea() -> None:
    assert sea_of([], _BOUNDS).polygons == ()


def test_the_water_is_on_the_right() -> None:
    eastward = [(-500.0, 0.0), (500.0, 0.0)]
    (sea,) = sea_of([shapely.LineString(eastward)], _BOUNDS).polygons
    assert sea.contains(shapely.Point(0, -50))
    assert sea.area == pytest.approx(200 * 100)
    (other,) = sea_of([shapely.LineString(eastward[::-1])], _BOUNDS).polygons
    assert other.contains(shapely.Point(0, 50))


def test_an_island_drawn_counter_clockwise_lies_in_the_sea() -> None:
    island = [(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0), (-50.0, -50.0)]
    assert _area(island) == pytest.approx(200 * 200 - 100 * 100)
    assert _area(island[::-1]) == pytest.approx(100 * 100)


def test_the_coast_may_come_in_pieces_of_any_order() -> None:
    whole = _area([(-500.0, 0.0), (0.0, 10.0), (500.0, 0.0)])
    assert _area([(0.0, 10.0), (500.0, 0.0)], [(-500.0, 0.0), (0.0, 10.0)]) == pytest.approx(whole)


def test_loose_ends_are_led_to_the_nearest_edge() -> None:
    sea = sea_of([shapely.LineString([(-95.0, 0.0), (95.0, 0.0)])], _BOUNDS)
    assert sea.loose_ends == 2
    assert sum(polygon.area for polygon in sea.polygons) == pytest.approx(200 * 100, rel=0.01)


def test_coast_outside_says_nothing() -> None:
    assert _area([(900.0, -10.0), (900.0, 10.0)]) == 0.0
