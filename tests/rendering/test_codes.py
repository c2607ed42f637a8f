"""Ids and depths as pictures."""

import numpy as np

from reasoned_explorer.rendering.codes import coded_colours, millimetres


def test_each_code_has_a_colour_of_its_own() -> None:
    codes = np.arange(600, dtype=np.int32).reshape(20, 30)
    colours = coded_colours(codes)
    assert colours.shape == (20, 30, 3)
    assert len(np.unique(colours.reshape(-1, 3), axis=0)) == 600
    assert (colours[0, 0] == 0).all()
    # Codes next to each other, as neighbours in a street have, are told apart at a glance.
    steps = np.abs(np.diff(colours.reshape(-1, 3).astype(int), axis=0)).sum(axis=1)
    assert steps.min() > 60


def test_a_code_has_the_same_colour_in_every_picture() -> None:
    some, others = np.array([[7, 9]], np.int32), np.array([[1, 2, 3, 9]], np.uint8)
    assert (coded_colours(some)[0, 1] == coded_colours(others)[0, 3]).all()


def test_depths_are_whole_millimetres_and_nothing_is_zero() -> None:
    depth_m = np.array([[0.0, 1.2344, 65.535, 900.0, np.inf, -np.inf]], np.float32)
    assert millimetres(depth_m).tolist() == [[0, 1234, 65535, 65535, 0, 0]]
    assert millimetres(depth_m).dtype == np.uint16
