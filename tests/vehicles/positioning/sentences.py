"""Sentences of a receiver, made for the tests."""

import math

from reasoned_explorer.geometry.frames import GeoOrigin

ORIGIN = GeoOrigin(48.46, -123.31)


def sealed(body: str) -> bytes:
    """Return a sentence with its checksum and end of line."""
    total = 0
    for letter in body:
        total ^= ord(letter)
    return f"${body}*{total:02X}\r\n".encode("latin-1")


def clock_text(utc_of_day_s: float) -> str:
    """Return hhmmss.ss."""
    hundredths = round(utc_of_day_s * 100.0)
    seconds, part = divmod(hundredths, 100)
    return f"{seconds // 3600 % 24:02d}{seconds // 60 % 60:02d}{seconds % 60:02d}.{part:02d}"


def angle_text(angle_deg: float, sides: str, width: int) -> str:
    """Return dddmm.mmmmmmm,X."""
    # Rounded as a whole, so that no minute is ever 60.
    parts = round(abs(angle_deg) * 60.0 * 1e7)
    degrees, minutes = divmod(parts, 60 * 10**7)
    side = sides[0] if angle_deg >= 0.0 else sides[1]
    return f"{degrees:0{width}d}{minutes // 10**7:02d}.{minutes % 10**7:07d},{side}"


def place_text(lat_deg: float, lon_deg: float) -> str:
    return f"{angle_text(lat_deg, 'NS', 2)},{angle_text(lon_deg, 'EW', 3)}"


def gga(utc_of_day_s: float, lat_deg: float, lon_deg: float, *, quality: int = 4, satellites: int = 18) -> bytes:
    place = place_text(lat_deg, lon_deg)
    return sealed(f"GNGGA,{clock_text(utc_of_day_s)},{place},{quality},{satellites:02d},0.7,30.0,M,-18.0,M,1.0,0000")


def rmc(
    utc_of_day_s: float,
    lat_deg: float,
    lon_deg: float,
    *,
    speed_mps: float = 0.0,
    course_deg: float = 0.0,
    quality: int = 4,
) -> bytes:
    knots = speed_mps * 3600.0 / 1852.0
    place, mode = place_text(lat_deg, lon_deg), "NADARF"[quality]
    return sealed(f"GNRMC,{clock_text(utc_of_day_s)},A,{place},{knots:.4f},{course_deg:.3f},271126,,,{mode},V")


def gst(utc_of_day_s: float, *, sigma_m: float = 0.014) -> bytes:
    return sealed(f"GNGST,{clock_text(utc_of_day_s)},1.0,,,,{sigma_m:.3f},{sigma_m:.3f},0.03")


def vtg(*, speed_mps: float, course_deg: float) -> bytes:
    return sealed(f"GNVTG,{course_deg:.2f},T,,M,{speed_mps * 3600.0 / 1852.0:.4f},N,{speed_mps * 3.6:.4f},K,D")


def epoch(
    utc_of_day_s: float,
    x_m: float,
    y_m: float,
    *,
    speed_mps: float = 0.0,
    course_rad: float = 0.0,
    quality: int = 4,
    sigma_m: float = 0.014,
) -> bytes:
    """Return what a receiver at a place of the world sends of one moment."""
    lat_deg, lon_deg = ORIGIN.geodetic_from_enu_deg(x_m, y_m)
    course_deg = math.degrees(course_rad) % 360.0
    return (
        gga(utc_of_day_s, lat_deg, lon_deg, quality=quality)
        + rmc(utc_of_day_s, lat_deg, lon_deg, speed_mps=speed_mps, course_deg=course_deg, quality=quality)
        + gst(utc_of_day_s, sigma_m=sigma_m)
    )
