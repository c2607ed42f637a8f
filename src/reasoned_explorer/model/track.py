"""Where a vehicle is sent and where it went."""

from dataclasses import dataclass
from enum import StrEnum


class LegOutcome(StrEnum):
    """How a leg ended."""

    ARRIVED = "arrived"
    COLLISION = "collision"
    STUCK = "stuck"
    STOPPED = "stopped"
    FAULT = "fault"


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """A moment of a track: mission seconds, ENU metres, compass heading in radians; true, not estimated, positions."""

    t_s: float
    x_m: float
    y_m: float
    z_m: float
    heading_rad: float


@dataclass(frozen=True, slots=True)
class Leg:
    """What came of one command to go somewhere.

    Attributes:
        target_x_m: Where the vehicle was sent, ENU, after its limits.
        target_y_m: Likewise.
        outcome: How it ended.
        duration_s: Seconds that the leg took.
        length_m: Metres travelled.
        track: The way that was travelled, oldest first; both ends are in it.
        detail: What was hit, or why it stopped; empty when it arrived.
        cross_track_rms_m: Root mean square distance from the straight line to the target, metres.
        localization_rms_m: Root mean square error of the localization filter, metres; None where truth is unknown.
    """

    target_x_m: float
    target_y_m: float
    outcome: LegOutcome
    duration_s: float
    length_m: float
    track: tuple[TrackPoint, ...]
    detail: str = ""
    cross_track_rms_m: float = 0.0
    localization_rms_m: float | None = None
