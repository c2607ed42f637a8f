"""AirSim's methods, of both generations, with what they answer checked.

The first generation is AirSim and Colosseum, whose server says it has version 1; the second is Cosys-AirSim (versions
from 2 on), where some methods take another last argument.
"""

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.model.errors import PartError
from reasoned_explorer.vehicles.airsim import conventions as conv
from reasoned_explorer.vehicles.airsim.corridor import Corridor
from reasoned_explorer.vehicles.airsim.pictures import ImageType, colour_of, depth_of
from reasoned_explorer.vehicles.airsim.rpc import Pending, RpcClient

T = TypeVar("T")
#: The first version of Cosys-AirSim's server.
_COSYS_FROM = 2
#: AirSim's numbers for how to fly: facing anywhere, and for how far to look ahead on a path: as it likes.
_ANY_FACING, _AUTO_LOOKAHEAD, _ADAPTIVE = 0, -1, 1
#: A flight takes as long as it takes: whoever waits has a deadline of its own.
_NO_LIMIT_S = 3e38
_ASK_AGAIN_S = 0.002


@dataclass(frozen=True, slots=True)
class Moment:
    """Where the vehicle is at a moment of the server's time.

    Attributes:
        t_s: The server's time, seconds.
        believed: Where the vehicle's estimator takes it to be; the height is that of its body.
        speed_mps: Of its body.
        yaw_rate_radps: Positive clockwise.
        landed: Whether it stands on the ground.
    """

    t_s: float
    believed: Pose
    speed_mps: float
    yaw_rate_radps: float
    landed: bool


@dataclass(frozen=True, slots=True)
class Collision:
    """What the vehicle last ran into.

    Attributes:
        collided: Whether it ran into anything since this was last asked.
        t_s: When, on the server's time, seconds.
        name: What it was.
    """

    collided: bool
    t_s: float
    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """A picture and where it was really taken.

    Attributes:
        pose: Of the camera.
        image: RGB, shape (height, width, 3).
    """

    pose: Pose
    image: NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class CameraView:
    """Where a camera really is, and what it sees of the world.

    Attributes:
        pose: Of the camera.
        fov_rad: Its horizontal field of view.
    """

    pose: Pose
    fov_rad: float


