"""What only privileged minds and agents may read: the world's truth of one mission.

`OracleTruth` says what the judge would say and how far success is; `FrontierSight` says where the frontier ahead of a
view would be, how far it is from there, and whether the way to it is open. Whoever reads them is a bound, not a method.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.context import MindContext
from reasoned_explorer.model import Fault, SettingsError, Verdict
from reasoned_explorer.simulation.vehicle import obstacles_on_leg
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.geodesic import DistanceField, Traveller
from reasoned_explorer.world.sight import Obstacles
from reasoned_explorer.world.taxonomy import IMPASSABLE_ON_FOOT, Ground

#: Declared only this far inside the success radius, metres.
INSIDE_M = 0.3
#: Legs are looked at in steps of this length, metres.
_SAMPLE_M = 0.25
#: The body keeps this far off what it could touch, metres.
_MARGIN_M = 0.15
#: As much forbidden ground in one leg: the next leg may begin where this one ends, and the judge allows 5 m.
_STRETCH_M = 2.0
_STRAY_M = 0.3
#: Whom only the goal's grounds stop.
_GHOST = Traveller(flies=True, radius_m=0.0, collides=False)
_IMPASSABLE = [int(ground) for ground in IMPASSABLE_ON_FOOT - {Ground.BUILDING}]
#: A leg that ends before this has no way ahead, metres.
_BLOCKED_M = 2.0


@dataclass(frozen=True)
class OracleTruth:
    """What privileged minds and agents read.

    Attributes:
        atlas: The world.
        judge: Of the mission.
        profile: Of the vehicle.
        explorer: How the agent explores: where a frontier stands depends on its score.
    """

    atlas: Atlas
    judge: Judge
    profile: VehicleProfile
    explorer: ExplorerSettings

    @property
    def remaining(self) -> DistanceField:
        """How far it is from everywhere to success, on compliant ground."""
        return self.judge.remaining

    def verdict(self, pose: Pose) -> Verdict:
        """Say "found" where the judge would agree."""
        report = self.judge.success(pose.x_m, pose.y_m, pose.z_m)
        # The vehicle knows where it is only to centimetres, so it stops a little inside the radius.
        found = report.success and report.distance_m <= self.judge.success_radius_m - INSIDE_M
        return Verdict(found, 1.0 if found else 0.0, "the judge agrees" if found else "")


class FrontierSight:
    """Sees the frontiers ahead of views as they truly are. One for each mission: it knows whether a start was left.

    Args:
        truth: Of the mission.
    """

    def __init__(self, truth: OracleTruth) -> None:
        self._truth = truth
        self._has_left = False

    def ahead(self, here: Pose, score_of: Callable[[float], float]) -> tuple[Pose, float]:
        """Return where a leg to the frontier ahead would end, and how far it is from there to success.

        The step to a frontier depends on its score, and its score on where the leg ends: a few rounds settle it.

        Args:
            here: Of the view.
            score_of: The score, 1 to 5, of a frontier from which that many metres remain; infinity where no way does.
        """
        self._has_left |= not self._shuns(here)
        level, free_m = self._truth.judge.spec.level, self._free_m(here)
        there, remaining_m = here, math.inf
        gone_m = -1.0
        for _ in range(4):
            leg_m = min(self._truth.explorer.step_m(score_of(remaining_m), level), free_m)
            if leg_m == gone_m:  # settled
                break
            gone_m, there = leg_m, here.ahead(leg_m)
            remaining_m = self._truth.remaining.at(there.x_m, there.y_m)
        return there, remaining_m

    def _free_m(self, here: Pose) -> float:
        """Return how far a straight leg goes before the body touches what it collides with, metres."""
        profile, longest_m = self._truth.profile, self._truth.explorer.step_range_m(self._truth.judge.spec.level)[1]
        there = here.ahead(longest_m)
        lengths = np.arange(0.0, longest_m + _SAMPLE_M, _SAMPLE_M)
        places = np.stack(
            (here.x_m + lengths * math.sin(here.heading_rad), here.y_m + lengths * math.cos(here.heading_rad)), axis=1
        )
        clear = clearance_m(places, obstacles_on_leg(self._truth.atlas, profile, here, there))
        # What the body touches already does not stop it on its way out.
        touches = (clear < profile.radius_m + _MARGIN_M) & (clear < clear[0] - 0.01)
        if not profile.flies:
            touches |= np.isin(self._truth.atlas.ground.at_many(places[:, 0], places[:, 1]), _IMPASSABLE)
        bounds = self._truth.atlas.world.bounds
        touches |= (places < (bounds.min_x_m, bounds.min_y_m)).any(axis=1)
        touches |= (places > (bounds.max_x_m, bounds.max_y_m)).any(axis=1)
        return longest_m if not touches.any() else max(0.0, float(lengths[int(np.argmax(touches))]) - _SAMPLE_M)

    def is_open(self, here: Pose, there: Pose, remaining_m: float) -> bool:
        """Return whether a leg leads somewhere: some way ahead, on ground that the goal allows, towards success."""
        gone_m = here.distance_to_m(there.x_m, there.y_m)
        return math.isfinite(remaining_m) and gone_m >= _BLOCKED_M and self._is_compliant(here, there)

    def _is_compliant(self, here: Pose, there: Pose) -> bool:
        if not self._truth.judge.spec.forbidden:
            return True
        judge = self._truth.judge
        # On its way off forbidden ground that it was put down on, it may take what the judge excuses.
        if not self._has_left and judge.compliance(_beside(here, there, 0.0)).compliant:
            return True
        # The vehicle strays from its line by centimetres, and the judge's tolerance ends at the edge of a cell.
        return not self._shuns(there) and all(
            judge.compliance(_beside(here, there, aside_m), excuse_start=False).longest_stretch_m <= _STRETCH_M
            for aside_m in (0.0, -_STRAY_M, _STRAY_M)
        )

    def _shuns(self, pose: Pose) -> bool:
        """Return whether a place is deep in forbidden ground."""
        judge = self._truth.judge
        if not judge.spec.forbidden:
            return False
        space = self._truth.atlas.geodesics.space(_GHOST, shunned=judge.spec.forbidden)
        col, row = np.floor(space.grid.cells_of(np.array([[pose.x_m, pose.y_m]]))[0]).astype(int)
        inside = 0 <= col < space.grid.cols and 0 <= row < space.grid.rows
        return inside and not space.free[row, col]


def clearance_m(places: NDArray[np.float64], obstacles: Obstacles | None) -> NDArray[np.float64]:
    """Return the distance from each place, shape (n, 2), to the nearest wall or disc, shape (n,)."""
    clear = np.full(len(places), np.inf)
    if obstacles is None:
        return clear
    if len(obstacles.walls):
        starts, ends = obstacles.walls[:, :2], obstacles.walls[:, 2:]
        along = ends - starts
        squared = np.maximum((along**2).sum(axis=1), 1e-12)
        shares = ((places[:, None] - starts) * along).sum(axis=2) / squared
        nearest = starts + np.clip(shares, 0.0, 1.0)[..., None] * along
        clear = np.hypot(*np.moveaxis(places[:, None] - nearest, 2, 0)).min(axis=1)
    if len(obstacles.discs):
        apart = np.hypot(*np.moveaxis(places[:, None] - obstacles.discs[:, :2], 2, 0)) - obstacles.discs[:, 2]
        clear = np.minimum(clear, apart.min(axis=1))
    return clear


def _beside(here: Pose, there: Pose, aside_m: float) -> list[tuple[float, float]]:
    """Return the leg between two poses, moved to its right."""
    x_m, y_m = aside_m * math.cos(here.heading_rad), -aside_m * math.sin(here.heading_rad)
    return [(here.x_m + x_m, here.y_m + y_m), (there.x_m + x_m, there.y_m + y_m)]


def truth_of(context: MindContext, who: str) -> OracleTruth:
    """Return the truth that a mind's factory was handed.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    if not isinstance(context.truth, OracleTruth):
        fault = Fault(f"{who} was asked for where no truth is known", "a simulated world and a goal it can judge")
        raise SettingsError("minds", [fault])
    return context.truth
