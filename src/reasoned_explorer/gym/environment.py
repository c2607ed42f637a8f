"""Outdoor object navigation with the face of a Gymnasium environment."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.evaluation.mission import Mission, judge_of
from reasoned_explorer.evaluation.mission_settings import MissionSettings, errors_of
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.gym.episode import SteeredEpisode, Views
from reasoned_explorer.gym.place import GOAL_CHARACTERS, GOAL_LENGTH, Place
from reasoned_explorer.model import Fault, Gathering, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import World

Observation = dict[str, Any]

#: What a step is worth: "time" is minus the share of T_max that it took, and 1 for a true declaration; "sparse" is
#: that 1 alone.
REWARDS = ("time", "sparse")
#: The third number of an action from which on it declares the goal found.
DECLARES_FROM = 0.5
#: No place lies further from a world's origin than this, metres.
_FARTHEST_M, _HIGHEST_M = 1e6, 1e4


class OutdoorEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """Find a thing outdoors: look, go to a waypoint, look again, and say when you are there.

    **Observation**, a dictionary:

    - ``images``: (N, side, side, 3) uint8, sRGB: the views of one look from left to right, spread over ``sweep_rad``
      about where the vehicle faces.
    - ``depth_m``: (N, side, side) float32: distance along each camera's axis, at most ``depth_range_m``, which is also
      what the sky has.
    - ``pose``: (5,) float32: x (east), y (north), height of the camera, metres, sine and cosine of the compass heading
      (clockwise from north): where the vehicle's filter believes to be, in the world's own frame.
    - ``goal``: the sentence. (Through the shared memory of an ``AsyncVectorEnv`` Gymnasium 1.4 hands out no texts:
      there, set ``shared_memory=False``.)
    - ``time_left_s``: (1,) float32.

    **Action**, three numbers in [-1, 1] (`action_of` makes one of metres and radians): how far to go, from 0 at -1 to
    ``step_max_m`` at 1; in which bearing, from -π (left) to π (right) of where the vehicle faces; and, from 0.5 on, the
    declaration that the goal is found where the vehicle is now, which ends the episode; the vehicle then does not move.
    Numbers out of range are clipped.

    **Reward.** ``"time"``: minus the share of T_max that went by since the last step, and 1 for a declaration that the
    judge agrees with: what a successful episode returns is its CASR. ``"sparse"``: only that 1.

    **End.** Terminated by a declaration, true or false; truncated when T_max or the steps are over.

    **Info**, of which an agent under test must read nothing, since it tells the truth: ``success``, ``spl``,
    ``soft_spl`` and ``casr`` (of the whole mission, 0 while it goes on), ``computing_s`` (CT), ``travelling_s`` (TT)
    and ``time_limit_s``, ``path_length_m``, ``reference_length_m`` (the shortest compliant way from the start),
    ``distance_to_goal_m`` (straight, to the nearest thing that satisfies), ``collisions`` so far, ``leg`` and
    ``leg_detail`` (how the last leg ended), ``steps``; and of a reset also ``goal``, ``world``, ``seed`` and ``start``.

    An episode depends on the arguments, the seed and the actions alone: it is the same, byte for byte, in every
    process. With ``reset(seed=n)`` it starts where a mission with the seed n does.

    Args:
        world: A world by name or file (`world.opening`), a world, or an atlas of one.
        goal: The sentence.
        start: Where every episode begins: a pose, or x, y (metres) and heading (radians); None draws one by the seed.
        vehicle: A registered vehicle profile.
        views: N, headings per look, 1 to 24.
        sweep_rad: What they span, radians, in [0, 2π].
        step_max_m: The longest step, metres, in [0.5, 200].
        t_max_s: Mission time after which an episode is truncated, seconds.
        max_steps: Likewise, steps.
        success_radius_m: R of the judge, metres, in [1, 50].
        decision_s: What each action is charged as computing time, seconds, 0 to 3,600.
        image_px: Side of a view, pixels, in [16, 4096].
        depth_range_m: Of `depth_m`, metres, in [0.1, 10,000].
        conditions: ``clear``, ``overcast``, ``dusk``, ``fog`` or ``rain``.
        reward: One of `REWARDS`.
        render_mode: ``"rgb_array"``, the views side by side, or None.

    Raises:
        InputError: If any of them cannot be used; all faults at once.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 2}  # noqa: RUF012 - Gymnasium's own form

    def __init__(
        self,
        world: str | World | Atlas = "park:7",
        goal: str = "Find me a bench",
        *,
        start: Pose | Sequence[float] | None = None,
        vehicle: str = "drone",
        views: int = 3,
        sweep_rad: float = math.radians(120.0),
        step_max_m: float = 20.0,
        t_max_s: float = 1800.0,
        max_steps: int = 500,
        success_radius_m: float = 15.0,
        decision_s: float = 0.0,
        image_px: int = 224,
        depth_range_m: float = 200.0,
        conditions: str = "clear",
        reward: str = "time",
        render_mode: str | None = None,
    ) -> None:
        found = Gathering()
        explorer = found.take(
            lambda: ExplorerSettings(
                views=views,
                sweep_rad=sweep_rad,
                step_min_m=0.5,
                step_max_m=step_max_m,
                t_max_s=t_max_s,
                max_steps=max_steps,
            ),
            ExplorerSettings(),
        )
        settings = MissionSettings(
            vehicle=vehicle,
            explorer=explorer,
            success_radius_m=success_radius_m,
            picture_px=image_px,
            conditions=conditions,
            # It asks for no planner, mind or captioner; a mission is set up with it, and never run.
            agent="guide",
        )
        found.add(*errors_of(settings))
        if faults := _faults(decision_s, depth_range_m, reward, render_mode):
            found.add(SettingsError("environment", faults))
        self._place = Place(world, goal, start)
        self._place.check(found)
        found.finish("environment")

        self._settings = settings
        self._step_max_m, self._decision_s = float(step_max_m), float(decision_s)
        self._depth_range_m, self._reward = float(depth_range_m), reward
        self._judges: dict[tuple[Atlas, str], Judge] = {}
        self._episode: SteeredEpisode | None = None
        self._views: Views | None = None
        self._rewarded_s = 0.0
        self.render_mode = render_mode
        self.action_space = spaces.Box(-1.0, 1.0, (3,), np.float32)
        self.observation_space = _observation_space(views, image_px, self._depth_range_m, float(t_max_s))

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Of the start and of everything that is drawn; None draws one from the last seed's generator.
            options: For this episode: ``goal``, ``world`` and ``start``, as the environment's own.

        Raises:
            InputError: If an option cannot be used; all faults at once.
            StartError: If no episode can begin, or none at this start.
        """
        super().reset(seed=seed)
        place = self._place.with_options(options)
        drawn = int(self.np_random.integers(1 << 62)) if seed is None else int(seed)
        mission = self._mission(place, drawn)
        self._episode = SteeredEpisode(mission, decision_s=self._decision_s)
        self._rewarded_s = 0.0
        observation = self._look(self._episode)
        start = mission.start
        about = {
            "goal": mission.goal.text,
            "world": mission.atlas.world.name,
            "seed": drawn,
            "start": (start.x_m, start.y_m, start.z_m, start.heading_rad),
        }
        return observation, {**self._info(self._episode, leg="", leg_detail=""), **about}

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Go somewhere and look, or declare; see the class.

        Raises:
            SettingsError: If the action is not three finite numbers.
            ResetNeeded: Before the first reset, and after an episode's end.
        """
        episode = self._running()
        distance_m, bearing_rad, declares = self._understood(action)
        outcome, detail = "", ""
        if declares:
            episode.declare()
            observation = self._observation(episode)
        else:
            leg = episode.go(distance_m, bearing_rad)
            outcome, detail = leg.outcome.value, leg.detail
            observation = self._look(episode)
        info = self._info(episode, leg=outcome, leg_detail=detail)
        gained = float(info["success"])
        if self._reward == "time":
            now_s = episode.clock.now_s()
            gained -= (now_s - self._rewarded_s) / self._settings.explorer.t_max_s
            self._rewarded_s = now_s
        truncated = episode.is_over and not episode.declared
        return observation, gained, episode.declared, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """Return the views of the last look side by side, shape (side, N * side, 3); None without a render mode.

        Raises:
            ResetNeeded: Before the first reset.
        """
        if self.render_mode is None:
            return None
        if self._views is None:
            raise ResetNeeded("there is nothing to render: call reset first")
        return np.concatenate(list(self._views.images), axis=1)

    def close(self) -> None:
        """Let go of the episode."""
        self._episode = self._views = None

    def action_of(self, distance_m: float, bearing_rad: float, *, declare: bool = False) -> NDArray[np.float32]:
        """Return the action that goes so far in a bearing (positive to the right), or declares."""
        share = 2.0 * distance_m / self._step_max_m - 1.0
        return np.array([share, bearing_rad / math.pi, 1.0 if declare else -1.0], np.float32).clip(-1.0, 1.0)

    @property
    def remaining_m(self) -> float:
        """How far it still is to where a declaration succeeds, metres, by the shortest compliant way; may be infinite.

        For shaping rewards: an agent under test must not read it. The first call for a goal takes a moment.

        Raises:
            ResetNeeded: Where no episode is running.
        """
        return self._running().remaining_m

    def _running(self) -> SteeredEpisode:
        if self._episode is None or self._episode.is_over:
            raise ResetNeeded("no episode is running: call reset first")
        return self._episode

    def _mission(self, place: Place, seed: int) -> Mission:
        atlas = place.atlas()
        key = atlas, place.goal
        settings = self._settings
        if key not in self._judges:
            self._judges.clear()  # one at a time: a judge is large
            self._judges[key] = judge_of(place.goal, atlas, settings.vehicle, settings.success_radius_m)
        chosen = replace(settings, seed=seed)
        return Mission(place.goal, atlas, chosen, start=place.start_pose, judge=self._judges[key])

    def _look(self, episode: SteeredEpisode) -> Observation:
        self._views = episode.look()
        return self._observation(episode)

    def _observation(self, episode: SteeredEpisode) -> Observation:
        if self._views is None:
            raise AssertionError  # every episode begins with a look
        pose, t_max_s = episode.vehicle.pose, self._settings.explorer.t_max_s
        heading = math.sin(pose.heading_rad), math.cos(pose.heading_rad)
        return {
            "images": self._views.images.copy(),
            "depth_m": np.minimum(self._views.depth_m, np.float32(self._depth_range_m)),
            "pose": np.array([pose.x_m, pose.y_m, pose.z_m, *heading], np.float32),
            "goal": episode.mission.goal.text,
            "time_left_s": np.array([max(0.0, t_max_s - episode.clock.now_s())], np.float32),
        }

    def _info(self, episode: SteeredEpisode, *, leg: str, leg_detail: str) -> dict[str, Any]:
        scored = episode.score() if episode.is_over else None
        return {
            "success": scored is not None and scored.success,
            "spl": 0.0 if scored is None else scored.spl,
            "soft_spl": 0.0 if scored is None else scored.soft_spl,
            "casr": 0.0 if scored is None else scored.casr,
            "computing_s": episode.ct_s,
            "travelling_s": episode.tt_s,
            "time_limit_s": self._settings.explorer.t_max_s,
            "path_length_m": episode.path_length_m,
            "reference_length_m": episode.mission.judge.reference_length_m(episode.mission.start),
            "distance_to_goal_m": episode.distance_to_goal_m,
            "collisions": episode.collisions,
            "leg": leg,
            "leg_detail": leg_detail,
            "steps": episode.decisions,
        }

    def _understood(self, action: ArrayLike) -> tuple[float, float, bool]:
        """Return metres, radians, and whether the goal is declared found."""
        try:
            numbers = np.asarray(action, np.float64)
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (3,) or not np.isfinite(numbers).all():
            raise SettingsError("action", [Fault(f"{action!r:.80}", "three finite numbers in [-1, 1]")])
        share, turn, declares = np.clip(numbers, -1.0, 1.0).tolist()
        return 0.5 * (share + 1.0) * self._step_max_m, turn * math.pi, declares >= DECLARES_FROM


