"""When frames were taken, by a clock of this computer."""

import pytest

from reasoned_explorer.vehicles.cameras.stamping import Stamper


def test_a_frame_that_waited_on_its_way_is_as_old_as_it_is():
    stamper = Stamper()
    for k in range(20):  # 20 frames a second, each 0.1 s on its way; the camera's clock is 90,000 s ahead
        assert stamper.taken_s(90_000.0 + 0.05 * k, 0.1 + 0.05 * k) == pytest.approx(0.1 + 0.05 * k, abs=1e-3)
    # The network hung for 3 s: what waited there comes all at once, and is not new.
    late = [stamper.taken_s(90_001.0 + 0.05 * k, 4.0) for k in range(20)]
    assert late == pytest.approx([1.1 + 0.05 * k for k in range(20)], abs=0.01)


def test_clocks_that_run_apart_make_no_frame_old():
    stamper = Stamper()
    for k in range(36_000):  # half an hour; the camera's clock is slow by 100 ppm
        told_s, arrived_s = 0.05 * k * (1.0 - 1e-4), 0.05 * k
        assert abs(stamper.taken_s(told_s, arrived_s) - arrived_s) < 0.01


def test_a_stream_that_begins_anew_is_stamped_anew():
    stamper = Stamper()
    stamper.taken_s(500.0, 10.0)
    assert stamper.taken_s(0.0, 20.0) == 20.0
    assert stamper.taken_s(1_000.0, 21.0) == 21.0


def test_a_camera_without_a_clock_is_taken_at_its_arrival():
    assert Stamper().taken_s(None, 7.0) == 7.0
