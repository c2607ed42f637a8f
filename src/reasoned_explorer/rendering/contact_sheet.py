"""One picture of every class of objects close up, with its name and somebody beside it for scale."""

import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.rendering.conditions import Conditions
from reasoned_explorer.rendering.ground import GroundMap
from reasoned_explorer.rendering.ground_map import ground_colours, ground_materials
from reasoned_explorer.rendering.library import linear_from_srgb
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.mesh_builder import MeshBuilder, Surface
from reasoned_explorer.rendering.models import model_of, tints_of, variants_of
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import FIRST_BUILDING_ID, Placed, Scene
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground

if TYPE_CHECKING:
    from PIL.Image import Image

#: The camera sees a thing's front from this far to its side and this far above level, radians; areas from higher up.
_ASIDE_RAD, _ABOVE_RAD, _ABOVE_AREA_RAD = math.radians(28.0), math.radians(9.0), math.radians(30.0)
#: Wherever the sun stands by the conditions, here it lights fronts, from the camera's other side: its compass heading.
_SUN_AZIMUTH_RAD = math.radians(325.0)
_FOV_RAD = math.radians(42.0)
#: The share of the picture that is left free around the thing.
_RIM = 0.08
#: Somebody stands so far beside a thing, metres, and is one of the grown-ups among the models.
_BESIDE_M, _PERSON_VARIANT = 0.55, 0
#: A wall reaches so far beyond a front to each side and above it, metres.
_WALL_BEYOND_M = 1.2
_WALL = Surface(Material.PLASTER, (0.78, 0.74, 0.66))
#: The ground is so wide, metres.
_GROUND_M = 240
_GROUND_OF_KIND = defaultdict(lambda: Ground.PAVEMENT, plant=Ground.GRASS, vehicle=Ground.ROAD)
_GROUNDS = {"lawn": Ground.GRASS, "pitch": Ground.PITCH, "playground": Ground.PLAYGROUND}
_NAME_PX, _GAP_PX = 20, 4
_PAPER, _INK = (250, 249, 246), (32, 34, 38)

Points = NDArray[np.float64]


def contact_sheet(
    *,
    cell_px: int = 224,
    columns: int = 9,
    conditions: Conditions | None = None,
    class_names: Sequence[str] = CLASS_NAMES,
    on_class: Callable[[str], None] | None = None,
) -> NDArray[np.uint8]:
    """Return the sheet.

    Args:
        cell_px: Side of the picture of each class, pixels.
        columns: Pictures beside each other.
        conditions: Time of day and weather.
        class_names: Which classes, in this order.
        on_class: Called with the name of each class before it is drawn.

    Returns:
        sRGB, shape (height, width, 3), uint8.

    Raises:
        UnknownNameError: If there is no such class.
        SettingsError: If the cells are too large or too small to draw.
    """
    from PIL import Image

    rows = -(-len(class_names) // columns)
    step_x, step_y = cell_px + _GAP_PX, cell_px + _NAME_PX + _GAP_PX
    sheet = Image.new("RGB", (columns * step_x + _GAP_PX, rows * step_y + _GAP_PX), _PAPER)
    for place, name in enumerate(class_names):
        stop_if_asked()
        if on_class is not None:
            on_class(name)
        row, column = divmod(place, columns)
        left, top = _GAP_PX + column * step_x, _GAP_PX + row * step_y
        sheet.paste(Image.fromarray(close_up(name, side_px=cell_px, conditions=conditions)), (left, top))
        _write(sheet, OBJECT_CLASSES[name].noun, (left + cell_px // 2, top + cell_px + _NAME_PX // 2), cell_px)
    return np.asarray(sheet)


def close_up(class_name: str, *, side_px: int = 224, conditions: Conditions | None = None) -> NDArray[np.uint8]:
    """Return a square picture of a class with somebody beside it, shape (side, side, 3), uint8.

    Raises:
        UnknownNameError: If there is no such class.
        SettingsError: If the side is out of range.
    """
    model, kind = model_of(class_name), OBJECT_CLASSES[class_name].kind
    things = [Placed(model, FIRST_BUILDING_ID, (0.0, 0.0, 0.0), tint=tints_of(class_name)[0])]
    corners = [_corners(model)]
    if class_name != "person":
        person = model_of("person", _PERSON_VARIANT % variants_of("person"))
        left_m, right_m, front_m = corners[0][:, 0].max(), corners[0][:, 0].min(), corners[0][:, 1].max()
        # Beside what is long, one would stand before it: on its other side one does not.
        beside_m = right_m - _BESIDE_M if kind == "vehicle" else left_m + _BESIDE_M
        place = (float(beside_m), max(0.0, float(front_m) - 0.4), 0.0)
        things.append(Placed(person, FIRST_BUILDING_ID + 1, place))
        corners.append(_corners(person) + place)
    if kind == "place":
        things.append(Placed(_wall(corners[0]), FIRST_BUILDING_ID + 2, (0.0, 0.0, 0.0)))
    scene = Scene.of_things(things, _plane(_GROUNDS.get(class_name, _GROUND_OF_KIND[kind])), np.zeros(8, np.uint8))
    above_rad = _ABOVE_AREA_RAD if kind == "area" else _ABOVE_RAD
    pose = _in_front_of(np.concatenate(corners), above_rad)
    renderer = Renderer(scene, replace(conditions or Conditions(), sun_azimuth_rad=_SUN_AZIMUTH_RAD))
    camera = Camera(side_px, side_px, _FOV_RAD)
    return renderer.picture(pose, camera, pitch_rad=-above_rad, antialias=2).colour


def _corners(model: Model) -> Points:
    """Return the corners of the box around a model, shape (8, 3); every vertex counts, a lamp's arm as well."""
    vertices = model.levels[0].vertices
    low, high = (vertices.min(axis=0), vertices.max(axis=0)) if len(vertices) else (np.zeros(3), np.zeros(3))
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)], np.float64)


