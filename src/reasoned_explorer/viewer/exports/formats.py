"""The formats by suffix, and how a file of any of them is written: whole or not at all."""

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import cast

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.model.disk import disk_error
from reasoned_explorer.viewer.exports.mission import ExportedMission

_ROOM = "reasoned_explorer.viewer.exports"


@dataclass(frozen=True, slots=True)
class Format:
    """A format that missions are written in.

    Attributes:
        suffix: Of its files.
        summary: What it is for.
        target: ``"module:function"`` of what turns an `ExportedMission` into the bytes of a file.
    """

    suffix: str
    summary: str
    target: str

    def encoded(self, mission: ExportedMission) -> bytes:
        """Return the bytes of a file.

        Raises:
            InputError: If the mission cannot be told in this format.
            MissingDependencyError: If the format's library is not installed.
        """
        module, _, name = self.target.partition(":")
        # Loaded here: most of them bring a library that nobody else needs.
        return cast("Callable[[ExportedMission], bytes]", getattr(import_module(module), name))(mission)


FORMATS = {
    each.suffix: each
    for each in (
        Format(".rrd", "Rerun", f"{_ROOM}.rerun_recording:rrd_bytes"),
        Format(".mcap", "Foxglove", f"{_ROOM}.foxglove_log:mcap_bytes"),
        Format(".geojson", "maps, real places only", f"{_ROOM}.geojson:geojson_bytes"),
        Format(".gpx", "tracks, real places only", f"{_ROOM}.gpx:gpx_bytes"),
    )
}


def export_mission(mission: ExportedMission, path: Path) -> int:
    """Write a mission into a file, by its suffix; a file that is there is replaced. Return how many bytes it has.

    It is written beside and renamed: there is never half a file. The same record gives the same bytes, but for .rrd,
    which holds the same and says so (``rerun rrd compare --unordered``), but numbers it anew each time.

    Raises:
        InputError: If the suffix is none of `FORMATS`, the mission cannot be told in that format, or no file can be
            written there.
        MissingDependencyError: If the format's library is not installed.
        PartError: If the disk fails, e.g. because it is full.
    """
    chosen = FORMATS.get(path.suffix.lower())
    if chosen is None:
        raise InputError("export", [Fault(f"{path}", f"a name that ends in {' or '.join(FORMATS)}")])
    data = chosen.encoded(mission)
    half = path.with_name(f"{path.name}.{os.getpid()}.half")
    try:
        half.write_bytes(data)
        half.replace(path)
    except OSError as error:
        with suppress(OSError):
            half.unlink(missing_ok=True)
        raise disk_error("export", path, error) from error
    return len(data)
