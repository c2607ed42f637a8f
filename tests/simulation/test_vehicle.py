import asyncio
import math

import numpy as np
import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import Camera, LegOutcome, PartError, SettingsError, StartError
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.vehicle import SimulatedVehicle, check_start
from reasoned_explorer.vehicles.profile import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Building, Region, World, WorldObject

MEADOW = Pose(30.0, 30.0)


def box(min_x: float, min_y: float, max_x: float, max_y: float) -> np.ndarray:
    return np.array([(min_x, min_y), (max_x, min_y), (max_x, max_y), (min_x, max_y)], dtype=np.float64)


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """A meadow of 100 m with a pond, a house with a court, a roof on posts, a tree, and a car facing east."""
    return Atlas(
        World(
            name="meadow",
            bounds=Bounds(0.0, 0.0, 100.0, 100.0),
            regions=(
                Region(Ground.GRASS, box(0.0, 0.0, 100.0, 100.0)),
                Region(Ground.WATER, box(60.0, 0.0, 70.0, 100.0), name="pond"),
            ),
            ways=(),
            buildings=(
                Building(box(20.0, 40.0, 40.0, 60.0), 10.0, holes=(box(26.0, 46.0, 34.0, 54.0),), name="Old House"),
                Building(box(80.0, 10.0, 90.0, 20.0), 5.0, kind="roof", min_height_m=3.0),
            ),
            objects=(
                WorldObject(0, "tree", 50.0, 20.0, size_m=(6.0, 6.0, 9.0)),
                WorldObject(1, "car", 50.0, 80.0, math.pi / 2, size_m=(4.4, 1.8, 1.5)),
                WorldObject(2, "bench", 10.0, 80.0, 0.0, size_m=(1.8, 0.6, 0.85)),
            ),
        )
    )


class RecordingEyes:
    """Remembers where cameras really looked from."""

    def __init__(self) -> None:
        self.poses: list[Pose] = []

    def look(self, pose: Pose, camera: Camera) -> ViewContent:
        self.poses.append(pose)
        return ViewContent((), (), 0.0, math.inf)


def mission(atlas, name, script, *, start=MEADOW, eyes=None, seed=3, **more):
    """Run a script with a vehicle on a virtual clock and return what it returns."""
    clock = VirtualClock()

    async def run():
        vehicle = SimulatedVehicle(
            atlas, PROFILES[name], start, clock=clock, eyes=eyes or RecordingEyes(), seed=seed, **more
        )
        async with vehicle:
            return await script(vehicle, clock)

    return clock.run(run())


def go(atlas, name, *targets, **more):
    async def script(vehicle, clock):
        return [await vehicle.go_to(Pose(x, y)) for x, y in targets]

    return mission(atlas, name, script, **more)


def test_a_leg_takes_its_time_on_the_clock_and_its_track_is_in_mission_time(atlas):
    async def script(vehicle, clock):
        await clock.think(7.0)
        leg = await vehicle.go_to(Pose(30.0, 37.0))
        return leg, clock.now_s(), vehicle.true_pose

    leg, now_s, pose = mission(atlas, "drone-authors", script)
    assert leg.outcome is LegOutcome.ARRIVED
    assert now_s == pytest.approx(7.0 + leg.duration_s)
    assert leg.duration_s == pytest.approx(13.2, abs=0.5)
    assert leg.track[0].t_s == pytest.approx(7.0)
    assert leg.track[-1].t_s == pytest.approx(now_s)
    assert (leg.track[-1].x_m, leg.track[-1].y_m) == pytest.approx((pose.x_m, pose.y_m))
    assert {point.z_m for point in leg.track} == {PROFILES["drone-authors"].camera_height_m}
    assert leg.localization_rms_m == pytest.approx(0.02, abs=0.02)


@pytest.mark.parametrize(
    ("name", "target", "detail"),
    [
        ("drone", (30.0, 50.0), "wall of a building"),
        ("go1", (30.0, 50.0), "wall of a building"),
        ("go1", (70.0, 30.0), "water"),
        ("go1", (50.0, 10.0), "tree"),
    ],
)
def test_what_was_hit_is_said(atlas, name, target, detail):
    start = Pose(50.0, 30.0) if detail == "tree" else Pose(30.0, 30.0)
    (leg,) = go(atlas, name, target, start=start)
    assert leg.outcome is LegOutcome.COLLISION
    assert leg.detail == detail
    assert math.hypot(leg.track[-1].x_m - target[0], leg.track[-1].y_m - target[1]) > 5.0


