"""Every model of every class, in every variant and at every level of detail."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest

from reasoned_explorer.model import UnknownNameError
from reasoned_explorer.rendering.material import TINTED, Material
from reasoned_explorer.rendering.models import model_of, natural_size_m, tints_of, variants_of
from reasoned_explorer.rendering.models.catalogue import _MAKERS
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from tests.rendering.meshes import (
    faces,
    fighting,
    floating,
    is_backed,
    is_closed,
    parts,
    seen_from,
    signed_volume,
    welded,
)

EVERY = [(name, variant) for name in OBJECT_CLASSES for variant in range(variants_of(name))]
EVERY_LEVEL = [(name, variant, level) for name, variant in EVERY for level in range(4)]
#: Below this height nothing reaches beyond the natural size: people walk and robots drive there.
HEADROOM_M = 2.2
LEAFY = {"tree", "shrub", "planter"}


def mesh_of(name, variant, level):
    return model_of(name, variant).levels[level]


@pytest.mark.parametrize("name", OBJECT_CLASSES)
def test_every_class_has_a_model_of_its_natural_size(name):
    model = model_of(name)
    assert len(model.levels) == 4
    assert model.size_m == natural_size_m(name)
    assert sorted(model.size_m) == sorted(OBJECT_CLASSES[name].size_m)
    assert model.scaling in {"axes", "uniform", "none"}
    assert tints_of(name)
    assert np.array(tints_of(name)).min() >= 0
    assert np.array(tints_of(name)).max() <= 1


def test_unknown_classes_are_named_with_the_near_misses():
    for ask in (model_of, variants_of, tints_of, natural_size_m):
        with pytest.raises(UnknownNameError, match="did you mean bench"):
            ask("bensch")


def test_variants_are_counted_round_and_kept():
    assert model_of("bench", variants_of("bench")) is model_of("bench", 0)
    assert model_of("tree", -1) is model_of("tree", variants_of("tree") - 1)
    assert len({model_of("tree", k).levels[0].vertices.tobytes() for k in range(variants_of("tree"))}) == variants_of(
        "tree"
    )


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_extent(name, variant):
    size = np.array(natural_size_m(name))
    kind = OBJECT_CLASSES[name].kind
    levels = model_of(name, variant).levels
    for mesh in levels:
        if name == "lawn":
            assert not len(mesh.triangles)
            continue
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        if kind == "area":
            assert (np.abs(mesh.vertices[:, :2]) <= size[:2] / 2 + 1e-3).all()
        elif kind == "place":
            assert low == pytest.approx([-size[0] / 2, 0, 0], abs=1e-3)
            assert high == pytest.approx([size[0] / 2, size[1], size[2]], abs=1e-3)
        elif name == "person":
            assert 1.0 <= high[2] <= 1.85
            assert (high - low)[:2].max() <= 1.0
        elif name == "tree":
            assert high[2] == pytest.approx(size[2], abs=0.6)
            assert 1.8 <= np.abs(mesh.vertices[:, :2]).max() <= 3.5
        else:
            below = mesh.vertices[mesh.vertices[:, 2] <= HEADROOM_M]
            # Of coarse levels, sides may bulge where the whole was drawn out to the finest level's extent.
            assert (np.abs(below[:, :2]) <= size[:2] / 2 + (2e-3 if mesh is levels[0] else 0.12)).all()
            assert high[2] == pytest.approx(size[2], abs=0.02)
        assert low[2] == pytest.approx(0, abs=2e-3)


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_levels_keep_the_extent_and_lose_triangles(name, variant):
    levels = model_of(name, variant).levels
    counts = [len(mesh.triangles) for mesh in levels]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] <= 24
    assert counts[0] <= (1500 if name == "tree" else 2500)
    if name == "lawn":
        return
    assert counts[-1] > 0
    for mesh in levels[1:]:
        assert mesh.vertices.min(axis=0) == pytest.approx(levels[0].vertices.min(axis=0), abs=1e-3)
        assert mesh.vertices.max(axis=0) == pytest.approx(levels[0].vertices.max(axis=0), abs=1e-3)


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_levels_keep_the_colour(name, variant):
    levels = model_of(name, variant).levels
    if name == "lawn":
        return
    tint = np.array(tints_of(name)[0])
    for level, mesh in enumerate(levels):
        colour = seen_colour(mesh, tint)
        assert colour == pytest.approx(seen_colour(levels[0], tint), abs=0.1 if level < 3 else 0.17), level


def seen_colour(mesh, tint):
    """The mean colour of what is seen from ahead, from behind and from the sides, a little from above."""
    colours = np.where(np.isin(mesh.materials, list(TINTED))[:, None], mesh.colours * tint, mesh.colours)
    return np.mean([colours[seen_from(mesh, heading)].mean(axis=0) for heading in (0.3, 1.9, -0.6)], axis=0)


@pytest.mark.parametrize(("name", "variant", "level"), EVERY_LEVEL)
def test_arrays_are_sound(name, variant, level):
    mesh = mesh_of(name, variant, level)
    count = len(mesh.triangles)
    assert (mesh.vertices.dtype, mesh.triangles.dtype, mesh.materials.dtype) == (np.float32, np.int32, np.uint8)
    assert mesh.normals.shape == (count, 3, 3)
    assert mesh.uvs.shape == (count, 3, 2)
    assert mesh.colours.shape == (count, 3)
    if not count:
        return
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.uvs).all()
    assert mesh.triangles.min() == 0
    assert mesh.triangles.max() == len(mesh.vertices) - 1
    assert mesh.colours.min() >= 0
    assert mesh.colours.max() <= 1
    assert set(mesh.materials.tolist()) <= {int(item) for item in Material}
    normals, areas = faces(mesh)
    assert areas.min() > 1e-9
    assert np.linalg.norm(mesh.normals, axis=2) == pytest.approx(1, abs=1e-4)
    assert np.einsum("mck,mk->mc", mesh.normals, normals).min() > 0


@pytest.mark.parametrize(("name", "variant", "level"), EVERY_LEVEL)
def test_nothing_is_inside_out(name, variant, level):
    """Closed parts enclose a positive volume; open ones face away from their middle, or lie on what is behind them."""
    mesh = mesh_of(name, variant, level)
    if not len(mesh.triangles):
        return
    triangles = welded(mesh)
    part = parts(triangles)
    normals, areas = faces(mesh)
    middles = mesh.vertices[mesh.triangles].astype(np.float64).mean(axis=1)
    for number in range(part.max() + 1):
        chosen = part == number
        if is_closed(triangles[chosen]):
            assert signed_volume(mesh, chosen) > -1e-9, middles[chosen].mean(axis=0)
            continue
        away = middles[chosen] - np.average(middles[chosen], axis=0, weights=areas[chosen])
        outward = float((np.einsum("mk,mk->m", normals[chosen], away) * areas[chosen]).sum())
        if (normals[chosen] @ normals[chosen][0]).min() > 0.9999:
            assert is_backed(mesh, chosen, (0.07, 0.07, 0.2, 2.5)[level]), middles[chosen].mean(axis=0)
        else:
            assert outward > 0, middles[chosen].mean(axis=0)


@pytest.mark.parametrize(("name", "variant", "level"), EVERY_LEVEL)
def test_nothing_floats(name, variant, level):
    mesh = mesh_of(name, variant, level)
    if not len(mesh.triangles):
        return
    part = parts(welded(mesh))
    loose = floating(mesh, part, 0.5 if name in LEAFY else 0.035 if level < 3 else 0.12)
    places = [mesh.vertices[mesh.triangles[part == k]].reshape(-1, 3).mean(axis=0).round(2).tolist() for k in loose]
    assert places == []


def digest():
    total = hashlib.sha256()
    for name, variant in EVERY[::2]:
        # Past the cache: what is made anew must be the same.
        for mesh in _MAKERS[name].model(variant, natural_size_m(name)).levels:
            for field in ("vertices", "triangles", "normals", "uvs", "colours", "materials"):
                total.update(getattr(mesh, field).tobytes())
    return total.hexdigest()


def test_the_same_bytes_in_every_process():
    command = "from tests.rendering.test_models import digest; print(digest())"
    other = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    assert other.stdout.strip() == digest()


#: What is smaller than a hand's palm and crosses another part in one plane is not seen to.
_PALM_M2 = 0.002


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_no_two_colours_lie_in_one_plane(name, variant):
    for mesh in model_of(name, variant).levels[:2]:
        normals, _ = faces(mesh)
        corners = mesh.vertices[mesh.triangles]
        # Nobody sees undersides, nor backs of fronts, which are on walls.
        hidden = normals[:, 2] < -0.9
        if OBJECT_CLASSES[name].kind == "place":
            hidden |= (normals[:, 1] < -0.9) & (corners[..., 1].max(axis=1) < 0.3)
        pairs = fighting(mesh, least_m2=_PALM_M2)
        assert not len(pairs[~hidden[pairs[:, 0]]])
