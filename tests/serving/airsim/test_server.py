"""The served methods against what no client should send: nothing that is refused has done anything."""

import asyncio
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError, SettingsError, StartError
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.airsim.conventions import quaternion, vector
from reasoned_explorer.vehicles.airsim.rpc import RpcClient
from reasoned_explorer.world.atlas import Atlas
from tests.world.worlds import field

pytest.importorskip("msgpack")

HOME = Pose(50.0, 50.0)
ATLAS = Atlas(field(("tree", 62.0, 50.0)))
#: Each method that moves or turns anything, with arguments that are good.
MOVING = {
    "takeoff": [20.0, ""],
    "land": [60.0, ""],
    "goHome": [3e38, ""],
    "moveToZ": [-5.5, 1.25, 3e38, {"is_rate": True, "yaw_or_rate": 0.0}, -1, 1, ""],
    "moveToPosition": [6.0, 7.0, -2.0, 3.0, 3e38, 0, {"is_rate": False, "yaw_or_rate": 0.0}, -1, 1, ""],
    "moveOnPath": [[vector(6.0, 7.0, -2.0)], 3.0, 3e38, 0, {"is_rate": True, "yaw_or_rate": 0.0}, -1, 1, ""],
    "moveByVelocity": [1.25, 0.0, 0.0, 2.0, 0, {"is_rate": True, "yaw_or_rate": 0.0}, ""],
    "moveByVelocityZ": [1.25, 0.0, -2.0, 2.0, 0, {"is_rate": True, "yaw_or_rate": 0.0}, ""],
    "moveByVelocityBodyFrame": [1.25, 0.0, 0.0, 2.0, 0, {"is_rate": True, "yaw_or_rate": 0.0}, ""],
    "rotateToYaw": [30.0, 3e38, 5.0, ""],
    "rotateByYawRate": [30.0, 1.25, ""],
    "simSetVehiclePose": [{"position": vector(1.0, 1.0, -2.0), "orientation": quaternion(0.0, 0.0, 1.0)}, True, ""],
}
#: Time-outs, look-aheads and margins, which are read and not needed.
NOT_NEEDED = (20.0, 60.0, 3e38, -1, 1, 5.0)


def served(script, **more):
    """Run a script with a client of a server whose drone hovers a metre and a half above home."""

    async def run():
        async with AirSimServer(ATLAS, HOME, speed=AS_FAST_AS_ASKED, **more) as server:
            client = RpcClient("127.0.0.1", server.port, deadline_s=60.0)
            try:
                await client.call("enableApiControl", True, "")
                await client.call("armDisarm", True, "")
                await client.call("moveToZ", -1.5, 1.0)
                return await script(client)
            finally:
                await client.close()

    return asyncio.run(run())


NOTHING_GOOD = st.one_of(
    st.none(),
    st.booleans(),
    st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e300, 1 << 63]),
    st.sampled_from(["", "no vehicle", [], {}, [[]], {"x_val": 1}]),
    st.text(max_size=5),
    st.binary(max_size=5),
)


@settings(max_examples=80)
@given(st.sampled_from(sorted(MOVING)), st.data())
def test_a_spoilt_command_is_refused_and_moves_nothing(method, data):
    arguments = list(MOVING[method])
    place = data.draw(st.sampled_from([at for at, good in enumerate(arguments) if good not in NOT_NEEDED]))
    good, spoilt = arguments[place], data.draw(NOTHING_GOOD)
    arguments[place] = spoilt

    async def script(client):
        before = await client.call("simGetVehiclePose", "")
        try:
            await client.call(method, *arguments)
        except PartError:
            assert await client.call("simGetVehiclePose", "") == before
            return
        # What is not refused must have been good: another truth, no vehicle's name, a way of facing without details.
        assert type(spoilt) is type(good)
        assert spoilt in (True, False, "", {}, {"x_val": 1})
        assert not (isinstance(good, dict) and "position" in good)

    served(script)