class AirSimApi:
    """Calls one vehicle's methods.

    Args:
        client: The link.
        vehicle_name: As the simulator's settings have it; empty for its only one.
        home: Where the vehicle started.
    """

    def __init__(self, client: RpcClient, *, vehicle_name: str = "", home: conv.HomeFrame | None = None) -> None:
        self.client, self.name = client, vehicle_name
        self.home = conv.HomeFrame() if home is None else home
        self.server_version = 1
        self._steps_are_over_when_answered = False

    @property
    def is_cosys(self) -> bool:
        """Whether the server is Cosys-AirSim."""
        return self.server_version >= _COSYS_FROM

    async def confirm(self) -> None:
        """Check that the server answers, and find out of which generation it is.

        Raises:
            PartError: If it does not.
        """
        if await self.client.call("ping") is not True:
            raise PartError("AirSim", "the server answers a ping, but not with true")
        version = await self.client.call("getServerVersion")
        if type(version) is not int or version < 1:
            raise PartError("AirSim", f"the server's version is {version!r:.40}; expected a number from 1 on")
        self.server_version = version

    async def take_control(self) -> None:
        """Have the vehicle listen to this program, with its motors on.

        Raises:
            PartError: If it does not.
        """
        await self.client.call("enableApiControl", True, self.name)  # noqa: FBT003 - the wire's
        if await self.client.call("isApiControlEnabled", self.name) is not True:
            raise PartError("AirSim", "the vehicle does not give control to programs")
        if await self.client.call("armDisarm", True, self.name) is not True:  # noqa: FBT003 - the wire's
            raise PartError("AirSim", "the vehicle does not arm")

    async def release(self) -> None:
        """Motors off, control given back."""
        await self.client.call("armDisarm", False, self.name)  # noqa: FBT003 - the wire's
        await self.client.call("enableApiControl", False, self.name)  # noqa: FBT003 - the wire's

    # Where it is.

    async def moment(self) -> Moment:
        """Return where the vehicle takes itself to be."""
        state = await self.client.call("getMultirotorState", self.name)
        return _read("getMultirotorState", lambda: self._moment(state))

    async def true_pose(self) -> Pose:
        """Return where the simulator knows the vehicle to be."""
        pose = await self.client.call("simGetVehiclePose", self.name)
        return _read("simGetVehiclePose", lambda: self.home.pose(pose["position"], pose["orientation"]))

    async def collision(self) -> Collision:
        """Return what the vehicle last ran into; the server then forgets that it did."""
        told = await self.client.call("simGetCollisionInfo", self.name)
        return _read(
            "simGetCollisionInfo",
            lambda: Collision(told["has_collided"] is True, _seconds(told["time_stamp"]), str(told["object_name"])),
        )

    async def fix_s(self) -> float | None:
        """Return when the satellite receiver last had a position, the server's seconds; None where it has none."""
        told = await self.client.call("getGpsData", "", self.name)
        return _read("getGpsData", lambda: _seconds(told["time_stamp"]) if told["is_valid"] is True else None)

    async def range_m(self, sensor: str) -> float:
        """Return how far something stands before a distance sensor, metres."""
        told = await self.client.call("getDistanceSensorData", sensor, self.name)
        return _read("getDistanceSensorData", lambda: _metres(told["distance"]))

    async def depth_ahead_m(self, camera: str, corridor: Corridor) -> float:
        """Return how far ahead, in the vehicle's heading, a depth picture of a camera shows something, metres."""
        more = {"annotation_name": ""} if self.is_cosys else {}
        wanted = {
            "camera_name": camera,
            "image_type": int(ImageType.DEPTH_PLANAR),
            "pixels_as_float": True,
            "compress": False,
            **more,
        }
        body = await self.true_pose()
        view = await self.camera(camera)
        answers = await self.client.call("simGetImages", [wanted], self.name, *self._external)

        def free_m() -> float:
            (answer,) = answers
            return corridor.free_m(
                depth_of(answer),
                fov_rad=view.fov_rad,
                camera=conv.attitude(answer["camera_orientation"]),
                heading_rad=body.heading_rad,
                height_m=view.pose.z_m,
            )

        return _read("simGetImages", free_m)

    # What it sees.

    async def shots(self, cameras: Sequence[str]) -> list[Shot]:
        """Return pictures of some cameras, taken at one moment."""
        more = {"annotation_name": ""} if self.is_cosys else {}
        wanted = [
            {
                "camera_name": camera,
                "image_type": int(ImageType.SCENE),
                "pixels_as_float": False,
                "compress": False,
                **more,
            }
            for camera in cameras
        ]
        answers = await self.client.call("simGetImages", wanted, self.name, *self._external)
        return _read("simGetImages", lambda: self._shots(answers, len(cameras)))

    async def camera(self, name: str) -> CameraView:
        """Return where a camera is."""
        told = await self.client.call("simGetCameraInfo", name, self.name, *self._external)
        return _read("simGetCameraInfo", lambda: self._camera(told))

    async def aim(self, name: str, bearing_rad: float) -> None:
        """Turn a camera to a bearing from straight ahead; where it sits stays as it is told: at the body's middle."""
        pose = {"position": conv.vector(0.0, 0.0, 0.0), "orientation": conv.quaternion(0.0, 0.0, bearing_rad)}
        await self.client.call("simSetCameraPose", name, pose, self.name, *self._external)

    async def object_pose(self, name: str) -> Pose | None:
        """Return where a thing of the scene is, in the frame of the simulator's world; None where there is none."""
        told = await self.client.call("simGetObjectPose", name, *((True,) if self.is_cosys else ()))
        try:
            return conv.HomeFrame().pose(told["position"], told["orientation"])
        except (KeyError, TypeError, ValueError):
            return None  # AirSim answers with NaN

    # What it does. Each returns at once; the answer says when it is over and whether it came about.

    async def take_off(self, limit_s: float = 20.0) -> Pending:
        """Rise to where AirSim takes off to."""
        return await self.client.begin("takeoff", limit_s, self.name)

    async def land(self, limit_s: float = 60.0) -> Pending:
        """Sink to the ground."""
        return await self.client.begin("land", limit_s, self.name)

    async def move_to_height(self, z_m: float, *, speed_mps: float) -> Pending:
        """Rise or sink to a height above the ground."""
        down_m = self.home.ned_m(0.0, 0.0, z_m)[2]
        still = {"is_rate": True, "yaw_or_rate": 0.0}
        ahead = (_AUTO_LOOKAHEAD, _ADAPTIVE)
        return await self.client.begin("moveToZ", down_m, speed_mps, _NO_LIMIT_S, still, *ahead, self.name)

    async def move_to(self, target: Pose, *, speed_mps: float) -> Pending:
        """Fly straight to a pose."""
        yaw = {"is_rate": False, "yaw_or_rate": conv.yaw_deg(target.heading_rad)}
        point = self.home.ned_m(target.x_m, target.y_m, target.z_m)
        ways = (_ANY_FACING, yaw, _AUTO_LOOKAHEAD, _ADAPTIVE)
        return await self.client.begin("moveToPosition", *point, speed_mps, _NO_LIMIT_S, *ways, self.name)

    async def turn_to(self, heading_rad: float, *, margin_rad: float = math.radians(1.0)) -> Pending:
        """Turn in place."""
        margin_deg = math.degrees(margin_rad)
        return await self.client.begin("rotateToYaw", conv.yaw_deg(heading_rad), _NO_LIMIT_S, margin_deg, self.name)

    async def hover(self) -> None:
        """Stop where it is, whatever it was doing."""
        await self.client.call("cancelLastTask", self.name)
        await self.client.begin("hover", self.name)

    async def pause(self, *, paused: bool) -> None:
        """Hold the simulator's time, or let it go."""
        await self.client.call("simPause", paused)

    async def go_on_for(self, seconds: float) -> None:
        """Let a held simulator's time pass for some seconds, then hold it again; return when it is held.

        Raises:
            PartError: If it does not come to hold.
        """
        limit_s = self.client.deadline_s + 2.0 * seconds
        await self.client.call("simContinueForTime", seconds, deadline_s=limit_s)
        if self._steps_are_over_when_answered:
            return
        # Old servers answer at once: then it is asked until the step is over.
        try:
            async with asyncio.timeout(limit_s):
                self._steps_are_over_when_answered = await self._is_held()
                while not self._steps_are_over_when_answered and not await self._is_held():
                    await asyncio.sleep(_ASK_AGAIN_S)
        except TimeoutError as error:
            raise PartError("AirSim", f"the simulator does not come to hold after {seconds:g} s") from error

    async def _is_held(self) -> bool:
        return await self.client.call("simIsPaused") is True

    @property
    def _external(self) -> tuple[bool, ...]:
        """The first generation's last argument: whether the camera belongs to no vehicle."""
        return () if self.is_cosys else (False,)

    def _moment(self, state: dict[str, Any]) -> Moment:
        kinematics = state["kinematics_estimated"]
        velocity, turning = conv.triple(kinematics["linear_velocity"]), conv.triple(kinematics["angular_velocity"])
        pose = self.home.pose(kinematics["position"], kinematics["orientation"])
        landed = state["landed_state"] == 0
        return Moment(_seconds(state["timestamp"]), pose, math.hypot(*velocity), turning[2], landed)

    def _shots(self, answers: list[dict[str, Any]], count: int) -> list[Shot]:
        if len(answers) != count:
            raise ValueError(f"{len(answers)} pictures of {count}")
        return [
            Shot(self.home.pose(one["camera_position"], one["camera_orientation"]), colour_of(one)) for one in answers
        ]

    def _camera(self, told: dict[str, Any]) -> CameraView:
        pose = self.home.pose(told["pose"]["position"], told["pose"]["orientation"])
        return CameraView(pose, math.radians(float(told["fov"])))


def _seconds(nanoseconds: object) -> float:
    if type(nanoseconds) is not int:
        raise ValueError(f"a time of {nanoseconds!r:.40}")
    return nanoseconds / 1e9


def _metres(value: object) -> float:
    if not is_within(value, 0.0):
        raise ValueError(f"a distance of {value!r:.40}")
    return float(value)  # type: ignore[arg-type]


def _read(method: str, read: Callable[[], T]) -> T:
    """Return what an answer says.

    Raises:
        PartError: If it says something else than AirSim's answers do.
    """
    try:
        return read()
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise PartError("AirSim", f"the answer to {method} is none that AirSim gives: {error!r:.120}") from error
