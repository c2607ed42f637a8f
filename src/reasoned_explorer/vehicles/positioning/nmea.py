"""Sentences of NMEA 0183 become fixes: GGA, RMC, GST and VTG of one moment are one fix."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any

from reasoned_explorer.geometry.frames import GeoOrigin
from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality, Report

INSTALL = "pip install 'reasoned-explorer[vehicles]'"
#: Quality as GGA gives it. What a receiver only reckons (6), was told (7) or makes up (8) is no fix.
_GGA_QUALITY = {
    "1": FixQuality.SINGLE,
    "2": FixQuality.DGPS,
    "3": FixQuality.SINGLE,
    "4": FixQuality.FIXED,
    "5": FixQuality.FLOAT,
}
#: Quality as RMC gives it since NMEA 2.3, for receivers that send no GGA; before that there was none.
_RMC_QUALITY = {
    "": FixQuality.SINGLE,
    "A": FixQuality.SINGLE,
    "D": FixQuality.DGPS,
    "F": FixQuality.FLOAT,
    "R": FixQuality.FIXED,
}
_KNOT_MPS = 1852.0 / 3600.0
_KMH_MPS = 1.0 / 3.6
_NUMBER = re.compile(r"-?\d{1,9}(\.\d{0,12})?", re.ASCII)
_TIME = re.compile(r"([01]\d|2[0-3])([0-5]\d)([0-5]\d|60)(\.\d{0,6})?", re.ASCII)
_ANGLE = re.compile(r"(\d{1,3})([0-5]\d(?:\.\d{0,12})?)", re.ASCII)
# The standard allows 82 characters; receivers with more digits send some more.
_LONGEST = 160


@dataclass(slots=True)
class NmeaCounts:
    """What came in so far.

    Attributes:
        sentences: Sentences with a right checksum.
        checksum_failures: Sentences whose checksum is wrong or is not there.
        malformed: Lines that are no sentences, or too long, and sentences of which nothing could be made.
        fixes: Fixes made, those of quality none included.
    """

    sentences: int = 0
    checksum_failures: int = 0
    malformed: int = 0
    fixes: int = 0


@dataclass(slots=True)
class _Epoch:
    """What was said of one moment so far."""

    utc_of_day_s: float
    time_s: float
    report: Report = field(default_factory=Report)
    kinds: set[str] = field(default_factory=set)
    is_told: bool = False


class NmeaReader:
    """Reads what a receiver sends, in pieces of any size, and returns the fixes that it makes up.

    A fix is complete, and returned, with the last of the kinds of sentences that the receiver sent of the moments
    before; at the latest when the next moment begins. Never raises on what comes in; what is wrong is counted.

    Attributes:
        counts: What came in so far.
        last_gga: The last GGA sentence with its end of line, for casters of corrections; empty before the first.

    Args:
        origin: Of the world's frame.

    Raises:
        MissingDependencyError: If pynmea2 is not installed.
    """

    def __init__(self, origin: GeoOrigin) -> None:
        if find_spec("pynmea2") is None:
            raise MissingDependencyError("reading NMEA", "pynmea2", INSTALL)
        import pynmea2

        self._pynmea2 = pynmea2
        self.counts = NmeaCounts()
        self.last_gga = b""
        self._origin = origin
        self._rest = b""
        self._is_overlong = False
        self._epoch: _Epoch | None = None
        self._before: set[str] = set()
        self._long_before: set[str] = set()

    def feed(self, data: bytes, *, time_s: float) -> list[Fix]:
        """Take in bytes that arrived at a time and return the fixes that are complete with them."""
        return [fix for line in self._lines(data) for fix in self._line(line, time_s)]

    def _lines(self, data: bytes) -> Iterator[bytes]:
        *whole, self._rest = (self._rest + data).split(b"\n")
        for line in whole:
            if self._is_overlong:
                self._is_overlong = False
                continue
            if len(line) > _LONGEST:
                # A binary message may stand before a sentence, without an end of line of its own.
                line = line[-_LONGEST:]  # noqa: PLW2901
            yield line
        if len(self._rest) > _LONGEST * 8:
            self._rest, self._is_overlong = b"", True
            self.counts.malformed += 1

    def _line(self, line: bytes, time_s: float) -> list[Fix]:
        sentence = self._sentence(line)
        take = None if sentence is None else _TAKERS.get(sentence.sentence_type)
        if sentence is None or take is None:
            return []
        kind, values = sentence.sentence_type, _fields(sentence)
        if kind == "GGA":
            self.last_gga = line[line.rfind(b"$") :].rstrip(b"\r") + b"\r\n"
        utc_of_day_s = _utc(values.get("timestamp"))
        if utc_of_day_s is None and kind != "VTG":  # VTG alone says no time: it belongs to the moment of the last
            self.counts.malformed += 1
            return []
        fixes = [] if utc_of_day_s is None else self._turned(utc_of_day_s, time_s)
        epoch = self._epoch
        if epoch is not None:
            epoch.kinds.add(kind)
            if not epoch.is_told:
                take(values, epoch)
                if self._before and epoch.kinds >= self._before | self._long_before:
                    fixes += self._told(epoch)
        return fixes

    def _sentence(self, line: bytes) -> Any | None:
        """Return a line as a sentence of a talker, or None where it is no such thing, which is counted."""
        start = line.rfind(b"$")
        text = line[max(0, start) :].rstrip(b"\r").decode("ascii", "replace")
        if start < 0 or not (text.isascii() and text.isprintable()):
            self.counts.malformed += bool(line.strip())
            return None
        try:
            sentence = self._pynmea2.parse(text, check=True)
        except self._pynmea2.ChecksumError:
            self.counts.checksum_failures += 1
            return None
        except Exception:  # noqa: BLE001 - whatever a library makes of noise on a wire, it is noise
            self.counts.malformed += 1
            return None
        self.counts.sentences += 1
        return sentence if isinstance(sentence, self._pynmea2.TalkerSentence) else None

    def _turned(self, utc_of_day_s: float, time_s: float) -> list[Fix]:
        """Begin a new moment where a sentence is of another than the last, and return what is left of that one."""
        last = self._epoch
        if last is not None and last.utc_of_day_s == utc_of_day_s:
            return []
        self._epoch = _Epoch(utc_of_day_s, time_s)
        if last is None:
            return []
        self._long_before, self._before = self._before, last.kinds
        return [] if last.is_told else self._told(last)

    def _told(self, epoch: _Epoch) -> list[Fix]:
        epoch.is_told = True
        if not epoch.kinds & {"GGA", "RMC"}:
            return []
        epoch.report.utc_of_day_s = epoch.utc_of_day_s
        self.counts.fixes += 1
        return [epoch.report.as_fix(epoch.time_s, self._origin)]


def _fields(sentence: Any) -> dict[str, str]:
    """Return the fields of a sentence by name, as they were sent; none where the library knows no such field."""
    names = [entry[1] for entry in sentence.fields]
    return {name: str(value) for name, value in zip(names, sentence.data, strict=False)}


def _number(text: str | None) -> float | None:
    """Return a plain decimal number, or None where a field is empty or anything else."""
    return float(text) if text and _NUMBER.fullmatch(text) else None


def _utc(text: str | None) -> float | None:
    """Return seconds since midnight for hhmmss.ss."""
    match = _TIME.fullmatch(text) if text else None
    if match is None:
        return None
    hours, minutes, seconds, part = match.groups()
    return int(hours) * 3600.0 + int(minutes) * 60.0 + float(seconds + (part or ""))


def _angle_deg(text: str | None, side: str | None, sides: str) -> float | None:
    """Return degrees for dddmm.mmm and a letter; the first of two letters is the positive side."""
    match = _ANGLE.fullmatch(text) if text else None
    if match is None or not side or side not in sides:
        return None
    angle_deg = int(match[1]) + float(match[2]) / 60.0
    return angle_deg if side == sides[0] else -angle_deg


def _take_place(values: dict[str, str], report: Report) -> None:
    report.lat_deg = _angle_deg(values.get("lat"), values.get("lat_dir"), "NS")
    report.lon_deg = _angle_deg(values.get("lon"), values.get("lon_dir"), "EW")


def _take_gga(values: dict[str, str], epoch: _Epoch) -> None:
    report = epoch.report
    # GGA is of the place, whatever RMC said before: it alone knows all qualities.
    report.quality = _GGA_QUALITY.get(values.get("gps_qual", ""), FixQuality.NONE)
    _take_place(values, report)
    satellites = _number(values.get("num_sats"))
    report.satellites = None if satellites is None or satellites < 0.0 else int(satellites)
    report.hdop = _number(values.get("horizontal_dil"))


def _take_rmc(values: dict[str, str], epoch: _Epoch) -> None:
    report = epoch.report
    if values.get("status") != "A":
        return
    knots, course_deg = _number(values.get("spd_over_grnd")), _number(values.get("true_course"))
    report.speed_mps = None if knots is None else knots * _KNOT_MPS
    report.course_deg = course_deg
    if "GGA" not in epoch.kinds:
        report.quality = _RMC_QUALITY.get(values.get("mode_indicator", ""), FixQuality.NONE)
        _take_place(values, report)


def _take_gst(values: dict[str, str], epoch: _Epoch) -> None:
    north_m, east_m = _number(values.get("std_dev_latitude")), _number(values.get("std_dev_longitude"))
    if north_m is not None and east_m is not None:
        epoch.report.sigma_m = (0.5 * (north_m * north_m + east_m * east_m)) ** 0.5


def _take_vtg(values: dict[str, str], epoch: _Epoch) -> None:
    report = epoch.report
    if report.speed_mps is not None:
        return
    kmh, knots = _number(values.get("spd_over_grnd_kmph")), _number(values.get("spd_over_grnd_kts"))
    if kmh is not None:
        report.speed_mps = kmh * _KMH_MPS
    elif knots is not None:
        report.speed_mps = knots * _KNOT_MPS
    report.course_deg = _number(values.get("true_track"))


_TAKERS: dict[str, Callable[[dict[str, str], _Epoch], None]] = {
    "GGA": _take_gga,
    "RMC": _take_rmc,
    "GST": _take_gst,
    "VTG": _take_vtg,
}