@pytest.mark.parametrize("method", sorted(MOVING))
def test_the_good_arguments_are_good(method):
    async def script(client):
        return await client.call(method, *MOVING[method])

    assert served(script) in {True, None}


@pytest.mark.parametrize("method", sorted(set(MOVING) - {"simSetVehiclePose"}))
def test_nothing_moves_that_is_not_armed(method):
    async def script(client):
        await client.call("land", 60.0, "")
        await client.call("armDisarm", False, "")
        before = await client.call("simGetVehiclePose", "")
        with pytest.raises(PartError, match="not armed"):
            await client.call(method, *MOVING[method])
        return before == await client.call("simGetVehiclePose", "")

    assert served(script)


def test_in_the_air_it_stays_armed():
    async def script(client):
        return await client.call("armDisarm", False, "")

    assert served(script) is False


@pytest.mark.parametrize(
    ("method", "arguments", "why"),
    [
        ("simGetImages", [[{"camera_name": "nose", "image_type": 0}], ""], "there is no camera 'nose'"),
        ("simGetImages", [[{"camera_name": "0", "image_type": 7}], ""], "kind 7 are not served"),
        ("simGetImages", [[{"camera_name": "0", "image_type": 0, "pixels_as_float": True}], ""], "bytes"),
        ("simGetVehiclePose", ["Ghost"], "there is no vehicle 'Ghost'"),
        (
            "simSetVehiclePose",
            [{"position": vector(1e4, 0.0, 0.0), "orientation": quaternion(0, 0, 0)}, True, ""],
            "off",
        ),
        ("simSetCameraPose", ["0", {"position": vector(0, 0, 0), "orientation": quaternion(0.5, 0, 0)}, ""], "roll"),
        ("simSetSegmentationObjectID", ["(a+)+", 1, True], "regular expression"),
        ("moveToPosition", [9e4, 0.0, -2.0, 3.0], "longer than is flown here"),
        ("moveToPosition", [900.0, 0.0, -2.0, 0.06], "longer than is flown here"),
        ("moveToPosition", [9.0, 0.0, -2.0, 1e-9], "greater than or equal to 0.05"),
        ("moveByVelocity", [1.0, 0.0, 0.0, 1e6], "less than or equal to 600"),
        ("simContinueForTime", [-1.0], "greater than or equal to 0"),
        ("simPause", ["yes"], "valid boolean"),
    ],
)
def test_refusals_say_why(method, arguments, why):
    async def script(client):
        with pytest.raises(PartError, match=why):
            await client.call(method, *arguments)

    served(script)


@pytest.mark.parametrize(("generation", "external"), [(1, [False]), (4, [])])
def test_both_generations_of_arguments_are_taken(generation, external):
    async def script(client):
        info = await client.call("simGetCameraInfo", "front_left", "", *external)
        where = await client.call("simGetObjectPose", "tree_0", *([] if external else [True]))
        return await client.call("getServerVersion"), info["fov"], where["position"]

    version, fov_deg, position = served(script, generation=generation)
    assert version == generation
    assert fov_deg == pytest.approx(90.0)
    assert (position["x_val"], position["y_val"]) == (0.0, 12.0)


def test_giving_control_back_stops_the_vehicle():
    async def script(client):
        await client.call("simPause", True)
        moving = await client.begin("moveToPosition", *MOVING["moveToPosition"])
        await client.call("simContinueForTime", 1.0)
        await client.call("enableApiControl", False, "")
        before = await client.call("simGetVehiclePose", "")
        await client.call("simContinueForTime", 5.0)
        assert await client.outcome(moving) is False
        return before == await client.call("simGetVehiclePose", "")

    assert served(script)


def test_a_walker_bad_settings_and_a_bad_start_are_refused():
    async def make(**more):
        return AirSimServer(ATLAS, more.pop("start", HOME), **more)

    with pytest.raises(SettingsError, match="3 faults"):
        asyncio.run(make(profile=PROFILES["go1"], generation=2, conditions="hail"))
    with pytest.raises(StartError, match="off the world"):
        asyncio.run(make(start=Pose(500.0, 0.0)))
