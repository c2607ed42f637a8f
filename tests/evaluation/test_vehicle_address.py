"""Vehicles that are named by where they are reached."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.vehicle_address import (
    AirSimAddress,
    Go1Address,
    MavlinkAddress,
    VehicleAddress,
    check_place,
    vehicle_address,
)
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import InputError, SettingsError
from reasoned_explorer.vehicles.airsim.place import ServedPlace
from reasoned_explorer.vehicles.mavlink.address import Address, Wire

HERE = AirSimAddress("127.0.0.1")


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("airsim://127.0.0.1", HERE),
        ("airsim://127.0.0.1:41451/", HERE),
        (" AirSim://127.0.0.1 ", HERE),
        ("airsim://sim.lan:9", AirSimAddress("sim.lan", 9)),
        ("airsim://[::1]:9", AirSimAddress("::1", 9)),
        ("mavlink:udpin:192.168.1.2:14550", MavlinkAddress(Address(Wire.UDP_IN, "192.168.1.2", 14550))),
        ("go1@mavlink:/dev/ttyACM0:57600", MavlinkAddress(Address(Wire.SERIAL, "/dev/ttyACM0", 57600), "go1")),
        ("go1://192.168.123.161", Go1Address("192.168.123.161", 8082)),
        ("go1-authors@go1://[::1]:9", Go1Address("::1", 9, "go1-authors")),
        ("drone-authors@airsim://127.0.0.1", AirSimAddress("127.0.0.1", 41451, "drone-authors")),
    ],
)
def test_an_address_is_read(text: str, address: VehicleAddress) -> None:
    assert vehicle_address(text) == address
    assert vehicle_address(f"{address.profile}@{address}") == address


@pytest.mark.parametrize("name", ["drone", "go1-authors", "", "airsim"])
def test_the_name_of_a_profile_is_none(name: str) -> None:
    assert vehicle_address(name) is None


@pytest.mark.parametrize(
    "text",
    [
        "airsim://",
        "airsim://host:0",
        "airsim://host:70000",
        "airsim://host:x",
        "airsim://host/path",
        "airsim://user@host",
        "airsim://host?x=1",
        "ship://host",
        "airsim:host",
        "mavlink:",
        "mavlink://host:14550",
        "mavlink:udpin:host",
        "nobody@mavlink:tcp:host:5760",
        "go1@airsim://host",
        "go1://",
        "go1:host",
        "go1://host:0",
        "drone@go1://host",
        "nobody@airsim://host",
        "airsim://[::1",
    ],
)
def test_what_is_none_is_told(text: str) -> None:
    with pytest.raises(InputError):
        vehicle_address(text)


@given(st.text(max_size=40))
def test_any_text_is_an_address_or_none_or_refused(text: str) -> None:
    try:
        vehicle_address(text)
        vehicle_address(f"airsim://{text}")
        vehicle_address(f"mavlink:{text}")
        vehicle_address(f"go1://{text}")
    except InputError:
        pass


def test_a_mission_begins_where_the_vehicle_stands_in_its_world() -> None:
    place = ServedPlace("plaza:3@200", "abc", Pose(1.0, 2.0, 0.0, 3.0), Pose(0.0, 0.0))
    assert check_place(place, "abc", HERE) == place
    with pytest.raises(SettingsError, match="another world, plaza:3@200"):
        check_place(place, "def", HERE)
    with pytest.raises(SettingsError, match="--start"):
        check_place(None, "abc", HERE)


def test_only_what_may_be_real_asks_whether_it_may_move() -> None:
    assert not HERE.may_be_real
    assert MavlinkAddress(Address(Wire.TCP, "127.0.0.1", 5760)).may_be_real
    assert Go1Address("127.0.0.1").may_be_real
