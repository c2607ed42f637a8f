"""Fixes from gpsd, the daemon that shares a receiver: its JSON protocol, a line for each report."""

import asyncio
import json
import math
from collections.abc import AsyncGenerator, Callable
from datetime import datetime
from typing import Any

from reasoned_explorer.geometry.frames import GeoOrigin
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality, Report

PORT = 2947
_PART = "positioning"
_WATCH = b'?WATCH={"enable":true,"json":true}\n'
#: Quality as TPV's status gives it (gpsd_json(5)); it is left out where it is unknown. Dead reckoning (5, 6), surveyed
#: time (7) and simulation (8) are no fixes of a moving receiver.
_STATUS = {0: FixQuality.SINGLE, 1: FixQuality.SINGLE, 2: FixQuality.DGPS, 3: FixQuality.FIXED, 4: FixQuality.FLOAT}
#: P(Y) code, of military receivers.
_STATUS[9] = FixQuality.SINGLE
_HAS_FIX = (2, 3)
# gpsd tells the errors of a moment after its place: those of the moment before are taken, if they are no older.
_OLDEST_S = 3.0
# A line of all satellites in view is some thousands of characters long.
_LINE_LIMIT = 1 << 16


class GpsdReader:
    """Turns gpsd's lines into fixes; what is no report of it is counted and passed over.

    gpsd's own estimates of errors (``epx`` and the like) are not used: it makes them from the geometry of the
    satellites alone and takes every fix to be an uncorrected one. What the receiver says of itself (GST) is.

    Attributes:
        malformed: Lines that are no JSON objects, so far.
    """

    def __init__(self, origin: GeoOrigin) -> None:
        self.malformed = 0
        self._origin = origin
        self._sky: dict[str, Any] = {}
        self._sigma_m: float | None = None
        self._sigma_time_s = -math.inf

    def take(self, line: bytes, *, time_s: float) -> Fix | None:
        """Take in a line that arrived at a time, and return the fix that it holds, if it does."""
        try:
            report = json.loads(line)
        except (ValueError, RecursionError):
            self.malformed += 1
            return None
        if not isinstance(report, dict):
            self.malformed += 1
            return None
        kind = report.get("class")
        if kind == "SKY":
            self._take_sky(report)
        elif kind == "GST":
            self._take_gst(report, time_s)
        elif kind == "TPV":
            return self._fix(report, time_s)
        return None

    def _take_sky(self, report: dict[str, Any]) -> None:
        sky: dict[str, Any] = {}
        if _number(report.get("hdop")) is not None:
            sky["hdop"] = _number(report["hdop"])
        seen = report.get("satellites")
        if isinstance(report.get("uSat"), int):
            sky["satellites"] = report["uSat"]
        elif isinstance(seen, list):
            sky["satellites"] = sum(isinstance(one, dict) and one.get("used") is True for one in seen)
        self._sky |= sky

    def _take_gst(self, report: dict[str, Any], time_s: float) -> None:
        north_m, east_m = _number(report.get("lat")), _number(report.get("lon"))
        if north_m is not None and east_m is not None:
            self._sigma_m, self._sigma_time_s = math.sqrt(0.5 * (north_m * north_m + east_m * east_m)), time_s

    def _fix(self, report: dict[str, Any], time_s: float) -> Fix:
        has_fix = report.get("mode") in _HAS_FIX
        status = report.get("status", 1)
        quality = _STATUS.get(status, FixQuality.NONE) if isinstance(status, int) else FixQuality.NONE
        return Report(
            quality=quality if has_fix else FixQuality.NONE,
            lat_deg=_number(report.get("lat")),
            lon_deg=_number(report.get("lon")),
            sigma_m=self._sigma_m if time_s - self._sigma_time_s <= _OLDEST_S else None,
            satellites=self._sky.get("satellites"),
            hdop=self._sky.get("hdop"),
            speed_mps=_number(report.get("speed")),
            course_deg=_number(report.get("track")),
            utc_of_day_s=_utc_of_day_s(report.get("time")),
        ).as_fix(time_s, self._origin)


async def gpsd_fixes(
    host: str, port: int, *, origin: GeoOrigin, now_s: Callable[[], float]
) -> AsyncGenerator[Fix, None]:
    """Yield what a gpsd reports, as it comes.

    Args:
        host: Where it runs.
        port: Its port, 2947 by custom.
        origin: Of the world's frame.
        now_s: The time, seconds; `Clock.now_s` of a real clock.

    Raises:
        PartError: If it cannot be reached, or goes away.
    """
    try:
        reader, writer = await asyncio.open_connection(host, port, limit=_LINE_LIMIT)
    except OSError as error:
        raise PartError(_PART, f"gpsd at {host}:{port} cannot be reached: {error}") from error
    understood = GpsdReader(origin)
    try:
        writer.write(_WATCH)
        while True:
            line = await _line(reader, understood)
            if not line:
                raise PartError(_PART, f"gpsd at {host}:{port} has closed the connection")
            fix = understood.take(line, time_s=now_s())
            if fix is not None:
                yield fix
    except OSError as error:
        raise PartError(_PART, f"gpsd at {host}:{port}: {error}") from error
    finally:
        writer.close()


async def _line(reader: asyncio.StreamReader, understood: GpsdReader) -> bytes:
    while True:
        try:
            return await reader.readline()
        except ValueError:  # a line without an end: the reader has thrown it away
            understood.malformed += 1


def _number(value: object) -> float | None:
    """Return a finite number, or None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if math.isfinite(value) else None
    except OverflowError:
        return None


def _utc_of_day_s(text: object) -> float | None:
    if not isinstance(text, str):
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return moment.hour * 3600.0 + moment.minute * 60.0 + moment.second + moment.microsecond * 1e-6
