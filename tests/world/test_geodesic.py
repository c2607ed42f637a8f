"""Shortest ways, checked against visibility graphs made with shapely."""

import dataclasses
import heapq
import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import InputError
from reasoned_explorer.world.geodesic import Geodesics, Traveller
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region, World
from tests.world.worlds import box, courtyard, field

WALKER = Traveller(flies=False, radius_m=0.35)
FLYER = Traveller(flies=True, radius_m=0.3)
GHOST = Traveller(flies=True, radius_m=0.3, collides=False)
POINT = Traveller(flies=False, radius_m=0.0)


def geodesics_of(world: World) -> Geodesics:
    return Geodesics.of(world, GroundRaster.of(world))


@pytest.fixture(scope="module")
def court() -> Geodesics:
    return geodesics_of(courtyard())


def length(way) -> float:
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def true_length(a, b, obstacles: list[shapely.Polygon]) -> float:
    """Return the shortest length from a to b around obstacles, by Dijkstra's search of the visibility graph."""
    block = shapely.union_all(obstacles).buffer(-1e-6)
    shapely.prepare(block)
    spots = [a, b, *{tuple(p) for o in obstacles for p in o.exterior.coords}]
    pairs = [(i, k) for i, k in itertools.combinations(range(len(spots)), 2)]
    lines = shapely.linestrings([[spots[i], spots[k]] for i, k in pairs])
    roads: dict[int, list[tuple[int, float]]] = {i: [] for i in range(len(spots))}
    for (i, k), line, hidden in zip(pairs, lines, shapely.intersects(block, lines), strict=True):
        if not hidden:
            roads[i].append((k, line.length))
            roads[k].append((i, line.length))
    best, queue = {0: 0.0}, [(0.0, 0)]
    while queue:
        so_far, i = heapq.heappop(queue)
        if i == 1:
            return so_far
        for k, more in roads[i]:
            if so_far + more < best.get(k, math.inf):
                best[k] = so_far + more
                heapq.heappush(queue, (so_far + more, k))
    return math.inf


@st.composite
def towns(draw):
    """Draw a field of 120 m with turned houses that keep apart, and two free points."""
    houses: list[shapely.Polygon] = []
    for _ in range(draw(st.integers(1, 6))):
        x, y = draw(st.floats(20.0, 100.0)), draw(st.floats(20.0, 100.0))
        sides = [draw(st.floats(6.0, 40.0)) / 2 for _ in range(2)]
        turn = draw(st.floats(0.0, 1.5))
        ring = np.asarray([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * sides
        ring = ring @ np.asarray([(math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))]) + (x, y)
        house = shapely.Polygon(ring)
        # Alleys narrower than a few cells are another question (below).
        if house.within(shapely.box(5, 5, 115, 115)) and all(house.distance(other) > 4.0 for other in houses):
            houses.append(house)
    assume(houses)
    ends = [(draw(st.floats(1.0, 119.0)), draw(st.floats(1.0, 119.0))) for _ in range(2)]
    assume(all(house.distance(shapely.Point(end)) > 1.5 for house in houses for end in ends))
    world = field(
        size_m=120.0,
        buildings=[Building(np.asarray(house.exterior.coords)[:-1], 9.0) for house in houses],
    )
    return world, houses, *ends


@settings(deadline=None, max_examples=60)
@given(towns())
def test_ways_are_as_short_as_the_visibility_graphs(town):
    world, houses, a, b = town
    geodesics = geodesics_of(world)
    truth = true_length(a, b, houses)
    way = geodesics.path(a, b, traveller=POINT)
    tolerance = 0.02 * truth + 1.0
    assert length(way) == pytest.approx(truth, abs=tolerance)
    assert geodesics.distance_m(a, b, traveller=POINT) == length(way)
    assert geodesics.field_m(b, traveller=POINT).at(*a) == pytest.approx(truth, abs=tolerance)
    np.testing.assert_allclose(way[[0, -1]], (a, b), atol=1e-3)
    # Corners are cut by no more than the cells that stand for a wall do.
    inner = shapely.union_all([house.buffer(-1.0) for house in houses])
    assert not shapely.LineString(way).intersects(inner)


@settings(deadline=None, max_examples=40)
@given(towns())
def test_the_way_back_is_as_long(town):
    world, _, a, b = town
    geodesics = geodesics_of(world)
    there, back = (geodesics.distance_m(*ends, traveller=WALKER) for ends in ((a, b), (b, a)))
    assert there == pytest.approx(back, rel=0.01, abs=0.5)


@settings(deadline=None, max_examples=50)
@given(*[st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 100.0))] * 2)
def test_open_ground_is_crossed_straight(a, b):
    geodesics = geodesics_of(field())
    assert geodesics.distance_m(a, b, traveller=WALKER) == pytest.approx(math.dist(a, b), abs=1e-3)
    assert geodesics.field_m(b, traveller=WALKER).at(*a) == pytest.approx(math.dist(a, b), abs=1e-3)


