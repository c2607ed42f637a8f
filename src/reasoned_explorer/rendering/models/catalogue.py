"""All models by the name of their class."""

from functools import lru_cache

from reasoned_explorer.model import UnknownNameError
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.mesh_builder import Colour
from reasoned_explorer.rendering.models import (
    art,
    bins,
    booths,
    cars,
    cycles,
    halls,
    people,
    places,
    play,
    posts,
    seats,
    signs,
    trees,
    waterworks,
)
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.shelf import kept_model
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

_MAKERS: dict[str, Maker] = {
    name: maker
    for module in (art, bins, booths, cars, cycles, halls, people, places, play, posts, seats, signs, trees, waterworks)
    for name, maker in module.MAKERS.items()
}


def natural_size_m(class_name: str) -> tuple[float, float, float]:
    """Return a class's size in a model's frame: across (x), ahead (y) and up, metres. Vehicles face ahead.

    Raises:
        UnknownNameError: If there is no such class.
    """
    _maker(class_name)
    item = OBJECT_CLASSES[class_name]
    length_m, width_m, height_m = item.size_m
    return (width_m, length_m, height_m) if item.kind == "vehicle" else (length_m, width_m, height_m)


def model_of(class_name: str, variant: int = 0) -> Model:
    """Return what things of a class look like; made once, then kept.

    Args:
        class_name: A name of `OBJECT_CLASSES`.
        variant: Any number; counted round after `variants_of`.

    Returns:
        The model, in the frame of `reasoned_explorer.rendering.mesh` at the class's natural size. Fronts of places (a
        cafe, a shop) begin at the wall, at y = 0, and reach forward. What is higher than people's heads (a lamp's arm,
        a flag) may reach beyond the natural size; so may what stands on an area.

    Raises:
        UnknownNameError: If there is no such class.
    """
    return _made(class_name, variant % variants_of(class_name))


def variants_of(class_name: str) -> int:
    """Return how many different models a class has, at least 1.

    Raises:
        UnknownNameError: If there is no such class.
    """
    return _maker(class_name).variants


def tints_of(class_name: str) -> tuple[Colour, ...]:
    """Return plausible tints of a class, sRGB in [0, 1], at least one; white alone where nothing is tinted.

    Raises:
        UnknownNameError: If there is no such class.
    """
    return _maker(class_name).tints


@lru_cache(maxsize=1024)
def _made(class_name: str, variant: int) -> Model:
    return kept_model(
        f"model-{class_name}-{variant}", lambda: _maker(class_name).model(variant, natural_size_m(class_name))
    )


def _maker(class_name: str) -> Maker:
    if class_name not in _MAKERS:
        raise UnknownNameError("object class", class_name, tuple(OBJECT_CLASSES))
    return _MAKERS[class_name]