def _wall(front: Points) -> Model:
    """Return the wall that a front is on."""
    builder = MeshBuilder()
    left, right, top = front[:, 0].min(), front[:, 0].max(), front[:, 2].max()
    builder.box(_WALL, (left - _WALL_BEYOND_M, -0.4, 0.0), (right + 3.0 * _WALL_BEYOND_M, 0.0, top + _WALL_BEYOND_M))
    mesh = builder.mesh()
    return Model((mesh,), mesh.size_m, "none")


def _plane(ground: Ground) -> GroundMap:
    codes = np.full((_GROUND_M, _GROUND_M), int(ground), np.uint8)
    corner = np.array([-_GROUND_M / 2.0, -_GROUND_M / 2.0, 1.0])
    return GroundMap(codes, corner, ground_materials(), linear_from_srgb(ground_colours()))


def _in_front_of(corners: Points, above_rad: float) -> Pose:
    """Return where a camera that looks down by an angle sees all the points as large as they fit in.

    Fronts face +y, which is north: it stands to the north, a little to one side.
    """
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    heading_rad = math.pi + _ASIDE_RAD
    flat, up = math.cos(above_rad), math.sin(above_rad)
    forward = np.array([math.sin(heading_rad) * flat, math.cos(heading_rad) * flat, -up])
    right = np.array([math.cos(heading_rad), -math.sin(heading_rad), 0.0])
    down = np.cross(forward, right)
    about = corners - middle
    # A point is in the picture if its distance across is at most this share of its distance ahead.
    slope = math.tan(0.5 * _FOV_RAD) * (1.0 - 2.0 * _RIM)
    across = np.maximum(np.abs(about @ right), np.abs(about @ down))
    distance_m = float((across / slope - about @ forward).max())
    x_m, y_m, z_m = middle - distance_m * forward
    return Pose(float(x_m), float(y_m), max(0.3, float(z_m)), heading_rad)


def _write(sheet: "Image", text: str, middle: tuple[int, int], room_px: int) -> None:
    """Write a name, smaller where it would not fit."""
    from PIL import ImageDraw, ImageFont

    pen = ImageDraw.Draw(sheet)
    for size in range(14, 7, -1):
        font = ImageFont.load_default(size)
        if pen.textlength(text, font=font) <= room_px or size == 8:
            pen.text(middle, text, fill=_INK, font=font, anchor="mm")
            return
