"""How buildings are built follows from their kind, their size and a draw of their own."""

from dataclasses import replace

import numpy as np
import pytest

from reasoned_explorer.rendering.building_styles import Family, Styles, mixed_draw, styles_of
from reasoned_explorer.rendering.footprints import Footprints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.world.world import Building
from tests.world.worlds import box


def styles_for(*buildings: Building, seed: int = 0) -> Styles:
    return styles_of(buildings, Footprints.of(buildings), seed=seed)


def row_of(kind: str, *, height_m: float = 12.0, count: int = 40) -> list[Building]:
    return [Building(outer=box(40 * i, 0, 40 * i + 25, 18), height_m=height_m, kind=kind) for i in range(count)]


@pytest.mark.parametrize(
    ("kind", "family"),
    [("detached", Family.HOUSE), ("apartments", Family.FLATS), ("university", Family.OFFICE), ("retail", Family.SHOP),
     ("warehouse", Family.HALL), ("cathedral", Family.CHURCH), ("garage", Family.HUT),
     ("greenhouse", Family.GLASSHOUSE)],
)  # fmt: skip
def test_kinds_decide_families(kind: str, family: Family) -> None:
    assert set(styles_for(*row_of(kind)).family.tolist()) == {family}


def test_what_the_map_does_not_say_follows_from_size() -> None:
    shed = Building(outer=box(0, 0, 5, 4), height_m=3.5)
    cottage = Building(outer=box(0, 0, 11, 9), height_m=7.0)
    palace = Building(outer=box(0, 0, 90, 70), height_m=20.0)
    assert styles_for(shed, cottage, palace).family.tolist() == [Family.HUT, Family.HOUSE, Family.OFFICE]
    assert len(set(styles_for(*row_of("yes")).family.tolist())) == 3


def test_a_thin_slab_overhead_is_a_canopy_and_one_on_the_ground_is_not() -> None:
    slab = Building(outer=box(0, 0, 20, 8), height_m=5.0, min_height_m=4.4)
    families = styles_for(slab, replace(slab, min_height_m=0.0, kind="roof")).family.tolist()
    assert families == [Family.CANOPY, Family.HUT]


def test_a_street_is_not_all_of_one_kind() -> None:
    styles = styles_for(*row_of("yes", height_m=16.0, count=80))
    assert len(set(styles.windows.tolist())) == 3
    assert 5 < styles.shops.sum() < 60
    assert len(np.unique(np.round(styles.windows_colour, 3), axis=0)) > 40


def test_walls_without_windows_match_those_with() -> None:
    styles = styles_for(*row_of("apartments", count=60))
    brick = styles.windows == Material.FACADE_BRICK
    plastered = styles.windows == Material.FACADE
    assert brick.any()
    assert (styles.plain[brick] == Material.BRICK).all()
    np.testing.assert_array_equal(styles.plain_colour[plastered], styles.windows_colour[plastered])


def test_low_buildings_have_no_ground_floor_apart() -> None:
    styles = styles_for(*row_of("retail", height_m=5.0))
    np.testing.assert_array_equal(styles.ground_m, styles.base_m)
    assert not styles.shops.any()


def test_a_draw_depends_on_key_and_purpose_alone() -> None:
    keys = np.arange(2000).astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    draw = mixed_draw(keys, 3)
    np.testing.assert_array_equal(mixed_draw(keys[::-1], 3)[::-1], draw)
    assert abs(draw.mean() - 0.5) < 0.03
    assert abs(np.corrcoef(draw, mixed_draw(keys, 4))[0, 1]) < 0.1
    assert draw.min() >= 0.0
    assert draw.max() < 1.0
