"""Frames: geodetic (WGS 84), local East-North-Up, and the North-East-Down of flying machines."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class GeoOrigin:
    """The point of the WGS 84 ellipsoid where a world's ENU frame has its origin.

    Attributes:
        lat_deg: Latitude, degrees, positive north, in [-90, 90].
        lon_deg: Longitude, degrees, positive east, in [-180, 180].
    """

    lat_deg: float
    lon_deg: float

    def enu_from_geodetic_m(self, lat_deg: Any, lon_deg: Any) -> "tuple[FloatArray, FloatArray]":
        """Return east and north of the origin, metres, for latitudes and longitudes in degrees.

        Scalars and arrays of one shape are taken; arrays of that shape are returned. Heights are taken as zero: within
        5 km of the origin the curvature of the earth moves a point by less than 5 mm horizontally.
        """
        # Loaded here: most of what uses poses needs neither.
        import numpy as np
        import pymap3d

        east_m, north_m, _ = pymap3d.geodetic2enu(
            np.asarray(lat_deg, dtype=np.float64), np.asarray(lon_deg, dtype=np.float64), 0.0, *self._triple()
        )
        return np.asarray(east_m, dtype=np.float64), np.asarray(north_m, dtype=np.float64)

    def geodetic_from_enu_deg(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return latitude and longitude, degrees, of a point of the ENU frame."""
        import pymap3d

        # A point on the ground lies below the tangent plane by d²/2R.
        drop_m = (x_m * x_m + y_m * y_m) / (2.0 * 6_371_000.0)
        lat_deg, lon_deg, _ = pymap3d.enu2geodetic(x_m, y_m, -drop_m, *self._triple())
        return float(lat_deg), float(lon_deg)

    def _triple(self) -> tuple[float, float, float]:
        return self.lat_deg, self.lon_deg, 0.0


#: Where those who tell satellites' positions put a world that is nowhere on earth: AirSim's own origin.
NOWHERE = GeoOrigin(47.641468, -122.140165)


def ned_from_enu(x_m: float, y_m: float, z_m: float) -> tuple[float, float, float]:
    """Return north, east, down for east, north, up."""
    return y_m, x_m, -z_m


def enu_from_ned(north_m: float, east_m: float, down_m: float) -> tuple[float, float, float]:
    """Return east, north, up for north, east, down."""
    return east_m, north_m, -down_m


def is_finite(*values: float) -> bool:
    """Return whether no value is NaN or infinite."""
    return all(math.isfinite(value) for value in values)
