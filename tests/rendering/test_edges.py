"""Strips along soft borders: on the true line, of both kinds of ground, not where kerbs and shores are."""

import numpy as np

from reasoned_explorer.rendering.crossings import crossings_of
from reasoned_explorer.rendering.edges import edges
from reasoned_explorer.rendering.ground_map import ground_map_of, ground_materials
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Region, Way, World
from tests.world.worlds import box, field

PATH = Way("path", Ground.PATH, np.array([(10.0, 20.0), (90.0, 70.0)]), 3.0)
STREET = Way("residential", Ground.ROAD, np.array([(0.0, 50.0), (100.0, 50.0)]), 8.0)


def edges_of(world: World) -> list[Patch]:
    return edges(world, ground_map_of(world), crossings_of(world))


def test_a_path_has_straight_edges_of_gravel_and_grass() -> None:
    inner, outer = edges_of(field(ways=[PATH]))
    along = np.array([80.0, 50.0]) / np.hypot(80.0, 50.0)
    for patch, low, high, material in ((inner, 1.28, 1.5, Material.GRAVEL), (outer, 1.5, 1.72, Material.GRASS)):
        off = patch.corners[..., :2] - PATH.line[0]
        aside = np.abs(off[..., 0] * along[1] - off[..., 1] * along[0])
        assert aside.min() > low - 0.01
        assert aside.max() < high + 0.01
        assert (patch.materials == material).all()
        step = patch.corners[:, 1] - patch.corners[:, 0]
        # Both sides, all along, in pieces that are not long.
        assert np.hypot(*step[:, :2].T).sum() > 2.0 * 90.0
        assert np.hypot(*step[:, :2].T).max() <= 10.5
        assert (np.cross(step, patch.corners[:, 2] - patch.corners[:, 0])[:, 2] > 0.0).all()


def test_strips_lie_between_the_ground_and_the_paint_each_kind_in_a_plane_of_its_own() -> None:
    lawn = Region(Ground.GARDEN, box(5, 5, 30, 30))
    square = Region(Ground.PLAZA, box(60, 60, 95, 95))
    heights: dict[tuple[float, ...], set[float]] = {}
    for patch in edges_of(field(ways=[PATH], regions=[lawn, square])):
        assert patch.corners[..., 2].min() > 0.0015
        assert patch.corners[..., 2].max() < 0.0115
        for face, colour, material in zip(patch.corners, patch.colours, patch.materials, strict=True):
            heights.setdefault((*colour.tolist(), float(material)), set()).update(face[:, 2].tolist())
    assert all(len(found) == 1 for found in heights.values())
    assert len(set.union(*heights.values())) == len(heights)


def test_there_are_none_at_kerbs_and_shores_and_none_without_borders() -> None:
    pond = Region(Ground.WATER, box(30, 5, 70, 30))
    found = edges_of(field(ways=[STREET], regions=[pond], ground=Ground.PAVEMENT))
    assert sum(len(patch.corners) for patch in found) == 0
    assert edges_of(World("none", field().bounds, (), (), (), ())) == []


def test_holes_have_edges_too_and_rings_may_run_either_way() -> None:
    ring = Region(Ground.PLAZA, box(20, 20, 80, 80)[::-1], holes=(box(40, 40, 60, 60),))
    inner, outer = edges_of(field(regions=[ring]))
    paved, green = (ground_materials()[kind] for kind in (Ground.PLAZA, Ground.GRASS))
    assert (inner.materials == paved).all()
    assert (outer.materials == green).all()
    middles = outer.corners[..., :2].mean(axis=1)
    in_hole = (np.abs(middles - 50.0) < 10.0).all(axis=1)
    beyond = (np.abs(middles - 50.0) > 30.0).any(axis=1)
    assert in_hole.any()
    assert (in_hole | beyond).all()
