import math
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.vehicles.positioning import nmea
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from tests.vehicles.positioning.sentences import ORIGIN, epoch, gga, gst, place_text, rmc, sealed, vtg

pytest.importorskip("pynmea2", reason="pynmea2 is not installed (the extra `vehicles`)")
LAT, LON = 48.4605, -123.3102


def reader() -> nmea.NmeaReader:
    return nmea.NmeaReader(ORIGIN)


def fixes_of(*data: bytes) -> list[Fix]:
    """Return the fixes of moments that arrive a second apart; one more ends the last of them."""
    reading, end_s = reader(), 43210.0
    pieces = (*data, gga(end_s, LAT, LON))
    fixes = [fix for number, piece in enumerate(pieces) for fix in reading.feed(piece, time_s=number)]
    return [fix for fix in fixes if fix.utc_of_day_s != end_s]


def test_sentences_of_one_moment_are_one_fix():
    (fix,) = fixes_of(epoch(36000.2, 12.5, -7.25, speed_mps=0.8, course_rad=1.5, sigma_m=0.02))
    assert (fix.x_m, fix.y_m) == pytest.approx((12.5, -7.25), abs=1e-3)
    assert fix.quality is FixQuality.FIXED
    assert fix.sigma_m == pytest.approx(0.02)
    assert fix.speed_mps == pytest.approx(0.8, abs=1e-3)
    assert fix.course_rad == pytest.approx(1.5, abs=1e-4)
    assert (fix.satellites, fix.hdop, fix.utc_of_day_s, fix.time_s) == (18, 0.7, 36000.2, 0)


def test_a_real_receiver_s_sentences_are_read():
    # From the documentation of a common receiver (u-blox), checksums included.
    data = (
        b"$GPGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,*5B\r\n"
        b"$GPRMC,083559.00,A,4717.11437,N,00833.91522,E,0.004,77.52,091202,,,A*57\r\n"
    )
    first, second = fixes_of(data)
    assert (first.lat_deg, first.lon_deg) == pytest.approx((47.2852332, 8.5652650), abs=1e-7)
    assert (first.quality, first.satellites, first.hdop) == (FixQuality.SINGLE, 8, 1.01)
    assert second.speed_mps == pytest.approx(0.004 * 0.514444, abs=1e-6)


@pytest.mark.parametrize(
    ("told", "quality"),
    [
        (0, FixQuality.NONE),
        (1, FixQuality.SINGLE),
        (2, FixQuality.DGPS),
        (3, FixQuality.SINGLE),
        (4, FixQuality.FIXED),
        (5, FixQuality.FLOAT),
        (6, FixQuality.NONE),
        (7, FixQuality.NONE),
        (8, FixQuality.NONE),
        (9, FixQuality.NONE),
    ],
)
def test_the_quality_is_carried_through(told, quality):
    (fix,) = fixes_of(gga(1.0, LAT, LON, quality=told))
    assert fix.quality is quality
    assert math.isfinite(fix.x_m) == (quality is not FixQuality.NONE)


@pytest.mark.parametrize(("lat", "lon"), [(48.5, -123.3), (-33.9, 151.2), (-0.5, -0.5), (0.25, 0.75)])
def test_all_four_quarters_of_the_earth(lat, lon):
    (fix,) = fixes_of(gga(1.0, lat, lon))
    assert (fix.lat_deg, fix.lon_deg) == pytest.approx((lat, lon), abs=1e-8)


def test_a_fix_is_told_with_its_last_sentence_once_the_receiver_s_habit_is_known():
    reading = reader()
    assert reading.feed(epoch(1.0, 0.0, 0.0), time_s=0.0) == []
    # The next moment ends the first; and is told itself with its own last sentence.
    told = reading.feed(epoch(1.2, 1.0, 0.0), time_s=0.2)
    assert [fix.utc_of_day_s for fix in told] == [1.0, 1.2]
    assert len(reading.feed(epoch(1.4, 2.0, 0.0), time_s=0.4)) == 1


def test_a_sentence_that_is_lost_delays_its_fix_and_no_other():
    reading = reader()
    whole = [epoch(second, float(second), 0.0) for second in range(1, 6)]
    lines = whole[2].split(b"\r\n")
    whole[2] = b"\r\n".join([*lines[:2], lines[2].replace(b"GST", b"GSX"), b""])  # its error figures are spoilt
    told = [[fix.utc_of_day_s for fix in reading.feed(piece, time_s=0.0)] for piece in whole]
    assert told == [[], [1.0, 2.0], [], [3.0, 4.0], [5.0]]
    assert reading.counts.checksum_failures == 1