def test_walkers_go_round_the_pond_and_flyers_over_it(court):
    around = 2 * math.hypot(5, 10) + 20
    assert court.distance_m((65, 60), (95, 60), traveller=WALKER) == pytest.approx(around, abs=0.7)
    assert court.distance_m((65, 60), (95, 60), traveller=FLYER) == pytest.approx(30.0, abs=1e-3)


def test_nobody_flies_through_a_house_but_the_one_that_does_not_collide(court):
    assert court.distance_m((5, 60), (65, 60), traveller=FLYER) > 63.0
    assert court.distance_m((5, 60), (65, 60), traveller=GHOST) == pytest.approx(60.0)


def test_a_roof_is_walked_under(court):
    assert court.distance_m((75, 15), (95, 15), traveller=WALKER) == pytest.approx(20.0, abs=1e-3)


def test_a_closed_court_is_not_reached(court):
    assert court.path((35, 60), (35, 40), traveller=WALKER) is None
    assert court.distance_m((35, 60), (35, 40), traveller=WALKER) == math.inf
    assert court.field_m((35, 40), traveller=WALKER).at(35, 60) == math.inf
    assert court.field_m((35, 40), traveller=WALKER).descend(35, 60) is None
    stretches = {court.reachable_component(35, y, traveller=WALKER) for y in (60, 40, 30)}
    assert len(stretches) == 2
    assert 0 not in stretches


def test_entrances_on_a_wall_are_reached_from_outside(court):
    # The nearest free cell of the north house's entrance may be in its court or in the street.
    assert court.distance_m((35, 40), (35, 50), traveller=WALKER) == pytest.approx(10.0, abs=0.8)
    assert court.distance_m((35, 50), (35, 40), traveller=WALKER) == pytest.approx(10.0, abs=0.8)


def test_what_is_deep_in_a_house_is_nowhere(court):
    assert court.distance_m((35, 40), (17.5, 60.0), traveller=WALKER) == math.inf
    assert court.reachable_component(17.5, 60.0, traveller=WALKER) == 0
    assert court.path((35, 40), (500.0, 500.0), traveller=WALKER) is None


def test_solid_things_are_walked_around_by_the_width_of_a_body():
    wall = [("car", 50.0, float(y)) for y in range(40, 61, 4)]
    row = geodesics_of(field(*wall))
    thin, wide = (row.distance_m((40, 50), (60, 50), traveller=Traveller(flies=False, radius_m=r)) for r in (0.0, 2.0))
    # Cars face north: 4.4 m across, 1.8 m along the wall, so that there are gaps of 2.2 m between them.
    assert thin == pytest.approx(20.0, abs=0.5)
    assert wide > 25.0


def test_of_a_tree_only_the_trunk_stands_in_the_way():
    around = geodesics_of(field(("tree", 50.5, 50.5))).distance_m((40.5, 50.5), (60.5, 50.5), traveller=WALKER)
    assert 20.0 < around < 20.5


