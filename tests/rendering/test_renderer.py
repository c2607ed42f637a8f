"""What pictures show, and that they are the same however they come about."""

import hashlib
import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, SettingsError
from reasoned_explorer.rendering.conditions import PRESETS, Conditions
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.projection import projection_of, resized
from reasoned_explorer.rendering.renderer import Picture, Renderer
from reasoned_explorer.rendering.scene import PICTURE_CLASSES, Scene
from reasoned_explorer.world.opening import open_world
from tests.rendering.things import FIRST, box, flat_mesh, scene_of

CAMERA = Camera(64, 48)
EYE = Pose(0.0, -6.0, 1.5, 0.0)


def digest(picture: Picture) -> str:
    parts = picture.colour.tobytes() + picture.depth_m.tobytes() + picture.instances.tobytes()
    return hashlib.sha256(parts).hexdigest()


@pytest.mark.parametrize(("aside_m", "is_drawn"), [(1.63, False), (2.2, True)])
def test_what_a_wall_hides_is_not_drawn_though_its_block_is_partly_free(aside_m: float, is_drawn: bool) -> None:
    # The wall ends within the block of samples from 40 to 47; the post stands there, behind the wall or beside it.
    wall, post = box((1.8, 0.2, 3.0)), box((0.2, 0.2, 1.0))
    renderer = Renderer(scene_of([(wall, (0.0, -2.9, 0.0)), (post, (aside_m, 0.0, 0.0))]))
    picture = renderer.ids(EYE, CAMERA)
    assert (renderer._room().scratch.levels[1] >= 0) == is_drawn
    assert (FIRST + 1 in picture.instances) == is_drawn


def test_a_box_stands_where_it_is() -> None:
    renderer = Renderer(scene_of([(box((2.0, 2.0, 2.0)), (0.0, 0.0, 0.0)), (box(), (3.0, 4.0, 0.0))]))
    picture = renderer.picture(EYE, CAMERA)
    assert picture.instances[24, 32] == FIRST
    assert picture.depth_m[24, 32] == pytest.approx(5.0, rel=1e-6)
    assert picture.instances[0, 0] == 0
    assert np.isinf(picture.depth_m[0, 0])
    assert picture.instances[-1, 0] == 1
    # A row below the horizon sees the ground at height · focal / offset.
    assert picture.depth_m[-1, 0] == pytest.approx(1.5 * 32.0 / 23.5, rel=1e-6)
    assert (np.argwhere(picture.instances == FIRST + 1)[:, 1] > 32).all()  # to the right is east


def test_headings_and_pitches_turn_the_right_way() -> None:
    renderer = Renderer(scene_of([(box((1.0, 1.0, 3.0)), (6.0, 0.0, 0.0))]))
    assert (renderer.ids(Pose(0.0, 0.0, 1.5, math.pi / 2), CAMERA).instances[:, 31:33] == FIRST).any()
    up = renderer.ids(Pose(0.0, 0.0, 1.5, math.pi / 2), CAMERA, pitch_rad=0.2).instances
    level = renderer.ids(Pose(0.0, 0.0, 1.5, math.pi / 2), CAMERA).instances
    assert np.argwhere(up == FIRST)[:, 0].mean() > np.argwhere(level == FIRST)[:, 0].mean() + 3
    assert (up == 0).sum() > (level == 0).sum()


def test_ids_are_those_of_pictures() -> None:
    world = open_world("park:1@150")
    renderer = Renderer(Scene.of(world))
    sighted, picture = renderer.ids(EYE, CAMERA), renderer.picture(EYE, CAMERA)
    assert (sighted.instances == picture.instances).all()
    assert (sighted.depth_m == picture.depth_m).all()
    smaller = Camera(32, 24)
    assert (
        renderer.ids_in(resized(projection_of(EYE, CAMERA), smaller)).depth_m == renderer.ids(EYE, smaller).depth_m
    ).all()
    first_object = FIRST + len(world.buildings)
    classes = renderer.classes(picture.instances)
    for instance in np.unique(picture.instances[picture.instances >= first_object]):
        name = world.objects[instance - first_object].class_name
        assert {PICTURE_CLASSES[code] for code in classes[picture.instances == instance]} == {name}


