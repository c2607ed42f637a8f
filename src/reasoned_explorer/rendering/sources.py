"""Where the looks of things come from."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.rendering.standins import block_model, box_model
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import Building

Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class ModelSource:
    """The looks that a class of objects can have.

    Attributes:
        model: Gives the model of a variant in ``range(variants)``, the same one every time.
        variants: How many there are.
        tints: Colours that one of its things can have, sRGB; may be empty.
    """

    model: Callable[[int], Model]
    variants: int
    tints: tuple[tuple[float, float, float], ...]


def object_models() -> dict[str, ModelSource]:
    """Return the looks of every class of objects."""
    return {name: _source(name) for name in OBJECT_CLASSES}


@lru_cache(maxsize=None)
def _source(name: str) -> ModelSource:
    from reasoned_explorer.model import UnknownNameError
    from reasoned_explorer.rendering.models import model_of, tints_of, variants_of

    try:
        model_of(name)
    except UnknownNameError:
        return _boxes(name)
    models = [model_of(name, variant) for variant in range(variants_of(name))]
    return ModelSource(models.__getitem__, len(models), tuple(tints_of(name)))


def _boxes(name: str) -> ModelSource:
    colours = np.random.default_rng(sum(map(ord, name))).uniform(0.2, 0.9, (3, 3))
    length_m, width_m, height_m = OBJECT_CLASSES[name].size_m
    if OBJECT_CLASSES[name].kind == "vehicle":
        length_m, width_m = width_m, length_m
    model = box_model((length_m, width_m, height_m), (0.9, 0.9, 0.9))
    return ModelSource(lambda _: model, 1, tuple((float(r), float(g), float(b)) for r, g, b in colours))


def building_model(building: Building, *, seed: int) -> tuple[Model, Place]:
    """Return a building's model, about a place of its own, and that place (ENU metres)."""
    try:
        from reasoned_explorer.rendering.buildings import mesh_of_building
    except ImportError:
        return centred(block_model(building))
    return centred(mesh_of_building(building, seed=seed))


def centred(model: Model) -> tuple[Model, Place]:
    """Return a model moved to the origin (single precision is fine only near it), and where it was."""
    points = model.levels[0].vertices
    if not len(points):
        return model, (0.0, 0.0, 0.0)
    middle = np.round(0.5 * (points.min(axis=0) + points.max(axis=0)).astype(np.float64))
    middle[2] = 0.0
    return Model(tuple(_moved(level, -middle) for level in model.levels), model.size_m, model.scaling), (
        float(middle[0]),
        float(middle[1]),
        0.0,
    )


def _moved(mesh: Mesh, by: np.ndarray) -> Mesh:
    vertices = (mesh.vertices.astype(np.float64) + by).astype(np.float32)
    return Mesh(vertices, mesh.triangles, mesh.normals, mesh.uvs, mesh.colours, mesh.materials)
