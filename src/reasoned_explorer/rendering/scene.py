"""What can be drawn of a world: models, and where each of them stands."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.ground import GroundMap, ground_of
from reasoned_explorer.rendering.library import Library, linear_from_srgb, pack
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.progress import Progress
from reasoned_explorer.world.taxonomy import CLASS_NAMES
from reasoned_explorer.world.world import World

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

#: Instance ids of what is no object: sky, ground, and the first building.
SKY_ID, GROUND_ID, FIRST_BUILDING_ID = 0, 1, 2
#: Names of the classes of a picture; the classes of objects follow in the order of their codes.
PICTURE_CLASSES: tuple[str, ...] = ("sky", "ground", "building", *CLASS_NAMES)
#: Edge of the cells in which instances are looked up, metres.
CELL_M = 40.0


class Instances(NamedTuple):
    """Where models stand.

    Attributes:
        prototypes: Which model of the library, shape (n,), int32.
        places: Where the model's origin is, ENU metres, shape (n, 3), float64.
        turns: Sine and cosine of the heading, shape (n, 2), float64.
        scales: Along the model's axes, shape (n, 3), float64.
        tints: Linear light, shape (n, 3), float32.
        ids: Instance ids of pictures, shape (n,), int32.
        balls: Centre and radius of a sphere around each, ENU metres, shape (n, 4), float64.
    """

    prototypes: NDArray[np.int32]
    places: NDArray[np.float64]
    turns: NDArray[np.float64]
    scales: NDArray[np.float64]
    tints: NDArray[np.float32]
    ids: NDArray[np.int32]
    balls: NDArray[np.float64]


class Cells(NamedTuple):
    """A grid over instances, so that what is not seen costs nothing.

    Attributes:
        balls: Centre and radius of a sphere around the instances of each cell, shape (c, 4), float64.
        starts: Members of cell k are ``members[starts[k]:starts[k + 1]]``, shape (c + 1,), int32.
        members: Places in the list of instances, int32.
    """

    balls: NDArray[np.float64]
    starts: NDArray[np.int32]
    members: NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """One thing of a scene.

    Attributes:
        model: What it looks like.
        id: Its instance id in pictures.
        place_m: Where its model's origin is, ENU metres.
        heading_rad: Its front faces this way (compass heading).
        scale: Along its model's axes.
        tint: sRGB in [0, 1]; what is `TINTED` is multiplied by it.
    """

    model: Model
    id: int
    place_m: tuple[float, float, float]
    heading_rad: float = 0.0
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Scene:
    """What can be drawn of a world. Build it with `Scene.of`.

    Attributes:
        library: The models.
        instances: Where they stand.
        cells: A grid over them.
        ground: What ground is where.
        classes: The class of each instance id, as places in `PICTURE_CLASSES`, uint8.
    """

    library: Library
    instances: Instances
    cells: Cells
    ground: GroundMap
    classes: NDArray[np.uint8]

    @classmethod
    def of(cls, world: "World | Atlas", *, seed: int | None = None, on_progress: Progress | None = None) -> "Scene":
        """Return the scene of a world.

        The renderer's kernels are compiled beside it, if need be, where `rendering.readiness.begin` was called before.

        Args:
            world: The world, or an atlas of it.
            seed: Of looks (which of its class's models a thing has, its colour); by default the world's own.
            on_progress: Told what takes long.
        """
        # Whoever compiles has no need of them.
        from reasoned_explorer.rendering.buildings import models_of_buildings
        from reasoned_explorer.rendering.fronts import fronts_of, walls_taken
        from reasoned_explorer.rendering.standing import stands_of

        tell = on_progress or (lambda _: None)
        tell("the ground")
        plain = world if isinstance(world, World) else world.world
        looks = plain.seed if seed is None else seed
        first_object = FIRST_BUILDING_ID + len(plain.buildings)
        ground = ground_of(plain)
        things = [Placed(mesh, GROUND_ID, place) for mesh, place in ground.markings]
        tell("buildings")
        fronts = fronts_of(plain)
        taken = walls_taken(list(fronts.values()))
        for k, (model, place) in enumerate(
            models_of_buildings(plain.buildings, seed=looks, fronts=taken, ways=plain.ways)
        ):
            things.append(Placed(model, FIRST_BUILDING_ID + k, place))
        tell("things")
        for one in stands_of(plain, fronts, seed=looks):
            place_m = (one.x_m, one.y_m, 0.0)
            things.append(Placed(one.model, first_object + one.item, place_m, one.heading_rad, one.scale, one.tint))
        codes = {name: PICTURE_CLASSES.index(name) for name in CLASS_NAMES}
        classes = [0, 1, *([2] * len(plain.buildings)), *(codes[item.class_name] for item in plain.objects)]
        return cls.of_things(things, ground, np.array(classes, np.uint8))

    @classmethod
    def of_things(cls, things: Sequence[Placed], ground: GroundMap, classes: NDArray[np.uint8]) -> "Scene":
        """Return a scene of things; those whose models have no triangles are left out."""
        kept = [thing for thing in things if any(len(level.triangles) for level in thing.model.levels)]
        models: dict[int, tuple[int, Model]] = {}
        for thing in kept:
            models.setdefault(id(thing.model), (len(models), thing.model))
        library = pack([model for _, model in models.values()])
        instances = _instances(kept, np.array([models[id(t.model)][0] for t in kept], np.int32), library)
        return cls(library, instances, _cells(instances), ground, classes)

    @property
    def triangle_count(self) -> int:
        """Triangles of all things at full detail."""
        firsts = self.library.prototypes[self.instances.prototypes, 0]
        return int(self.library.levels[firsts, 3].astype(np.int64).sum())


def _instances(things: Sequence[Placed], prototypes: NDArray[np.int32], library: Library) -> Instances:
    places = np.array([thing.place_m for thing in things], np.float64).reshape(-1, 3)
    headings = np.array([thing.heading_rad for thing in things], np.float64)
    turns = np.stack([np.sin(headings), np.cos(headings)], axis=1)
    scales = np.array([thing.scale for thing in things], np.float64).reshape(-1, 3)
    tints = linear_from_srgb(np.array([thing.tint for thing in things], np.float32).reshape(-1, 3))
    ids = np.array([thing.id for thing in things], np.int32)
    boxes = library.boxes[prototypes] * scales[:, None, :]
    middle, half = boxes.mean(axis=1), 0.5 * (boxes[:, 1] - boxes[:, 0])
    centres = places + np.stack(
        [
            middle[:, 0] * turns[:, 1] + middle[:, 1] * turns[:, 0],
            middle[:, 1] * turns[:, 1] - middle[:, 0] * turns[:, 0],
            middle[:, 2],
        ],
        axis=1,
    )
    radii = np.sqrt((half * half).sum(axis=1))
    return Instances(prototypes, places, turns, scales, tints, ids, np.column_stack([centres, radii]))


def _cells(instances: Instances) -> Cells:
    columns = np.floor(instances.balls[:, :2] / CELL_M).astype(np.int64)
    keys, cell_of = np.unique(columns, axis=0, return_inverse=True)
    cell_of = cell_of.reshape(-1)
    members = np.argsort(cell_of, kind="stable").astype(np.int32)
    starts = np.searchsorted(cell_of[members], np.arange(len(keys) + 1)).astype(np.int32)
    balls = np.zeros((len(keys), 4))
    for k in range(len(keys)):
        own = instances.balls[members[starts[k] : starts[k + 1]]]
        low, high = (own[:, :3] - own[:, 3:]).min(axis=0), (own[:, :3] + own[:, 3:]).max(axis=0)
        balls[k, :3] = 0.5 * (low + high)
        balls[k, 3] = (np.linalg.norm(own[:, :3] - balls[k, :3], axis=1) + own[:, 3]).max()
    return Cells(balls, starts, members)
