"""A satellite fix: where a receiver says that it is, how good that is, and how fast it moves."""

import math
from dataclasses import dataclass
from enum import IntEnum

from reasoned_explorer.geometry.frames import GeoOrigin


class FixQuality(IntEnum):
    """How a fix came about; the better, the larger."""

    NONE = 0
    SINGLE = 1
    DGPS = 2
    FLOAT = 3
    FIXED = 4

    @property
    def as_text(self) -> str:
        """In words, for people."""
        return ("no fix", "single", "DGPS", "RTK float", "RTK fixed")[self]


@dataclass(frozen=True, slots=True)
class Fix:
    """What a receiver says at a moment.

    Attributes:
        time_s: When, on the caller's clock, seconds: when its first byte came in.
        quality: How it came about. Of `FixQuality.NONE` everything about place and motion is None or NaN.
        lat_deg: Latitude, degrees, WGS 84.
        lon_deg: Longitude, degrees.
        x_m: East of the world's origin, metres.
        y_m: North of it.
        sigma_m: One standard deviation per axis as the receiver tells it (all of its error, slow and quick); None where
            it does not.
        satellites: How many it used; None where it does not say.
        hdop: Horizontal dilution of precision; None where it does not say.
        speed_mps: Speed over ground, metres a second; None where it does not say.
        course_rad: Course over ground, a heading in [0, 2π); None where it does not say.
        utc_of_day_s: The moment itself by the receiver, seconds since midnight UTC; None where it does not say.
    """

    time_s: float
    quality: FixQuality
    lat_deg: float = math.nan
    lon_deg: float = math.nan
    x_m: float = math.nan
    y_m: float = math.nan
    sigma_m: float | None = None
    satellites: int | None = None
    hdop: float | None = None
    speed_mps: float | None = None
    course_rad: float | None = None
    utc_of_day_s: float | None = None


@dataclass(slots=True)
class Report:
    """What was read of a fix before it is judged: numbers as they came, or None.

    Attributes:
        quality: As told.
        lat_deg: Latitude, degrees.
        lon_deg: Longitude, degrees.
        sigma_m: Standard deviation per axis.
        satellites: How many were used.
        hdop: Horizontal dilution of precision.
        speed_mps: Speed over ground.
        course_deg: Course over ground, degrees clockwise from north.
        utc_of_day_s: Seconds since midnight UTC.
    """

    quality: FixQuality = FixQuality.NONE
    lat_deg: float | None = None
    lon_deg: float | None = None
    sigma_m: float | None = None
    satellites: int | None = None
    hdop: float | None = None
    speed_mps: float | None = None
    course_deg: float | None = None
    utc_of_day_s: float | None = None

    def as_fix(self, time_s: float, origin: GeoOrigin) -> Fix:
        """Return the fix: of quality none where the place is impossible, with None for other impossible figures."""
        lat_deg, lon_deg = _within(self.lat_deg, -90.0, 90.0), _within(self.lon_deg, -180.0, 180.0)
        if self.quality is FixQuality.NONE or lat_deg is None or lon_deg is None:
            return Fix(time_s, FixQuality.NONE, satellites=self.satellites, utc_of_day_s=self.utc_of_day_s)
        x_m, y_m = origin.enu_from_geodetic_m(lat_deg, lon_deg)
        course_deg = _within(self.course_deg, 0.0, 360.0)
        return Fix(
            time_s,
            self.quality,
            lat_deg,
            lon_deg,
            float(x_m),
            float(y_m),
            _within(self.sigma_m, 1e-4, 1e4),
            self.satellites,
            _within(self.hdop, 0.1, 90.0),  # 99.99 is how receivers say that they do not know
            _within(self.speed_mps, 0.0, 300.0),
            None if course_deg is None else math.radians(course_deg % 360.0),
            self.utc_of_day_s,
        )


def _within(value: float | None, low: float, high: float) -> float | None:
    """Return a value that is a number in a range, else None."""
    return value if value is not None and low <= value <= high else None
