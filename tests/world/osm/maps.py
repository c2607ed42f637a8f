"""Small maps, written as OSM XML in a frame of metres around a point."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

LAT, LON = 48.0, 11.0
_M_PER_DEG_LAT = 111_200.0
_M_PER_DEG_LON = 111_320.0 * math.cos(math.radians(LAT))
#: 400 m by 400 m around the middle.
BBOX = (LON - 200 / _M_PER_DEG_LON, LAT - 200 / _M_PER_DEG_LAT, LON + 200 / _M_PER_DEG_LON, LAT + 200 / _M_PER_DEG_LAT)
REAL_BBOXES = {
    "helsinki-centre": (24.9352, 60.1642, 24.9534, 60.1791),
    "munich-centre": (11.5657, 48.1314, 11.5861, 48.1434),
    "monaco-2025": (7.409, 43.7235, 7.440, 43.7525),
    "uvic-campus": (-123.3165, 48.4602, -123.3077, 48.4661),
}


def degrees(x_m: float, y_m: float) -> tuple[float, float]:
    return LAT + y_m / _M_PER_DEG_LAT, LON + x_m / _M_PER_DEG_LON


class Map:
    """Collects nodes, ways and relations; points are metres east and north of the middle."""

    def __init__(self) -> None:
        self.parts: list[str] = []
        self._next = 1

    def node(self, x_m: float, y_m: float, tags: Mapping[str, str] | None = None) -> int:
        at, self._next = self._next, self._next + 1
        lat, lon = degrees(x_m, y_m)
        self.parts.append(f'<node id="{at}" version="1" lat="{lat:.7f}" lon="{lon:.7f}">{_tags(tags)}</node>')
        return at

    def way(
        self, points: Sequence[tuple[float, float]], tags: Mapping[str, str] | None = None, *, closed: bool = False
    ) -> int:
        ids = [self.node(x_m, y_m) for x_m, y_m in points]
        return self.way_of([*ids, ids[0]] if closed else ids, tags)

    def way_of(self, ids: Sequence[int], tags: Mapping[str, str] | None = None) -> int:
        at, self._next = self._next, self._next + 1
        refs = "".join(f'<nd ref="{ref}"/>' for ref in ids)
        self.parts.append(f'<way id="{at}" version="1">{refs}{_tags(tags)}</way>')
        return at

    def box(self, x0: float, y0: float, x1: float, y1: float, tags: Mapping[str, str] | None = None) -> int:
        return self.way([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], tags, closed=True)

    def relation(self, members: Sequence[tuple[int, str]], tags: Mapping[str, str]) -> int:
        at, self._next = self._next, self._next + 1
        inner = "".join(f'<member type="way" ref="{ref}" role="{role}"/>' for ref, role in members)
        tags = {"type": "multipolygon", **tags}
        self.parts.append(f'<relation id="{at}" version="1">{inner}{_tags(tags)}</relation>')
        return at

    def xml(self) -> str:
        return f'<?xml version="1.0" encoding="UTF-8"?><osm version="0.6">{"".join(self.parts)}</osm>'

    def write(self, folder: Path, name: str = "map.osm") -> Path:
        path = folder / name
        path.write_text(self.xml(), encoding="utf-8")
        return path


def _tags(tags: Mapping[str, str] | None) -> str:
    return "".join(f"<tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in (tags or {}).items())
