"""What a machine has beside the wire that it is driven by: a receiver, corrections for it, a camera."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from reasoned_explorer.clock import RealClock
from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.model import Camera, Fault, Gathering, PartError, SettingsError
from reasoned_explorer.model.checks import is_there, is_within
from reasoned_explorer.vehicles.cameras.fitting import FittedCamera
from reasoned_explorer.vehicles.cameras.live import LiveCamera
from reasoned_explorer.vehicles.cameras.source import CameraSource, DeviceSource, parse_camera
from reasoned_explorer.vehicles.positioning.anchored import AnchoredReceiver
from reasoned_explorer.vehicles.positioning.receiver import Receiver
from reasoned_explorer.vehicles.positioning.source import (
    GpsdSource,
    NtripSource,
    SerialSource,
    parse_ntrip,
    parse_source,
)

#: Where a receiver takes the origin to be until its first fix tells.
_ANYWHERE = GeoOrigin(0.0, 0.0)


def _to_nobody(text: str) -> None:
    del text


@dataclass(frozen=True, slots=True)
class Equipment:
    """What a machine has beside its wire.

    Attributes:
        positions: Its satellite receiver.
        corrections: Where corrections for that come from.
        camera: Its camera, which looks ahead.
        fov_rad: Horizontal field of view of the camera's whole picture, radians; None where it is not known.
        say: Told, for people, what goes wrong and does not end the mission.
    """

    positions: GpsdSource | SerialSource | None = None
    corrections: NtripSource | None = None
    camera: CameraSource | None = None
    fov_rad: float | None = None
    say: Callable[[str], object] = field(default=_to_nobody, compare=False, repr=False)

    def receiver(self, start: Pose, origin: GeoOrigin | None, now_s: Callable[[], float]) -> AnchoredReceiver | None:
        """Return its receiver; None where it has none.

        Args:
            start: Where the machine stands in the world's frame.
            origin: Where on earth that frame's origin lies; None where the first fix is to tell.
            now_s: The mission's time, seconds.
        """
        if self.positions is None:
            return None
        told: set[str] = set()

        def tell(fault: PartError) -> None:
            if str(fault) not in told:  # a caster is asked again and again
                told.add(str(fault))
                self.say(f"{fault}; positions go on without")

        receiver = Receiver(
            self.positions, origin=origin or _ANYWHERE, now_s=now_s, corrections=self.corrections, on_fault=tell
        )
        return AnchoredReceiver(receiver, start, is_placed=origin is not None)

    def photographer(self, model: Camera, *, least_px: int = 0) -> FittedCamera | None:
        """Return its camera, not yet opened; None where it has none.

        Args:
            model: The camera of the machine's profile.
            least_px: Least width of its pictures, pixels.

        Raises:
            MissingDependencyError: If PyAV is not installed.
        """
        if self.camera is None:
            return None
        # Whatever clock the mission has, a camera lives in real time.
        live = LiveCamera(self.camera, now_s=RealClock().now_s)
        return FittedCamera(live, model, fov_rad=self.fov_rad, least_px=least_px)


def read_equipment(
    found: Gathering,
    *,
    gps: str | None = None,
    ntrip: str | None = None,
    camera: str | None = None,
    camera_fov_deg: float | None = None,
    say: Callable[[str], object] = _to_nobody,
) -> Equipment:
    """Return what a person wrote; what is wrong with it is kept in ``found``.

    Args:
        found: Where it is kept.
        gps: ``gpsd://HOST[:PORT]`` or ``serial:DEVICE[:BAUD]``.
        ntrip: ``ntrip://HOST[:PORT]/MOUNTPOINT``.
        camera: ``/dev/videoN`` or ``rtsp://HOST[:PORT]/PATH``.
        camera_fov_deg: Horizontal field of view of its whole picture, degrees.
        say: See `Equipment`.
    """
    positions = None if gps is None else found.take(lambda: parse_source(gps), None)
    corrections = None if ntrip is None else found.take(lambda: parse_ntrip(ntrip), None)
    source = None if camera is None else found.take(lambda: parse_camera(camera), None)
    devices = (
        ("--gps", positions.device) if isinstance(positions, SerialSource) else None,
        ("--camera", source.device) if isinstance(source, DeviceSource) else None,
    )
    for name, device in filter(None, devices):
        if device.startswith("/") and not is_there(Path(device)):
            remedy = "see to its cable, and to its name under /dev"
            found.add(SettingsError(name, [Fault(f"there is no {device}", "a device of this machine", remedy)]))
    if ntrip is not None and (gps is None or isinstance(positions, GpsdSource)):
        what, remedy = "corrections without a receiver", "give --gps serial:DEVICE, too"
        if gps is not None:
            what, remedy = f"corrections for {gps}", "give the caster's address to gpsd itself, beside the receiver's"
        found.add(SettingsError("--ntrip", [Fault(what, "corrections for a receiver on a serial line", remedy)]))
    fov_rad = None
    if camera_fov_deg is not None:
        if camera is None or not is_within(camera_fov_deg, 10.0, 170.0):
            fault = Fault(f"{camera_fov_deg!r:.40}", "degrees in [10, 170], of the --camera that is given")
            found.add(SettingsError("--camera-fov", [fault]))
        else:
            fov_rad = math.radians(camera_fov_deg)
    return Equipment(positions, corrections, source, fov_rad, say)
