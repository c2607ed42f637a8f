"""A world in figures."""

import dataclasses

import pytest

from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.summary import summarise
from reasoned_explorer.world.taxonomy import Ground
from tests.world.worlds import courtyard


def test_figures():
    summary = summarise(courtyard())
    assert summary.area_km2 == pytest.approx(0.008)
    assert summary.objects["bench"] == 2
    assert next(iter(summary.objects)) == "bench"
    assert summary.buildings == 3
    assert summary.entrances == 2
    assert summary.height_sources == pytest.approx({"height": 1 / 3, "levels": 1 / 3, "default": 1 / 3})
    assert summary.ways_m["residential"] == pytest.approx(100.0)
    assert summary.ways_m["footway"] == pytest.approx(100.0 + (20.0**2 + 27.0**2) ** 0.5)
    assert summary.ground[Ground.ROAD] == pytest.approx(0.1)
    assert Ground.SAND not in summary.ground
    assert sum(summary.ground.values()) == pytest.approx(1.0)


def test_lines_say_it_to_people():
    text = "\n".join(summarise(courtyard()).lines())
    for words in (
        "100 m × 80 m",
        "2  benches",
        "1  fire hydrant",
        "unknown ground",
        "residential 0.10 km",
        "assumed 33.3 %",
    ):
        assert words in text


def test_a_ground_at_hand_is_used():
    world = courtyard()
    assert summarise(world, GroundRaster.of(world, cell_m=1.0)).ground[Ground.ROAD] == pytest.approx(0.1)


def test_an_empty_world():
    world = dataclasses.replace(courtyard(), regions=(), ways=(), buildings=(), objects=())
    summary = summarise(world)
    assert summary.unknown_share == 1.0
    assert "ways: none" in summary.lines()
