"""Every served method, called by clients that are not ours: Cosys-AirSim's Python package and AirSim's own.

AirSim's own (1.8.1) needs ``pip install --no-deps --no-build-isolation airsim`` after rpc-msgpack; where it is not
there, its half is skipped.
"""

import importlib
import io
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

pytest.importorskip("msgpackrpc", reason="rpc-msgpack, which the official client speaks through, is not installed")

#: The clients, and which generation of servers they are made for.
CLIENTS = {"cosysairsim": 4, "airsim": 1}


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    return Atlas(open_world("park:7"))


@pytest.fixture(scope="module", params=sorted(CLIENTS))
def airsim(request: pytest.FixtureRequest) -> Any:
    pytest.importorskip(request.param, reason=f"the official client {request.param} is not installed")
    return importlib.import_module(request.param)


@pytest.fixture(scope="module")
def served(airsim: Any, atlas: Atlas) -> Iterator[BackgroundServer]:
    x_m, y_m = _free_spot(atlas)

    def make() -> AirSimServer:
        return AirSimServer(atlas, Pose(x_m, y_m), speed=AS_FAST_AS_ASKED, generation=CLIENTS[airsim.__name__])

    with BackgroundServer(make) as server:
        yield server


def _free_spot(atlas: Atlas) -> tuple[float, float]:
    """Return a point with nothing solid within 25 m at the height of a metre and a half."""
    bounds = atlas.world.bounds
    for x_m in np.arange(bounds.min_x_m + 40.0, bounds.max_x_m - 40.0, 5.0):
        for y_m in np.arange(bounds.min_y_m + 40.0, bounds.max_y_m - 40.0, 5.0):
            near = atlas.sight.obstacles_near(x_m, y_m, x_m, y_m, z_m=1.5, margin_m=25.0)
            if not len(near.walls) and not len(near.discs):
                return float(x_m), float(y_m)
    raise AssertionError("a park without a meadow")


@pytest.fixture
def client(airsim: Any, served: BackgroundServer) -> Any:
    made = airsim.MultirotorClient(port=served.port, timeout_value=60)
    made.reset()
    made.simPause(False)
    made.enableApiControl(True)
    made.armDisarm(True)
    return made


def fly(answer: Any) -> Any:
    """What `join` does, with the answer, which `join` keeps to itself."""
    return answer.get()


def position(client: Any) -> tuple[float, float, float]:
    where = client.simGetVehiclePose().position
    return where.x_val, where.y_val, where.z_val


def test_the_connection_is_confirmed(airsim: Any, client: Any, capsys: pytest.CaptureFixture[str]) -> None:
    client.confirmConnection()
    made_for = CLIENTS[airsim.__name__]
    told = f"Client Ver:{made_for} (Min Req: 1), Server Ver:{made_for} (Min Req: {made_for})"
    assert told in capsys.readouterr().out
    assert client.ping() is True
    assert client.getServerVersion() == made_for
    assert client.getMinRequiredClientVersion() == 1
    assert client.isApiControlEnabled() is True
    assert client.listVehicles() == ["SimpleFlight"]
    assert '"ClockSpeed":1.0' in client.getSettingsString()


def test_nothing_flies_without_control_and_arms(client: Any) -> None:
    client.armDisarm(False)
    with pytest.raises(Exception, match="not armed"):
        fly(client.takeoffAsync())
    client.enableApiControl(False)
    assert client.isApiControlEnabled() is False
    with pytest.raises(Exception, match="API control is not enabled"):
        fly(client.takeoffAsync())
    assert position(client) == (0.0, 0.0, 0.0)


def test_it_takes_off_hovers_and_lands(airsim: Any, client: Any) -> None:
    assert client.getMultirotorState().landed_state == airsim.LandedState.Landed
    assert fly(client.takeoffAsync()) is True
    assert position(client) == (0.0, 0.0, -2.0)
    assert client.getMultirotorState().landed_state == airsim.LandedState.Flying
    assert fly(client.hoverAsync()) is True
    assert fly(client.landAsync()) is True
    assert client.getMultirotorState().landed_state == airsim.LandedState.Landed