def test_an_outline_stands_in_the_way_where_the_thing_is_solid():
    world = field(("fountain", 50.0, 50.0), ("playground", 50.0, 20.0))
    big = tuple(
        type(item)(item.id, item.class_name, item.x_m, item.y_m, outline=box(45, item.y_m - 15, 55, item.y_m + 15))
        for item in world.objects
    )
    geodesics = geodesics_of(World(world.name, world.bounds, world.regions, (), (), big))
    assert geodesics.distance_m((40, 50), (60, 50), traveller=POINT) == pytest.approx(
        2 * math.hypot(5, 15) + 10, abs=1.0
    )
    assert geodesics.distance_m((40, 20), (60, 20), traveller=POINT) == pytest.approx(20.0, abs=1e-3)


def test_compliant_ways():
    # A lawn of 30 m × 40 m on a plaza, with a gap of unknown ground; and a flower bed 3 m wide.
    lawn = Region(Ground.GRASS, box(35, 30, 65, 70))
    bed = Region(Ground.GARDEN, box(35, 0, 38, 10))
    geodesics = geodesics_of(field(ground=Ground.PLAZA, regions=[lawn, bed]))
    off_lawn = {"traveller": POINT, "shunned": frozenset({Ground.GRASS, Ground.GARDEN})}
    # Two metres of the lawn's edge are tolerated.
    truth = true_length((20, 50), (80, 50), [shapely.box(37, 32, 63, 68)])
    assert geodesics.distance_m((20, 50), (80, 50), **off_lawn) == pytest.approx(truth, rel=0.02)
    assert geodesics.distance_m((20, 50), (80, 50), traveller=POINT) == pytest.approx(60.0)
    assert geodesics.distance_m((20, 5), (80, 5), **off_lawn) == pytest.approx(60.0, abs=1e-3)
    to_plaza = geodesics.distance_m((20, 50), (80, 50), traveller=POINT, allowed=frozenset({Ground.PLAZA}))
    assert to_plaza == pytest.approx(truth, rel=0.02)


def test_who_strays_less_keeps_farther_off_shunned_ground():
    ways = geodesics_of(field(ground=Ground.PLAZA, regions=[Region(Ground.GRASS, box(20, 0, 80, 60))]))
    lengths = [
        length(
            ways.path(
                (10.0, 30.0),
                (90.0, 30.0),
                traveller=Traveller(flies=True, radius_m=0.0, collides=collides, strays_m=strays_m),
                shunned=frozenset({Ground.GRASS}),
            )
        )
        for collides in (True, False)
        for strays_m in (2.0, 1.0, 0.0)
    ]
    assert lengths[0] < lengths[1] < lengths[2]
    assert lengths[3:] == lengths[:3]


def test_unknown_ground_is_neither_wanted_nor_shunned():
    geodesics = geodesics_of(field(ground=Ground.UNKNOWN, regions=[Region(Ground.PATH, box(0, 0, 100, 10))]))
    way = {"traveller": WALKER, "allowed": frozenset({Ground.PATH})}
    assert geodesics.distance_m((20, 50), (80, 50), **way) == pytest.approx(60.0, abs=1e-3)


def test_the_nearest_of_several_targets_is_meant(court):
    targets = [(95.0, 5.0), (60.0, 40.0), (8.0, 40.0)]
    assert court.distance_m((50, 40), targets, traveller=WALKER) == pytest.approx(10.0, abs=0.3)
    assert court.field_m(targets, traveller=WALKER).at(50, 40) == pytest.approx(10.0, abs=0.3)


def test_a_way_to_a_disc_ends_at_its_edge(court):
    way = court.path((40, 40), (70, 40, 12), traveller=WALKER)
    assert length(way) == pytest.approx(18.0, abs=0.3)
    assert math.dist(way[-1], (70, 40)) == pytest.approx(12.0)
    assert court.distance_m((65, 40), (70, 40, 12), traveller=WALKER) == 0.0
    assert court.distance_m((40, 40), (60.1, 40.1, 0.05), traveller=WALKER) == pytest.approx(20.1, abs=0.5)


