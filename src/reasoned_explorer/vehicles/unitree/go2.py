"""A Go2 by its vendor's own SDK, `unitree_sdk2py`, where the user has that installed."""

import asyncio
import math
import threading
from collections.abc import Callable
from contextlib import suppress
from importlib import metadata
from importlib.util import find_spec
from typing import Any

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.model import Fault, MissingDependencyError, PartError, SettingsError
from reasoned_explorer.vehicles.looking import Content
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.unitree.go1_robot import velocity_within
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.robot import BodyReading, Robot, Velocity
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.vehicle import Photographer, UnitreeVehicle
from reasoned_explorer.vehicles.unitree.whereabouts import PositionSource

#: The middleware that the robot itself runs; another version beside it has been seen to crash its programs.
CYCLONEDDS = "0.10.2"
_INSTALL = "pip install cyclonedds==0.10.2 && pip install git+https://github.com/unitreerobotics/unitree_sdk2_python"
_SPORT_STATE, _LOW_STATE = "rt/sportmodestate", "rt/lowstate"
#: Of SportModeState_'s ``mode``: lying down, and motors soft.
_LYING_MODES = frozenset({5, 7})
_FIRST_STATE_S, _LOST_S, _POSTURE_S = 5.0, 0.5, 3.0
_CALL_S = 3.0
_LIFETIME_S = 0.3
#: States nearer to each other in time tell no speed.
_LEAST_S = 0.005
_LEG_MOTORS = 12


