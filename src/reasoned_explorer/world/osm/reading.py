"""OpenStreetMap files, read into plain tables of nodes, ways and relations.

libosmium (through pyosmium) does the decoding and keeps the nodes' places; only what carries tags or belongs to a
multipolygon reaches Python, so that a large file with a small bounding box stays affordable.
"""

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import osmium
import shapely
from numpy.typing import NDArray
from osmium.filter import EmptyTagFilter, TagFilter

from reasoned_explorer.model import Fault, WorldError
from reasoned_explorer.model.checks import is_there

BoxDeg = tuple[float, float, float, float]
_SUFFIXES = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf", ".pbf")
_CHUNK = 20_000
#: What the lost are called whose latitude or longitude is none.
OFF_EARTH = "nodes that lie nowhere on earth"
#: What osmium says where a file gives no coordinate.
_UNDEFINED = 2**31 - 1
_EXPECTED = "an OpenStreetMap extract: .osm, .osm.gz, .osm.bz2 or .osm.pbf"
_GET_ONE = "download the extract again, for example with the export of openstreetmap.org"


@dataclass(frozen=True, slots=True)
class NodeRecord:
    """A node with tags; degrees."""

    osm_id: int
    lon_deg: float
    lat_deg: float
    tags: dict[str, str]


@dataclass(frozen=True, slots=True)
class WayRecord:
    """A way, or what is left of one; its line stands in the extract's ``way_lines`` at the same place.

    Attributes:
        osm_id: Its id.
        tags: Its tags; empty for ways that only belong to relations.
        closed: Whether it ends where it begins.
    """

    osm_id: int
    tags: dict[str, str]
    closed: bool


@dataclass(frozen=True, slots=True)
class RelationRecord:
    """A multipolygon: its tags and the ids of the ways that it consists of."""

    osm_id: int
    tags: dict[str, str]
    way_ids: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Extract:
    """What a file holds.

    Attributes:
        header_box_deg: What the file says that it covers (lon0, lat0, lon1, lat1), or None.
        nodes: Nodes with tags, by id.
        ways: Ways, by id; one with lost nodes may stand here in several pieces.
        way_lines: Their lines, degrees, as shapely geometries; rings are closed lines.
        relations: Multipolygons, by id.
        newest_edit: The day of the newest edit of anything with tags, ``YYYY-MM-DD``, or empty.
        lost: Counts of what could not be read, by what it was.
    """

    header_box_deg: BoxDeg | None
    nodes: tuple[NodeRecord, ...]
    ways: tuple[WayRecord, ...]
    way_lines: NDArray[np.object_]
    relations: tuple[RelationRecord, ...]
    newest_edit: str = ""
    lost: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Torn:
    """A way some of whose nodes, (id, longitude, latitude), had no place yet when it was read: (id, None, None)."""

    record: WayRecord
    nodes: tuple[tuple[int, float | None, float | None], ...]