def test_antialiasing_changes_edges_alone() -> None:
    renderer = Renderer(scene_of([(box((2.0, 2.0, 2.0), (0.9, 0.1, 0.1)), (0.3, 0.0, 0.0))]))
    plain, smooth = renderer.picture(EYE, CAMERA), renderer.picture(EYE, CAMERA, antialias=2)
    assert (plain.instances != smooth.instances).mean() < 0.02
    far = np.abs(plain.colour.astype(int) - smooth.colour.astype(int)).max(axis=2)
    assert np.median(far) <= 2
    reds = smooth.colour[..., 0].astype(int) - smooth.colour[..., 1]
    assert len(np.unique(reds)) > len(np.unique(plain.colour[..., 0].astype(int) - plain.colour[..., 1]))


@pytest.fixture(scope="module")
def park() -> Scene:
    return Scene.of(open_world("park:1@150"))


def some_poses() -> list[Pose]:
    rng = np.random.default_rng(3)
    return [Pose(*rng.uniform(-60.0, 60.0, 2), 1.6, rng.uniform(0.0, 6.28)) for _ in range(8)]


def test_threads_and_order_change_nothing(park: Scene) -> None:
    alone = Renderer(park)
    expected = [digest(alone.picture(pose, CAMERA)) for pose in some_poses()]
    shared = Renderer(park)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda pose: digest(shared.picture(pose, CAMERA)), some_poses()[::-1] * 3))
    assert found == expected[::-1] * 3
    assert [digest(alone.picture(pose, CAMERA)) for pose in some_poses()] == expected


@pytest.mark.parametrize("conditions", ["clear", "rain"])
def test_how_many_threads_shade_a_picture_changes_nothing(conditions: str, park: Scene) -> None:
    alone, several = Renderer(park, PRESETS[conditions]), Renderer(park, PRESETS[conditions], threads=3)
    for pose in some_poses()[:4]:
        for antialias in (1, 2):
            expected = digest(alone.picture(pose, CAMERA, antialias=antialias))
            assert digest(several.picture(pose, CAMERA, antialias=antialias)) == expected
    with pytest.raises(SettingsError, match="0 threads; expected 1 or more"):
        Renderer(park, threads=0)


def test_room_for_few_shadow_tiles_changes_nothing(park: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = [digest(Renderer(park).picture(pose, CAMERA)) for pose in some_poses()]
    monkeypatch.setattr("reasoned_explorer.rendering.shadows.FINE_TILES", 40)
    monkeypatch.setattr("reasoned_explorer.rendering.shadows.COARSE_TILES", 30)
    shared = Renderer(park)
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(lambda pose: digest(shared.picture(pose, CAMERA)), some_poses())) == expected


