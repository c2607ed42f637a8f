import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.safety.area import AllowedGround, Circle, Polygon
from reasoned_explorer.vehicles.safety.cause import Cause

SQUARE = Polygon(((0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)))
#: A U: the straight way from arm to arm leads over what it does not enclose.
HORSESHOE = Polygon(((0, 0), (30, 0), (30, 30), (20, 30), (20, 10), (10, 10), (10, 30), (0, 30)))
metres = st.floats(-40.0, 70.0)


@pytest.mark.parametrize(("x", "y", "inside"), [(10, 10, 10.0), (1, 10, 1.0), (-3, 10, -3.0), (23, 24, -5.0)])
def test_a_polygon_knows_how_far_its_edge_is(x, y, inside):
    assert SQUARE.inside_by_m(x, y) == pytest.approx(inside)


def test_a_way_ends_at_the_last_allowed_point():
    reach = AllowedGround(SQUARE, margin_m=1.0).reach(Pose(10.0, 10.0), 10.0, 40.0)
    assert (reach.x_m, reach.y_m, reach.length_m) == pytest.approx((10.0, 19.0, 9.0), abs=0.03)
    assert reach.cause is Cause.FENCE


def test_a_way_out_and_in_again_ends_where_it_leads_out():
    reach = AllowedGround(HORSESHOE).reach(Pose(5.0, 20.0), 25.0, 20.0)
    assert reach.x_m == pytest.approx(10.0, abs=0.03)


def test_ground_to_keep_out_of_also_as_a_question():
    ring = AllowedGround(None, (Circle(10.0, 0.0, 3.0),), margin_m=1.0).reach(Pose(0.0, 0.0), 20.0, 0.0)
    asked = AllowedGround(keep_out_at=lambda x, _: x > 6.0).reach(Pose(0.0, 0.0), 20.0, 0.0)
    assert (ring.cause, asked.cause) == (Cause.KEEP_OUT, Cause.KEEP_OUT)
    assert ring.x_m == pytest.approx(6.0, abs=0.05)
    assert 5.7 < asked.x_m <= 6.0


def test_from_too_near_an_edge_one_may_go_in_but_not_along():
    ground = AllowedGround(SQUARE, margin_m=2.0)
    assert ground.reach(Pose(0.5, 10.0), 10.0, 10.0).cause is None
    assert ground.reach(Pose(0.5, 10.0), 0.1, 10.0).length_m < 0.05


def test_from_outside_one_may_come_back_in():
    ground = AllowedGround(SQUARE, margin_m=1.0)
    assert ground.reach(Pose(-2.0, 10.0), 10.0, 10.0).cause is None
    assert ground.reach(Pose(-2.0, 10.0), -1.0, 10.0).length_m == 0.0


@given(metres, metres, metres, metres, st.floats(0.0, 3.0), st.sampled_from([SQUARE, HORSESHOE, Circle(10, 10, 15)]))
def test_a_leg_that_is_let_through_never_ends_or_leads_outside(x0, y0, x1, y1, margin_m, fence):
    here, ground = Pose(x0, y0), AllowedGround(fence, (Circle(5.0, 5.0, 2.0),), margin_m=margin_m)
    reach = ground.reach(here, x1, y1)
    start_m, _ = ground.clearance(x0, y0)
    if reach.length_m == 0.0:
        return
    assert ground.clearance(reach.x_m, reach.y_m)[0] >= 0.0
    for share in (0.25, 0.5, 0.75):
        x, y = x0 + share * (reach.x_m - x0), y0 + share * (reach.y_m - y0)
        assert ground.clearance(x, y)[0] >= min(margin_m, start_m) - 0.03


@pytest.mark.parametrize(
    "points", [((0, 0), (1, 1)), ((0, 0), (1, 1), (2, 2)), ((0, 0), (1, math.nan), (2, 0)), ((0, 0), (1, 0), ("a", 1))]
)
def test_corners_that_enclose_nothing_are_refused(points):
    with pytest.raises(SettingsError, match="polygon"):
        Polygon(points)


@pytest.mark.parametrize("radius_m", [0.0, -1.0, math.inf, math.nan])
def test_circles_that_are_none_are_refused(radius_m):
    with pytest.raises(SettingsError, match="radius"):
        Circle(0.0, 0.0, radius_m)