def test_things_below_a_flyer_do_not_stop_it(atlas):
    assert go(atlas, "drone", (10.0, 90.0), start=Pose(10.0, 70.0))[0].outcome is LegOutcome.ARRIVED
    assert go(atlas, "go1", (10.0, 90.0), start=Pose(10.0, 70.0))[0].detail == "bench"


def test_a_flyer_crosses_water_and_the_authors_drone_crosses_walls(atlas):
    assert go(atlas, "drone", (75.0, 30.0), start=Pose(55.0, 30.0))[0].outcome is LegOutcome.ARRIVED
    assert go(atlas, "drone-authors", (30.0, 65.0))[0].outcome is LegOutcome.ARRIVED


def test_a_roof_can_be_gone_under(atlas):
    assert go(atlas, "go1", (85.0, 25.0), start=Pose(85.0, 5.0))[0].outcome is LegOutcome.ARRIVED


def test_the_edge_of_the_world_stops_and_is_no_collision(atlas):
    (leg,) = go(atlas, "drone", (30.0, -10.0), start=Pose(30.0, 5.0))
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "edge of the world")
    assert leg.track[-1].y_m >= 0.0


def test_views_come_in_the_order_asked_for_with_keys_of_their_own(atlas):
    headings = [math.radians(degrees) for degrees in (300.0, 0.0, 60.0)]
    eyes = RecordingEyes()

    async def script(vehicle, clock):
        first = await vehicle.look(headings)
        second = await vehicle.look(headings)
        await vehicle.go_to(Pose(30.0, 35.0))
        third = await vehicle.look(headings[:1])
        return first, second, third, vehicle.pose

    first, second, third, pose = mission(atlas, "drone", script, eyes=eyes)
    assert [view.key for view in first] == [(0, 0, 0), (0, 0, 1), (0, 0, 2)]
    assert [view.key for view in second] == [(0, 1, 0), (0, 1, 1), (0, 1, 2)]
    assert [view.key for view in third] == [(1, 0, 0)]
    assert [view.pose.heading_rad for view in first] == pytest.approx(headings)
    assert all(isinstance(view.content, ViewContent) for view in first)
    # What a view shows is seen from where the camera really is; where it is said to be is the estimate.
    assert eyes.poses[0] != first[0].pose
    assert eyes.poses[0].distance_to_m(30.0, 30.0) == 0.0
    assert eyes.poses[0].z_m == PROFILES["drone"].camera_height_m
    assert first[0].pose.distance_to_m(30.0, 30.0) < 0.1
    assert third[0].pose.distance_to_m(pose.x_m, pose.y_m) == 0.0


def test_the_authors_quadruped_looks_around_in_about_seventeen_seconds(atlas):
    headings = [math.radians(degrees) for degrees in (300.0, 0.0, 60.0)]

    async def script(vehicle, clock):
        views = await vehicle.look(headings)
        return views, clock.now_s(), vehicle.true_pose

    eyes = RecordingEyes()
    views, now_s, pose = mission(atlas, "go1-authors", script, eyes=eyes)
    assert now_s == pytest.approx(17.0, abs=0.5)
    for view, heading, seen in zip(views, headings, eyes.poses, strict=True):
        assert abs(bearing_between_rad(view.pose.heading_rad, heading)) < math.radians(4.0)
        assert abs(bearing_between_rad(seen.heading_rad, heading)) < math.radians(12.0)
    assert abs(bearing_between_rad(pose.heading_rad, headings[-1])) < math.radians(12.0)
    assert pose.distance_to_m(30.0, 30.0) < 0.05


def test_a_quadruped_begins_to_look_at_the_nearer_end(atlas):
    eyes = RecordingEyes()

    async def script(vehicle, clock):
        return await vehicle.look([math.radians(degrees) for degrees in (300.0, 0.0, 60.0)])

    views = mission(atlas, "go1", script, eyes=eyes, start=Pose(30.0, 30.0, 0.0, math.radians(70.0)))
    assert math.degrees(eyes.poses[0].heading_rad) == pytest.approx(60.0, abs=12.0)
    assert math.degrees(views[0].pose.heading_rad) == pytest.approx(300.0, abs=4.0)
    assert [view.key[2] for view in views] == [0, 1, 2]