def test_masks_of_cells_are_targets(court):
    mask = np.zeros(court.grid.shape, bool)
    mask[:, 90:] = True
    assert court.distance_m((60.5, 40.5), mask, traveller=WALKER) == pytest.approx(30.0, abs=0.5)
    assert court.field_m(mask, traveller=WALKER).at(60.5, 40.5) == pytest.approx(30.0, abs=0.5)
    assert court.distance_m((60, 40), np.zeros(court.grid.shape, bool), traveller=WALKER) == math.inf
    assert court.grid.centres_of(mask)[0].tolist() == [90.5, 0.5]


def test_descending_a_field_leads_to_the_target(court):
    field_ = court.field_m((95, 60), traveller=WALKER)
    at, walked = (7.0, 60.0), 0.0
    for _ in range(20):
        step = field_.descend(*at)
        if step.distance_m < 0.1:
            break
        walked += math.dist(at, (step.x_m, step.y_m))
        assert step.heading_rad == pytest.approx(math.atan2(step.x_m - at[0], step.y_m - at[1]) % math.tau)
        at = step.x_m, step.y_m
    assert at == pytest.approx((95, 60), abs=1e-3)
    assert walked == pytest.approx(field_.at(7.0, 60.0), rel=1e-3)
    assert walked == pytest.approx(court.distance_m((7, 60), (95, 60), traveller=WALKER), rel=0.02)


def test_a_field_falls_along_ways(court):
    lengths = court.field_m((95, 60), traveller=WALKER).lengths_m()
    near, far = lengths[:, :-1], lengths[:, 1:]
    both = np.isfinite(near) & np.isfinite(far)
    # Between neighbours the distance changes by no more than the way between them (and what any-angle ways err by).
    assert np.abs(near[both] - far[both]).max() < 1.5


def test_a_field_reads_no_length_of_a_cell_that_was_not_reached(court):
    field_ = court.field_m((50, 40), traveller=WALKER, max_m=20.0)
    # What stands in memory there before is anything at all: here what cannot even be cast without a warning.
    signalling = np.uint32(0x7FA00000).view(np.float32)
    spoilt = dataclasses.replace(field_, lengths=np.where(field_.links != 0, field_.lengths, signalling))
    np.testing.assert_array_equal(spoilt.lengths_m(), field_.lengths_m())
    assert np.isinf(spoilt.lengths_m()).any()


def test_a_field_ends_where_it_should(court):
    field_ = court.field_m((50, 40), traveller=WALKER, max_m=20.0)
    assert field_.at(65, 40) == pytest.approx(15.0, abs=0.1)
    assert field_.at(75, 40) == math.inf


def test_one_question_leaves_no_trace_in_the_next(court):
    first = court.path((7, 60), (95, 60), traveller=WALKER)
    court.path((50, 40), (60, 40), traveller=WALKER)
    court.path((95, 5), [(7, 60), (8, 70)], traveller=FLYER)
    np.testing.assert_array_equal(court.path((7, 60), (95, 60), traveller=WALKER), first)


def test_bad_input(court):
    with pytest.raises(InputError, match="finite"):
        court.path((math.nan, 0.0), (1.0, 1.0), traveller=WALKER)
    with pytest.raises(InputError, match="finite"):
        court.field_m([(math.inf, 0.0)], traveller=WALKER)
    with pytest.raises(InputError, match=r"shape \(3, 3\)"):
        court.path((1.0, 1.0), np.ones((3, 3), bool), traveller=WALKER)
    with pytest.raises(InputError, match=r"radius of -1\.0"):
        court.path((1.0, 1.0), (5.0, 5.0, -1.0), traveller=WALKER)
    with pytest.raises(InputError, match="shape"):
        court.path((1.0, 1.0), [(5.0, 5.0, 1.0, 1.0)], traveller=WALKER)
    with pytest.raises(InputError, match="max_m"):
        court.field_m((5.0, 5.0), traveller=WALKER, max_m=math.nan)
    with pytest.raises(InputError, match="radius_m"):
        Traveller(flies=False, radius_m=math.nan)
    with pytest.raises(InputError, match="strays_m"):
        Traveller(flies=False, radius_m=0.0, strays_m=2.5)
