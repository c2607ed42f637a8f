import json
import math

import pytest

from reasoned_explorer.model import Camera, SettingsError
from reasoned_explorer.serving.airsim.settings import AUTHORS_RIG, AirSimSettings, camera_name_of

#: The shape of a user's file, with much that only Unreal needs.
FILE = {
    "SeeDocsAt": "https://github.com/Microsoft/AirSim/blob/main/docs/settings.md",
    "SettingsVersion": 1.2,
    "SimMode": "Multirotor",
    "ClockSpeed": 20,
    "ApiServerPort": 41452,
    "OriginGeopoint": {"Latitude": 60.17, "Longitude": 24.94, "Altitude": 5},
    "CameraDefaults": {"CaptureSettings": [{"ImageType": 0, "Width": 320, "Height": 240, "FOV_Degrees": 80}]},
    "SubWindows": [{"WindowID": 0, "CameraName": "0", "ImageType": 3, "Visible": False}],
    "Vehicles": {
        "Scout": {
            "VehicleType": "SimpleFlight",
            "AutoCreate": True,
            "Cameras": {
                "left": {
                    "CaptureSettings": [{"ImageType": 0, "Width": 224, "Height": 224, "FOV_Degrees": 90}],
                    "X": 0.25,
                    "Y": -0.1,
                    "Z": -0.1,
                    "Pitch": 0.0,
                    "Roll": 0.0,
                    "Yaw": -45.0,
                }
            },
        }
    },
}


def test_a_users_file_is_read(tmp_path):
    path = tmp_path / "settings.json"
    path.write_text(json.dumps(FILE), encoding="utf-8-sig")  # Windows writes a byte-order mark
    settings = AirSimSettings.read(path)
    assert (settings.ClockSpeed, settings.ApiServerPort, settings.vehicle_name) == (20.0, 41452, "Scout")
    assert settings.OriginGeopoint.Latitude == 60.17
    cameras = settings.cameras()
    assert (cameras["left"].Yaw, cameras["left"].X) == (-45.0, 0.25)
    assert settings.capture(cameras["left"], 0).camera() == Camera(224, 224, math.radians(90.0))
    # What a camera does not say comes from the file's defaults, and then from AirSim's.
    assert settings.capture(cameras["front_center"], 0).Width == 320
    assert settings.capture(cameras["left"], 1).Width == 256


def test_the_papers_rig_has_three_square_cameras():
    settings = AirSimSettings.of(AUTHORS_RIG)
    cameras = settings.cameras()
    assert [cameras[name].Yaw for name in ("front_left", "front_center", "front_right")] == [-45.0, 0.0, 45.0]
    for name in ("front_left", "front_center", "front_right"):
        assert settings.capture(cameras[name], 0).camera() == Camera(224, 224, math.radians(90.0))


def test_the_standard_cameras_are_there_and_answer_to_their_old_numbers():
    cameras = AirSimSettings().cameras()
    assert cameras["bottom_center"].Pitch == -90.0
    assert [camera_name_of(number, cameras) for number in ("0", "1", "2", "3", "4", "")] == [
        "front_center",
        "front_right",
        "front_left",
        "bottom_center",
        "back_center",
        "front_center",
    ]
    assert camera_name_of("nose", cameras) is None


def test_all_faults_are_told_at_once():
    given = {"SimMode": "Car", "ClockSpeed": 0, "Vehicles": {"A": {}, "B": {}}}
    with pytest.raises(SettingsError) as caught:
        AirSimSettings.of(given)
    assert len(caught.value.faults) == 3


@pytest.mark.parametrize("given", ['{"Vehicles": ', "[1]", "\0", '{"CameraDefaults": {"Roll": 10}}'])
def test_a_file_that_cannot_be_served_is_refused(tmp_path, given):
    path = tmp_path / "settings.json"
    path.write_text(given)
    with pytest.raises(SettingsError, match="AirSim settings"):
        AirSimSettings.read(path)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(SettingsError, match=r"settings\.json as AirSim reads it"):
        AirSimSettings.read(tmp_path / "none.json")
