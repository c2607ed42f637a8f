"""What other sensors than the satellite receiver measured, each with its own time on the caller's clock."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ImuSample:
    """Turn rate, and acceleration where the machine knows it free of gravity.

    Attributes:
        time_s: The end of the time that it is the mean of, seconds.
        yaw_rate_radps: Radians a second, positive clockwise.
        forward_mps2: Acceleration ahead, metres a second squared; None where it is not known.
        right_mps2: Acceleration to the right; None where it is not known.
    """

    time_s: float
    yaw_rate_radps: float
    forward_mps2: float | None = None
    right_mps2: float | None = None


@dataclass(frozen=True, slots=True)
class CompassReading:
    """A heading.

    Attributes:
        time_s: When.
        heading_rad: From true north, clockwise.
    """

    time_s: float
    heading_rad: float


@dataclass(frozen=True, slots=True)
class OdometryReading:
    """A velocity of the body against the ground, of legs, wheels or optical flow.

    Attributes:
        time_s: When.
        forward_mps: Ahead, metres a second.
        right_mps: To the right.
    """

    time_s: float
    forward_mps: float
    right_mps: float = 0.0
