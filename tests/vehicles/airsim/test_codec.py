import sys

import pytest

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.vehicles.airsim.codec import as_bytes, new_packer, new_unpacker


def test_numbers_travel_as_doubles():
    unpacker = new_unpacker(max_bytes=1 << 10, max_items=10)
    unpacker.feed(new_packer()([0.1, 1 / 3]))
    assert list(unpacker) == [[0.1, 1 / 3]]


def test_without_the_library_the_command_that_installs_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "msgpack", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[vehicles\]'"):
        new_packer()


def test_bytes_are_had_from_bytes_and_from_text_that_was_bytes():
    assert as_bytes(b"\x89PNG") == b"\x89PNG"
    assert as_bytes("\udc89PNG") == b"\x89PNG"
    with pytest.raises(ValueError, match="expected bytes"):
        as_bytes([1, 2])
