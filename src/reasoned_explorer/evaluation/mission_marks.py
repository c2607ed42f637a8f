"""What a mission leaves on a map: track, decisions, ways on with their scores, goals, the start and the end."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib import colormaps
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.path import Path as MarkPath
from matplotlib.patheffects import withStroke
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

from reasoned_explorer.evaluation.mission_trace import MapFrontier, MapGoal, MissionTrace
from reasoned_explorer.geometry import Pose
from reasoned_explorer.world.drawing_style import mix, width_pt
from reasoned_explorer.world.lettering import Room
from reasoned_explorer.world.painting import Board
from reasoned_explorer.world.sheet import put_text
from reasoned_explorer.world.symbols import compound_path
from reasoned_explorer.world.textures import lines_of, polygon_of

FloatArray = NDArray[np.float64]

#: The marks' colours; those of the verdict are told apart by their sign as well.
PINK = "#d6287a"
TRACK_FROM, TRACK_TO = "#6f8fd0", "#14224f"
GOLD, GOLD_EDGE = "#f2b01e", "#8a5a00"
SHORTEST = "#1d1d1d"
RIGHT, WRONG, NEUTRAL = "#00785a", "#c04a00", "#5b6068"
GRAPH = "#7d8794"
Q_RANGE = (1.0, 5.0)

#: Viridis without its palest end, which would be lost on light ground.
_SCORES = LinearSegmentedColormap.from_list("scores", colormaps["viridis"](np.linspace(0.0, 0.94, 64)))


def score_colour(q: float | None) -> str:
    """Return the colour of a score from 1 to 5; grey for none."""
    if q is None:
        return "#b9bdc2"
    low, high = Q_RANGE
    return str(to_hex(_SCORES(min(max((q - low) / (high - low), 0.0), 1.0))))


def regular(corners: int, *, turn_deg: float = 0.0, waist: float = 1.0) -> MarkPath:
    """Return a regular polygon of radius 1, or a star where ``waist`` is less than 1; a corner points north."""
    count = corners * (2 if waist < 1.0 else 1)
    angles = np.pi / 2 + math.radians(turn_deg) + np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radii = np.where(np.arange(count) % 2 == 0, 1.0, waist) if waist < 1.0 else np.ones(count)
    return compound_path([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])


DISC = regular(40)
DIAMOND = regular(4)
STAR = regular(5, waist=0.45)
OCTAGON = regular(8, turn_deg=22.5)
CHEVRON = MarkPath([(-0.75, -0.55), (0.0, 0.35), (0.75, -0.55)], [MarkPath.MOVETO, MarkPath.LINETO, MarkPath.LINETO])
ARROW = compound_path([np.array([(0.0, 1.15), (0.8, -0.85), (0.0, -0.4), (-0.8, -0.85)])])
CROSS = MarkPath([(-1, -1), (1, 1), (-1, 1), (1, -1)], [MarkPath.MOVETO, MarkPath.LINETO] * 2)
TICK = MarkPath([(-0.9, 0.05), (-0.25, -0.65), (0.95, 0.75)], [MarkPath.MOVETO, MarkPath.LINETO, MarkPath.LINETO])


def turned(path: MarkPath, heading_rad: float) -> MarkPath:
    """Return a mark that points north turned to a compass heading."""
    sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
    x, y = path.vertices[:, 0], path.vertices[:, 1]
    return MarkPath(np.column_stack([x * cosine + y * sine, -x * sine + y * cosine]), path.codes)


def arc_path(share: float) -> MarkPath:
    """Return the arc of a dial of radius 1 that starts at the top and runs clockwise over a share of the circle."""
    angles = np.pi / 2 - np.linspace(0.0, 2.0 * np.pi * min(max(share, 0.0), 1.0), 40)
    return MarkPath(np.column_stack([np.cos(angles), np.sin(angles)]))


def stamp(
    axes: object,
    place: tuple[float, float],
    path: MarkPath,
    size_pt: float,
    *,
    face: str = "none",
    edge: str = "none",
    width: float = 0.8,
    alpha: float = 1.0,
    zorder: float = 10.0,
) -> None:
    """Put a mark of radius ``size_pt`` points at a place of the axes."""
    axes.add_collection(  # type: ignore[attr-defined]
        PathCollection(
            [path],
            sizes=[size_pt * size_pt],
            offsets=[place],
            offset_transform=axes.transData,  # type: ignore[attr-defined]
            transform=IdentityTransform(),
            facecolors=face,
            edgecolors=edge,
            linewidths=width,
            alpha=alpha,
            zorder=zorder,
            capstyle="round",
            joinstyle="round",
        ),
        autolim=False,
    )