class _Collector:
    """Gathers what a pass over a file yields; of several versions of a thing, the last one counts."""

    def __init__(self, box_deg: BoxDeg | None, members: frozenset[int]) -> None:
        self.box_deg, self.members = box_deg, members
        self.nodes: dict[int, NodeRecord] = {}
        self.ways: dict[int, list[tuple[WayRecord, Any]]] = {}
        self.torn: dict[int, _Torn] = {}
        self.newest: Any = None
        self.lost = {"nodes without a place": 0, OFF_EARTH: 0, "ways that lost nodes": 0, "ways without a line": 0}
        self._fresh: list[int] = []
        self._factory = osmium.geom.WKBFactory()

    def add(self, item: Any) -> None:
        if item.deleted:
            return
        if item.is_node():
            self._add_node(item)
        else:
            self._add_way(item)

    def _note_edit(self, item: Any) -> None:
        stamp = item.timestamp
        if self.newest is None or stamp > self.newest:
            self.newest = stamp

    def _add_node(self, node: Any) -> None:
        place = node.location
        if not place.valid():
            is_told = _UNDEFINED not in {place.x, place.y}
            self.lost[OFF_EARTH if is_told else "nodes without a place"] += 1
            return
        if self.box_deg is not None and not _within(self.box_deg, place.lon, place.lat):
            return
        self._note_edit(node)
        self.nodes[node.id] = NodeRecord(node.id, place.lon, place.lat, {tag.k: tag.v for tag in node.tags})

    def _add_way(self, way: Any) -> None:
        if not len(way.tags) and way.id not in self.members:
            return
        tags = {tag.k: tag.v for tag in way.tags}
        record = WayRecord(way.id, tags, closed=way.is_closed() and len(way.nodes) > 3)
        if tags:
            self._note_edit(way)
        self.torn.pop(way.id, None)
        self._fresh.append(way.id)
        if len(self._fresh) >= _CHUNK:
            self.drop_outside()
        try:
            self.ways[way.id] = [(record, self._factory.create_linestring(way))]
        except (osmium.InvalidLocationError, RuntimeError, ValueError):
            self.ways[way.id] = []
            self.torn[way.id] = _Torn(
                record,
                tuple(
                    (node.ref, node.lon, node.lat) if node.location.valid() else (node.ref, None, None)
                    for node in way.nodes
                ),
            )

    def drop_outside(self) -> None:
        """Forget the ways read lately that do not touch the box, unless a multipolygon may need them."""
        fresh, self._fresh = self._fresh, []
        if self.box_deg is None:
            return
        candidates = [way_id for way_id in fresh if way_id not in self.members and self.ways.get(way_id)]
        if not candidates:
            return
        lines = shapely.from_wkb(np.array([self.ways[way_id][0][1] for way_id in candidates], dtype=object))
        extent = shapely.bounds(lines)
        lon0, lat0, lon1, lat1 = self.box_deg
        apart = (extent[:, 0] > lon1) | (extent[:, 2] < lon0) | (extent[:, 1] > lat1) | (extent[:, 3] < lat0)
        for at in np.flatnonzero(apart):
            self.ways.pop(candidates[at], None)

    def missing(self) -> frozenset[int]:
        """Return the ids of the nodes whose places are not known."""
        return frozenset(ref for torn in self.torn.values() for ref, lon, _ in torn.nodes if lon is None)

    def mend(self, places: Mapping[int, tuple[float, float]]) -> None:
        """Make lines of the torn ways: whole, or cut short where nodes stay lost."""
        for way_id in sorted(self.torn):
            torn = self.torn[way_id]
            runs: list[list[tuple[float, float]]] = [[]]
            for ref, lon, lat in torn.nodes:
                place = places.get(ref) if lon is None or lat is None else (lon, lat)
                if place is not None:
                    runs[-1].append(place)
                elif runs[-1]:
                    runs.append([])
            known = sum(map(len, runs))
            self.lost["ways that lost nodes"] += 0 < known < len(torn.nodes)
            if torn.record.closed and known < len(torn.nodes):
                ring = [point for run in runs for point in run]
                runs = [[*ring, ring[0]]] if len(set(ring)) >= 3 else []
            lines = [shapely.LineString(run) for run in runs if len(set(run)) >= 2]
            self.lost["ways without a line"] += not lines
            self.ways[way_id] = [(torn.record, shapely.to_wkb(line, hex=True)) for line in lines]


def _within(box_deg: BoxDeg, lon_deg: float, lat_deg: float) -> bool:
    return box_deg[0] <= lon_deg <= box_deg[2] and box_deg[1] <= lat_deg <= box_deg[3]


def read_extract(path: Path, *, box_deg: BoxDeg | None = None) -> Extract:
    """Read an OpenStreetMap file.

    Args:
        path: The file. Its ids need not be sorted.
        box_deg: Where given (lon0, lat0, lon1, lat1), nodes outside and ways that do not touch it are left out,
            except for the ways of multipolygons.

    Raises:
        WorldError: There is no such file, or it cannot be read as what its name says it is.
    """
    check_file(path)
    try:
        with tempfile.TemporaryDirectory(prefix="reasoned-explorer-") as folder:
            return _read(path, box_deg, Path(folder))
    except (osmium.InvalidLocationError, RuntimeError, ValueError, OSError) as error:
        what = f"{path} cannot be read as {_format_of(path)} ({_first_line(error)})"
        raise WorldError("OpenStreetMap file", [Fault(what, f"{_EXPECTED}, whole", _GET_ONE)]) from error


