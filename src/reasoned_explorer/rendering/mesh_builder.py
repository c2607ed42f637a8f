"""Shapes from which models are put together: boxes, rods, tubes, turned bodies, plates.

Everything is made of rings of points with skins between them (`MeshBuilder.loft`) or of flat polygons. Normals and
texture coordinates are worked out at the end, for all triangles at once.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh
from reasoned_explorer.rendering.mesh_maths import (
    FloatArray,
    IntArray,
    bevelled_box,
    box_uvs,
    circle_points,
    corner_normals,
    cross,
    faces_of,
    signed_volume,
    tangents_of,
    two_across,
    unit_box,
)
from reasoned_explorer.rendering.polygons import triangulated

Colour = tuple[float, float, float]

#: The coarsest level of detail: a few boxes.
FAR = 3
#: Share of the sides of round bodies that is kept at each level of detail.
_KEPT_SIDES = (1.0, 0.6, 0.4, 0.3)
_LEAST_AREA_M2 = 1e-9
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Surface:
    """What a part is made of.

    Attributes:
        material: Decides texture and light.
        colour: Reflectance, sRGB in [0, 1]; of tinted materials it multiplies the tint.
    """

    material: Material
    colour: Colour

    def shaded(self, factor: float) -> "Surface":
        """Return the same surface, darker (below 1) or lighter (above 1, at most white)."""
        red, green, blue = self.colour
        return Surface(self.material, (min(1.0, red * factor), min(1.0, green * factor), min(1.0, blue * factor)))


@dataclass(frozen=True, slots=True)
class _Part:
    vertices: FloatArray
    triangles: IntArray
    surface: Surface
    smooth: bool
    shades: FloatArray | None = None  # per triangle (m,), where they differ
    normals: FloatArray | None = None  # per corner (m, 3, 3), where a part brings its own


class MeshBuilder:
    """Gathers parts and makes one mesh of them.

    Points are ``(x, y, z)`` in metres. Closed parts come out with their faces outward whatever the order of the points.

    Args:
        detail: 0 for the finest level to `FAR` for the coarsest: round bodies get fewer sides, boxes lose their bevels.
    """

    def __init__(self, *, detail: int = 0) -> None:
        self.detail = detail
        self._parts: list[_Part] = []

    def box(self, surface: Surface, low: ArrayLike, high: ArrayLike, *, bevel: float = 0.0) -> None:
        """Add a box along the axes.

        Args:
            surface: Of all faces.
            low: The corner with the least coordinates.
            high: The opposite corner.
            bevel: Width of the chamfer at every edge, metres; only at the finest level.
        """
        lowest, highest = np.asarray(low, np.float64), np.asarray(high, np.float64)
        middle, half = (lowest + highest) / 2.0, (highest - lowest) / 2.0
        if bevel > 0.0 and self.detail == 0:
            signs, triangles = bevelled_box()
            inset = np.minimum(bevel, 0.49 * half)
            vertices = (signs[:, None, :] * (half - inset * (1.0 - np.eye(3))[None])).reshape(-1, 3)
        else:
            vertices, triangles = unit_box()
            vertices = vertices * half
        self.part(surface, vertices + middle, triangles)

    def beam(  # noqa: PLR0917 - two ends and a section, as one says it
        self, surface: Surface, start: ArrayLike, end: ArrayLike, width: float, height: float, up: ArrayLike = (0, 0, 1)
    ) -> None:
        """Add a straight bar of rectangular section.

        Args:
            surface: Of all faces.
            start: Middle of one end.
            end: Middle of the other end.
            width: Of the section, across ``up``, metres.
            height: Of the section, along ``up``, metres.
            up: Rough direction of the section's height; not along the bar.
        """
        first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
        along = (last - first) / np.linalg.norm(last - first)
        across = cross(along, np.asarray(up, np.float64))
        across /= np.linalg.norm(across)
        over = cross(across, along)
        vertices, triangles = unit_box()
        frame = np.stack([across * width / 2.0, (last - first) / 2.0, over * height / 2.0])
        self.part(surface, vertices @ frame + (first + last) / 2.0, triangles)

    def cylinder(
        self,
        surface: Surface,
        start: ArrayLike,
        end: ArrayLike,
        radius: float,
        end_radius: float | None = None,
        *,
        sides: int = 12,
        smooth: bool = True,
        capped: bool = True,
    ) -> None:
        """Add a cylinder, or a frustum or a cone where the radii differ.

        Args:
            surface: Of all faces.
            start: Middle of one end.
            end: Middle of the other end.
            radius: At the start, metres.
            end_radius: At the end, metres; 0 makes a cone; as at the start unless given.
            sides: At the finest level.
            smooth: Round rather than faceted.
            capped: Whether the ends are closed; leave them open only where nobody can see them.
        """
        first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
        circle = circle_points(self.sides(sides), *two_across(last - first))
        rings = np.stack([first + radius * circle, last + (radius if end_radius is None else end_radius) * circle])
        self.loft(surface, rings, smooth=smooth, capped=capped)

    def lathe(
        self,
        surface: Surface,
        profile: Sequence[tuple[float, float]],
        at: ArrayLike = (0, 0, 0),
        *,
        sides: int = 16,
        smooth: bool = True,
        stretch: tuple[float, float] = (1.0, 1.0),
        capped: bool = True,
    ) -> None:
        """Add a body turned about an upright axis.

        Args:
            surface: Of all faces.
            profile: Radius and height of its rings in order, metres.
            at: Where the axis meets height 0.
            sides: At the finest level.
            smooth: Round rather than faceted.
            stretch: Factors along x and y, for oval bodies.
            capped: Whether the ends are closed; leave them open only where nobody can see them.
        """
        count = self.sides(sides)
        circle = circle_points(count, np.array([stretch[0], 0.0, 0.0]), np.array([0.0, stretch[1], 0.0]))
        rings = np.stack([radius * circle + np.array([0.0, 0.0, height]) for radius, height in profile])
        self.loft(surface, rings + np.asarray(at, np.float64), smooth=smooth, capped=capped)

    def sphere(
        self, surface: Surface, centre: ArrayLike, radius: float | Sequence[float], *, sides: int = 12, rings: int = 6
    ) -> None:
        """Add a sphere, or an ellipsoid with three radii.

        Args:
            surface: Of all faces.
            centre: Its middle.
            radius: Metres; or along x, y and z.
            sides: Around, at the finest level.
            rings: Bands from pole to pole, at the finest level.
        """
        bands = max(2, self.sides(rings))
        circle = circle_points(max(4, self.sides(sides)), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, bands + 1)
        widths = np.cos(angles)
        widths[[0, -1]] = 0.0
        unit = widths[:, None, None] * circle[None] + np.sin(angles)[:, None, None] * _UP
        self.loft(surface, unit * np.broadcast_to(np.asarray(radius, np.float64), 3) + np.asarray(centre, np.float64))

    def torus(
        self,
        surface: Surface,
        centre: ArrayLike,
        radius: float,
        thickness: float,
        axis: ArrayLike = (0, 0, 1),
        *,
        around: int = 20,
        sides: int = 6,
    ) -> None:
        """Add a ring.

        Args:
            surface: Of all faces.
            centre: Its middle.
            radius: Of the middle of the tube, metres.
            thickness: Radius of the tube, metres.
            axis: The ring lies across it.
            around: Pieces along the ring, at the finest level.
            sides: Of the tube, at the finest level.
        """
        circle = circle_points(max(5, self.sides(around)), *two_across(np.asarray(axis, np.float64)))
        self.tube(surface, np.asarray(centre, np.float64) + radius * circle, thickness, sides=sides, closed=True)

    def tube(
        self,
        surface: Surface,
        points: ArrayLike,
        radius: ArrayLike,
        *,
        sides: int = 6,
        closed: bool = False,
    ) -> None:
        """Add a round bar along a line.

        Args:
            surface: Of all faces.
            points: Middle of the bar, shape (n, 3).
            radius: Metres; or one for each point.
            sides: At the finest level.
            closed: Whether the last point joins the first.
        """
        path = np.asarray(points, np.float64)
        radii = np.broadcast_to(np.asarray(radius, np.float64), len(path))
        count = self.sides(sides)
        tangents = tangents_of(path, closed=closed)
        first, _ = two_across(tangents[0])
        rings = []
        for at, tangent, size in zip(path, tangents, radii, strict=True):
            # Carry the frame along the line, so that the skin does not twist.
            first = first - (first @ tangent) * tangent
            first /= np.linalg.norm(first)
            rings.append(at + size * circle_points(count, first, cross(tangent, first)))
        self.loft(surface, np.stack(rings), capped=not closed, closed=closed)

    def extrude(
        self, surface: Surface, outline: ArrayLike, axis: str, start: float, end: float, *, smooth: bool = False
    ) -> None:
        """Add a prism over an outline.

        Args:
            surface: Of all faces.
            outline: Corners of a simple polygon, shape (n, 2): ``(y, z)`` across x, ``(x, z)`` across y or ``(x, y)``
                across z.
            axis: ``"x"``, ``"y"`` or ``"z"``: along which it is drawn out.
            start: Where it begins on the axis, metres.
            end: Where it ends.
            smooth: Round rather than faceted along the outline.
        """
        flat = np.asarray(outline, np.float64)
        place = "xyz".index(axis)
        rings = np.stack([np.insert(flat, place, at, axis=1) for at in (start, end)])
        self.loft(surface, rings, smooth=smooth)

    def loft(
        self, surface: Surface, rings: ArrayLike, *, smooth: bool = True, capped: bool = True, closed: bool = False
    ) -> None:
        """Add a skin over rings of points.

        Args:
            surface: Of all faces.
            rings: Shape (k, n, 3): k rings of n points, each ring closed. A ring of one place is a tip.
            smooth: Round rather than faceted.
            capped: Whether the first and the last ring are closed by flat faces.
            closed: Whether the last ring joins the first (then there are no caps).
        """
        points = np.asarray(rings, np.float64)
        count, around = points.shape[:2]
        places = np.arange(count * around).reshape(count, around)
        for index in np.flatnonzero(np.ptp(points, axis=1).max(axis=1) < 1e-9):
            places[index] = places[index, 0]
        if closed:
            places = np.concatenate([places, places[:1]])
        ringed = np.concatenate([places, places[:, :1]], axis=1)
        lower, upper = ringed[:-1, :-1], ringed[1:, :-1]
        turned_lower, turned_upper = ringed[:-1, 1:], ringed[1:, 1:]
        skin = np.concatenate(
            [
                np.stack([lower, turned_lower, turned_upper], axis=-1).reshape(-1, 3),
                np.stack([lower, turned_upper, upper], axis=-1).reshape(-1, 3),
            ]
        )
        vertices = points.reshape(-1, 3)
        caps = []
        if capped and not closed:
            start, end = triangulated(points[0]), triangulated(points[-1])
            caps = [start[:, ::-1], end + places[-1, 0]]
        whole = np.concatenate([skin, *caps]) if caps else skin
        if signed_volume(vertices, whole) < 0.0:
            skin, caps = skin[:, ::-1], [cap[:, ::-1] for cap in caps]
        self.part(surface, vertices, skin, smooth=smooth)
        for cap in caps:
            self.part(surface, vertices, cap)

    def sheet(self, surface: Surface, points: ArrayLike) -> None:
        """Add a flat polygon that is seen from both sides; points of shape (n, 3), in order around it."""
        corners = np.asarray(points, np.float64)
        front = triangulated(corners)
        self.part(surface, np.concatenate([corners, corners]), np.concatenate([front, front[:, ::-1] + len(corners)]))

    def decal(self, surface: Surface, points: ArrayLike) -> None:
        """Add a flat polygon that is seen from one side: paint on a face behind it.

        Args:
            surface: Of the polygon.
            points: Shape (n, 3), counter-clockwise as seen; lay it a centimetre before the face.
        """
        corners = np.asarray(points, np.float64)
        self.part(surface, corners, triangulated(corners))

    def card(self, surface: Surface, foot: ArrayLike, width: float, height: float, heading_rad: float = 0.0) -> None:
        """Add an upright rectangle that is seen from both sides.

        Args:
            surface: Of both sides.
            foot: Middle of its lower edge.
            width: Metres.
            height: Metres.
            heading_rad: Where it faces: 0 is +y, clockwise from above.
        """
        right = np.array([math.cos(heading_rad), -math.sin(heading_rad), 0.0]) * width / 2.0
        base, up = np.asarray(foot, np.float64), height * _UP
        self.sheet(surface, [base + right, base - right, base - right + up, base + right + up])

    def part(
        self,
        surface: Surface,
        vertices: FloatArray,
        triangles: IntArray,
        *,
        smooth: bool = False,
        shades: FloatArray | None = None,
        normals: FloatArray | None = None,
    ) -> None:
        """Add triangles as they are.

        Args:
            surface: Of all of them.
            vertices: Shape (n, 3).
            triangles: Shape (m, 3), counter-clockwise from outside.
            smooth: Whether normals are shared where triangles share vertices.
            shades: Factor of the colour of each triangle, shape (m,); 1 unless given.
            normals: At each corner, shape (m, 3, 3); worked out unless given.
        """
        self._parts.append(_Part(vertices, triangles, surface, smooth, shades, normals))

    def add(
        self,
        other: "MeshBuilder",
        at: ArrayLike = (0, 0, 0),
        *,
        heading_rad: float = 0.0,
        scale: float | Sequence[float] = 1.0,
    ) -> None:
        """Add all parts of another builder: scaled, then turned (clockwise from above), then moved."""
        cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        factors = np.broadcast_to(np.asarray(scale, np.float64), 3)
        for part in other._parts:
            normals = None if part.normals is None else (part.normals / factors) @ turn
            self._parts.append(
                _Part(
                    (part.vertices * factors) @ turn + np.asarray(at, np.float64),
                    part.triangles[:, ::-1] if np.prod(factors) < 0.0 else part.triangles,
                    part.surface,
                    part.smooth,
                    part.shades,
                    normals if normals is None else normals / np.linalg.norm(normals, axis=-1, keepdims=True),
                )
            )

    def _colours(self, counts: list[int]) -> FloatArray:
        colours = np.repeat(np.array([part.surface.colour for part in self._parts]), counts, axis=0)
        if any(part.shades is not None for part in self._parts):
            shades = [
                np.ones(count) if part.shades is None else part.shades
                for part, count in zip(self._parts, counts, strict=True)
            ]
            colours = np.clip(colours * np.concatenate(shades)[:, None], 0.0, 1.0)
        return colours

    def sides(self, count: int) -> int:
        """Return how many sides a round body has at this level of detail that has ``count`` at the finest."""
        return max(3, round(count * _KEPT_SIDES[self.detail]))

    def mesh(self) -> Mesh:
        """Return everything as one mesh; triangles without area are left out."""
        if not self._parts:
            return _EMPTY
        sizes = [len(part.vertices) for part in self._parts]
        starts = np.cumsum([0, *sizes[:-1]])
        vertices = np.concatenate([part.vertices for part in self._parts])
        triangles = np.concatenate([part.triangles + at for part, at in zip(self._parts, starts, strict=True)])
        counts = [len(part.triangles) for part in self._parts]
        smooth = np.repeat([part.smooth for part in self._parts], counts)
        faces, areas = faces_of(vertices, triangles)
        normals = corner_normals(vertices, triangles, faces * areas[:, None], smooth)
        own = np.repeat([part.normals is not None for part in self._parts], counts)
        if own.any():
            normals[own] = np.concatenate([part.normals for part in self._parts if part.normals is not None])
        good = areas > _LEAST_AREA_M2
        shared, places = _welded(vertices.astype(np.float32), triangles[good])
        return Mesh(
            vertices=shared,
            triangles=places,
            normals=normals[good].astype(np.float32),
            uvs=box_uvs(vertices[triangles[good]], faces[good]).astype(np.float32),
            colours=self._colours(counts)[good].astype(np.float32),
            materials=np.repeat([part.surface.material for part in self._parts], counts)[good].astype(np.uint8),
        )


def _welded(vertices: NDArray[np.float32], triangles: IntArray) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return the vertices that triangles use, each place once, and where they are there: what is drawn is projected."""
    rows = np.ascontiguousarray(vertices).view(np.dtype((np.void, vertices.dtype.itemsize * 3))).ravel()
    corners = triangles.ravel()
    _, firsts, names = np.unique(rows[corners], return_index=True, return_inverse=True)
    order = np.argsort(firsts)  # as they come: neighbours stay neighbours
    ranks = np.empty(len(order), np.int32)
    ranks[order] = np.arange(len(order), dtype=np.int32)
    return vertices[corners[firsts[order]]], ranks[names].reshape(-1, 3)


_EMPTY = Mesh(
    np.zeros((0, 3), np.float32),
    np.zeros((0, 3), np.int32),
    np.zeros((0, 3, 3), np.float32),
    np.zeros((0, 3, 2), np.float32),
    np.zeros((0, 3), np.float32),
    np.zeros(0, np.uint8),
)
