"""What takes long to make and is always the same, kept on disk beside the compiled code: models and textures.

A file is named for what it holds, so that there are never more files than things to keep, and says what it was made
by: the sources of this room, numpy, the processor. One that was made by anything else, or is damaged, is made anew and
replaced. Many processes may use it at once, since files are written beside and then put in place.
"""

import hashlib
import json
import math
import os
import threading
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import draws
from reasoned_explorer.rendering.cache import cache_folder, processor
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.world import taxonomy

Arrays = Sequence[NDArray[Any]]
_ALIGNED, _MESH_ARRAYS = 64, 6
#: A file begins with who made it, a check sum of all that follows, and how long the description of its arrays is.
_HEAD_SIZE = 128


def kept_arrays(name: str, make: Callable[[], Arrays]) -> Arrays:
    """Return arrays as they are kept, or make and keep them.

    Args:
        name: Of the file, without its ending.
        make: Makes them: always the same ones.
    """
    folder = shelf_folder()
    if folder is None:
        return make()
    path = folder / f"{name}.kept"
    try:
        return _read(np.fromfile(path, np.uint8))
    except (OSError, ValueError, TypeError, KeyError):
        made = make()
        _write(path, made)
        return made


def kept_model(name: str, make: Callable[[], Model]) -> Model:
    """Return a model as it is kept, or make and keep it; see `kept_arrays`."""
    return _model_of(kept_arrays(name, lambda: _arrays_of(make())))


def shelf_folder() -> Path | None:
    """Return where files are kept, or None where nothing is."""
    folder = cache_folder()
    return None if folder is None else folder / "shelf"


def _arrays_of(model: Model) -> Arrays:
    """Return a model as arrays: which mesh each level is, its size, how it scales, and each mesh once."""
    meshes = {id(mesh): mesh for mesh in model.levels}
    places = list(meshes)
    found: list[NDArray[Any]] = [
        np.array([places.index(id(mesh)) for mesh in model.levels], np.int64),
        np.array(model.size_m, np.float64),
        np.frombuffer(model.scaling.encode(), np.uint8),
    ]
    for mesh in meshes.values():
        found += [mesh.vertices, mesh.triangles, mesh.normals, mesh.uvs, mesh.colours, mesh.materials]
    return found


def _model_of(arrays: Arrays) -> Model:
    levels, size_m, scaling, *parts = arrays
    meshes = [Mesh(*parts[at : at + _MESH_ARRAYS]) for at in range(0, len(parts), _MESH_ARRAYS)]
    x_m, y_m, z_m = size_m.tolist()
    return Model(tuple(meshes[at] for at in levels.tolist()), (x_m, y_m, z_m), scaling.tobytes().decode())


def _read(content: NDArray[np.uint8]) -> Arrays:
    head = content[:_HEAD_SIZE].tobytes().decode("ascii").split()
    rest = content[_HEAD_SIZE:]
    if head[:-1] != [_maker(), f"{zlib.crc32(rest.data):08x}"]:
        raise ValueError("made by something else, or damaged")
    length = int(head[-1])
    found, at = [], _room(length)
    for kind, shape in json.loads(rest[:length].tobytes()):
        whole = np.dtype(kind).itemsize * math.prod(shape)
        found.append(rest[at : at + whole].view(kind).reshape(shape))
        at += _room(whole)
    return found


def _write(path: Path, arrays: Arrays) -> None:
    about = json.dumps([(array.dtype.str, array.shape) for array in arrays]).encode()
    rest = b"".join(_padded(part) for part in (about, *(array.tobytes() for array in arrays)))
    head = f"{_maker()} {zlib.crc32(rest):08x} {len(about)}".encode().ljust(_HEAD_SIZE)
    beside = path.with_suffix(f".{os.getpid()}-{threading.get_ident()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        beside.write_bytes(head + rest)
        beside.replace(path)
    except OSError:  # a full or a foreign disk: it is made again next time
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def _padded(part: bytes) -> bytes:
    return part.ljust(_room(len(part)), b"\0")


def _room(size: int) -> int:
    return -(-size // _ALIGNED) * _ALIGNED


@lru_cache(maxsize=1)
def _maker() -> str:
    found = hashlib.sha256(f"{np.__version__}\n{processor()}\n".encode())
    for source in (*sorted(Path(__file__).parent.rglob("*.py")), Path(taxonomy.__file__), Path(draws.__file__)):
        found.update(source.read_bytes())
    return found.hexdigest()
