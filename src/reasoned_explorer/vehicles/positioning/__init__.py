"""Where a real machine is: fixes of a satellite receiver, corrections for it, what a filter makes of all sensors.

`parse_source` reads what a person writes (``gpsd://HOST``, ``serial:/dev/ttyUSB1:38400``), `Receiver` makes one stream
of fixes of it, and `Localizer` one position of fixes, turn rates, a compass and odometry, with a `PositionVerdict`:
whether a machine may move by it, and if not, why. No clock is read here: the caller says what time it is.
"""

from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.localizer import Localization, Localizer, LocalizerSettings
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.receiver import Receiver
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS, ReceiverModel
from reasoned_explorer.vehicles.positioning.source import (
    GpsdSource,
    NtripSource,
    SerialSource,
    parse_ntrip,
    parse_source,
)
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings
from reasoned_explorer.vehicles.positioning.verdict import Grade, PositionLimits, PositionVerdict

__all__ = [
    "RECEIVERS",
    "CompassReading",
    "Fix",
    "FixQuality",
    "GpsdSource",
    "Grade",
    "ImuSample",
    "Localization",
    "Localizer",
    "LocalizerSettings",
    "NtripSource",
    "OdometryReading",
    "PositionLimits",
    "PositionVerdict",
    "Receiver",
    "ReceiverModel",
    "SerialSource",
    "TrackSettings",
    "parse_ntrip",
    "parse_source",
]
