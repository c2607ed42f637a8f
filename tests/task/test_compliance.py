import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.task.compliance import compliance_of
from reasoned_explorer.world.taxonomy import Ground

FORBIDDEN = frozenset({Ground.GRASS})


class FakeGround:
    """Path for y < 0, grass for 0 ≤ y < width, path beyond; unknown for x > 100."""

    def __init__(self, width_m=1000.0):
        self.width_m = width_m

    def at_many(self, xs_m, ys_m):
        xs, ys = np.asarray(xs_m), np.asarray(ys_m)
        codes = np.where((ys >= 0) & (ys < self.width_m), int(Ground.GRASS), int(Ground.PATH))
        return np.where(xs > 100, int(Ground.UNKNOWN), codes).astype(np.uint8)

    def tolerated(self, xs_m, ys_m):
        return (np.asarray(ys_m) <= 2.0) | (np.asarray(ys_m) >= self.width_m - 2.0) | (np.asarray(xs_m) > 98)


def report(*points, width_m=1000.0, forbidden=FORBIDDEN):
    ground = FakeGround(width_m)
    return compliance_of(points, ground, forbidden, tolerated=ground.tolerated)


def test_a_track_off_forbidden_ground_complies():
    assert report((0, -5), (50, -5)).compliant


def test_without_a_condition_everything_complies():
    assert report((0, -5), (0, 500), forbidden=frozenset()).compliant


def test_walking_along_the_edge_is_tolerated():
    along = report((0, -1), (0, 1.5), (60, 1.5), (60, -1))
    assert along.compliant
    assert along.forbidden_m == pytest.approx(63.0, abs=1.0)


def test_walking_deeper_along_the_edge_is_not():
    assert not report((0, -1), (0, 3.0), (60, 3.0), (60, -1)).compliant


@pytest.mark.parametrize(("width_m", "compliant"), [(3.0, True), (4.5, True), (5.5, False), (8.0, False)])
def test_crossing_counts_from_edge_to_edge(width_m, compliant):
    assert report((0, -10), (0, 30), width_m=width_m).compliant is compliant


def test_two_short_crossings_do_not_add_up():
    track = [(0, -10), (0, 14), (20, 14), (20, -10)]
    assert report(*track, width_m=4.8).compliant


def test_a_violation_happens_after_five_metres():
    assert report((0, -10), (0, 30)).violation_at_m == pytest.approx(15.0, abs=0.3)


def test_unknown_ground_is_neutral():
    assert report((110, -10), (110, 50), (150, 50)).compliant


def test_who_starts_on_forbidden_ground_may_leave_it():
    assert report((0, 10), (0, -5)).compliant
    assert report((0, 10), (8, 5), (0, -5)).compliant


def test_but_may_not_stay_there():
    assert not report((0, 10), (60, 10)).compliant
    assert not report((0, 10), (0, -5), (20, -5), (20, 10)).compliant


def test_a_track_of_one_point_complies():
    assert report((0, 10)).compliant
    assert report().compliant


@given(st.lists(st.tuples(st.floats(-50, 150), st.floats(-30, 30)), min_size=2, max_size=8))
def test_what_is_counted_is_never_more_than_what_was_walked(points):
    found = report(*points, width_m=6.0)
    length_m = sum(math.dist(a, b) for a, b in pairwise(points))
    assert found.longest_stretch_m <= found.forbidden_m + 0.5
    assert found.forbidden_m <= length_m + 1e-6
    assert found.compliant == math.isinf(found.violation_at_m)
    assert found.compliant or found.violation_at_m <= length_m + 1e-6
