"""Multipolygons, put together the way libosmium does it."""

from collections.abc import Iterator
from pathlib import Path

import osmium
import pytest
import shapely

from reasoned_explorer.world.osm.features import RELATION, features_of
from reasoned_explorer.world.osm.importer import frame_of
from reasoned_explorer.world.osm.reading import read_extract
from tests.world.osm.maps import BBOX, REAL_BBOXES, Map


def _areas(town: Map, folder: Path) -> list:
    origin, bounds = frame_of(BBOX)
    found = features_of(read_extract(town.write(folder)), origin, bounds)
    return [area.shape for area in found.areas if area.kind == RELATION]


def test_rings_in_pieces_holes_and_islands_in_holes(tmp_path: Path) -> None:
    town = Map()
    ids = [town.node(x, y) for x, y in [(0, 0), (100, 0), (100, 100), (0, 100)]]
    pieces = [town.way_of([ids[2], ids[3], ids[0]]), town.way_of([ids[0], ids[1], ids[2]])]
    hole, island = town.box(20, 20, 80, 80), town.box(40, 40, 60, 60)
    members = [(pieces[0], "outer"), (hole, "inner"), (pieces[1], ""), (island, "outer")]
    town.relation(members, {"natural": "wood"})
    (wood,) = _areas(town, tmp_path)
    assert wood.area == pytest.approx(100 * 100 - 60 * 60 + 20 * 20, rel=0.01)


def test_outer_rings_that_share_an_edge_become_one(tmp_path: Path) -> None:
    town = Map()
    ids = [town.node(x, y) for x, y in [(0, 0), (50, 0), (50, 50), (0, 50), (100, 0), (100, 50)]]
    left = town.way_of([ids[0], ids[1], ids[2], ids[3], ids[0]])
    right = town.way_of([ids[1], ids[4], ids[5], ids[2], ids[1]])
    town.relation([(left, "outer"), (right, "outer")], {"landuse": "grass"})
    (grass,) = _areas(town, tmp_path)
    assert grass.area == pytest.approx(50 * 100, rel=0.01)


def test_a_member_named_twice_counts_once(tmp_path: Path) -> None:
    town = Map()
    ring = town.box(0, 0, 30, 30)
    town.relation([(ring, "outer"), (ring, "outer")], {"landuse": "grass"})
    (grass,) = _areas(town, tmp_path)
    assert grass.area == pytest.approx(900, rel=0.01)


def _assembled_by_libosmium(path: Path) -> Iterator[tuple[int, float]]:
    factory = osmium.geom.WKBFactory()
    for item in osmium.FileProcessor(str(path)).with_areas():
        if item.is_area() and not item.from_way():
            yield item.orig_id(), shapely.from_wkb(factory.create_multipolygon(item)).area


@pytest.mark.parametrize("place", sorted(REAL_BBOXES))
def test_whole_multipolygons_are_those_of_libosmium(osm_folder: Path, place: str) -> None:
    path = osm_folder / f"{place}.osm.pbf"
    extract = read_extract(path)
    lines = {}
    for way, line in zip(extract.ways, extract.way_lines, strict=True):
        lines.setdefault(way.osm_id, []).append(line)
    expected = dict(_assembled_by_libosmium(path))
    checked = 0
    for relation in extract.relations:
        if relation.osm_id in expected and all(len(lines.get(way_id, ())) == 1 for way_id in relation.way_ids):
            rings = [lines[way_id][0] for way_id in sorted(set(relation.way_ids))]
            assert shapely.build_area(shapely.multilinestrings(rings)).area == pytest.approx(
                expected[relation.osm_id], rel=1e-6
            ), relation.osm_id
            checked += 1
    assert checked > 5
