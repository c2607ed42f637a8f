import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.geometry import GeoOrigin, enu_from_ned, ned_from_enu


@given(st.floats(-80, 80), st.floats(-179, 179), st.floats(-3000, 3000), st.floats(-3000, 3000))
def test_there_and_back_is_the_same_place(lat_deg: float, lon_deg: float, x_m: float, y_m: float) -> None:
    origin = GeoOrigin(lat_deg, lon_deg)
    there_x_m, there_y_m = origin.enu_from_geodetic_m(*origin.geodetic_from_enu_deg(x_m, y_m))
    assert float(there_x_m) == pytest.approx(x_m, abs=0.01)
    assert float(there_y_m) == pytest.approx(y_m, abs=0.01)


def test_a_minute_of_latitude_is_a_nautical_mile() -> None:
    # 1 852 m on the mean earth; the ellipsoid has 1 843 m at the equator and 1 862 m at the poles.
    _, north_m = GeoOrigin(45.0, 7.0).enu_from_geodetic_m(45.0 + 1.0 / 60.0, 7.0)
    assert float(north_m) == pytest.approx(1852.0, abs=1.0)


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_enu_and_ned_are_each_others_inverse(x_m: float, y_m: float, z_m: float) -> None:
    assert enu_from_ned(*ned_from_enu(x_m, y_m, z_m)) == (x_m, y_m, z_m)


def test_up_is_negative_down() -> None:
    assert ned_from_enu(1.0, 2.0, 3.0) == (2.0, 1.0, -3.0)
