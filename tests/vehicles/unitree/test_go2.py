"""The driver of a Go2 against a fake of the vendor's SDK; no robot and no SDK were at hand."""

import asyncio
import math
from importlib.util import find_spec

import pytest

from reasoned_explorer.clock import RealClock, VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome, MissingDependencyError, PartError, SettingsError
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.unitree.go2 import Go2Robot, Go2Vehicle
from reasoned_explorer.vehicles.unitree.robot import Velocity
from tests.vehicles.unitree.fake_unitree_sdk2py import FakeGo2

GO1 = PROFILES["go1"]


@pytest.fixture
def robot(monkeypatch):
    fake = FakeGo2()
    fake.install(monkeypatch)
    with fake:
        yield fake


def driven(script, **more):
    clock = RealClock()

    async def run():
        async with Go2Vehicle(GO1, clock=clock, home=Pose(10.0, 20.0, 0.0, math.pi / 2), **more) as vehicle:
            return await script(vehicle)

    return clock.run(run())


def test_it_walks_a_leg_and_stands(robot):
    async def script(vehicle):
        leg = await vehicle.go_to(Pose(11.0, 20.0, 0.0, math.pi / 2))
        return leg, vehicle.pose, vehicle.battery_percent, vehicle.hottest_motor_c

    leg, pose, battery, hottest = driven(script)
    assert leg.outcome is LegOutcome.ARRIVED, leg
    assert (pose.x_m, pose.y_m) == pytest.approx((11.0, 20.0), abs=0.4)
    # Its frame is x ahead and y left; it faced east.
    assert (robot.x, robot.y) == pytest.approx((pose.x_m - 10.0, pose.y_m - 20.0), abs=0.1)
    assert robot.velocity == (0.0, 0.0, 0.0)
    assert robot.calls[-1] == "StopMove"
    assert (battery, hottest) == (64.0, 41.0)


def test_what_is_to_the_right_is_to_the_left_with_the_sign_changed(robot):
    async def script(vehicle):
        (view,) = await vehicle.look([math.pi])
        return view

    view = driven(script)
    assert view.pose.heading_rad == pytest.approx(math.pi, abs=0.2)
    assert robot.yaw == pytest.approx(-math.pi / 2, abs=0.2)


def test_a_move_that_is_not_said_anew_ends(robot):
    clock = RealClock()

    async def run():
        link = Go2Robot(now_s=clock.now_s)
        await link.start()
        await link.moment(Velocity(0.5))
        assert robot.velocity == (0.5, 0.0, 0.0)
        async with asyncio.timeout(10.0):
            while robot.velocity != (0.0, 0.0, 0.0):
                await asyncio.sleep(0.02)
        await link.close(lies=False)
        await link.close(lies=False)

    clock.run(run())


def test_a_robot_that_falls_silent_is_told_to_stand_and_the_leg_ends(robot):
    async def script(vehicle):
        async def silence():
            await asyncio.sleep(1.0)
            robot.is_silent = True

        silencing = asyncio.create_task(silence())
        leg = await vehicle.go_to(Pose(40.0, 20.0))
        await silencing
        return leg, robot.velocity

    leg, velocity = driven(script)
    assert leg.outcome is LegOutcome.STOPPED
    assert "the link is lost" in leg.detail
    assert velocity == (0.0, 0.0, 0.0)


def test_a_robot_that_refuses_is_a_fault(robot):
    robot.code = 3203

    async def nothing(vehicle):
        return None

    with pytest.raises(PartError, match="StopMove is answered with code 3203"):
        driven(nothing)


@pytest.mark.skipif(find_spec("unitree_sdk2py") is not None, reason="the SDK is installed")
def test_without_the_sdk_it_names_the_command_that_installs_it():
    with pytest.raises(MissingDependencyError, match=r"cyclonedds==0\.10\.2"):
        Go2Vehicle(GO1, clock=RealClock())


def test_middleware_of_another_version_is_refused(monkeypatch):
    FakeGo2().install(monkeypatch, cyclonedds="11.0.1")
    with pytest.raises(SettingsError, match="crashes the robot"):
        Go2Vehicle(GO1, clock=RealClock())


def test_a_clock_that_is_not_real_is_refused():
    with pytest.raises(SettingsError, match="real clock"):
        Go2Vehicle(GO1, clock=VirtualClock())