def check_file(path: Path) -> None:
    """Check that there is a file that could be an OpenStreetMap file, by its name and size.

    Raises:
        WorldError: There is none.
    """
    if not is_there(path):
        fault = Fault(f"there is no file {path}", _EXPECTED, "check the path")
    elif path.is_dir():
        fault = Fault(f"{path} is a directory", _EXPECTED, "name the file in it")
    elif not path.name.lower().endswith(_SUFFIXES):
        fault = Fault(f"{path.name!r} has a name that is none of an OpenStreetMap file", _EXPECTED, "rename it")
    elif path.stat().st_size == 0:
        fault = Fault(f"{path} is empty", _EXPECTED, _GET_ONE)
    else:
        return
    raise WorldError("OpenStreetMap file", [fault])


def _format_of(path: Path) -> str:
    return "PBF" if path.name.lower().endswith(".pbf") else "OSM XML"


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]


def _read(path: Path, box_deg: BoxDeg | None, folder: Path) -> Extract:
    pool = osmium.io.ThreadPool(1)
    with osmium.io.Reader(str(path), osmium.osm.NOTHING, thread_pool=pool) as reader:
        header = reader.header()
        several_versions = header.has_multiple_object_versions
        header_box = _header_box(header)
    source = _newest_versions(path, folder) if several_versions else path
    relations = _read_relations(source, pool)
    collector = _read_nodes_and_ways(source, relations, box_deg, pool)
    pieces = [piece for way_id in sorted(collector.ways) for piece in collector.ways[way_id]]
    lines = np.empty(len(pieces), dtype=object)
    if pieces:
        lines[:] = shapely.from_wkb(np.array([wkb for _, wkb in pieces], dtype=object))
    newest = collector.newest
    return Extract(
        header_box_deg=header_box,
        nodes=tuple(collector.nodes[node_id] for node_id in sorted(collector.nodes)),
        ways=tuple(record for record, _ in pieces),
        way_lines=lines,
        relations=relations,
        newest_edit="" if newest is None or newest.year < 2004 else newest.strftime("%Y-%m-%d"),
        lost={what: count for what, count in collector.lost.items() if count},
    )


def _header_box(header: Any) -> BoxDeg | None:
    box = header.box()
    if not box.valid():
        return None
    low, high = box.bottom_left, box.top_right
    return (low.lon, low.lat, high.lon, high.lat)


def _read_nodes_and_ways(
    source: Path, relations: tuple[RelationRecord, ...], box_deg: BoxDeg | None, pool: Any
) -> _Collector:
    collector = _Collector(box_deg, frozenset(way_id for relation in relations for way_id in relation.way_ids))
    with_tags = EmptyTagFilter()
    with_tags.enable_for(osmium.osm.NODE)
    kinds = osmium.osm.NODE | osmium.osm.WAY
    for item in osmium.FileProcessor(str(source), kinds, pool).with_locations().with_filter(with_tags):
        collector.add(item)
    collector.drop_outside()
    places: dict[int, tuple[float, float]] = {}
    if missing := collector.missing():
        # Nodes that stand after their ways, and those with negative ids (never uploaded), are not found on the way.
        for node in osmium.FileProcessor(str(source), osmium.osm.NODE, pool):
            if node.id in missing and node.location.valid() and not node.deleted:
                places[node.id] = (node.location.lon, node.location.lat)
    collector.mend(places)
    return collector


def _read_relations(source: Path, pool: Any) -> tuple[RelationRecord, ...]:
    multipolygons = TagFilter(("type", "multipolygon"))
    found: Iterable[Any] = osmium.FileProcessor(str(source), osmium.osm.RELATION, thread_pool=pool).with_filter(
        multipolygons
    )
    records = [
        RelationRecord(
            item.id,
            {tag.k: tag.v for tag in item.tags},
            tuple(member.ref for member in item.members if member.type == "w"),
        )
        for item in found
        if not item.deleted and len(item.tags) > 1
    ]
    return tuple(sorted(records, key=lambda record: record.osm_id))


def _newest_versions(path: Path, folder: Path) -> Path:
    """Write the newest version of everything to a file in ``folder``."""
    target = folder / "newest.osm.pbf"
    merged = osmium.MergeInputReader()
    merged.add_file(str(path))
    with osmium.SimpleWriter(str(target), overwrite=True) as writer:
        merged.apply(writer, simplify=True)
    return target