def test_the_time_of_a_fix_is_when_its_first_byte_came_in():
    reading = reader()
    reading.feed(epoch(1.0, 0.0, 0.0), time_s=0.0)
    first, second, third, _ = epoch(2.0, 0.0, 0.0).split(b"\r\n")
    reading.feed(first + b"\r\n", time_s=10.0)
    reading.feed(second + b"\r\n", time_s=10.1)
    (fix,) = reading.feed(third + b"\r\n", time_s=10.2)
    assert fix.time_s == 10.0


@pytest.mark.parametrize("size", [1, 3, 17, 4096])
def test_pieces_may_be_of_any_size(size):
    data = b"".join(epoch(float(second), float(second), 0.0) for second in range(1, 8))
    reading = reader()
    fixes = [fix for at in range(0, len(data), size) for fix in reading.feed(data[at : at + size], time_s=0.0)]
    assert [round(fix.x_m) for fix in fixes] == [1, 2, 3, 4, 5, 6, 7]


def test_vtg_gives_the_speed_where_rmc_is_not_sent():
    (fix,) = fixes_of(gga(1.0, LAT, LON) + vtg(speed_mps=1.25, course_deg=90.0))
    assert (fix.speed_mps, fix.course_rad) == pytest.approx((1.25, math.pi / 2), abs=1e-4)


def test_a_receiver_of_rmc_alone_gives_fixes_too():
    (fix,) = fixes_of(rmc(1.0, LAT, LON, speed_mps=1.0))
    assert fix.quality is FixQuality.FIXED


def test_a_void_rmc_is_no_fix():
    (fix,) = fixes_of(sealed(f"GNRMC,000001.00,V,{place_text(LAT, LON)},1.0,2.0,271126,,,N"))
    assert fix.quality is FixQuality.NONE
    assert fix.speed_mps is None


def test_rmc_does_not_make_a_fix_of_what_gga_says_is_none():
    (fix,) = fixes_of(gga(1.0, LAT, LON, quality=0) + rmc(1.0, LAT, LON))
    assert fix.quality is FixQuality.NONE


def test_wrong_and_missing_checksums_are_counted_and_give_no_fix():
    reading = reader()
    good = gga(1.0, LAT, LON)
    assert reading.feed(good.replace(b"48", b"49", 1) + good.split(b"*")[0] + b"\r\n", time_s=0.0) == []
    assert reading.counts.checksum_failures == 2
    assert reading.counts.sentences == 0


def test_binary_messages_in_between_are_passed_over():
    reading = reader()
    noise = bytes(range(256)) * 3
    fixes = [
        fix
        for second in range(1, 5)
        for fix in reading.feed(noise + epoch(float(second), float(second), 0.0) + b"\xb5b" + noise, time_s=0.0)
    ]
    assert [round(fix.x_m) for fix in fixes] == [1, 2, 3, 4]


def test_a_line_without_an_end_is_given_up():
    reading = reader()
    assert reading.feed(b"$GNGGA," * 10_000, time_s=0.0) == []
    assert reading.counts.malformed >= 1
    assert len(reading._rest) < 4096
    reading.feed(b"\r\n" + epoch(1.0, 0.0, 0.0), time_s=0.0)
    assert reading.feed(epoch(2.0, 0.0, 0.0), time_s=0.0)


@pytest.mark.parametrize(
    "body",
    [
        "GNGGA,000001.00,9130.0,N,00833.0,E,4,08,1.0,1.0,M,1.0,M,,",  # beyond the pole
        "GNGGA,000001.00,4875.0,N,00833.0,E,4,08,1.0,1.0,M,1.0,M,,",  # 75 minutes
        "GNGGA,000001.00,4830.0,X,00833.0,E,4,08,1.0,1.0,M,1.0,M,,",
        "GNGGA,000001.00,nan,N,00833.0,E,4,08,1.0,1.0,M,1.0,M,,",
        "GNGGA,000001.00,1e1,N,00833.0,E,4,08,1.0,1.0,M,1.0,M,,",
        "GNGGA,000001.00,4830.0,N,,,4,08,1.0,1.0,M,1.0,M,,",
        "GNGGA,000001.00,4830.0,N,18130.0,E,4,08,1.0,1.0,M,1.0,M,,",
        "GNGGA,000001.00",
    ],
)
def test_an_impossible_place_with_a_right_checksum_is_no_fix(body):
    (fix,) = fixes_of(sealed(body))
    assert fix.quality is FixQuality.NONE