def test_it_flies_to_positions_along_paths_to_heights_and_home(airsim: Any, client: Any) -> None:
    fly(client.takeoffAsync())
    yaw = airsim.YawMode(is_rate=False, yaw_or_rate=90.0)
    assert fly(client.moveToPositionAsync(12.0, -5.0, -2.0, 3.0, yaw_mode=yaw)) is True
    assert position(client) == pytest.approx((12.0, -5.0, -2.0), abs=0.3)
    turned = client.simGetVehiclePose().orientation
    assert (turned.w_val, turned.z_val) == pytest.approx((math.cos(math.pi / 4), math.sin(math.pi / 4)), abs=0.05)
    path = [airsim.Vector3r(12.0, 5.0, -2.0), airsim.Vector3r(0.0, 8.0, -4.0)]
    assert fly(client.moveOnPathAsync(path, 3.0)) is True
    assert position(client) == pytest.approx((0.0, 8.0, -4.0), abs=0.3)
    assert fly(client.moveToZAsync(-1.5, 1.0)) is True
    assert position(client)[2] == -1.5
    assert fly(client.goHomeAsync()) is True
    assert position(client) == pytest.approx((0.0, 0.0, 0.0), abs=0.3)


def test_it_flies_by_velocity_and_turns(client: Any) -> None:
    fly(client.takeoffAsync())
    assert fly(client.moveByVelocityAsync(2.0, 0.0, 0.0, 3.0)) is True
    north_m, east_m, _ = position(client)
    assert 4.0 < north_m < 6.1
    assert east_m == pytest.approx(0.0, abs=1e-6)
    assert fly(client.moveByVelocityZAsync(0.0, 1.0, -2.0, 3.0)) is True
    assert fly(client.moveByVelocityBodyFrameAsync(1.0, 0.0, 0.0, 1.0)) is True
    assert fly(client.rotateToYawAsync(-90.0)) is True
    assert client.simGetVehiclePose().orientation.z_val == pytest.approx(-math.sin(math.pi / 4), abs=0.05)
    assert fly(client.rotateByYawRateAsync(30.0, 1.0)) is True
    turned = client.simGetVehiclePose().orientation
    assert math.degrees(2.0 * math.atan2(turned.z_val, turned.w_val)) == pytest.approx(-60.0, abs=4.0)


def test_a_task_can_be_cancelled_where_time_is_held(client: Any) -> None:
    client.simPause(True)
    assert client.simIsPause() is True
    rising = client.takeoffAsync()
    client.simContinueForTime(1.0)
    assert position(client)[2] == pytest.approx(-0.5)
    client.cancelLastTask()
    assert fly(rising) is False
    client.simContinueForTime(5.0)
    assert position(client)[2] == pytest.approx(-0.5)
    client.simPause(False)
    assert client.simIsPause() is False


def test_the_pose_can_be_set_in_part(airsim: Any, client: Any) -> None:
    nan = math.nan
    client.simSetVehiclePose(airsim.Pose(airsim.Vector3r(3.0, 4.0, -2.0), airsim.Quaternionr(0, 0, 1, 0)), True)
    assert position(client) == (3.0, 4.0, -2.0)
    client.simSetVehiclePose(airsim.Pose(airsim.Vector3r(nan, 6.0, nan), airsim.Quaternionr(nan, nan, nan, nan)), True)
    assert position(client) == (3.0, 6.0, -2.0)
    kinematics = client.simGetGroundTruthKinematics()
    assert kinematics.orientation.z_val == pytest.approx(1.0)
    assert kinematics.linear_velocity.x_val == 0.0
    estimated = client.getMultirotorState().kinematics_estimated.position
    assert (estimated.x_val, estimated.y_val) == pytest.approx((3.0, 6.0), abs=0.01)


def test_the_sensors_measure(client: Any) -> None:
    fly(client.takeoffAsync())
    imu = client.getImuData()
    assert imu.linear_acceleration.z_val == pytest.approx(-9.81, abs=0.01)
    assert imu.time_stamp > 0
    assert client.getBarometerData().altitude == pytest.approx(124.0)
    assert client.getBarometerData().pressure < 101_325.0
    field = client.getMagnetometerData().magnetic_field_body
    assert field.x_val > 0.0  # it faces north
    assert field.z_val > 0.0
    gps = client.getGpsData()
    assert gps.is_valid
    assert gps.gnss.fix_type == 3
    assert gps.gnss.geo_point.latitude == pytest.approx(47.641468, abs=1e-6)
    assert client.getHomeGeoPoint().altitude == pytest.approx(122.0)
    assert client.getDistanceSensorData().distance > 20.0
    assert client.simGetGroundTruthEnvironment().gravity.z_val > 9.0


