"""One mission that somebody outside steers: look, go to a waypoint, declare."""

import math
from collections.abc import Coroutine
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.clock import SteppedClock
from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.scoring import Look, MissionScore, outcome_of, score
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Leg, LegOutcome, TrackPoint
from reasoned_explorer.rendering.renderer import Picture
from reasoned_explorer.simulation.painter import Painter
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.vehicle import SimulatedVehicle

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """What a look shows, from left to right.

    Attributes:
        images: sRGB, shape (N, height, width, 3), uint8.
        depth_m: Along each camera's axis, shape (N, height, width), float32; infinite in the sky.
    """

    images: NDArray[np.uint8]
    depth_m: NDArray[np.float32]


@dataclass(slots=True)
class _DepthKeeper:
    """The vehicle's painter; it keeps the depth of each picture that it takes, which views do not carry."""

    painter: Painter
    taken: list[Picture] = field(default_factory=list)

    def paint(self, pose: Pose, camera: Camera) -> NDArray[np.uint8]:
        self.taken.append(self.painter.picture(pose, camera))
        return self.taken[-1].colour

    def depth_of(self, image: NDArray[np.uint8]) -> NDArray[np.float32]:
        return next(picture.depth_m for picture in self.taken if picture.colour is image)


class _Blind:
    """Eyes for a vehicle whose pictures alone are looked at."""

    def look(self, pose: Pose, camera: Camera) -> ViewContent:  # noqa: ARG002 - the protocol's
        return ViewContent((), (), 0.0, math.inf)


class SteeredEpisode:
    """A mission whose start, judge and settings are a `Mission`'s and whose decisions come from outside.

    Args:
        mission: Set up and never run.
        decision_s: What each decision is charged, seconds; it counts as CT.
    """

    def __init__(self, mission: Mission, *, decision_s: float = 0.0) -> None:
        settings = mission.settings
        self.mission = mission
        self.clock = SteppedClock()
        self._decision_s = decision_s
        self._painter = _DepthKeeper(
            Painter(mission.atlas, side_px=settings.picture_px, conditions=settings.conditions)
        )
        self.vehicle = SimulatedVehicle(
            mission.atlas,
            mission.profile,
            mission.start,
            clock=self.clock,
            eyes=_Blind(),
            painter=self._painter,
            seed=settings.seed,
        )
        start = mission.start
        self._track = [TrackPoint(0.0, start.x_m, start.y_m, start.z_m, start.heading_rad)]
        self._looks: list[Look] = []
        self.declared = False
        self.decisions = 0
        self.collisions = 0
        self.ct_s = 0.0
        self.tt_s = 0.0

    @property
    def path_length_m(self) -> float:
        """Metres travelled."""
        points = np.array([(point.x_m, point.y_m) for point in self._track])
        return float(np.hypot(*np.diff(points, axis=0).T).sum())

    @property
    def distance_to_goal_m(self) -> float:
        """From where the vehicle truly is, straight, to the nearest thing that satisfies the goal."""
        here = self.vehicle.true_pose
        return self.mission.judge.success(here.x_m, here.y_m).nearest_m

    @property
    def remaining_m(self) -> float:
        """How far it truly still is to where a declaration succeeds, by the shortest compliant way; may be infinite."""
        here = self.vehicle.true_pose
        return float(self.mission.judge.remaining.at(here.x_m, here.y_m))

    @property
    def is_over_time(self) -> bool:
        """Whether T_max is over."""
        return self.clock.now_s() >= self.mission.settings.explorer.t_max_s

    @property
    def is_over(self) -> bool:
        """Whether nothing more can be done: declared, out of time, or out of steps."""
        return self.declared or self.is_over_time or self.decisions >= self.mission.settings.explorer.max_steps

    def look(self) -> Views:
        """Look in the mission's headings about where the vehicle faces."""
        ahead_rad = self.vehicle.pose.heading_rad
        headings = [ahead_rad + bearing for bearing in self.mission.settings.explorer.bearings_rad()]
        self._painter.taken.clear()
        views = self._timed(self.vehicle.look(headings))
        self._looks.append(Look(len(self._track) - 1, tuple(view.pose.heading_rad for view in views)))
        depths = [self._painter.depth_of(view.image) for view in views]
        return Views(np.stack([view.image for view in views]), np.stack(depths))

    def go(self, distance_m: float, bearing_rad: float) -> Leg:
        """Decide to go straight to a point some way off, and go there, facing on; what comes in between is reported.

        Args:
            distance_m: From where the vehicle believes to be.
            bearing_rad: From where it faces, positive to the right.
        """
        self._decide()
        leg = self._timed(self.vehicle.go_to(self.vehicle.pose.ahead(distance_m, bearing_rad=bearing_rad)))
        self._track += leg.track
        self.collisions += leg.outcome is LegOutcome.COLLISION
        return leg

    def declare(self) -> None:
        """Decide to say "Found Goal"."""
        self._decide()
        self.declared = True

    def score(self) -> MissionScore:
        """Return what the mission scores if it ends here."""
        mission, start = self.mission, self.mission.start
        way = mission.judge.reference_path(start)
        return score(
            outcome_of(
                self._track,
                mission.judge,
                mission_id=f"{mission.atlas.world.name}|{mission.goal.text}|{mission.settings.seed}",
                vehicle=mission.profile.name,
                declared=self.declared,
                computing_s=self.ct_s,
                planner_computing_s=self.ct_s,
                travelling_s=self.tt_s,
                time_limit_s=mission.settings.explorer.t_max_s,
                looks=self._looks,
                fov_rad=mission.profile.camera.horizontal_fov_rad,
                reference_length_m=mission.judge.reference_length_m(start),
                reference_way=() if way is None else way,
            )
        )

    def _decide(self) -> None:
        self.decisions += 1
        self.clock.run(self.clock.think(self._decision_s))
        self.ct_s += self._decision_s

    def _timed(self, doing: Coroutine[Any, Any, T]) -> T:
        """Return what comes of looking or travelling; its seconds are TT."""
        started_s = self.clock.now_s()
        done = self.clock.run(doing)
        self.tt_s += self.clock.now_s() - started_s
        return done
