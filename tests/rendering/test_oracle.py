"""Depth and ids are those of a ray caster that shares no code with the renderer."""

import math

import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import Scene
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.world import World

pytest.importorskip("embreex", reason="the oracle of pictures: pip install embreex")

from tests.rendering.oracle import Comparison, compared

CAMERA = Camera(160, 120, math.radians(80.0))
VIEWS = 25


def poses(world: World, count: int, seed: int) -> list[tuple[Pose, float]]:
    """Random poses along ways, in all directions, some from above, with random pitches."""
    rng = np.random.default_rng(seed)
    ways = [way for way in world.ways if way.level == 0]
    found = []
    for k in range(count):
        line = ways[rng.integers(len(ways))].line
        at = rng.integers(len(line) - 1)
        x, y = line[at] + rng.random() * (line[at + 1] - line[at])
        height = 12.0 if k % 5 == 0 else rng.uniform(0.3, 2.0)
        found.append((Pose(x, y, height, rng.uniform(0.0, 2.0 * math.pi)), rng.uniform(-0.5, 0.3)))
    return found


def comparisons(renderer: Renderer, world: World, count: int, **options) -> list[Comparison]:
    return [compared(renderer, pose, CAMERA, pitch_rad=pitch, **options) for pose, pitch in poses(world, count, 7)]


def mean_wrong(found: list[Comparison]) -> float:
    return sum(one.wrong_share for one in found) / len(found)


@pytest.fixture(scope="module", params=["downtown:3@250", "park:2@250"])
def drawn(request) -> tuple[Renderer, World]:
    world = open_world(request.param)
    return Renderer(Scene.of(world)), world


def test_ids_and_depth_agree(drawn) -> None:
    found = comparisons(*drawn, VIEWS)
    assert mean_wrong(found) <= 1e-4
    assert max(one.depth_error for one in found) <= 1e-5


def test_a_camera_five_millimetres_off_is_noticed(drawn) -> None:
    assert mean_wrong(comparisons(*drawn, 12, eye_error_m=0.005)) > 2e-4


def test_without_levels_and_culling_they_agree_too() -> None:
    world = open_world("park:2@100")
    found = comparisons(Renderer(Scene.of(world)), world, 4, everything=True)
    assert mean_wrong(found) <= 1e-4
    assert max(one.depth_error for one in found) <= 1e-5


def test_in_a_real_place(osm_folder) -> None:
    world = open_world(str(osm_folder / "munich-centre.osm.pbf"))
    found = comparisons(Renderer(Scene.of(world)), world, VIEWS)
    assert mean_wrong(found) <= 1e-4
    assert max(one.depth_error for one in found) <= 1e-5