def test_cancelled_on_its_way_it_stops_there(atlas):
    async def script(vehicle, clock):
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(vehicle.go_to(Pose(30.0, 38.0)), 4.0)
        part = vehicle.last_leg
        again = await vehicle.go_to(Pose(30.0, 38.0))
        return part, again

    part, again = mission(atlas, "go1", script)
    assert (part.outcome, part.detail) == (LegOutcome.STOPPED, "cancelled")
    assert part.duration_s == pytest.approx(4.0, abs=0.1)
    assert 1.0 < part.length_m < 3.2
    assert part.track[-1].y_m == pytest.approx(30.0 + part.length_m, abs=0.1)
    assert again.outcome is LegOutcome.ARRIVED
    assert again.track[0].y_m == pytest.approx(part.track[-1].y_m)


def test_a_link_that_is_told_to_fail_fails_at_its_leg(atlas):
    async def script(vehicle, clock):
        first = await vehicle.go_to(Pose(30.0, 33.0))
        with pytest.raises(PartError, match="link lost"):
            await vehicle.go_to(Pose(30.0, 36.0))
        return first, await vehicle.go_to(Pose(30.0, 36.0))

    legs = mission(atlas, "drone", script, faults={1: "link lost"})
    assert [leg.outcome for leg in legs] == [LegOutcome.ARRIVED, LegOutcome.ARRIVED]


@pytest.mark.parametrize("target", [Pose(math.nan, 1.0), Pose(1.0, math.inf), Pose(1.0, 1.0, 0.0, math.nan)])
def test_a_target_that_is_no_number_is_refused(atlas, target):
    async def script(vehicle, clock):
        with pytest.raises(SettingsError, match="finite"):
            await vehicle.go_to(target)
        with pytest.raises(SettingsError, match="finite"):
            await vehicle.look([target.heading_rad, math.nan])
        return await vehicle.go_to(Pose(30.0, 33.0))

    assert mission(atlas, "drone", script).outcome is LegOutcome.ARRIVED


def test_the_same_seed_gives_the_same_mission_and_another_another(atlas):
    once, twice, other = (go(atlas, "go1", (36.0, 30.0), (33.0, 25.0), seed=seed) for seed in (8, 8, 9))
    assert once == twice
    assert once != other


@pytest.mark.parametrize(
    ("name", "pose", "words"),
    [
        ("drone", Pose(22.0, 50.0), "inside a building .Old House."),
        ("drone-authors", Pose(22.0, 50.0), "inside a building"),
        ("go1", Pose(65.0, 50.0), "water"),
        ("go1", Pose(50.05, 20.0), "tree"),
        ("drone", Pose(-1.0, 50.0), "off the world"),
        ("drone", Pose(50.0, 100.5), "off the world"),
        ("go1", Pose(math.nan, 50.0), "finite"),
        ("go1", Pose(50.0, 50.0, 0.0, math.inf), "finite"),
    ],
)
def test_where_no_mission_can_begin(atlas, name, pose, words):
    with pytest.raises(StartError, match=words):
        check_start(atlas, PROFILES[name], pose)
    with pytest.raises(StartError, match=words):
        SimulatedVehicle(atlas, PROFILES[name], pose, clock=VirtualClock(), eyes=RecordingEyes(), seed=1)


@pytest.mark.parametrize(
    ("name", "pose"),
    [
        ("drone", Pose(65.0, 50.0)),  # over water
        ("go1", Pose(30.0, 50.0)),  # in the court
        ("go1", Pose(85.0, 15.0)),  # under the roof
        ("go1", Pose(0.0, 0.0)),  # in the corner
        ("drone", Pose(19.9, 50.0)),  # before the wall
    ],
)
def test_where_one_can(atlas, name, pose):
    check_start(atlas, PROFILES[name], pose)


def test_all_faults_of_a_start_are_named_at_once(atlas):
    world = atlas.world
    drowned = World(
        "drowned",
        world.bounds,
        (Region(Ground.WATER, box(0.0, 0.0, 100.0, 100.0)),),
        (),
        (),
        (WorldObject(0, "tree", 50.0, 20.0, size_m=(6.0, 6.0, 9.0)),),
    )
    with pytest.raises(StartError) as caught:
        check_start(Atlas(drowned), PROFILES["go1"], Pose(50.0, 20.0))
    assert len(caught.value.faults) == 2
