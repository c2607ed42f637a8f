import math
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.cli.parsing import check_start_form, parse_bbox, parse_start, parse_worlds
from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import ReasonedExplorerError, StartError, WorldError
from tests.world.worlds import courtyard

HERE = courtyard()
MUNICH = replace(HERE, origin=GeoOrigin(48.1374, 11.5755))


def test_a_start_in_a_generated_world_is_in_metres() -> None:
    start = parse_start("12.5,-3,90", HERE)
    assert start is not None
    assert (start.x_m, start.y_m) == (12.5, -3.0)
    assert start.heading_rad == pytest.approx(math.pi / 2)


def test_a_start_in_a_real_place_is_on_earth() -> None:
    start = parse_start("48.1380, 11.5756, -90", MUNICH)
    assert start is not None
    assert start.x_m == pytest.approx(7.4, abs=0.1)
    assert start.y_m == pytest.approx(66.7, abs=0.2)
    assert start.heading_rad == pytest.approx(1.5 * math.pi)


def test_the_heading_may_be_left_out_and_is_then_north() -> None:
    start = parse_start("1,2", HERE)
    assert start is not None
    assert start.heading_rad == 0.0


def test_all_faults_of_a_start_are_told_at_once() -> None:
    with pytest.raises(StartError) as raised:
        parse_start("nan,north", HERE)
    assert len(raised.value.faults) == 2
    with pytest.raises(StartError, match=r"is off courtyard; expected latitude 48\.1374 to 48\.1381"):
        parse_start("48.2,11.57,0", MUNICH)
    with pytest.raises(StartError, match="latitude comes first"):
        parse_start("111.57,48.13,0", MUNICH)


@pytest.mark.parametrize("text", ["", "1,2,3", "1,2,3,four", "1,2,3,inf"])
def test_a_bounding_box_is_four_numbers(text: str) -> None:
    with pytest.raises(WorldError, match="lon0,lat0,lon1,lat1"):
        parse_bbox(text)


@given(st.text(max_size=40))
def test_whatever_is_typed_is_understood_or_refused(text: str) -> None:
    for parse in (lambda: parse_start(text, HERE), lambda: parse_bbox(text)):
        with suppress(ReasonedExplorerError):
            parse()


@pytest.mark.parametrize("heading", ["900", "-361", "1e9"])
def test_a_heading_is_within_a_turn(heading: str) -> None:
    for refuse in (lambda: parse_start(f"1,2,{heading}", HERE), lambda: check_start_form(f"1,2,{heading}")):
        with pytest.raises(StartError, match="-360 to 360 degrees, clockwise from north"):
            refuse()


def test_every_fault_of_a_text_says_something_of_its_own() -> None:
    with pytest.raises(WorldError) as raised:
        parse_bbox("1,2,3")
    assert [fault.what for fault in raised.value.faults] == ["3 values"]


def test_worlds_stand_between_commas_and_a_file_with_commas_is_one(tmp_path: Path) -> None:
    town = tmp_path / "bay,north.osm"
    town.touch()
    assert parse_worlds(["park:1@300, plaza:2@300", str(town)]) == ("park:1@300", "plaza:2@300", str(town))
    assert parse_worlds([]) == ()
    assert parse_worlds([""]) == ("",)
