"""Methods about what is seen: cameras, pictures, things and their segmentation numbers."""

import asyncio
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field

from reasoned_explorer.serving.airsim import messages
from reasoned_explorer.serving.airsim.arguments import ImageRequest, LoosePose, Name, checked
from reasoned_explorer.serving.airsim.flight import State
from reasoned_explorer.serving.airsim.simulator import Simulator
from reasoned_explorer.serving.airsim.studio import Wanted
from reasoned_explorer.serving.msgpack_rpc import Method, MethodError
from reasoned_explorer.simulation.mishaps import MishapKind
from reasoned_explorer.vehicles.airsim.conventions import Wire, attitude, triple
from reasoned_explorer.vehicles.airsim.pictures import ImageType

_Requests = Annotated[list[ImageRequest], Field(max_length=32)]
_Number = Annotated[int, Field(ge=0, le=255)]
_Fov = Annotated[float, Field(gt=0.0, lt=180.0)]


class SceneMethods:
    """Shows the world; see the official clients for what each method means.

    Last arguments that only one generation of clients gives are read and not needed.

    Args:
        simulator: What is shown.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._sim = simulator

    def table(self) -> dict[str, Method]:
        """Return the methods by name."""
        shown: dict[str, Callable[..., Any]] = {
            "simGetImage": self.image,
            "simGetImages": self.images,
            "simGetCameraInfo": self.camera_info,
            "simSetCameraPose": self.set_camera_pose,
            "simSetCameraFov": self.set_camera_fov,
            "simListSceneObjects": self.list_objects,
            "simGetObjectPose": self.object_pose,
            "simSetSegmentationObjectID": self.set_number,
            "simGetSegmentationObjectID": self.number,
        }
        return {name: checked(name, method) for name, method in shown.items()}

    def image(
        self, camera_name: Name, image_type: int, vehicle_name: Name = "", external: bool | str = ""
    ) -> "asyncio.Future[bytes]":
        """Return a picture as a PNG."""
        del external
        wanted = self._wanted(ImageRequest(camera_name=camera_name, image_type=image_type, compress=True))
        self._sim.check_name(vehicle_name)
        (future,) = self._sim.studio.take(self._sim.drone.look(self._sim.now_s), [wanted])

        async def packed() -> bytes:
            data: bytes = (await future)["image_data_uint8"]
            return data

        return asyncio.ensure_future(packed())

    def images(
        self, requests: _Requests, vehicle_name: Name = "", external: bool | str = ""
    ) -> "asyncio.Future[list[Wire]]":
        """Return pictures that are taken at one moment."""
        del external
        sim = self._sim
        sim.check_name(vehicle_name)
        now_s = sim.now_s
        if sim.mishaps.at(MishapKind.CAMERA_SILENCE, now_s):
            raise MethodError("the camera gives no picture")
        wanted = [self._wanted(one) for one in requests]
        body = sim.drone.look(now_s)
        taken = sim.studio.take(body, wanted)
        about = [self._about(one, request, body, now_s) for one, request in zip(wanted, requests, strict=True)]

        async def together() -> list[Wire]:
            made = await asyncio.gather(*taken)
            return [told | data for told, data in zip(about, made, strict=True)]

        return asyncio.ensure_future(together())

    def camera_info(self, camera_name: Name, vehicle_name: Name = "", external: bool | str = "") -> Wire:
        """Return where a camera is and what it sees of the world."""
        del external
        sim = self._sim
        sim.check_name(vehicle_name)
        known = sim.studio.known(camera_name)
        camera = sim.studio.camera(known, ImageType.SCENE)
        fov_rad = camera.horizontal_fov_rad
        return {
            "pose": self._camera_pose(known, sim.drone.look(sim.now_s)),
            "fov": math.degrees(fov_rad),
            "proj_mat": messages.projection(fov_rad, camera.width_px / camera.height_px),
        }

    def set_camera_pose(
        self, camera_name: Name, pose: LoosePose, vehicle_name: Name = "", external: bool | str = ""
    ) -> None:
        """Have a camera sit and look elsewhere, in its body's frame; it stays level."""
        del external
        sim = self._sim
        sim.check_name(vehicle_name)
        known = sim.studio.known(camera_name)
        try:
            forward_m, right_m, down_m = triple(pose.position.model_dump())
            looks = attitude(pose.orientation.model_dump())
        except ValueError as error:
            raise MethodError(f"simSetCameraPose: {error}") from error
        if max(abs(forward_m), abs(right_m), abs(down_m)) > 10.0:
            raise MethodError("simSetCameraPose: a camera sits at most 10 m from the body's middle")
        if abs(looks.roll_rad) > 1e-3:
            raise MethodError("simSetCameraPose: cameras do not roll here")
        old = sim.studio.aim_of(known)
        aim = replace(old, forward_m=forward_m, right_m=right_m, down_m=down_m)
        sim.studio.aim(known, replace(aim, yaw_rad=looks.yaw_rad, pitch_rad=looks.pitch_rad))

    def set_camera_fov(
        self, camera_name: Name, fov_degrees: _Fov, vehicle_name: Name = "", external: bool | str = ""
    ) -> None:
        """Give a camera another field of view."""
        del external
        self._sim.check_name(vehicle_name)
        self._sim.studio.zoom(self._sim.studio.known(camera_name), math.radians(fov_degrees))

    def list_objects(self, name_regex: Name = ".*") -> list[str]:
        """Return the names of things."""
        try:
            return self._sim.scenery.matching(name_regex)
        except ValueError as error:
            raise MethodError(f"simListSceneObjects: {error}") from error

    def object_pose(self, object_name: Name, ned: bool = True) -> Wire:
        """Return where a thing is, as seen from home; NaN where there is none."""
        del ned
        pose = self._sim.scenery.pose_of(object_name)
        return messages.NOWHERE if pose is None else self._sim.home.wire_pose(pose)

    def set_number(self, mesh_name: Name, object_id: _Number, is_name_regex: bool = False) -> bool:
        """Give things a segmentation number; return whether there are any."""
        try:
            return self._sim.scenery.number(mesh_name, object_id, is_pattern=is_name_regex)
        except ValueError as error:
            raise MethodError(f"simSetSegmentationObjectID: {error}") from error

    def number(self, mesh_name: Name) -> int:
        """Return the segmentation number of a thing; -1 where there is none."""
        return self._sim.scenery.id_of(mesh_name)

    def _wanted(self, request: ImageRequest) -> Wanted:
        """Return what is asked for.

        Raises:
            MethodError: If there is no such camera, or the picture is of a kind that is not served.
        """
        camera = self._sim.studio.known(request.camera_name)
        try:
            kind = ImageType(request.image_type)
        except ValueError as error:
            served = ", ".join(f"{one.value} ({one.name})" for one in ImageType)
            raise MethodError(f"pictures of kind {request.image_type} are not served; these are: {served}") from error
        if request.pixels_as_float and kind in {ImageType.SCENE, ImageType.SEGMENTATION}:
            raise MethodError(f"pictures of kind {kind.name} are bytes: pixels_as_float is for depths")
        return Wanted(camera, kind, request.pixels_as_float, request.compress and not request.pixels_as_float)

    def _camera_pose(self, camera: str, body: State) -> Wire:
        aim = self._sim.studio.aim_of(camera)
        return self._sim.home.wire_pose(aim.pose(body), pitch_rad=aim.pitch_rad)

    def _about(self, wanted: Wanted, request: ImageRequest, body: State, now_s: float) -> dict[str, Any]:
        pose = self._camera_pose(wanted.camera, body)
        return {
            "camera_position": pose["position"],
            "camera_name": request.camera_name,
            "camera_orientation": pose["orientation"],
            "time_stamp": messages.nanoseconds(now_s),
            "message": "",
            "pixels_as_float": wanted.as_float,
            "compress": wanted.compress,
            "image_type": int(wanted.kind),
        }
