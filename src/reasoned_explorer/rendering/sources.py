"""Where the looks of things come from."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.standins import box_model
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES


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
        variants = variants_of(name)
    except UnknownNameError:
        return _boxes(name)
    return ModelSource(lambda variant: model_of(name, variant), variants, tuple(tints_of(name)))


def _boxes(name: str) -> ModelSource:
    colours = np.random.default_rng(sum(map(ord, name))).uniform(0.2, 0.9, (3, 3))
    length_m, width_m, height_m = OBJECT_CLASSES[name].size_m
    if OBJECT_CLASSES[name].kind == "vehicle":
        length_m, width_m = width_m, length_m
    model = box_model((length_m, width_m, height_m), (0.9, 0.9, 0.9))
    return ModelSource(lambda _: model, 1, tuple((float(r), float(g), float(b)) for r, g, b in colours))
