"""Positions on earth of what happened in a real place."""

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.viewer.exports.mission import ExportedMission

#: Digits of degrees that are kept: about a millimetre.
_DIGITS = 8


class NotOnEarthError(InputError):
    """A mission in a place that is not on earth, for a format that knows latitudes and longitudes only."""


class Earth:
    """Where the frame of a mission's place lies on earth.

    Args:
        mission: What is to be exported.
        suffix: Of the format that needs it, for the message.

    Raises:
        NotOnEarthError: If the mission took place in a world that somebody made up.
    """

    def __init__(self, mission: ExportedMission, suffix: str) -> None:
        header = mission.record.header
        if header.origin_deg is None:
            place = f"{header.world!r} is not a place on earth" if header.is_judged else "no place on earth is known"
            fault = Fault(
                place,
                f"for {suffix} a mission in a real place",
                "export it as .rrd or .mcap, which need no place on earth",
            )
            raise NotOnEarthError("export", [fault])
        self._origin = GeoOrigin(*header.origin_deg)

    def lon_lat_deg(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return longitude and latitude, degrees on WGS 84, of a point of the mission's frame."""
        lat_deg, lon_deg = self._origin.geodetic_from_enu_deg(x_m, y_m)
        return round(lon_deg, _DIGITS), round(lat_deg, _DIGITS)
