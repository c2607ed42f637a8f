"""AirSim's settings.json, as far as the served simulator reads it: the clock, the cameras, where on earth it is.

What else such files hold is for Unreal, and is left alone.
"""

import json
import math
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from reasoned_explorer.model import Camera, Fault, SettingsError

_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Pixels = Annotated[int, Field(ge=1, le=4096)]

#: The cameras that every AirSim vehicle has, by their names and old numbers: yaw and pitch, degrees.
STANDARD_CAMERAS = {
    "front_center": (0.0, 0.0),
    "front_right": (0.0, 0.0),
    "front_left": (0.0, 0.0),
    "bottom_center": (0.0, -90.0),
    "back_center": (180.0, 0.0),
}
_OLD_NUMBERS = {str(number): name for number, name in enumerate(STANDARD_CAMERAS)} | {"": "front_center"}


class _Part(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)


class Capture(_Part):
    """Size and field of view of one kind of picture."""

    ImageType: int = 0
    Width: _Pixels = 256
    Height: _Pixels = 144
    FOV_Degrees: Annotated[float, Field(gt=0.0, lt=180.0)] = 90.0

    def camera(self) -> Camera:
        """Return the pinhole camera."""
        return Camera(self.Width, self.Height, math.radians(self.FOV_Degrees))


class CameraSettings(_Part):
    """Where a camera sits on the body (metres forward, right, down), where it looks (degrees), what it takes."""

    CaptureSettings: tuple[Capture, ...] = ()
    X: _Finite = 0.0
    Y: _Finite = 0.0
    Z: _Finite = 0.0
    Pitch: Annotated[float, Field(ge=-90.0, le=90.0)] = 0.0
    Roll: Annotated[float, Field(ge=0.0, le=0.0)] = 0.0  # the renderer draws level pictures
    Yaw: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0


class VehicleSettings(_Part):
    """One vehicle."""

    VehicleType: str = "SimpleFlight"
    Cameras: dict[str, CameraSettings] = Field(default_factory=dict)


class GeoPoint(_Part):
    """A place on earth, degrees and metres."""

    Latitude: Annotated[float, Field(ge=-90.0, le=90.0)] = 47.641468
    Longitude: Annotated[float, Field(ge=-180.0, le=180.0)] = -122.140165
    Altitude: _Finite = 122.0


class AirSimSettings(_Part):
    """A settings file; AirSim's defaults where it says nothing."""

    SimMode: str = "Multirotor"
    ClockSpeed: Annotated[float, Field(ge=1e-3, le=1e4)] = 1.0
    ApiServerPort: Annotated[int, Field(ge=0, le=65535)] = 41451
    OriginGeopoint: GeoPoint = Field(default_factory=GeoPoint)
    CameraDefaults: CameraSettings = Field(default_factory=CameraSettings)
    Vehicles: dict[str, VehicleSettings] = Field(default_factory=lambda: {"SimpleFlight": VehicleSettings()})

    @field_validator("SimMode")
    @classmethod
    def _a_drone(cls, mode: str) -> str:
        if mode not in {"", "Multirotor"}:
            raise ValueError("only Multirotor is served")
        return mode

    @field_validator("Vehicles")
    @classmethod
    def _one_vehicle(cls, vehicles: dict[str, VehicleSettings]) -> dict[str, VehicleSettings]:
        if len(vehicles) != 1:
            raise ValueError("exactly one vehicle is served")
        return vehicles

    @classmethod
    def of(cls, given: object) -> "AirSimSettings":
        """Return settings from what a JSON file holds.

        Raises:
            SettingsError: If they cannot be served; all faults at once.
        """
        try:
            return cls.model_validate(given)
        except ValidationError as error:
            raise SettingsError("AirSim settings", [_fault(one) for one in error.errors()]) from error

    @classmethod
    def read(cls, path: Path) -> "AirSimSettings":
        """Return the settings of a file.

        Raises:
            SettingsError: If it cannot be read, or served; all faults at once.
        """
        try:
            given = json.loads(path.read_text("utf-8-sig"))
        except (OSError, ValueError, RecursionError) as error:
            fault = Fault(f"{path}: {error}", "a settings.json as AirSim reads it")
            raise SettingsError("AirSim settings", [fault]) from error
        return cls.of(given)

    @property
    def vehicle_name(self) -> str:
        """What the vehicle is called."""
        return next(iter(self.Vehicles))

    def cameras(self) -> dict[str, CameraSettings]:
        """Return the cameras by name: the standard ones, and those of the file."""
        defaults = self.CameraDefaults
        standard = {
            name: defaults.model_copy(update={"Yaw": yaw, "Pitch": pitch})
            for name, (yaw, pitch) in STANDARD_CAMERAS.items()
        }
        return standard | self.Vehicles[self.vehicle_name].Cameras

    def capture(self, camera: CameraSettings, image_type: int) -> Capture:
        """Return how a camera takes a kind of picture: as its own settings say, or the file's defaults, or AirSim's."""
        for one in (*camera.CaptureSettings, *self.CameraDefaults.CaptureSettings):
            if one.ImageType == image_type:
                return one
        return Capture(ImageType=image_type)


def camera_name_of(name: str, known: dict[str, CameraSettings]) -> str | None:
    """Return which camera a name, or an old number, means; None where there is none."""
    if name in known:
        return name
    return _OLD_NUMBERS.get(name)


def _rig(**yaws_deg: float) -> dict[str, Any]:
    """Return settings with cameras of 224 × 224 pixels and 90° that look in some directions."""
    shots = [{"ImageType": kind, "Width": 224, "Height": 224, "FOV_Degrees": 90.0} for kind in (0, 1, 2, 3, 5)]
    cameras = {name: {"CaptureSettings": shots, "Yaw": yaw} for name, yaw in yaws_deg.items()}
    return {
        "SettingsVersion": 1.2,
        "SimMode": "Multirotor",
        "CameraDefaults": {"CaptureSettings": shots},
        "Vehicles": {"SimpleFlight": {"VehicleType": "SimpleFlight", "Cameras": cameras}},
    }


#: The paper's rig: three cameras of 224 × 224 pixels and 90°, to the left, ahead and to the right.
AUTHORS_RIG = _rig(front_left=-45.0, front_center=0.0, front_right=45.0)


def _fault(error: Any) -> Fault:
    where = ".".join(str(part) for part in error["loc"])
    return Fault(f"{where} is {error['input']!r:.60}", str(error["msg"]))
