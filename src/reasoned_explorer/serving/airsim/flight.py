"""A flight of the served drone, worked out when it begins: where it is at each moment, and what it runs into."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import normalise_heading_rad

Floats = NDArray[np.float64]


class State(NamedTuple):
    """Where the drone is and how it moves: ENU metres, a compass heading, metres and radians a second."""

    x_m: float
    y_m: float
    z_m: float
    heading_rad: float
    vx_mps: float = 0.0
    vy_mps: float = 0.0
    vz_mps: float = 0.0
    yaw_rate_radps: float = 0.0


class Hit(NamedTuple):
    """What a flight ran into.

    Attributes:
        elapsed_s: When, seconds from the flight's start.
        name: What, as it is called on the wire.
        x_m: Where the body was then.
        y_m: Likewise.
        z_m: Likewise.
        heading_rad: In which direction the obstacle lies.
    """

    elapsed_s: float
    name: str
    x_m: float
    y_m: float
    z_m: float
    heading_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """One command's motion.

    Attributes:
        start_s: When it began, the server's seconds.
        points: Shape (n, 5), n ≥ 1: seconds since the start, growing; x, y, z; heading, radians, without jumps.
        answer_s: When the command is answered, seconds since the start; the motion may end a little later.
        succeeded: What is answered.
        hit: What it ran into, or None.
        leave: Called with seconds since the start when the flight ends there: leaves the body where it then is.
    """

    start_s: float
    points: Floats
    answer_s: float
    succeeded: bool
    hit: Hit | None
    leave: Callable[[float], None]

    @property
    def duration_s(self) -> float:
        """Seconds until the drone stands."""
        return float(self.points[-1, 0])

    def state(self, elapsed_s: float) -> State:
        """Return where the drone is so many seconds after the start."""
        points = self.points
        times = points[:, 0]
        x, y, z, heading = (float(np.interp(elapsed_s, times, points[:, k])) for k in range(1, 5))
        place = int(np.searchsorted(times, elapsed_s, side="right"))
        if elapsed_s < 0.0 or place >= len(times):
            return State(x, y, z, normalise_heading_rad(heading))
        before, after = points[place - 1], points[place]
        vx, vy, vz, rate = ((after[1:] - before[1:]) / (after[0] - before[0])).tolist()
        return State(x, y, z, normalise_heading_rad(heading), vx, vy, vz, rate)
