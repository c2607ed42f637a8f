import numpy as np
import pytest

from reasoned_explorer.serving.airsim.scenery import Scenery
from reasoned_explorer.world.atlas import Atlas
from tests.world.worlds import courtyard


@pytest.fixture
def scenery():
    return Scenery(Atlas(courtyard()))


def test_things_are_called_by_class_and_place(scenery):
    assert scenery.matching("bench_.*") == ["bench_0", "bench_7"]
    assert scenery.matching("BUILDING_0") == ["building_0"]  # case aside, as with AirSim
    assert "Sky" not in scenery.matching(".*")


def test_things_stand_where_the_world_says(scenery):
    bench = scenery.pose_of("bench_0")
    assert (bench.x_m, bench.y_m) == (50.0, 28.0)
    assert scenery.pose_of("building_0").x_m == 35.0
    assert scenery.pose_of("Ground") is None


def test_numbers_can_be_given_one_by_one_and_by_pattern(scenery):
    assert scenery.number("bench_0", 7, is_pattern=False)
    assert scenery.number("tree_.*", 9, is_pattern=True)
    assert (scenery.id_of("bench_0"), scenery.id_of("tree_1")) == (7, 9)
    instances = np.array([[0, 1], [scenery.names.index("bench_0"), scenery.names.index("tree_1")]], np.int32)
    assert scenery.numbered(instances).tolist() == [[0, 1], [7, 9]]
    scenery.reset()
    assert scenery.id_of("bench_0") != 7


@pytest.mark.parametrize("pattern", ["(a+)+$", "(", "a*b*c*d*e*", "x" * 201, "(?:a|a)*b", "(x){50}"])
def test_patterns_that_are_none_or_would_take_long_are_refused(scenery, pattern):
    with pytest.raises(ValueError, match="regular expression"):
        scenery.matching(pattern)