def _observation_space(views: int, side_px: int, depth_range_m: float, t_max_s: float) -> spaces.Dict:
    farthest = np.array([_FARTHEST_M, _FARTHEST_M, _HIGHEST_M, 1.0, 1.0], np.float32)
    lowest = -farthest
    lowest[2] = 0.0
    return spaces.Dict(
        {
            "images": spaces.Box(0, 255, (views, side_px, side_px, 3), np.uint8),
            "depth_m": spaces.Box(0.0, depth_range_m, (views, side_px, side_px), np.float32),
            "pose": spaces.Box(lowest, farthest, dtype=np.float32),
            "goal": spaces.Text(GOAL_LENGTH, charset=GOAL_CHARACTERS),
            "time_left_s": spaces.Box(0.0, t_max_s, (1,), np.float32),
        }
    )


def _faults(decision_s: object, depth_range_m: object, reward: object, render_mode: object) -> list[Fault]:
    faults = []
    if not is_within(decision_s, 0.0, 3600.0):
        faults.append(Fault(f"decision_s is {decision_s!r:.60}", "0 to 3,600 seconds"))
    if not is_within(depth_range_m, 0.1, 10_000.0):
        faults.append(Fault(f"depth_range_m is {depth_range_m!r:.60}", "0.1 to 10,000 metres"))
    if reward not in REWARDS:
        faults.append(Fault(f"reward is {reward!r:.60}", f"one of {', '.join(REWARDS)}"))
    if render_mode not in {None, *OutdoorEnv.metadata["render_modes"]}:
        faults.append(Fault(f"render_mode is {render_mode!r:.60}", "rgb_array, or None"))
    return faults
