"""How the simulated body moves: one leg, one turn or one wait at a time, 20 ticks a second.

The body is what is true; sensors that err measure it, the filter estimates it, the follower steers by the estimate.
Follower and filter are the ones that drivers of real machines use (`vehicles.control`).
"""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import draws
from reasoned_explorer.simulation import kernels
from reasoned_explorer.simulation.sensors import TICK_HZ, SensorNoise
from reasoned_explorer.vehicles.control import kernels as control
from reasoned_explorer.vehicles.control.follower import FollowerSettings
from reasoned_explorer.vehicles.control.localization import PoseFilter
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.world.world import Bounds

Floats = NDArray[np.float64]
TICK_S = 1.0 / TICK_HZ
#: Simulated standing after a leg, seconds: long enough to come to rest; what is longer passes in one go.
_STAND_S = 1.0
_LEAST_STAND_TICKS = 6
#: The machine follows a command with this lag, seconds (assumed).
_LAG_S = 0.1
#: How long its sway stays alike, seconds (assumed).
_SWAY_TAU_S = 1.0


class End(StrEnum):
    """How a motion ended."""

    ARRIVED = "arrived"
    STUCK = "stuck"
    TIME = "out of time"
    CUT = "cut short"
    WALL = "wall"
    DISC = "disc"
    GROUND = "ground"
    EDGE = "edge of the world"


_ENDS = {
    kernels.END_ARRIVED: End.ARRIVED,
    kernels.END_STUCK: End.STUCK,
    kernels.END_TIME: End.TIME,
    kernels.END_WALL: End.WALL,
    kernels.END_DISC: End.DISC,
    kernels.END_GROUND: End.GROUND,
    kernels.END_EDGE: End.EDGE,
}


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Ground that a body cannot stand on, as a raster.

    Attributes:
        codes: Shape (rows, cols), uint8; rows from south to north, columns from west to east.
        min_x_m: West edge of the first column.
        min_y_m: South edge of the first row.
        cell_m: Edge of a cell.
        blocked: Shape (256,), bool: which codes stop the body.
    """

    codes: NDArray[np.uint8]
    min_x_m: float
    min_y_m: float
    cell_m: float
    blocked: NDArray[np.bool_]

    @classmethod
    def open(cls) -> "Ground":
        """Return ground that stops nothing."""
        return cls(np.zeros((1, 1), np.uint8), 0.0, 0.0, 1.0, np.zeros(256, np.bool_))


NO_WALLS: Floats = np.empty((0, 4))
NO_DISCS: Floats = np.empty((0, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What came of one motion.

    Attributes:
        end: How it ended.
        hit: Row of the wall or disc, or code of the ground, that ended it; -1 otherwise.
        duration_s: Seconds that it took, standing afterwards included.
        length_m: Metres really travelled.
        points: Shape (n, 4): seconds since the start, x, y, heading [0, 2π); the truth, both ends included.
        cross_track_rms_m: Of the truth from the straight line; 0 where nothing was driven.
        localization_rms_m: Of the filter's position.
        refused: Measurements that the filter did not believe.
    """

    end: End
    hit: int
    duration_s: float
    length_m: float
    points: Floats
    cross_track_rms_m: float
    localization_rms_m: float
    refused: int


@dataclass(frozen=True, slots=True, eq=False)
class _Saved:
    arrays: tuple[NDArray[np.float64] | NDArray[np.int64], ...]
    waits: int