def test_pictures_come_in_all_kinds(airsim: Any, client: Any) -> None:
    fly(client.takeoffAsync())
    kind = airsim.ImageType
    asked = [
        airsim.ImageRequest("front_center", kind.Scene, False, False),
        airsim.ImageRequest("0", kind.Scene, False, True),
        airsim.ImageRequest("front_left", kind.DepthPlanar, True, False),
        airsim.ImageRequest("front_right", kind.Segmentation, False, False),
        airsim.ImageRequest("0", kind.DepthPerspective, True, False),
        airsim.ImageRequest("0", kind.DepthVis, False, True),
    ]
    raw, packed, depth, numbers, perspective, visible = client.simGetImages(asked)
    assert {(one.width, one.height) for one in (raw, packed, depth, numbers)} == {(224, 224)}
    flipped = np.frombuffer(raw.image_data_uint8, np.uint8).reshape(224, 224, 3)[:, :, ::-1]
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(packed.image_data_uint8))), flipped)
    depth_m = airsim.get_pfm_array(depth)
    assert depth_m.shape == (224, 224)
    assert depth_m[-1].max() < 10.0  # the ground before it
    assert (airsim.get_pfm_array(perspective) > 0.0).all()
    assert len(np.unique(np.frombuffer(numbers.image_data_uint8, np.uint8).reshape(-1, 3), axis=0)) > 1
    assert visible.image_data_uint8[:4] == b"\x89PNG"
    assert raw.camera_position.z_val == -2.0
    assert client.simGetImage("front_center", kind.Scene)[:4] == b"\x89PNG"


def test_cameras_say_where_they_look_and_can_be_turned(airsim: Any, client: Any) -> None:
    left = client.simGetCameraInfo("front_left")
    assert left.fov == pytest.approx(90.0)
    assert left.pose.orientation.z_val == pytest.approx(-math.sin(math.pi / 8))
    up = airsim.Pose(airsim.Vector3r(0.1, 0.0, -0.2), airsim.Quaternionr(0.0, math.sin(0.1), 0.0, math.cos(0.1)))
    client.simSetCameraPose("front_left", up)
    client.simSetCameraFov("front_left", 60.0)
    moved = client.simGetCameraInfo("front_left")
    assert moved.pose.position.z_val == pytest.approx(-0.2)
    assert moved.pose.orientation.y_val == pytest.approx(math.sin(0.1))
    assert moved.fov == pytest.approx(60.0)


def test_things_have_names_places_and_numbers(client: Any) -> None:
    benches = client.simListSceneObjects("bench_.*")
    assert benches
    assert set(benches) < set(client.simListSceneObjects())
    where = client.simGetObjectPose(benches[0]).position
    assert math.isfinite(where.x_val)
    assert math.isnan(client.simGetObjectPose("no such thing").position.x_val)
    assert client.simSetSegmentationObjectID("bench_.*", 42, True) is True
    assert {client.simGetSegmentationObjectID(name) for name in benches} == {42}
    assert client.simSetSegmentationObjectID("no such thing", 42) is False
    assert client.simGetSegmentationObjectID("no such thing") == -1


def test_what_is_run_into_is_told_once(airsim: Any, client: Any) -> None:
    assert client.simGetCollisionInfo().has_collided is False
    tree = next(iter(client.simListSceneObjects("tree_.*")))
    at = client.simGetObjectPose(tree).position
    client.simSetVehiclePose(
        airsim.Pose(airsim.Vector3r(at.x_val - 4.0, at.y_val, -1.5), airsim.Quaternionr(0.0, 0.0, 0.0, 1.0)), True
    )
    assert fly(client.moveByVelocityAsync(2.0, 0.0, 0.0, 5.0)) is False
    hit = client.simGetCollisionInfo()
    assert hit.has_collided is True
    assert hit.normal.x_val < 0.0
    assert hit.time_stamp > 0
    assert client.simGetCollisionInfo().has_collided is False
