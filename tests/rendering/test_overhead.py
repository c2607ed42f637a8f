"""Pictures from straight above."""

import math

import numpy as np
import pytest

from reasoned_explorer.model import SettingsError
from reasoned_explorer.rendering.conditions import PRESETS
from reasoned_explorer.rendering.overhead import overhead
from tests.rendering.things import FIRST, box, scene_of

SCENE = scene_of([(box((4.0, 4.0, 6.0)), (10.0, 20.0, 0.0)), (box((2.0, 2.0, 1.0)), (-20.0, 0.0, 0.0))])


def _middle(instances: np.ndarray, instance: int) -> tuple[float, float]:
    row, column = np.argwhere(instances == instance).mean(axis=0) + 0.5
    return float(column), float(row)


def test_things_lie_where_a_map_has_them() -> None:
    picture = overhead(SCENE, 0.0, 0.0, span_m=60.0, width_px=240, height_px=240)
    # Four pixels a metre, north on top.
    assert _middle(picture.instances, FIRST) == pytest.approx((120 + 40, 120 - 80), abs=0.6)
    assert _middle(picture.instances, FIRST + 1) == pytest.approx((120 - 80, 120), abs=0.6)
    assert (picture.instances == FIRST).sum() == pytest.approx(16 * 16, abs=20)
    assert (picture.instances == 0).sum() == 0


def test_its_depth_is_the_height_above_the_ground() -> None:
    picture = overhead(SCENE, 0.0, 0.0, span_m=60.0, width_px=240, height_px=240)
    assert picture.depth_m[picture.instances == 1] == pytest.approx(0.0, abs=0.005)
    assert picture.depth_m[40, 160] == pytest.approx(6.0, abs=0.005)


def test_walls_hardly_lean() -> None:
    """A wall of 12 metres at the picture's corner is seen as half a pixel."""
    tower = scene_of([(box((4.0, 4.0, 12.0)), (27.0, 27.0, 0.0))])
    picture = overhead(tower, 0.0, 0.0, span_m=60.0, width_px=240, height_px=240)
    assert _middle(picture.instances, FIRST) == pytest.approx((120 + 108, 120 - 108), abs=0.8)


def test_the_heading_is_on_top() -> None:
    picture = overhead(SCENE, 0.0, 0.0, span_m=60.0, width_px=240, height_px=240, heading_rad=math.pi / 2)
    assert _middle(picture.instances, FIRST + 1) == pytest.approx((120, 120 + 80), abs=0.6)


def test_fog_hides_nothing_from_above() -> None:
    red = scene_of([(box((20.0, 20.0, 3.0), (0.9, 0.1, 0.1)), (0.0, 0.0, 0.0))])
    colour = overhead(red, 0.0, 0.0, span_m=60.0, width_px=64, height_px=64, conditions=PRESETS["fog"]).colour
    assert int(colour[32, 32, 0]) - int(colour[32, 32, 1]) > 80


@pytest.mark.parametrize("span_m", [0.0, 1e5, math.nan])
def test_a_span_out_of_range_is_refused(span_m: float) -> None:
    with pytest.raises(SettingsError, match="metres"):
        overhead(SCENE, 0.0, 0.0, span_m=span_m)
