"""What a single thing would cover of a picture if nothing hid it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.projection import Projection
from reasoned_explorer.rendering.raster_kernels import Canvas, _bound, _distance, _draw_level, _level_of, _matrix_of
from reasoned_explorer.rendering.scene import Instances
from reasoned_explorer.world.compiling import kernel


class Sheet(NamedTuple):
    """Room to draw single things in.

    Attributes:
        canvas: Only its samples are used. They must be as many as the largest view has.
        corners: Projected vertices, shape (v, 5), float64, for as many as the largest model's level has.
        matrix: Shape (3, 4), float64.
        rectangle: First and last column and row of the thing that was drawn, shape (1, 4), int32.
    """

    canvas: Canvas
    corners: NDArray[np.float64]
    matrix: NDArray[np.float64]
    rectangle: NDArray[np.int32]


@kernel
def place_on_sheet(library: Library, instances: Instances, i: int, view: Projection, sheet: Sheet) -> float:
    """Set the rectangle that an instance may cover in a view; return its greatest nearness, 0 where it is not in it."""
    _matrix_of(instances, i, view, sheet.matrix)
    prototype, rectangle = int(instances.prototypes[i]), sheet.rectangle
    nearness, first_x, last_x, first_y, last_y = _bound(library.boxes, prototype, sheet.matrix, view.width, view.height)
    rectangle[0, 0], rectangle[0, 1], rectangle[0, 2], rectangle[0, 3] = first_x, last_x, first_y, last_y
    return nearness


@kernel
def farthest_on_sheet(library: Library, instances: Instances, i: int, sheet: Sheet) -> float:
    """Return the greatest depth that the box of an instance has where `place_on_sheet` has put it."""
    boxes, matrix, prototype = library.boxes, sheet.matrix, instances.prototypes[i]
    farthest = matrix[2, 3]
    for axis in range(3):
        farthest += max(matrix[2, axis] * boxes[prototype, 0, axis], matrix[2, axis] * boxes[prototype, 1, axis])
    return farthest


@kernel
def draw_on_sheet(
    library: Library, instances: Instances, i: int, view: Projection, density: float, sheet: Sheet
) -> None:
    """Draw an instance alone, as `raster_kernels.draw` would, where `place_on_sheet` has put it.

    Samples of the rectangle that it covers have the owner 0, the others -1.
    """
    canvas, rectangle = sheet.canvas, sheet.rectangle
    for y in range(rectangle[0, 2], rectangle[0, 3] + 1):
        for x in range(rectangle[0, 0], rectangle[0, 1] + 1):
            canvas.nearness[y, x] = 0.0
            canvas.owners[y, x] = -1
    distance = max(_distance(instances.balls, i, view.eye), 0.25)
    prototype = instances.prototypes[i]
    level = _level_of(library, prototype, instances.balls[i, 3] * view.focal / view.samples / distance, density)
    _draw_level(library, library.prototypes[prototype, 0] + level, sheet.matrix, 0, canvas, sheet.corners)