@pytest.mark.parametrize("moment", ["", "250000.00", "006000.00", "nan", "00000", "000001.0x"])
def test_a_moment_that_cannot_be_read_is_no_moment(moment):
    reading = reader()
    reading.feed(sealed(f"GNGGA,{moment},{place_text(LAT, LON)},4,08,1.0,1.0,M,1.0,M,,"), time_s=0.0)
    assert reading.feed(gga(5.0, LAT, LON), time_s=0.0) == []
    assert reading.counts.malformed == 1


@pytest.mark.parametrize(
    "body",
    [
        "GNGST,000001.00,,,,,nan,0.1,",
        "GNGST,000001.00,,,,,-inf,1e999,",
        "GNGST,000001.00,,,,,0,0,",
        "GNGST,000001.00,,,,,,,",
    ],
)
def test_error_figures_that_are_none_are_left_out(body):
    (fix,) = fixes_of(gga(1.0, LAT, LON) + sealed(body))
    assert fix.quality is FixQuality.FIXED
    assert fix.sigma_m is None


def test_the_last_gga_is_kept_for_casters():
    reading = reader()
    reading.feed(gga(1.0, LAT, LON) + gst(1.0), time_s=0.0)
    assert reading.last_gga == gga(1.0, LAT, LON)


def test_midnight_is_a_moment_like_others():
    first, second = fixes_of(gga(86399.8, LAT, LON), gga(0.0, LAT, LON))
    assert (first.utc_of_day_s, second.utc_of_day_s) == (86399.8, 0.0)


@given(st.lists(st.binary(max_size=300), max_size=20))
def test_garbage_never_raises_and_is_never_a_fix(pieces):
    reading = reader()
    for piece in pieces:
        assert reading.feed(piece, time_s=0.0) == []


FIELD = st.one_of(
    st.text(st.characters(codec="ascii"), max_size=12),
    st.sampled_from(["000001.00", "N", "E", "A", "4", "nan", "inf", "-1", "1e5", "9" * 400, "4830.0", "00833.0", "١"]),
)


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["GNGGA", "GPRMC", "GNGST", "GNVTG", "PUBX", "GPGPQ", "GPGSV"]),
            st.lists(FIELD, max_size=16),
        ),
        max_size=8,
    )
)
def test_garbage_under_a_right_checksum_never_raises_and_never_gives_a_place_that_cannot_be(sentences):
    reading = reader()
    for kind, fields in sentences:
        for fix in reading.feed(sealed(",".join([kind, *fields]).encode("utf-8").decode("latin-1")), time_s=0.0):
            if fix.quality is not FixQuality.NONE:
                assert abs(fix.lat_deg) <= 90.0
                assert abs(fix.lon_deg) <= 180.0
                assert math.isfinite(fix.x_m + fix.y_m)
            assert fix.speed_mps is None or 0.0 <= fix.speed_mps <= 300.0
            assert fix.course_rad is None or 0.0 <= fix.course_rad < 2.0 * math.pi
            assert fix.sigma_m is None or fix.sigma_m > 0.0


@given(st.data())
def test_spoilt_bits_of_a_good_stream_give_true_fixes_or_none(data):
    stream = bytearray(b"".join(epoch(float(second), 10.0 * second, 0.0) for second in range(1, 6)))
    for at in data.draw(st.lists(st.integers(0, len(stream) - 1), min_size=1, max_size=1)):
        stream[at] ^= 1 << data.draw(st.integers(0, 7))
    reading = reader()
    for fix in reading.feed(bytes(stream), time_s=0.0):
        if fix.quality is not FixQuality.NONE:
            assert fix.utc_of_day_s is not None
            assert fix.x_m == pytest.approx(10.0 * fix.utc_of_day_s, abs=0.01)


def test_without_the_library_the_command_that_installs_it_is_said(monkeypatch):
    monkeypatch.setattr(nmea, "find_spec", lambda _: None)
    with pytest.raises(MissingDependencyError, match=r"reasoned-explorer\[vehicles\]"):
        reader()


def test_the_module_is_imported_without_the_library():
    assert "pynmea2" not in vars(sys.modules[nmea.__name__])
