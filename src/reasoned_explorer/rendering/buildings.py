"""What buildings look like, from their footprints, heights and kinds."""

from collections.abc import Sequence

import numpy as np

from reasoned_explorer.rendering.building_churches import church_windows, towers
from reasoned_explorer.rendering.building_details import balconies, dormers, posts, roof_things
from reasoned_explorer.rendering.building_doors import doors
from reasoned_explorer.rendering.building_roofs import Roofs, flat_roofs, gables, roofs_of, slopes
from reasoned_explorer.rendering.building_styles import Styles, styles_of
from reasoned_explorer.rendering.building_walls import cornices, undersides, walls
from reasoned_explorer.rendering.footprints import Floats, Footprints
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.patches import Patch, extents_of, meshes_of
from reasoned_explorer.world.world import Building

#: Where a model's origin stands, ENU metres.
Place = tuple[float, float, float]


def mesh_of_building(building: Building, *, seed: int) -> Model:
    """Return what a building looks like, in ENU metres as its footprint is.

    Args:
        building: The building. Its rings may run either way and may have corners that shape nothing.
        seed: Of what the map does not say: colours, storeys, roofs.

    Returns:
        Three levels of detail; without triangles if the footprint has no area.
    """
    return _models([building], np.zeros((1, 2)), seed=seed)[0]


def models_of_buildings(buildings: Sequence[Building], *, seed: int) -> list[tuple[Model, Place]]:
    """Return what buildings look like, all at once, each about a place of its own, in whole metres.

    Each looks as `mesh_of_building` has it, whatever stands beside it.
    """
    if not buildings:
        return []
    places = np.zeros((len(buildings), 2))
    for at, one in enumerate(buildings):
        if len(one.outer):
            places[at] = np.round((one.outer.min(axis=0) + one.outer.max(axis=0)) / 2.0)
    models = _models(buildings, places, seed=seed)
    return [(model, (x, y, 0.0)) for model, (x, y) in zip(models, places.tolist(), strict=True)]


def _models(buildings: Sequence[Building], places: Floats, *, seed: int) -> list[Model]:
    prints = Footprints.of(buildings)
    styles = styles_of(buildings, prints, seed=seed)
    roofs = roofs_of(prints, styles)
    levels = [
        meshes_of(patches, len(buildings), origins=places)
        for patches in (
            _fine(buildings, prints, styles, roofs),
            _middling(buildings, prints, styles, roofs),
            _coarse(prints, styles, roofs),
        )
    ]
    sizes = extents_of(levels[0])
    return [Model(meshes, size_m, "none") for meshes, size_m in zip(zip(*levels, strict=True), sizes, strict=True)]


def _fine(buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    return [
        *walls(prints, styles, roofs, bands=True),
        undersides(prints, styles),
        *cornices(prints, styles, roofs),
        *flat_roofs(prints, styles, roofs, parapets=True),
        slopes(prints, styles, roofs),
        *gables(prints, styles, roofs, thick=True),
        *roof_things(prints, styles, roofs),
        *doors(buildings, prints, styles, roofs, fine=True),
        *dormers(prints, styles, roofs),
        *balconies(prints, styles, roofs),
        posts(prints, styles),
        *church_windows(prints, styles, roofs),
        *towers(prints, styles, roofs),
    ]


def _middling(buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    return [
        *walls(prints, styles, roofs, bands=True),
        undersides(prints, styles),
        *flat_roofs(prints, styles, roofs, parapets=False),
        slopes(prints, styles, roofs),
        *gables(prints, styles, roofs, thick=True),
        *roof_things(prints, styles, roofs),
        *doors(buildings, prints, styles, roofs, fine=False),
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
