"""Worlds in files come back as they were."""

import dataclasses
import functools
import gzip
import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import WorldError
from reasoned_explorer.world.files import load_world, save_world
from reasoned_explorer.world.taxonomy import CLASS_NAMES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject
from tests.world.worlds import courtyard

# Without the time of day, which would make another name of each case in each process of the tests.
packed = functools.partial(gzip.compress, mtime=0)

place = st.floats(-500.0, 500.0)
points = st.lists(st.tuples(place, place), min_size=3, max_size=6).map(np.asarray)
size = st.floats(0.01, 50.0)
text = st.text(st.characters(categories=["L", "N", "P"]), max_size=8)


@st.composite
def worlds(draw):
    regions = draw(
        st.lists(
            st.builds(Region, st.sampled_from(Ground), points, st.lists(points, max_size=2).map(tuple), text),
            max_size=3,
        )
    )
    ways = draw(
        st.lists(st.builds(Way, text, st.sampled_from(Ground), points, size, text, st.integers(-2, 2)), max_size=3)
    )
    buildings = draw(
        st.lists(
            st.builds(
                Building,
                points,
                st.floats(5.0, 90.0),
                st.lists(points, max_size=1).map(tuple),
                text,
                text,
                points,
                st.floats(0.0, 4.0),
                st.sampled_from(("height", "levels", "default")),
            ),
            max_size=3,
        )
    )
    objects = [
        WorldObject(
            i,
            draw(st.sampled_from(CLASS_NAMES)),
            draw(place),
            draw(place),
            draw(st.floats(0.0, 6.28)),
            draw(st.tuples(size, size, size)),
            draw(st.dictionaries(text, text, max_size=2)),
            draw(st.none() | points),
            draw(st.integers(-1, len(buildings) - 1)),
        )
        for i in range(draw(st.integers(0, 4)))
    ]
    origin = draw(st.none() | st.builds(GeoOrigin, st.floats(-80, 80), st.floats(-180, 180)))
    return World(
        draw(text), Bounds(-500, -500, 500, 500), tuple(regions), tuple(ways), tuple(buildings), tuple(objects), origin,
        draw(text), draw(text), draw(st.integers(0, 2**31)),
    )  # fmt: skip


def assert_same(a, b, *, within):
    """Compare dataclasses, sequences and numbers all the way down."""
    if dataclasses.is_dataclass(a):
        assert type(a) is type(b)
        for item in dataclasses.fields(a):
            assert_same(getattr(a, item.name), getattr(b, item.name), within=within)
    elif isinstance(a, np.ndarray):
        assert b.dtype == np.float64
        np.testing.assert_allclose(a, b, rtol=0.0, atol=within)
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for left, right in zip(a, b, strict=True):
            assert_same(left, right, within=within)
    elif isinstance(a, float):
        assert b == pytest.approx(a, rel=0.0, abs=within)
    else:
        assert a == b


def test_the_courtyard_comes_back(tmp_path):
    path = tmp_path / "a.rexworld"
    save_world(courtyard(), path)
    assert_same(courtyard(), load_world(path), within=5e-7)
    assert [item.name for item in tmp_path.iterdir()] == ["a.rexworld"]


@settings(deadline=None, max_examples=60)
@given(world=worlds())
def test_everything_comes_back_to_a_millimetre(world, tmp_path_factory):
    folder = tmp_path_factory.mktemp("worlds")
    save_world(world, folder / "a.rexworld")
    again = load_world(folder / "a.rexworld")
    assert_same(world, again, within=0.0005001)
    save_world(again, folder / "b.rexworld")
    assert (folder / "a.rexworld").read_bytes() == (folder / "b.rexworld").read_bytes()


def document_of(tmp_path):
    save_world(courtyard(), tmp_path / "sound.rexworld")
    return json.loads(gzip.decompress((tmp_path / "sound.rexworld").read_bytes()))


def refuse(tmp_path, data, says):
    path = tmp_path / "bad.rexworld"
    path.write_bytes(data)
    with pytest.raises(WorldError, match=says) as caught:
        load_world(path)
    return caught.value


@pytest.mark.parametrize("cut", [1, 9, 12, 100, -9, -1])
def test_a_truncated_file(tmp_path, cut):
    document_of(tmp_path)
    refuse(tmp_path, (tmp_path / "sound.rexworld").read_bytes()[:cut], "cut short|broken")


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "not JSON"),
        (b"no gzip at all", "broken"),
        (packed(b"{"), "not JSON"),
        (packed(b"\xff\xfe"), "not JSON"),
        (packed(b"[]"), "something else"),
        (packed(b'{"format": "other"}'), "something else"),
        (packed(b'{"format": "rexworld", "version": 2}'), "newer release"),
        (packed(b'{"format": "rexworld", "version": 1}'), "world"),
        (packed(b'{"format": "rexworld", "version": 1, "world": {"seed": NaN}}'), "not JSON"),
    ],
)
def test_a_broken_file(tmp_path, data, says):
    refuse(tmp_path, data, says)


def test_a_flipped_byte(tmp_path):
    document_of(tmp_path)
    data = bytearray((tmp_path / "sound.rexworld").read_bytes())
    data[len(data) // 2] ^= 0xFF
    refuse(tmp_path, bytes(data), "broken|cut short")


def test_all_faults_of_a_file_at_once(tmp_path):
    document = document_of(tmp_path)
    document["world"]["objects"][0]["at"] = [1]
    document["world"]["ways"][0]["width"] = "wide"
    document["world"]["colour"] = "red"
    error = refuse(tmp_path, packed(json.dumps(document).encode()), "3 faults")
    assert "objects.0.at" in str(error)


def test_unknown_names_with_their_near_misses(tmp_path):
    document = document_of(tmp_path)
    document["world"]["objects"][0]["cls"] = "bennch"
    document["world"]["regions"][0]["ground"] = "lava"
    document["world"]["ways"][0]["line"].append(3)
    error = refuse(tmp_path, packed(json.dumps(document).encode()), "did you mean bench")
    assert len(error.faults) == 3


def test_faults_of_the_world_itself(tmp_path):
    document = document_of(tmp_path)
    document["world"]["ways"][0]["width"] = 0
    refuse(tmp_path, packed(json.dumps(document).encode()), "width of 0.0 m")


def test_nothing_is_written_for_a_bad_world_or_name(tmp_path):
    with pytest.raises(WorldError, match="finite"):
        save_world(dataclasses.replace(courtyard(), bounds=Bounds(0, 0, math.nan, 1)), tmp_path / "a.rexworld")
    with pytest.raises(WorldError, match=r"ends in \.rexworld"):
        save_world(courtyard(), tmp_path / "a.json")
    with pytest.raises(WorldError, match="cannot be written"):
        save_world(courtyard(), tmp_path / "nowhere" / "a.rexworld")
    assert list(tmp_path.iterdir()) == []


def test_no_such_file(tmp_path):
    with pytest.raises(WorldError, match="no such file"):
        load_world(tmp_path / "a.rexworld")
