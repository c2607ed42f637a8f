"""Where a simulated body is while a leg is under way: the leg is worked out when it begins, and told as time passes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.simulation.mishaps import MishapKind, Mishaps
from reasoned_explorer.simulation.motion import Body, Motion
from reasoned_explorer.vehicles.safety.telemetry import Telemetry

#: A machine stands by itself so long after its link was lost, seconds.
FAILSAFE_S = 0.5


@dataclass(frozen=True, slots=True)
class State:
    """A moment of a body.

    Attributes:
        pose: Where it takes itself to be.
        speed_mps: Over ground.
        yaw_rate_radps: Positive clockwise.
    """

    pose: Pose
    speed_mps: float = 0.0
    yaw_rate_radps: float = 0.0


class UnderWay:
    """A leg while it is travelled.

    Args:
        started_s: Mission time at its start.
        motion: All of it.
        start: Where the body really was then.
        body: As the leg leaves it. The error of its filter there serves for all of the leg.
    """

    def __init__(self, started_s: float, motion: Motion, start: Pose, body: Body) -> None:
        self._started_s, self._motion, self._start = started_s, motion, start
        true, believed = body.true_pose, body.pose
        self._off_m = believed.x_m - true.x_m, believed.y_m - true.y_m
        self._off_rad = bearing_between_rad(true.heading_rad, believed.heading_rad)

    def at(self, now_s: float) -> State:
        """Return where it takes itself to be at a time."""
        elapsed_s = now_s - self._started_s
        times, rows = self._course
        x, y, heading = (float(np.interp(elapsed_s, times, column)) for column in rows.T)
        pose = Pose(x + self._off_m[0], y + self._off_m[1], 0.0, normalise_heading_rad(heading + self._off_rad))
        place = int(np.searchsorted(times, elapsed_s, side="right"))
        if place >= len(times) or place == 0:
            return State(pose)
        vx, vy, rate = ((rows[place] - rows[place - 1]) / (times[place] - times[place - 1])).tolist()
        return State(pose, float(np.hypot(vx, vy)), rate)

    @cached_property
    def _course(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Seconds since the start, and x, y and heading then, which goes on beyond a full turn; most legs need none."""
        points, start = self._motion.points, self._start
        if not len(points):
            points = np.array([(0.0, start.x_m, start.y_m, start.heading_rad)])
        rows = points[:, 1:].copy()
        rows[:, 2] = np.unwrap(points[:, 3])
        return points[:, 0], rows


def told(state: State, mishaps: Mishaps, now_s: float) -> Telemetry:
    """Return what a body tells of itself, with all that has befallen it."""
    battery = mishaps.at(MishapKind.BATTERY_LOW, now_s)
    return Telemetry(
        pose=mishaps.told(state.pose, now_s),
        t_s=now_s,
        speed_mps=state.speed_mps,
        yaw_rate_radps=state.yaw_rate_radps,
        link_age_s=mishaps.silent_s(MishapKind.LINK_LOSS, now_s),
        position_age_s=mishaps.silent_s(MishapKind.POSITION_SILENCE, now_s),
        battery=1.0 if battery is None else battery.amount,
    )
