"""Holding and stepping the served autopilot's time, for programs whose clocks jump (`vehicles.mavlink.lockstep`)."""

import asyncio
from collections.abc import Callable
from typing import Any

from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.airsim.flight import State
from reasoned_explorer.serving.mavlink.pilot import Pilot
from reasoned_explorer.vehicles.mavlink.lockstep import ANSWER_TYPE, REQUEST_TYPE, Ask, Report, Request


class Steps:
    """Answers requests.

    Args:
        pilot: Whose time it is.
        dialect: The module of messages.
        tell: Tells all that whoever asks is to know beside the report, which comes last.
        on_hold: Called when time is held.
    """

    def __init__(
        self,
        pilot: Pilot,
        dialect: Any,
        *,
        tell: Callable[[Callable[[Any], None]], None],
        on_hold: Callable[[], None],
    ) -> None:
        self._pilot, self._dialect, self._tell, self._on_hold = pilot, dialect, tell, on_hold
        #: The last request, and its answer when it is there: a request that comes again is not obeyed again.
        self._last: tuple[object, int] | None = None
        self._answer: Any = None

    def take(self, message: Any, sender: object, reply: Callable[[Any], None]) -> None:
        """Take an envelope in; one that holds no request is thrown away."""
        request = Request.read(message.payload) if message.payload_type == REQUEST_TYPE else None
        if request is None:
            return
        key = sender, request.number
        if key == self._last:
            if self._answer is not None:
                reply(self._answer)
            return
        self._last, self._answer = key, None

        def answer(_: object = None) -> None:
            packed = self._report(request).pack()
            made = self._dialect.MAVLink_tunnel_message(0, 0, ANSWER_TYPE, len(packed), packed)
            if self._last == key:
                self._answer = made
            self._tell(reply)
            reply(made)

        passing = self._obey(request)
        if passing is None:
            answer()
        else:
            passing.add_done_callback(answer)

    def _obey(self, request: Request) -> "asyncio.Future[None] | None":
        pilot, timeline = self._pilot, self._pilot.timeline
        if request.ask is Ask.HOLD:
            timeline.hold()
            self._on_hold()
        elif request.ask is Ask.RELEASE:
            timeline.let_go()
        elif request.ask is Ask.LOOK:
            pilot.drone.look(pilot.now_s)
        elif request.ask is Ask.STEP:
            seconds, ends_s = request.seconds, pilot.motion_ends_s
            if request.until_idle and ends_s is not None:
                seconds = min(seconds, max(0.0, ends_s - pilot.now_s))
            return timeline.go_on_for(seconds)
        return None

    def _report(self, request: Request) -> Report:
        pilot = self._pilot
        true, believed = pilot.drone.state(pilot.now_s), pilot.belief()
        speed = (true.vx_mps**2 + true.vy_mps**2 + true.vz_mps**2) ** 0.5
        return Report(
            number=request.number,
            t_s=pilot.now_s,
            true=_pose(true),
            believed=_pose(believed),
            speed_mps=speed,
            yaw_rate_radps=true.yaw_rate_radps,
            is_busy=pilot.is_busy,
            is_landed=pilot.is_landed,
            hits=pilot.hits,
            hit=pilot.hit,
        )


def _pose(state: State) -> Pose:
    return Pose(state.x_m, state.y_m, state.z_m, state.heading_rad)
