"""The sheet of all classes."""

import numpy as np
import pytest

from reasoned_explorer.model import UnknownNameError
from reasoned_explorer.rendering.contact_sheet import close_up, contact_sheet


def test_the_sheet_has_a_cell_for_each_class_in_order() -> None:
    drawn: list[str] = []
    names = ["bench", "car", "cafe", "lawn", "street_lamp"]
    sheet = contact_sheet(cell_px=48, columns=3, class_names=names, on_class=drawn.append)
    assert drawn == names
    assert sheet.shape == (2 * (48 + 24) + 4, 3 * 52 + 4, 3)
    bench = close_up("bench", side_px=48)
    assert (sheet[4:52, 4:52] == bench).all()
    # Under each picture stands its name, and the last cell is empty.
    assert (sheet[52:72, 4:52].min(axis=2) < 120).any()
    assert (sheet[80:, 110:] == sheet[0, 0]).all()


def test_somebody_stands_beside_the_thing() -> None:
    """With a lamp of six metres he is small, with a hydrant large: what is white in his clothes tells."""
    whites = [int((close_up(name, side_px=96).min(axis=2) > 235).sum()) for name in ("street_lamp", "fire_hydrant")]
    assert whites[1] > 4 * whites[0] > 0


def test_the_sun_lights_fronts() -> None:
    assert np.median(close_up("cafe", side_px=64)) > 90


def test_an_unknown_class_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="bench"):
        close_up("bensh")