class Body:
    """A simulated body with its sensors, filter and follower.

    Args:
        profile: What it can do.
        noise: How its sensors err.
        start: Where it truly is at the start.
        seed: Of all its draws.
        bounds: It stops at these.
        ground: What it cannot stand on; none by default.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        noise: SensorNoise,
        start: Pose,
        *,
        seed: int,
        bounds: Bounds,
        ground: Ground | None = None,
    ) -> None:
        self.profile = profile
        self.noise = noise
        self._seed = draws.key_of(seed, "body")
        self._noise = noise.as_array()
        self._ground = Ground.open() if ground is None else ground
        self._ground_array = np.array([self._ground.min_x_m, self._ground.min_y_m, self._ground.cell_m])
        self._bounds = np.array([bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m], dtype=np.float64)
        self._body = np.array(
            [
                profile.speed_mps,
                profile.acceleration_mps2,
                profile.turn_rate_radps,
                profile.turn_acceleration_radps2,
                _LAG_S,
                profile.sway_mps,
                _SWAY_TAU_S,
                profile.radius_m,
                float(profile.collides),
                float(profile.moves_sideways),
            ]
        )
        settings = FollowerSettings.of(profile)
        self._follow, self._gains = settings.as_array(), settings.gains_array()
        self._memory = np.zeros(control.MEM_SIZE)
        self._tally = np.zeros(kernels.TALLY_SIZE)
        self._waits = 0
        self._true = self._first_truth(start)
        self.filter = self._first_belief(start)

    def _first_truth(self, start: Pose) -> Floats:
        true = np.zeros(kernels.TRUE_SIZE)
        true[[kernels.TRUE_X, kernels.TRUE_Y, kernels.TRUE_HEADING]] = start.x_m, start.y_m, start.heading_rad
        noise = self.noise
        for slot, sigma in (
            (kernels.TRUE_BIAS, noise.gyro_bias_sigma_radps),
            (kernels.TRUE_WANDER_X, noise.wander_sigma_m),
            (kernels.TRUE_WANDER_Y, noise.wander_sigma_m),
            (kernels.TRUE_COMPASS, noise.compass_wander_sigma_rad),
            (kernels.TRUE_SCALE, noise.odometry_scale_sigma),
        ):
            true[slot] = sigma * draws.normal(self._seed, "slow", slot)
        true[kernels.TRUE_SCALE] += 1.0
        return true

    def _first_belief(self, start: Pose) -> PoseFilter:
        """Begin with what one fix and one reading of the compass would say."""
        noise, seed = self.noise, self._seed
        believed = Pose(
            start.x_m + self._true[kernels.TRUE_WANDER_X] + noise.position_sigma_m * draws.normal(seed, "first", 0),
            start.y_m + self._true[kernels.TRUE_WANDER_Y] + noise.position_sigma_m * draws.normal(seed, "first", 1),
            0.0,
            normalise_heading_rad(
                start.heading_rad
                + self._true[kernels.TRUE_COMPASS]
                + noise.compass_sigma_rad * draws.normal(seed, "first", 2)
            ),
        )
        first = PoseFilter(
            noise.filter_settings(),
            believed,
            position_sigma_m=max(1e-4, math.hypot(noise.position_sigma_m, noise.wander_sigma_m)),
            heading_sigma_rad=max(1e-4, math.hypot(noise.compass_sigma_rad, noise.compass_wander_sigma_rad)),
            gyro_bias_sigma_radps=max(1e-6, noise.gyro_bias_sigma_radps),
        )
        # The first fix errs by the wander that the filter also carries as a state, with the opposite sign.
        cov = first.covariance
        for place, slow in (
            (control.EKF_X, control.EKF_WANDER_X),
            (control.EKF_Y, control.EKF_WANDER_Y),
            (control.EKF_HEADING, control.EKF_COMPASS_WANDER),
        ):
            cov[place, slow] = cov[slow, place] = -cov[slow, slow]
        return first

    @property
    def true_pose(self) -> Pose:
        """Where the body really is."""
        true = self._true
        return Pose(
            float(true[kernels.TRUE_X]),
            float(true[kernels.TRUE_Y]),
            0.0,
            normalise_heading_rad(float(true[kernels.TRUE_HEADING])),
        )

    @property
    def pose(self) -> Pose:
        """Where the filter believes it to be."""
        return self.filter.pose

    def nees(self) -> float:
        """Return the normalised estimation error squared of position and heading (three degrees of freedom)."""
        state, true = self.filter.state, self._true
        error = np.array(
            [
                state[control.EKF_X] - true[kernels.TRUE_X],
                state[control.EKF_Y] - true[kernels.TRUE_Y],
                control.wrap_bearing(state[control.EKF_HEADING] - true[kernels.TRUE_HEADING]),
            ]
        )
        chosen = [control.EKF_X, control.EKF_Y, control.EKF_HEADING]
        return float(error @ np.linalg.solve(self.filter.covariance[np.ix_(chosen, chosen)], error))

    def drive(
        self,
        target: Pose,
        *,
        leg: int,
        walls: Floats = NO_WALLS,
        discs: Floats = NO_DISCS,
        limit_s: float | None = None,
        face: bool = True,
    ) -> Motion:
        """Go to a point in a straight line, then turn to the target's heading.

        Args:
            target: Where to go, in the frame of the estimate.
            leg: Number of the motion: what its draws are keyed by.
            walls: What is in the way, shape (n, 4): x0, y0, x1, y1.
            discs: Likewise, shape (m, 3): x, y, radius.
            limit_s: Stop after so many seconds, wherever it is, at once, which the filter knows; by default three times
                what it should take.
            face: Whether to turn to the target's heading in the end.
        """
        pose = self.pose
        heading = target.heading_rad if face else math.nan
        distance_m = pose.distance_to_m(target.x_m, target.y_m)
        due_s = distance_m / self.profile.speed_mps + 2.0 * math.pi / self.profile.turn_rate_radps
        self._set_off(target.x_m, target.y_m, heading, control.PHASE_DRIVE)
        stand_s = min(self.profile.settle_s, _STAND_S)
        motion = self._run(
            leg, due_s=due_s, distance_m=distance_m, stand_s=stand_s, limit_s=limit_s, walls=walls, discs=discs
        )
        if limit_s is not None:
            # A filter that took it to fly on would refuse fixes for seconds.
            self._rest()
            self.filter.stand(0.0)
            return motion
        rest_s = self.profile.settle_s - stand_s
        if rest_s > 0.0:
            self.wait(rest_s)
            motion = _lengthened(motion, rest_s)
        return motion

    def turn(self, heading_rad: float, *, leg: int) -> Motion:
        """Turn in place to a heading (in the frame of the estimate)."""
        pose = self.pose
        self._set_off(pose.x_m, pose.y_m, heading_rad, control.PHASE_FACE)
        due_s = 2.0 * math.pi / self.profile.turn_rate_radps
        return self._run(leg, due_s=due_s)

    def place(self, pose: Pose) -> None:
        """Put the body somewhere else, at rest; its filter begins anew there, with what one fix says."""
        self._rest()
        self._true[[kernels.TRUE_X, kernels.TRUE_Y, kernels.TRUE_HEADING]] = pose.x_m, pose.y_m, pose.heading_rad
        fresh = self._first_belief(pose)
        for array, first in zip(self._arrays()[2:], (fresh.state, fresh.covariance, fresh.rejects), strict=True):
            array[...] = first

    def cruise_at(self, speed_mps: float) -> None:
        """Take another cruise speed from the next motion on, metres a second."""
        if speed_mps != self.profile.speed_mps:
            self.profile = replace(self.profile, speed_mps=speed_mps)
            self._body[kernels.BODY_SPEED] = speed_mps
            self._follow = FollowerSettings.of(self.profile).as_array()

    def wait(self, duration_s: float) -> None:
        """Let seconds pass in which the body stands still."""
        if duration_s <= 0.0:
            return
        self._rest()
        kernels.wander(self._true, self._noise, np.uint64(draws.key_of(self._seed, "wait", self._waits)), duration_s)
        self._waits += 1
        self.filter.stand(duration_s)

    def save(self) -> object:
        """Return all that changes, for `restore`."""
        return _Saved(tuple(array.copy() for array in self._arrays()), self._waits)

    def restore(self, saved: object) -> None:
        """Go back to what `save` returned.

        Raises:
            TypeError: If it did not come from `save`.
        """
        if not isinstance(saved, _Saved):
            raise TypeError(f"expected what save() returned, not {type(saved).__name__}")
        for array, kept in zip(self._arrays(), saved.arrays, strict=True):
            array[...] = kept
        self._waits = saved.waits

    def _arrays(self) -> tuple[NDArray[np.float64] | NDArray[np.int64], ...]:
        return self._true, self._memory, self.filter.state, self.filter.covariance, self.filter.rejects

    def _rest(self) -> None:
        self._true[kernels.TRUE_VX : kernels.TRUE_SWAY_Y + 1] = 0.0

    def _set_off(self, x_m: float, y_m: float, heading_rad: float, phase: int) -> None:
        state = self.filter.state
        x, y = float(state[control.EKF_X]), float(state[control.EKF_Y])
        control.follower_start(self._memory, x, y, float(x_m), float(y_m), float(heading_rad), phase)

    def _run(
        self,
        leg: int,
        *,
        due_s: float,
        distance_m: float = 0.0,
        stand_s: float = 0.0,
        limit_s: float | None = None,
        walls: Floats = NO_WALLS,
        discs: Floats = NO_DISCS,
    ) -> Motion:
        if limit_s is None:
            max_ticks = math.ceil((3.0 * due_s + 10.0) * TICK_HZ)
            stand_ticks = max(_LEAST_STAND_TICKS, round(stand_s * TICK_HZ))
        else:
            max_ticks, stand_ticks = math.floor(limit_s * TICK_HZ + 1e-6), 0
        rows = int(max_ticks / TICK_HZ / kernels.TRACK_S + 3.0 * distance_m / kernels.TRACK_M) + 16
        record = np.empty((rows, 4))
        kept = kernels.run_leg(
            np.uint64(draws.key_of(self._seed, "leg", leg)),
            self._true,
            self._body,
            self._noise,
            self.filter.settings_array,
            self.filter.state,
            self.filter.covariance,
            self.filter.rejects,
            self.filter.work,
            self._follow,
            self._gains,
            self._memory,
            walls,
            discs,
            self._ground.codes,
            self._ground.blocked,
            self._ground_array,
            self._bounds,
            TICK_S,
            max_ticks,
            stand_ticks,
            record,
            self._tally,
        )
        self._rest()
        tally = self._tally
        points = record[:kept].copy()
        points[:, 3] %= 2.0 * math.pi
        points[points[:, 3] >= 2.0 * math.pi, 3] = 0.0
        ticks, driven = tally[kernels.TALLY_TICKS], tally[kernels.TALLY_DRIVEN]
        end = _ENDS[int(tally[kernels.TALLY_END])]
        return Motion(
            end=End.CUT if end is End.TIME and limit_s is not None else end,
            hit=int(tally[kernels.TALLY_HIT]),
            duration_s=float(ticks) * TICK_S,
            length_m=float(tally[kernels.TALLY_LENGTH]),
            points=points,
            cross_track_rms_m=math.sqrt(tally[kernels.TALLY_CROSS_SQUARES] / driven) if driven else 0.0,
            localization_rms_m=math.sqrt(tally[kernels.TALLY_ERROR_SQUARES] / ticks) if ticks else 0.0,
            refused=int(tally[kernels.TALLY_REFUSED]),
        )


def _lengthened(motion: Motion, rest_s: float) -> Motion:
    last = motion.points[-1:].copy()
    last[0, 0] += rest_s
    return replace(motion, duration_s=motion.duration_s + rest_s, points=np.concatenate((motion.points, last)))
