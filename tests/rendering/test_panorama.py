"""Pictures all around and of several cameras."""

import math

import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, SettingsError
from reasoned_explorer.rendering.panorama import panorama, side_by_side
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import Scene
from reasoned_explorer.world.opening import open_world
from tests.rendering.things import FIRST, box, scene_of

EYE = Pose(0.0, 0.0, 1.5, 0.0)


@pytest.fixture(scope="module")
def park() -> Renderer:
    return Renderer(Scene.of(open_world("park:1@150")))


def test_every_column_of_a_panorama_is_one_heading() -> None:
    """A post at each of eight compass points stands where its heading says, the camera's own in the middle."""
    posts = [
        (box((0.3, 0.3, 3.0)), (10.0 * math.sin(k * math.pi / 4), 10.0 * math.cos(k * math.pi / 4), 0.0))
        for k in range(8)
    ]
    picture = panorama(Renderer(scene_of(posts)), EYE, width_px=512, height_px=64, antialias=1)
    for k in range(8):
        columns = np.unique(np.argwhere(picture.instances == FIRST + k)[:, 1])
        if k == 4:  # behind: the seam
            columns = np.where(columns < 256, columns + 512, columns)
        wanted = (0.5 + k / 8.0) % 1.0 * 512 if k != 4 else 512
        assert columns.mean() + 0.5 == pytest.approx(wanted, abs=0.6)


def test_its_depth_is_along_the_ground() -> None:
    tower = (box((2.0, 2.0, 30.0)), (0.0, 20.0, 0.0))
    picture = panorama(Renderer(scene_of([tower])), EYE, width_px=512, height_px=96, antialias=1)
    on_the_face = picture.depth_m[:, 256][picture.instances[:, 256] == FIRST]
    assert len(on_the_face) > 40
    assert on_the_face == pytest.approx(19.0, rel=1e-4)


def test_no_seam_shows(park: Renderer) -> None:
    """The picture drawn column by column, where nothing can be off, is all but the same."""
    pose, width_px, height_px = EYE.facing(0.7), 256, 64
    picture = panorama(park, pose, width_px=width_px, height_px=height_px)
    focal_px = width_px / (2.0 * math.pi)
    camera = Camera(1, height_px, 2.0 * math.atan(0.5 / focal_px))
    turns = [((column + 0.5) / width_px - 0.5) * 2.0 * math.pi for column in range(width_px)]
    exact = side_by_side(park, pose, camera, turns)
    assert (picture.instances != exact.instances).mean() < 0.01
    apart = np.abs(picture.colour.astype(int) - exact.colour.astype(int)).max(axis=2)
    assert np.median(apart) <= 1
    assert (apart > 24).mean() < 0.02
    # And the columns at which strips meet are no worse than the rest.
    worst = apart.mean(axis=0)
    assert worst.max() < 12.0


def test_a_panorama_turned_is_the_same_picture_moved(park: Renderer) -> None:
    north, east = (panorama(park, EYE.facing(heading), width_px=256, height_px=48) for heading in (0.0, math.pi / 2))
    assert (np.roll(north.instances, -64, axis=1) == east.instances).mean() > 0.98


def test_views_stand_side_by_side_from_left_to_right(park: Renderer) -> None:
    camera, bearings = Camera(40, 32), (-0.8, 0.0, 0.8)
    together = side_by_side(park, EYE, camera, bearings)
    assert together.colour.shape == (32, 120, 3)
    for place, bearing in enumerate(bearings):
        alone = park.picture(EYE.facing(bearing), camera, antialias=2)
        here = slice(40 * place, 40 * place + 40)
        assert (together.colour[:, here] == alone.colour).all()
        assert (together.depth_m[:, here] == alone.depth_m).all()


def test_what_cannot_be_drawn_is_refused(park: Renderer) -> None:
    with pytest.raises(SettingsError, match="at least 16 pixels"):
        panorama(park, EYE, width_px=4)
    with pytest.raises(SettingsError, match="at least one"):
        side_by_side(park, EYE, Camera(8, 8), [])
