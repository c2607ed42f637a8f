"""Heights of buildings come from the map where it says something."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.world.osm.buildings import heights_of, is_building


@pytest.mark.parametrize(
    ("tags", "top_m", "bottom_m", "source"),
    [
        ({"building": "yes", "height": "12,5"}, 12.5, 0.0, "height"),
        ({"building": "yes", "building:height": "40'"}, 12.192, 0.0, "height"),
        ({"building": "yes", "building:levels": "4", "roof:levels": "1"}, 15.0, 0.0, "levels"),
        ({"building": "yes", "height": "-4", "building:levels": "2"}, 6.0, 0.0, "levels"),
        ({"building:part": "yes", "height": "20", "min_height": "8"}, 20.0, 8.0, "height"),
        ({"building:part": "yes", "height": "20", "building:min_level": "2"}, 20.0, 6.0, "height"),
        ({"building": "yes", "height": "5", "min_height": "9"}, 5.0, 0.0, "height"),
        ({"building": "roof", "height": "4"}, 4.0, 3.6, "height"),
    ],
)
def test_heights(tags: dict[str, str], top_m: float, bottom_m: float, source: str) -> None:
    heights = heights_of(tags, area_m2=200.0, seed=0, key=1)
    assert heights.top_m == pytest.approx(top_m)
    assert heights.bottom_m == pytest.approx(bottom_m)
    assert heights.source == source


def test_defaults_depend_on_seed_and_type_only() -> None:
    house = heights_of({"building": "house"}, area_m2=100.0, seed=1, key=7)
    assert house == heights_of({"building": "house"}, area_m2=100.0, seed=1, key=7)
    assert house.source == "default"
    assert house != heights_of({"building": "house"}, area_m2=100.0, seed=2, key=7)
    assert 5.5 <= house.top_m <= 8.5
    assert heights_of({"building": "yes"}, area_m2=10.0, seed=1, key=7).top_m <= 4.0


@settings(deadline=None, max_examples=100)
@given(
    st.dictionaries(
        st.sampled_from(["height", "min_height", "building:levels", "building:min_level", "roof:levels", "building"]),
        st.one_of(st.text(max_size=6), st.floats().map(str), st.integers().map(str)),
    )
)
def test_any_heights_are_sane(tags: dict[str, str]) -> None:
    heights = heights_of(tags, area_m2=100.0, seed=0, key=1)
    assert math.isfinite(heights.top_m)
    assert 0.0 <= heights.bottom_m < heights.top_m


@pytest.mark.parametrize(
    ("tags", "expected"),
    [({"building": "yes"}, True), ({"building": "no"}, False), ({"building": "yes", "layer": "-1"}, False),
     ({"building": "construction"}, False), ({"building:part": "yes"}, True), ({}, False)],
)  # fmt: skip
def test_what_is_a_building(tags: dict[str, str], expected: bool) -> None:
    assert is_building(tags) is expected
