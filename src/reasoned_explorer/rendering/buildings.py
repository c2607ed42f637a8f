"""What buildings look like, from their footprints, heights and kinds."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.rendering.building_churches import church_windows, towers
from reasoned_explorer.rendering.building_details import balconies, dormers, posts, roof_things
from reasoned_explorer.rendering.building_doors import NOTHING_AROUND, Doors, Surroundings, doors, doors_of
from reasoned_explorer.rendering.building_roofs import Roofs, flat_roofs, gables, roofs_of, slopes
from reasoned_explorer.rendering.building_shops import Shops, awnings, shop_fronts, shops_of
from reasoned_explorer.rendering.building_styles import Styles, styles_of
from reasoned_explorer.rendering.building_walls import cornices, undersides, walls
from reasoned_explorer.rendering.footprints import Floats, Footprints
from reasoned_explorer.rendering.fronts import NO_FRONTS
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.patches import Patch, extents_of, meshes_of
from reasoned_explorer.world.world import Building, Way

#: Where a model's origin stands, ENU metres.
Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class _Street:
    """What buildings show to the street: shops and doors; and where fronts of places leave no room."""

    shops: Shops
    doors: Doors
    fronts: Floats


def mesh_of_building(building: Building, *, seed: int) -> Model:
    """Return what a building looks like, in ENU metres as its footprint is.

    Args:
        building: The building. Its rings may run either way and may have corners that shape nothing.
        seed: Of what the map does not say: colours, storeys, roofs.

    Returns:
        Three levels of detail; without triangles if the footprint has no area.
    """
    return _models([building], np.zeros((1, 2)), NOTHING_AROUND, seed=seed)[0]


def models_of_buildings(
    buildings: Sequence[Building], *, seed: int, fronts: Floats = NO_FRONTS, ways: Sequence[Way] = ()
) -> list[tuple[Model, Place]]:
    """Return what buildings look like, all at once, each about a place of its own, in whole metres.

    Each looks as `mesh_of_building` has it, whatever stands beside it, but for doors, awnings and balconies.

    Args:
        buildings: The buildings.
        seed: As of `mesh_of_building`.
        fronts: Where fronts of places are (`reasoned_explorer.rendering.fronts.walls_taken`), shape (n, 3): there are
            neither doors nor awnings nor balconies.
        ways: Buildings without known entrances have a door on their side.
    """
    if not buildings:
        return []
    places = np.zeros((len(buildings), 2))
    for at, one in enumerate(buildings):
        if len(one.outer):
            places[at] = np.round((one.outer.min(axis=0) + one.outer.max(axis=0)) / 2.0)
    models = _models(buildings, places, Surroundings(fronts, ways), seed=seed)
    return [(model, (x, y, 0.0)) for model, (x, y) in zip(models, places.tolist(), strict=True)]


def _models(buildings: Sequence[Building], places: Floats, around: Surroundings, *, seed: int) -> list[Model]:
    prints = Footprints.of(buildings)
    styles = styles_of(buildings, prints, seed=seed)
    roofs = roofs_of(prints, styles)
    street = _Street(shops_of(prints, styles, roofs), doors_of(buildings, prints, styles, roofs, around), around.fronts)
    levels = [
        meshes_of(patches, len(buildings), origins=places)
        for patches in (
            _fine(prints, styles, roofs, street),
            _middling(prints, styles, roofs, street),
            _coarse(prints, styles, roofs),
        )
    ]
    sizes = extents_of(levels[0])
    return [Model(meshes, size_m, "none") for meshes, size_m in zip(zip(*levels, strict=True), sizes, strict=True)]


def _fine(prints: Footprints, styles: Styles, roofs: Roofs, street: _Street) -> list[Patch]:
    return [
        *walls(prints, styles, roofs, bands=True),
        *shop_fronts(street.shops),
        undersides(prints, styles),
        *cornices(prints, styles, roofs),
        *flat_roofs(prints, styles, roofs, parapets=True),
        slopes(prints, styles, roofs),
        *gables(prints, styles, roofs, thick=True),
        *roof_things(prints, styles, roofs),
        *doors(street.doors, styles, fine=True),
        *dormers(prints, styles, roofs),
        *balconies(prints, styles, roofs, street.fronts),
        *awnings(street.shops, street.doors, street.fronts),
        posts(prints, styles),
        *church_windows(prints, styles, roofs),
        *towers(prints, styles, roofs),
    ]


def _middling(prints: Footprints, styles: Styles, roofs: Roofs, street: _Street) -> list[Patch]:
    return [
        *walls(prints, styles, roofs, bands=True),
        *shop_fronts(street.shops),
        undersides(prints, styles),
        *flat_roofs(prints, styles, roofs, parapets=False),
        slopes(prints, styles, roofs),
        *gables(prints, styles, roofs, thick=True),
        *roof_things(prints, styles, roofs),
        *doors(street.doors, styles, fine=False),
        posts(prints, styles),
        *church_windows(prints, styles, roofs),
        *towers(prints, styles, roofs),
    ]


def _coarse(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    return [
        *walls(prints, styles, roofs, bands=False),
        undersides(prints, styles),
        *flat_roofs(prints, styles, roofs, parapets=False),
        slopes(prints, styles, roofs),
        *gables(prints, styles, roofs, thick=False),
        *towers(prints, styles, roofs),
    ]
