"""Pictures by ray casting (Embree), of the very triangles that the renderer drew."""

import time
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.projection import NEAR_M, Projection, projection_of
from reasoned_explorer.rendering.raster_kernels import GROUND_REACH_M, LEAST_SIZE
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import GROUND_ID, SKY_ID, Scene

#: Two surfaces whose distances differ by less, relatively, are in one place.
SAME_PLACE = 2e-6
#: One thing's surfaces whose distances differ by more, relatively, are different parts of it.
OTHER_PART = 1e-3


@dataclass(frozen=True)
class Comparison:
    """How far a picture is from the oracle's: the share of pixels that show something else, and the greatest relative
    error of depth among the others. Of two things in one place either is right."""

    wrong_share: float
    depth_error: float


def compared(
    renderer: Renderer,
    pose: Pose,
    camera: Camera,
    *,
    pitch_rad: float = 0.0,
    everything: bool = False,
    eye_error_m: float = 0.0,
) -> Comparison:
    view = projection_of(pose, camera, pitch_rad=pitch_rad)
    canvas = renderer._drawn(view, everything=everything)
    depth, ids = renderer._read(view, canvas)
    levels = shown_levels(renderer.scene, renderer._room().scratch.levels, view)
    moved = view._replace(eye=view.eye + eye_error_m * view.axes[0])
    true_depth, true_ids = cast(renderer.scene, levels, moved)
    solid = (ids != SKY_ID) & (true_ids != SKY_ID)
    error = np.zeros(ids.shape)
    error[solid] = np.abs(depth[solid] / true_depth[solid] - 1.0)
    wrong = (ids != true_ids) & ((error > SAME_PLACE) | ~solid)
    # Where a thing hides a part of its own, an edge may fall on the other side of a ray, too.
    wrong |= error > OTHER_PART
    return Comparison(float(wrong.mean()), float(error[~wrong].max(initial=0.0)))


def cast(scene: Scene, levels: np.ndarray, view: Projection) -> tuple[np.ndarray, np.ndarray]:
    """Depth along the axis and ids of instances drawn at levels (those at -1 are left out)."""
    soup, owners = soup_of(scene, levels, view)
    rays = rays_of(view)
    found = _embree(soup).run(*_single(rays), output=1)["primID"]
    ids = np.where(found >= 0, owners[found], SKY_ID)
    # Embree says which triangle; how far it is in double precision, as its own is not enough at grazing angles.
    a, b, c = np.moveaxis(soup[found], 1, 0)
    normals = np.cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(found >= 0, (normals * a).sum(axis=1) / (normals * rays).sum(axis=1), np.inf)
    return depth.reshape(view.height, view.width), ids.reshape(view.height, view.width)


def cast_seconds(scene: Scene, levels: np.ndarray, view: Projection) -> float:
    """This thread's time to cast a picture's rays, once Embree has its scene."""
    soup, _ = soup_of(scene, levels, view)
    embree, rays = _embree(soup), _single(rays_of(view))
    embree.run(*rays, output=1)
    begin = time.thread_time()
    embree.run(*rays, output=1)
    return time.thread_time() - begin


def soup_of(scene: Scene, levels: np.ndarray, view: Projection) -> tuple[np.ndarray, np.ndarray]:
    """Triangles about the eye that face it, shape (n, 3, 3), and their ids."""
    triangles, owners = [ground(view)], [np.full(2, GROUND_ID)]
    for i in np.flatnonzero(levels >= 0).tolist():
        own = corners_of(scene, i, levels[i]) - view.eye
        # Only what faces the eye: backs are not drawn.
        facing = (np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]) * own[:, 0]).sum(axis=1) < 0.0
        triangles.append(own[facing])
        owners.append(np.full(int(facing.sum()), scene.instances.ids[i]))
    return np.concatenate(triangles), np.concatenate(owners)


def rays_of(view: Projection) -> np.ndarray:
    """A ray through the middle of every sample, one metre along the axis, shape (n, 3)."""
    x = (np.arange(view.width) + 0.5 - view.centre_x) / view.focal
    y = (np.arange(view.height) + 0.5 - view.centre_y) / view.focal
    across, down = np.meshgrid(x, y)
    rays: np.ndarray = view.axes[2] + across[..., None] * view.axes[0] + down[..., None] * view.axes[1]
    return rays.reshape(-1, 3)


def _single(rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Origins on the near plane and directions, in single precision."""
    return (rays * NEAR_M).astype(np.float32), rays.astype(np.float32)


def _embree(soup: np.ndarray) -> EmbreeScene:
    scene = EmbreeScene()
    TriangleMesh(scene, soup.astype(np.float32))
    return scene


def shown_levels(scene: Scene, drawn: np.ndarray, view: Projection) -> np.ndarray:
    """The levels that were drawn; what was left out (it must be hidden) at its coarsest, but for what is too small."""
    levels = drawn.astype(np.int64)
    balls = scene.instances.balls
    size = 2.0 * balls[:, 3] * view.focal / np.maximum(np.linalg.norm(balls[:, :3] - view.eye, axis=1), 1e-9)
    coarsest = scene.library.prototypes[scene.instances.prototypes, 1] - 1
    ahead = (balls[:, :3] - view.eye) @ view.axes[2] > -balls[:, 3]
    left_out = (levels < 0) & ahead & (size > LEAST_SIZE * 1.0001)
    levels[left_out] = coarsest[left_out]
    return levels


def corners_of(scene: Scene, i: int, level: int) -> np.ndarray:
    """World coordinates of an instance's triangles, shape (n, 3, 3)."""
    library, instances = scene.library, scene.instances
    _, _, first, count = library.levels[library.prototypes[instances.prototypes[i], 0] + level]
    points = library.vertices[library.triangles[first : first + count]] * instances.scales[i]
    sine, cosine = instances.turns[i]
    east = points[..., 0] * cosine + points[..., 1] * sine
    north = points[..., 1] * cosine - points[..., 0] * sine
    corners: np.ndarray = np.stack([east, north, points[..., 2]], axis=-1) + instances.places[i]
    return corners


def ground(view: Projection) -> np.ndarray:
    """The plane z = 0 about the eye, as far ahead as it is drawn."""
    forward = view.axes[2] * (1.0, 1.0, 0.0)
    length = float(np.linalg.norm(forward))
    if length < 1e-6:
        forward, length = np.array([0.0, 1.0, 0.0]), 1.0
    forward /= length
    side = np.array([forward[1], -forward[0], 0.0])
    reach = (
        (GROUND_REACH_M + view.eye[2] * view.axes[2, 2]) / view.axes[2, :2].dot(forward[:2]) if length > 0.01 else 1e3
    )
    near, wide = -1000.0, 4.0 * reach
    foot = np.array([0.0, 0.0, -view.eye[2]])
    a, b = foot + near * forward - wide * side, foot + near * forward + wide * side
    c, d = foot + reach * forward + wide * side, foot + reach * forward - wide * side
    return np.array([[a, b, c], [a, c, d]])
