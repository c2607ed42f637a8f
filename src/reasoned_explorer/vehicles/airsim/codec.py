"""MessagePack as both ends of an AirSim link speak it; loaded when it is first needed."""

from collections.abc import Callable
from typing import Any

from reasoned_explorer.model.errors import MissingDependencyError

#: Positions travel as doubles, pictures as bytes.
Pack = Callable[[object], bytes]
#: What unpacking raises on bytes that are no MessagePack, or more of it than is taken.
MALFORMED = (ValueError, TypeError, OverflowError, RecursionError)


def _msgpack() -> Any:
    try:
        import msgpack
    except ModuleNotFoundError as error:
        raise MissingDependencyError(
            "the wire of AirSim", "msgpack", "pip install 'reasoned-explorer[vehicles]'"
        ) from error
    return msgpack


def new_packer() -> Pack:
    """Return what packs a message.

    Raises:
        MissingDependencyError: If the library is not installed.
    """
    pack: Pack = _msgpack().Packer(use_bin_type=True).pack
    return pack


def new_unpacker(*, max_bytes: int, max_items: int) -> Any:
    """Return what unpacks messages from chunks of bytes: `feed` it, then iterate.

    Old servers send bytes as text: text that is none keeps its bytes (`as_bytes` gives them back).

    Args:
        max_bytes: Of one message.
        max_items: Of one array or map: room is made for them before they have come.

    Raises:
        MissingDependencyError: If the library is not installed.
    """
    return _msgpack().Unpacker(
        raw=False,
        unicode_errors="surrogateescape",
        max_buffer_size=max_bytes,
        max_array_len=max_items,
        max_map_len=min(max_items, 4096),
    )


def as_bytes(value: object) -> bytes:
    """Return what was sent as bytes, or as text by a server that knows no bytes, as bytes.

    Raises:
        ValueError: If it is neither.
    """
    if isinstance(value, bytes):
        return value
    if isinstance(value, str):
        return value.encode("utf-8", "surrogateescape")
    raise ValueError(f"expected bytes, not {type(value).__name__}")
