"""The files that ``rex look`` writes: all of them whole, or none."""

import json
import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_there, path_of
from reasoned_explorer.model.disk import disk_error


def check_target(path: Path) -> None:
    """Check where a picture is to go.

    Raises:
        SettingsError: If it cannot go there; with all the reasons.
    """
    path = path_of(path, "--out", SettingsError)
    faults = []
    if path.suffix.lower() != ".png":
        faults.append(Fault(f"picture file {str(path)!r}", "a name that ends in .png"))
    if not is_there(path.parent) or not path.parent.is_dir():
        faults.append(Fault(f"folder {str(path.parent)!r} is not there", "an existing folder", "create it first"))
    if is_there(path) and path.is_dir():
        faults.append(Fault(f"{str(path)!r} is a folder", "the name of a file"))
    if faults:
        raise SettingsError("--out", faults)


def files_of(
    out: Path,
    colour: NDArray[np.uint8],
    *,
    depth_m: NDArray[np.float32] | None = None,
    heights_m: NDArray[np.float32] | None = None,
    instances: NDArray[np.int32] | None = None,
    classes: NDArray[np.uint8] | None = None,
    thanks: str = "",
) -> dict[Path, bytes]:
    """Return what is to be written, by where.

    Args:
        out: The picture; what belongs to it has its name with another ending.
        colour: sRGB, shape (height, width, 3).
        depth_m: Metres, shape (height, width); None writes none.
        heights_m: Likewise, above the ground.
        instances: Instance ids, likewise.
        classes: Places in `PICTURE_CLASSES`, likewise.
        thanks: Whom the map is from; kept in the pictures.
    """
    from reasoned_explorer.rendering.codes import coded_colours, millimetres

    files = {out: _png(colour, thanks)}
    for name, metres in (("depth", depth_m), ("height", heights_m)):
        if metres is not None:
            files[out.with_suffix(f".{name}.npy")] = _npy(metres)
            files[out.with_suffix(f".{name}.png")] = _png(millimetres(metres), thanks)
    for name, codes in (("ids", instances), ("classes", classes)):
        if codes is not None:
            files[out.with_suffix(f".{name}.npy")] = _npy(codes)
            files[out.with_suffix(f".{name}.png")] = _png(coded_colours(codes), thanks)
    if classes is not None:
        files[out.with_suffix(".classes.json")] = _legend(classes)
    return files


def write_together(files: Mapping[Path, bytes]) -> None:
    """Write files; where one cannot be written, none is, and what was there stays.

    Raises:
        SettingsError: If the place was chosen badly.
        PartError: If the disk fails.
    """
    unfinished: dict[Path, Path] = {}
    path = Path()
    try:
        for path, content in files.items():
            handle, name = tempfile.mkstemp(prefix=f".{path.name[:40]}.", suffix=".part", dir=path.parent)
            unfinished[path] = Path(name)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            unfinished[path].chmod(0o644)
        for path in list(unfinished):
            unfinished[path].replace(path)
            del unfinished[path]
    except OSError as reason:
        raise disk_error("look", path, reason, kind=SettingsError) from reason
    finally:
        for left in unfinished.values():
            with suppress(OSError):
                left.unlink(missing_ok=True)


def _png(pixels: NDArray[np.uint8] | NDArray[np.uint16], thanks: str) -> bytes:
    about, file = PngInfo(), BytesIO()
    if thanks:
        about.add_itxt("Copyright", thanks)
    # A twentieth larger than at the usual level, and written in a third of the time.
    Image.fromarray(pixels).save(file, "PNG", pnginfo=about, compress_level=2)
    return file.getvalue()


def _npy(values: NDArray[np.generic]) -> bytes:
    file = BytesIO()
    np.save(file, values, allow_pickle=False)
    return file.getvalue()


def _legend(classes: NDArray[np.uint8]) -> bytes:
    """Return the classes that are seen: name, colour in the picture and share of it, by code."""
    from reasoned_explorer.rendering.codes import coded_colours
    from reasoned_explorer.rendering.scene import PICTURE_CLASSES

    codes, counts = np.unique(classes, return_counts=True)
    legend = {
        str(int(code)): {
            "name": PICTURE_CLASSES[int(code)],
            "colour": [int(value) for value in rgb],
            "share": round(int(count) / classes.size, 6),
        }
        for code, count, rgb in zip(codes, counts, coded_colours(codes), strict=True)
    }
    return (json.dumps(legend, indent=2) + "\n").encode()
