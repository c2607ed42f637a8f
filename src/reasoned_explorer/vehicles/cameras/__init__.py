"""Cameras whose pictures do not come over the wire of a vehicle: on this computer, or on the network.

`parse_camera` reads what a person writes (``/dev/video0``, ``rtsp://HOST/PATH``); `LiveCamera` keeps its newest frame
and gives none that was taken before it was asked for; `FittedCamera` cuts that to the camera of a profile, for drivers.
"""

from reasoned_explorer.vehicles.cameras.fitting import FittedCamera, fitted
from reasoned_explorer.vehicles.cameras.live import CameraSettings, LiveCamera
from reasoned_explorer.vehicles.cameras.source import DeviceSource, RtspSource, parse_camera

__all__ = ["CameraSettings", "DeviceSource", "FittedCamera", "LiveCamera", "RtspSource", "fitted", "parse_camera"]
