"""The served robot's satellite receiver: NMEA over TCP, or gpsd's JSON protocol."""

import asyncio
import json
import math
from datetime import UTC, datetime, timedelta
from enum import StrEnum

from reasoned_explorer.geometry.frames import NOWHERE, GeoOrigin
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.simulation.sensors import SensorNoise
from reasoned_explorer.simulation.walking import SatelliteFix

#: The robot's time 0; any day would do.
_EPOCH = datetime(2026, 1, 1, 12, tzinfo=UTC)
_KNOT_MPS = 1852.0 / 3600.0
#: A client that reads nothing is hung up on when so many bytes wait for it.
_BACKLOG_BYTES = 1 << 20
_REQUEST_BYTES = 4096
_SATELLITES = 18
#: (GGA quality, RMC mode, gpsd status) of receivers by the noise that they have.
_QUALITY = {"rtk-float": (5, "F", 4), "single": (1, "A", 1)}
_FIXED = (4, "R", 3)


class GnssDialect(StrEnum):
    """How a served receiver speaks."""

    NMEA = "nmea"
    GPSD = "gpsd"


class GnssServer:
    """Tells whoever connects where the receiver is.

    Each client is greeted with the last fix as soon as it is listened to.

    Args:
        noise: How the receiver errs: what it says of its own quality and errors.
        origin: Of the world's frame on earth.
        dialect: What it speaks.
    """

    def __init__(
        self, noise: SensorNoise, *, origin: GeoOrigin | None = None, dialect: GnssDialect | str = GnssDialect.GPSD
    ) -> None:
        if dialect not in set(GnssDialect):
            raise SettingsError("served receiver", [Fault(f"dialect {dialect!r:.40}", "nmea or gpsd")])
        self.dialect, self.origin = GnssDialect(dialect), origin or NOWHERE
        self._sigma_m = max(0.001, math.hypot(noise.position_sigma_m, noise.wander_sigma_m))
        self._quality = _QUALITY.get(noise.name, _FIXED)
        self._clients: set[asyncio.StreamWriter] = set()
        self._server: asyncio.Server | None = None
        self._last: tuple[float, SatelliteFix] | None = None
        #: Fixes sent since the last client was greeted, the greeting counted; 0 while there is none.
        self.sent = 0
        #: For tests: says nothing while it is set.
        self.is_silent = False

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen; return the port."""
        self._server = await asyncio.start_server(self._serve, host, port, limit=_REQUEST_BYTES)
        found: int = self._server.sockets[0].getsockname()[1]
        return found

    async def close(self) -> None:
        """Hang up on everybody."""
        server, self._server = self._server, None
        if server is not None:
            server.close()
        for client in tuple(self._clients):
            self._drop(client)

    def tell(self, time_s: float, fix: SatelliteFix) -> None:
        """Tell all clients what the receiver says at a time of the robot."""
        self._last = time_s, fix
        if self.is_silent or not self._clients:
            return
        message = self._message(time_s, fix)
        for client in tuple(self._clients):
            self._send(client, message)
        self.sent += bool(self._clients)

    def _message(self, time_s: float, fix: SatelliteFix) -> bytes:
        place = (0.0, 0.0) if not fix.has_fix else self.origin.geodetic_from_enu_deg(fix.x_m, fix.y_m)
        course_deg = math.degrees(math.atan2(fix.vx_mps, fix.vy_mps)) % 360.0
        speed_mps = math.hypot(fix.vx_mps, fix.vy_mps)
        moment = _EPOCH + timedelta(seconds=time_s)
        if self.dialect is GnssDialect.NMEA:
            return self._sentences(moment, fix, place, speed_mps, course_deg)
        return self._reports(moment, fix, place, speed_mps, course_deg)

    def _reports(
        self, moment: datetime, fix: SatelliteFix, place: tuple[float, float], speed_mps: float, course_deg: float
    ) -> bytes:
        common = {"device": "/dev/served", "time": f"{moment:%Y-%m-%dT%H:%M:%S}.{moment.microsecond // 1000:03d}Z"}
        if not fix.has_fix:
            return _line({"class": "TPV", **common, "mode": 1})
        gst = {"class": "GST", **common, "lat": self._sigma_m, "lon": self._sigma_m}
        tpv = {
            "class": "TPV",
            **common,
            "mode": 3,
            "status": self._quality[2],
            "lat": round(place[0], 10),
            "lon": round(place[1], 10),
            "speed": round(speed_mps, 4),
            "track": round(course_deg, 4),
        }
        return _line(gst) + _line(tpv)

    def _sentences(
        self, moment: datetime, fix: SatelliteFix, place: tuple[float, float], speed_mps: float, course_deg: float
    ) -> bytes:
        at = f"{moment:%H%M%S}.{moment.microsecond // 10000:02d}"
        day = f"{moment:%d%m%y}"
        if not fix.has_fix:
            return _sealed(f"GNGGA,{at},,,,,0,00,99.9,,M,,M,,") + _sealed(f"GNRMC,{at},V,,,,,,,{day},,,N,V")
        where = f"{_angle(place[0], 'NS', 2)},{_angle(place[1], 'EW', 3)}"
        quality, mode, _ = self._quality
        speed, sigma = f"{speed_mps / _KNOT_MPS:.4f}", f"{self._sigma_m:.4f}"
        return (
            _sealed(f"GNGGA,{at},{where},{quality},{_SATELLITES},0.7,30.0,M,47.0,M,1.0,0000")
            + _sealed(f"GNRMC,{at},A,{where},{speed},{course_deg:.3f},{day},,,{mode},V")
            + _sealed(f"GNGST,{at},1.0,,,,{sigma},{sigma},0.03")
        )

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            if self.dialect is GnssDialect.GPSD:
                writer.write(_line({"class": "VERSION", "release": "served", "proto_major": 3, "proto_minor": 15}))
            else:
                self._greet(writer)
            while line := await reader.readline():
                if self.dialect is GnssDialect.GPSD:
                    self._answer(line, writer)
        except (OSError, ValueError):
            pass  # what is no line of a request ends its connection
        finally:
            self._drop(writer)

    def _answer(self, line: bytes, writer: asyncio.StreamWriter) -> None:
        request = line.strip()
        if request.startswith(b"?WATCH"):
            watches = b'"enable":true' in request.replace(b" ", b"")
            writer.write(_line({"class": "DEVICES", "devices": [{"class": "DEVICE", "path": "/dev/served"}]}))
            writer.write(_line({"class": "WATCH", "enable": watches, "json": watches}))
            if watches and writer not in self._clients:
                self._greet(writer)
            elif not watches:
                self._clients.discard(writer)
        elif request.startswith(b"?VERSION"):
            writer.write(_line({"class": "VERSION", "release": "served", "proto_major": 3, "proto_minor": 15}))
        else:
            writer.write(_line({"class": "ERROR", "message": "Unrecognized request"}))

    def _greet(self, writer: asyncio.StreamWriter) -> None:
        self._clients.add(writer)
        self.sent = 0
        if self._last is not None and not self.is_silent:
            self._send(writer, self._message(*self._last))
            self.sent = 1

    def _send(self, client: asyncio.StreamWriter, message: bytes) -> None:
        if client.is_closing() or client.transport.get_write_buffer_size() > _BACKLOG_BYTES:
            self._drop(client)
            return
        client.write(message)

    def _drop(self, client: asyncio.StreamWriter) -> None:
        self._clients.discard(client)
        client.close()


def _line(report: dict[str, object]) -> bytes:
    return json.dumps(report, separators=(",", ":")).encode("ascii") + b"\r\n"


def _sealed(body: str) -> bytes:
    total = 0
    for letter in body.encode("ascii"):
        total ^= letter
    return f"${body}*{total:02X}\r\n".encode("ascii")


def _angle(angle_deg: float, sides: str, width: int) -> str:
    """Return dddmm.mmmmmmm,X; rounded as a whole, so that no minute is ever 60."""
    parts = round(abs(angle_deg) * 60.0 * 1e7)
    degrees, minutes = divmod(parts, 60 * 10**7)
    side = sides[0] if angle_deg >= 0.0 else sides[1]
    return f"{degrees:0{width}d}{minutes // 10**7:02d}.{minutes % 10**7:07d},{side}"