class Go2Robot(Robot):
    """A Go2 in its sport mode. The SDK's threads bring states; its calls are made in a thread, they wait for answers.

    A `Move` that is not said anew for a third of a second is ended by `StopMove`, whatever the robot itself would do.

    Args:
        now_s: The time, seconds; `Clock.now_s` of a real clock.
        interface: The network interface towards the robot, such as ``eth0``; empty for the SDK's choice.
        limits: What commands are cut down to.
        period_s: How often the tracker steers, seconds.
        first_state_s: How long to wait for the first state.
        posture_s: How long getting up or lying down takes.

    Raises:
        MissingDependencyError: If the SDK is not installed.
        SettingsError: If the version of its middleware is not the robot's.
    """

    name = "Go2"

    def __init__(
        self,
        *,
        now_s: Callable[[], float],
        interface: str = "",
        limits: CommandLimits | None = None,
        period_s: float = 0.05,
        first_state_s: float = _FIRST_STATE_S,
        posture_s: float = _POSTURE_S,
    ) -> None:
        check_sdk()
        self.period_s, self.limits = period_s, limits or CommandLimits()
        self._now_s, self._interface = now_s, interface
        self._first_state_s, self._posture_s = first_state_s, posture_s
        self._lock = threading.Lock()
        self._state: Any = None
        self._heard_s = -math.inf
        self._battery: float | None = None
        self._hottest: float | None = None
        self._last: BodyReading | None = None
        self._last_s = -math.inf
        self._due_s = 0.0
        self._moves, self._given_s = False, -math.inf
        self._watching: asyncio.Task[None] | None = None
        self._sport: Any = None
        self._subscribers: list[Any] = []

    def now_s(self) -> float:
        """Return the clock's time."""
        return self._now_s()

    @property
    def silent_s(self) -> float:
        """For how long no state has come in."""
        return self._now_s() - self._heard_s

    async def start(self) -> None:
        """Join the robot's network and have it stand in balance."""
        try:
            await asyncio.to_thread(self._open)
        except Exception as error:  # the SDK raises bare exceptions
            raise PartError(self.name, f"its SDK does not start: {error}") from error
        until_s = self._now_s() + self._first_state_s
        while self._heard_s == -math.inf:
            if self._now_s() > until_s:
                await self.close(lies=False)
                raise PartError(self.name, f"nothing was heard on {_SPORT_STATE} in {self._first_state_s:g} s")
            await self._pass(0.02)
        await self._call("StopMove")
        self._due_s = self._now_s()
        self._watching = asyncio.create_task(self._watch())

    async def close(self, *, lies: bool) -> None:
        """Leave it standing, or have it lie down, and leave its network."""
        sport, self._sport = self._sport, None
        if sport is None:
            return
        watching, self._watching = self._watching, None
        if watching is not None:
            watching.cancel()
            await asyncio.gather(watching, return_exceptions=True)
        try:
            await self._call("StopMove", sport=sport)
            if lies:
                await self._pass(1.0)
                await self._call("StandDown", sport=sport)
        finally:
            subscribers, self._subscribers = self._subscribers, []
            for subscriber in subscribers:
                await asyncio.to_thread(subscriber.Close)

    async def moment(self, velocity: Velocity | None) -> BodyReading:
        """Command it, wait for the next moment, and return its last state, which must be a fresh one."""
        if velocity is not None:
            sent = self.cut(velocity)
            # Its y and its turns are to the left.
            await self._call("Move", sent.forward_mps, 0.0 - sent.right_mps, 0.0 - sent.turn_radps)
            self._moves, self._given_s = True, self._now_s()
        elif self._moves:
            self._moves = False
            await self._call("StopMove")
        self._due_s = max(self._due_s + self.period_s, self._now_s())
        await self._pass(self._due_s - self._now_s())
        age_s = self._now_s() - self._heard_s
        if age_s > _LOST_S:
            self._moves = False
            await self._call("StopMove")
            raise PartError(self.name, f"nothing was heard of the robot for {age_s:.1f} s")
        return self._reading()

    async def get_up(self) -> None:
        """Have it rise, and stand in balance."""
        await self._call("StandUp")
        await self._pass(self._posture_s)
        await self._call("BalanceStand")
        if (await self.moment(None)).lies:
            raise PartError(self.name, "it does not get up")

    def cut(self, velocity: Velocity) -> Velocity:
        """Return what the limits leave of a velocity."""
        return velocity_within(self.limits, velocity)

    async def _pass(self, seconds: float) -> None:
        """Let time pass."""
        await asyncio.sleep(seconds)

    def _open(self) -> None:
        from unitree_sdk2py.core.channel import ChannelFactoryInitialize, ChannelSubscriber
        from unitree_sdk2py.go2.sport.sport_client import SportClient
        from unitree_sdk2py.idl.unitree_go.msg.dds_ import LowState_, SportModeState_

        ChannelFactoryInitialize(0, *([self._interface] if self._interface else []))
        for topic, kind, take in (
            (_SPORT_STATE, SportModeState_, self._take_state),
            (_LOW_STATE, LowState_, self._take_low_state),
        ):
            subscriber = ChannelSubscriber(topic, kind)
            subscriber.Init(take, 10)
            self._subscribers.append(subscriber)
        sport = SportClient()
        sport.SetTimeout(_CALL_S)
        sport.Init()
        self._sport = sport

    async def _call(self, method: str, *values: float, sport: Any = None) -> None:
        """Call the SDK.

        Raises:
            PartError: If the robot does not take it.
        """
        sport = sport or self._sport
        if sport is None:
            raise PartError(self.name, "the link is not open")
        try:
            code = await asyncio.to_thread(getattr(sport, method), *values)
        except Exception as error:  # the SDK raises bare exceptions
            raise PartError(self.name, f"{method}: {error}") from error
        if isinstance(code, int) and code != 0:
            raise PartError(self.name, f"{method} is answered with code {code}")

    async def _watch(self) -> None:
        """Have it stand where nobody says any more that it is to walk."""
        while True:
            await asyncio.sleep(0.1)
            if self._moves and self._now_s() - self._given_s > _LIFETIME_S:
                self._moves = False
                with suppress(PartError):
                    await self._call("StopMove")

    # What the SDK's threads bring.

    def _take_state(self, state: Any) -> None:
        with self._lock:
            self._state, self._heard_s = state, self._now_s()

    def _take_low_state(self, state: Any) -> None:
        try:
            battery = float(state.bms_state.soc)
            hottest = float(max(motor.temperature for motor in state.motor_state[:_LEG_MOTORS]))
        except (AttributeError, TypeError, ValueError):
            return
        with self._lock:
            self._battery, self._hottest = battery, hottest

    def _reading(self) -> BodyReading:
        with self._lock:
            state, heard_s, battery, hottest = self._state, self._heard_s, self._battery, self._hottest
        try:
            numbers = [
                float(value) for value in (*state.position[:2], state.imu_state.rpy[2], state.imu_state.gyroscope[2])
            ]
            mode = int(state.mode)
        except (AttributeError, TypeError, ValueError, IndexError) as error:
            raise PartError(self.name, f"a state that is none: {error}") from error
        if not all(map(math.isfinite, numbers)):
            raise PartError(self.name, "a state whose numbers are not finite")
        ahead_m, left_m, yaw_left, rate_left = numbers
        yaw_rad = normalise_heading_rad(0.0 - yaw_left)
        forward_mps, right_mps = self._speed(ahead_m, 0.0 - left_m, yaw_rad, heard_s)
        reading = BodyReading(
            self._now_s(),
            0.0 - rate_left,
            forward_mps,
            right_mps,
            yaw_rad,
            ahead_m,
            0.0 - left_m,
            lies=mode in _LYING_MODES,
            battery_percent=battery,
            hottest_motor_c=hottest,
        )
        self._last, self._last_s = reading, heard_s
        return reading

    def _speed(self, ahead_m: float, aside_m: float, yaw_rad: float, heard_s: float) -> tuple[float, float]:
        """Return the body's velocity by where its legs took it; in which frame ``velocity`` is, its docs leave open."""
        last, period_s = self._last, heard_s - self._last_s
        if last is None:
            return 0.0, 0.0
        if period_s < _LEAST_S:  # nothing new was heard: it has not stopped for that
            return last.forward_mps, last.right_mps
        along, across = (ahead_m - last.ahead_m) / period_s, (aside_m - last.aside_m) / period_s
        middle = last.yaw_rad + 0.5 * bearing_between_rad(last.yaw_rad, yaw_rad)
        sin_y, cos_y = math.sin(middle), math.cos(middle)
        return along * cos_y + across * sin_y, across * cos_y - along * sin_y


