"""Worlds with faults are refused with all of them."""

import dataclasses
import math

import numpy as np
import pytest

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import WorldError
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.validation import check_world
from reasoned_explorer.world.world import Bounds, Building, Region, Way
from tests.world.worlds import box, courtyard


def changed(part, place, **changes):
    world = courtyard()
    members = list(getattr(world, part))
    members[place] = dataclasses.replace(members[place], **changes)
    return dataclasses.replace(world, **{part: tuple(members)})


def test_a_sound_world_passes():
    check_world(courtyard())


@pytest.mark.parametrize(
    ("world", "says"),
    [
        (changed("objects", 0, x_m=math.nan), "finite"),
        (changed("objects", 0, heading_rad=math.inf), "heading_rad"),
        (changed("objects", 0, id=5), "has the id 5"),
        (changed("objects", 0, class_name="benhc"), "did you mean bench"),
        (changed("objects", 0, size_m=(1.0, 0.0, 1.0)), "width of 0.0 m"),
        (changed("objects", 0, x_m=-0.5), "outside the bounds"),
        (changed("objects", 0, outline=box(0, 0, 1, 1)[:2]), "outline of 2 points"),
        (changed("objects", 0, building=3), "building = 3"),
        (changed("regions", 0, outer=np.asarray([(0.0, 0.0), (1.0, math.nan), (2.0, 2.0)])), "not finite"),
        (changed("regions", 0, outer=np.zeros((4, 3))), r"shape \(4, 3\)"),
        (changed("regions", 0, holes=(box(0, 0, 1, 1)[:2],)), "hole 0 of 2 points"),
        (changed("regions", 0, ground=7), "ground = 7"),
        (changed("ways", 0, line=np.asarray([(0.0, 0.0)])), "line of 1 points"),
        (changed("ways", 0, width_m=-1.0), "width of -1.0 m"),
        (changed("buildings", 0, height_m=math.nan), "height of nan"),
        (changed("buildings", 0, min_height_m=12.0), "underside below the roof"),
        (changed("buildings", 0, height_source="guess"), "guess"),
        (changed("buildings", 0, entrances=np.asarray([1.0, 2.0])), "entrances of shape"),
        (dataclasses.replace(courtyard(), bounds=Bounds(0, 0, 0, 80)), "are empty"),
        (dataclasses.replace(courtyard(), bounds=Bounds(0, 0, 5001, 5001)), "25.0 km²"),
        (dataclasses.replace(courtyard(), bounds=Bounds(0, 0, math.inf, 80)), "finite"),
        (dataclasses.replace(courtyard(), origin=GeoOrigin(91.0, 0.0)), "latitude 91"),
    ],
)
def test_faults_are_named(world, says):
    with pytest.raises(WorldError, match=says):
        check_world(world)


def test_all_faults_at_once():
    world = dataclasses.replace(
        courtyard(),
        regions=(Region(Ground.GRASS, np.zeros((1, 2))),),
        ways=(Way("path", Ground.PATH, np.zeros((1, 2)), 0.0),),
        buildings=(Building(np.zeros((2, 2)), -3.0), Building(box(0, 0, 1, 1), 3.0)),
    )
    with pytest.raises(WorldError) as caught:
        check_world(world)
    assert len(caught.value.faults) == 6


def test_a_flood_of_faults_is_counted():
    objects = tuple(dataclasses.replace(courtyard().objects[0], x_m=-1.0) for _ in range(80))
    with pytest.raises(WorldError, match="more faults") as caught:
        check_world(dataclasses.replace(courtyard(), objects=objects))
    assert len(caught.value.faults) == 51