def test_processes_agree(park: Scene) -> None:
    program = (
        "from tests.rendering.test_renderer import *\n"
        "renderer = Renderer(Scene.of(open_world('park:1@150')))\n"
        "print([digest(renderer.picture(pose, CAMERA)) for pose in some_poses()])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    renderer = Renderer(park)
    assert done.stdout.strip() == str([digest(renderer.picture(pose, CAMERA)) for pose in some_poses()])


def test_shadows_fall_away_from_the_sun() -> None:
    south = Conditions(sun_elevation_rad=math.radians(45.0), sun_azimuth_rad=math.pi)
    renderer = Renderer(scene_of([(box((1.0, 1.0, 2.0)), (0.0, 0.0, 0.0))]), south)
    above = renderer.picture(Pose(0.0, 0.0, 12.0, 0.0), Camera(96, 96), pitch_rad=-math.pi / 2)

    def brightness(x_m: float, y_m: float) -> float:
        row, column = 48 - y_m * 48 / 12.0, 48 + x_m * 48 / 12.0
        return float(above.colour[int(row), int(column)].mean())

    lit = brightness(-3.0, -3.0)
    assert brightness(0.0, 1.6) < 0.7 * lit  # two metres high: two metres long
    assert brightness(0.0, 3.2) == pytest.approx(lit, rel=0.15)
    assert brightness(0.0, -1.2) == pytest.approx(lit, rel=0.15)
    assert brightness(1.4, 1.2) == pytest.approx(lit, rel=0.15)


@pytest.mark.parametrize("elevation_deg", [8.0, 25.0, 60.0])
@pytest.mark.parametrize("tilt_deg", [0.0, 20.0, 70.0])
def test_thin_double_faces_do_not_darken_themselves(elevation_deg: float, tilt_deg: float) -> None:
    # A board a few metres up, facing the sun more or less, given both ways round.
    tilt = math.radians(tilt_deg)
    across, along = np.array([2.0, 0.0, 0.0]), np.array([0.0, math.cos(tilt), math.sin(tilt)]) * 2.0
    middle = np.array([0.0, 0.0, 4.0])
    corners = [middle - across - along, middle + across - along, middle + across + along, middle - across + along]
    faces = [[corners[i] for i in order] for order in ((0, 1, 2), (0, 2, 3), (2, 1, 0), (3, 2, 0))]
    board = Model((flat_mesh(faces),), (4.0, 4.0, 6.0))
    renderer = Renderer(
        scene_of([(board, (0.0, 0.0, 0.0))]),
        Conditions(sun_elevation_rad=math.radians(elevation_deg), sun_azimuth_rad=math.pi),
    )
    picture = renderer.picture(Pose(0.0, -5.0, 9.0, 0.0), Camera(96, 96), pitch_rad=-0.8)
    seen = picture.colour[picture.instances == FIRST].astype(float)
    assert len(seen) > 300
    assert np.ptp(seen[:, 1]) < 16.0


def test_mirrors_do_not_show_what_was_drawn_before(park: Scene) -> None:
    rain = Renderer(park, PRESETS["rain"])
    first = [digest(rain.picture(pose, CAMERA)) for pose in some_poses()]
    assert [digest(rain.picture(pose, CAMERA)) for pose in some_poses()[::-1]] == first[::-1]


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_conditions_look_different(name: str, park: Scene) -> None:
    picture = Renderer(park, PRESETS[name]).picture(some_poses()[0], CAMERA, antialias=2)
    assert 40 < picture.colour.mean() < 215
    others = [Renderer(park, PRESETS[other]).picture(some_poses()[0], CAMERA, antialias=2) for other in PRESETS]
    assert sum((other.colour == picture.colour).all() for other in others) == 1
    assert all((other.instances == picture.instances).all() for other in others)


def test_glowing_things_are_as_bright_in_shadow() -> None:
    roof = box((8.0, 8.0, 0.2))
    lamp = box((0.5, 0.5, 0.5), (1.0, 0.9, 0.6), Material.GLOW)
    renderer = Renderer(scene_of([(roof, (0.0, 0.0, 4.0)), (lamp, (0.0, 0.0, 1.2))]))
    bare = Renderer(scene_of([(lamp, (0.0, 0.0, 1.2))]))
    assert (renderer.picture(EYE, CAMERA).colour[24, 32] == bare.picture(EYE, CAMERA).colour[24, 32]).all()


@pytest.mark.parametrize(
    ("camera", "options", "fault"),
    [
        (Camera(0, 10), {}, "width_px"),
        (Camera(10, 10, 4.0), {}, "horizontal_fov_rad"),
        (CAMERA, {"antialias": 3}, "antialias"),
        (CAMERA, {"pitch_rad": 2.0}, "pitch_rad"),
    ],
)
def test_what_cannot_be_drawn_is_said(camera: Camera, options: dict, fault: str, park: Scene) -> None:
    with pytest.raises(SettingsError, match=fault):
        Renderer(park).picture(EYE, camera, **options)


def test_an_empty_scene_is_ground_and_sky() -> None:
    picture = Renderer(scene_of([])).picture(EYE, CAMERA)
    assert set(np.unique(picture.instances)) == {0, 1}