class Go2Vehicle(UnitreeVehicle):
    """A Go2, on a real clock only.

    Args:
        profile: See `UnitreeVehicle`, as all that is not told here.
        clock: The mission's, a real one.
        interface: The network interface towards the robot.
        limits: What commands are cut down to.
        home: Where it stands at the start.
        positions: Its receiver.
        camera: Takes its pictures.
        settings: How it walks and looks.
        content: For simulated captioners.

    Raises:
        MissingDependencyError: If the SDK is not installed.
        SettingsError: If the clock is not real, or the version of the SDK's middleware is not the robot's.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        *,
        clock: Clock,
        interface: str = "",
        limits: CommandLimits | None = None,
        home: Pose | None = None,
        positions: PositionSource | None = None,
        camera: Photographer | None = None,
        settings: WalkSettings | None = None,
        content: Content | None = None,
    ) -> None:
        if clock.name != "real":
            raise SettingsError("Go2", [Fault(f"a {clock.name} clock", "the real clock: it is a real robot")])
        robot = Go2Robot(now_s=clock.now_s, interface=interface, limits=limits)
        super().__init__(
            profile,
            robot,
            clock=clock,
            home=home,
            positions=positions,
            camera=camera,
            settings=settings,
            content=content,
        )


def check_sdk() -> None:
    """Check that the SDK is installed, with the middleware that the robot has.

    Raises:
        MissingDependencyError: If it is not.
        SettingsError: If the middleware is another.
    """
    if find_spec("unitree_sdk2py") is None:
        raise MissingDependencyError("driving a Go2", "unitree_sdk2py", _INSTALL)
    try:
        found = metadata.version("cyclonedds")
    except metadata.PackageNotFoundError:
        raise MissingDependencyError("driving a Go2", "cyclonedds", _INSTALL) from None
    if found != CYCLONEDDS:
        fault = Fault(
            f"cyclonedds {found}",
            f"{CYCLONEDDS}, which the robot runs",
            f"another version crashes the robot's own programs: pip install cyclonedds=={CYCLONEDDS}",
        )
        raise SettingsError("driving a Go2", [fault])
