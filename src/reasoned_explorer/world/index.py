"""Which objects are near a point."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, InputError, UnknownNameError
from reasoned_explorer.world.index_kernels import KEY_UNIT, build_grid, footprint_distance, search_grid
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES
from reasoned_explorer.world.world import World, WorldObject

_BUCKET_M = 20.0
_FIRST_REACH_M = 25.0
_ALL = np.empty(0, np.bool_)
_CODE_OF = {name: code for code, name in enumerate(CLASS_NAMES)}

Ids = NDArray[np.int64]


class ObjectIndex:
    """Objects in columns, and a grid to find them by place.

    The footprint of an object is its outline where it has one, else the rectangle of its length and width turned to its
    heading; the footprint of a place (a cafe, a shop: `ObjectClass.kind`) is the point of its entrance.

    Attributes:
        x_m: East of each object, shape (n,), metres.
        y_m: North, metres.
        class_code: Place of its class in `CLASS_NAMES`.
        heading_rad: Heading of its front.
        length_m: Across its front.
        width_m: Depth.
        height_m: Height.
    """

    def __init__(self, world: World) -> None:
        objects = world.objects
        columns = np.asarray([(o.x_m, o.y_m, o.heading_rad, *o.size_m) for o in objects], dtype=np.float64).reshape(
            -1, 6
        )
        self.x_m, self.y_m, self.heading_rad, self.length_m, self.width_m, self.height_m = columns.T.copy()
        self.class_code: Ids = np.asarray([_CODE_OF[o.class_name] for o in objects], dtype=np.int64)
        self._spans, self._outlines = _outlines_of(objects)
        self._table = self._footprints(np.asarray([o.object_class.kind == "place" for o in objects], dtype=np.bool_))
        bounds = world.bounds
        self._frame = np.asarray([bounds.min_x_m, bounds.min_y_m, _BUCKET_M])
        self._shape = (
            max(1, math.ceil(bounds.height_m / _BUCKET_M)),
            max(1, math.ceil(bounds.width_m / _BUCKET_M)),
        )
        self._starts, self._ids, self._firsts = build_grid(self._table, *self._shape, self._frame)
        self._reach_m = math.hypot(bounds.width_m, bounds.height_m)
        self._masks: dict[tuple[str, ...], NDArray[np.bool_]] = {}

    @classmethod
    def of(cls, world: World) -> "ObjectIndex":
        """Index the objects of a world."""
        return cls(world)

    def __len__(self) -> int:
        return self.x_m.size

    def within(self, x_m: float, y_m: float, radius_m: float, *, class_names: Iterable[str] | None = None) -> Ids:
        """Return the ids of the objects whose footprint is within a radius of a point.

        Args:
            x_m: East, metres.
            y_m: North, metres.
            radius_m: At least 0, metres; its rim is included.
            class_names: Only these classes, or all.

        Returns:
            Ids, shape (n,), sorted by footprint distance rounded to 1 mm, then by id.

        Raises:
            InputError: If a number is not finite (the radius may be infinite) or the radius is negative.
            UnknownNameError: If there is no such class.
        """
        return self._search(x_m, y_m, radius_m, self._mask(class_names)) % KEY_UNIT

    def nearest(
        self, x_m: float, y_m: float, *, class_names: Iterable[str] | None = None, max_m: float = math.inf
    ) -> tuple[int, float] | None:
        """Return the nearest object's id and footprint distance in metres, or None if there is none within ``max_m``.

        Of objects that are equally near to within 1 mm, the one with the lowest id is returned.

        Raises:
            InputError: If a number is not finite (``max_m`` may be infinite) or ``max_m`` is negative.
            UnknownNameError: If there is no such class.
        """
        mask = self._mask(class_names)
        reach_m = min(_FIRST_REACH_M, max_m)
        while True:
            keys = self._search(x_m, y_m, reach_m, mask)
            if keys.size:
                nearest = int(keys[0] % KEY_UNIT)
                return nearest, self.footprint_distance_m(nearest, x_m, y_m)
            if reach_m >= max_m or reach_m == math.inf:
                return None
            # Beyond the world's own extent doubling finds nothing that looking at everything would not.
            reach_m = min(max_m, 4.0 * reach_m if reach_m < self._reach_m else math.inf)

    def of_class(self, name: str) -> Ids:
        """Return the ids of all objects of a class, rising.

        Raises:
            UnknownNameError: If there is no such class.
        """
        self._mask((name,))
        return np.flatnonzero(self.class_code == _CODE_OF[name])

    def footprint_distance_m(self, object_id: int, x_m: float, y_m: float) -> float:
        """Return the distance from a point to an object's footprint, metres; 0 inside it.

        Raises:
            InputError: If there is no such object.
        """
        if not 0 <= object_id < len(self):
            raise InputError("object index", [Fault(f"object {object_id}", f"an id in [0, {len(self)})")])
        return float(footprint_distance(self._table, self._spans, self._outlines, object_id, x_m, y_m))

    def _search(self, x_m: float, y_m: float, radius_m: float, mask: NDArray[np.bool_]) -> Ids:
        if not (math.isfinite(x_m) and math.isfinite(y_m) and radius_m >= 0.0):
            faults = [
                Fault(f"{n} = {v}", "a finite number") for n, v in (("x_m", x_m), ("y_m", y_m)) if not math.isfinite(v)
            ]
            if not radius_m >= 0.0:
                faults.append(Fault(f"a radius of {radius_m} m", "0 or more"))
            raise InputError("object index", faults)
        keys: Ids = search_grid(
            self._table,
            self._spans,
            self._outlines,
            self._starts,
            self._ids,
            self._firsts,
            self._shape,
            self._frame,
            self.class_code,
            mask,
            float(x_m),
            float(y_m),
            float(radius_m),
        )
        return keys

    def _mask(self, class_names: Iterable[str] | None) -> NDArray[np.bool_]:
        if class_names is None:
            return _ALL
        names = (class_names,) if isinstance(class_names, str) else tuple(class_names)
        if names not in self._masks:
            for name in names:
                if name not in _CODE_OF:
                    raise UnknownNameError("object class", name, tuple(OBJECT_CLASSES))
            mask = np.zeros(len(CLASS_NAMES), np.bool_)
            mask[[_CODE_OF[name] for name in names]] = True
            self._masks[names] = mask
        return self._masks[names]

    def _footprints(self, is_place: NDArray[np.bool_]) -> NDArray[np.float64]:
        half_length = np.where(is_place, 0.0, self.length_m / 2.0)
        half_width = np.where(is_place, 0.0, self.width_m / 2.0)
        sin, cos = np.sin(self.heading_rad), np.cos(self.heading_rad)
        reach_x = half_length * np.abs(cos) + half_width * np.abs(sin)
        reach_y = half_length * np.abs(sin) + half_width * np.abs(cos)
        box = np.stack((self.x_m - reach_x, self.y_m - reach_y, self.x_m + reach_x, self.y_m + reach_y), axis=1)
        for i in np.flatnonzero(self._spans[:, 1] > self._spans[:, 0]):
            ring = self._outlines[self._spans[i, 0] : self._spans[i, 1]]
            box[i] = (*ring.min(axis=0), *ring.max(axis=0))
        table: NDArray[Any] = np.column_stack((self.x_m, self.y_m, sin, cos, half_length, half_width, box))
        return np.ascontiguousarray(table, dtype=np.float64)


def _outlines_of(objects: tuple[WorldObject, ...]) -> tuple[Ids, NDArray[np.float64]]:
    spans = np.zeros((len(objects), 2), np.int64)
    rings, end = [np.empty((0, 2))], 0
    for i, item in enumerate(objects):
        if item.outline is not None and item.object_class.kind != "place":
            spans[i] = end, end + len(item.outline)
            end += len(item.outline)
            rings.append(np.asarray(item.outline, dtype=np.float64))
    return spans, np.ascontiguousarray(np.concatenate(rings))
