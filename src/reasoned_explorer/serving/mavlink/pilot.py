"""The served autopilot's state: its mode, its motors, where it is told to go, and what it does when links are lost."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.serving.airsim.drone import CLIMB_MPS, Drone
from reasoned_explorer.serving.airsim.flight import Flight, State
from reasoned_explorer.serving.airsim.timeline import Alarm, Timeline
from reasoned_explorer.serving.mavlink.parameters import HOLD, HOME, LANDING, NOTHING, Parameters
from reasoned_explorer.simulation.mishaps import MishapKind, Mishaps
from reasoned_explorer.vehicles.control.follower import FollowerSettings
from reasoned_explorer.vehicles.mavlink.flavours import Flavour

#: Answers to commands, of the enumeration MAV_RESULT.
ACCEPTED, REJECTED_NOW, DENIED, UNSUPPORTED, FAILED = 0, 1, 2, 3, 4
#: Severities of texts.
CRITICAL, ERROR, INFO = 2, 3, 6
#: A target that is nearer is no place to go to, metres; a heading that is nearer is had, radians.
_THERE_M, _FACED_RAD = 0.05, 1e-3
#: Nothing farther from home is gone to, metres; no faster, metres a second.
FARTHEST_M, SLOWEST_MPS, FASTEST_MPS = 5000.0, 0.05, 30.0
_TAKEOFF_M = 2.5
#: No way takes longer, seconds: working it out would hold up everybody else.
_LONGEST_S = 7200.0
#: An armed machine empties its battery in so many seconds.
_ENDURANCE_S = 1800.0
#: Setpoints that came within so many seconds let PX4 take its guided mode.
_FRESH_S = 1.0


#: Nothing befalls it.
NO_MISHAPS = Mishaps()


class Target(NamedTuple):
    """Where to go: a place, a heading, either or none of both (then it stands). NaN where there is none."""

    x_m: float = math.nan
    y_m: float = math.nan
    z_m: float = math.nan
    heading_rad: float = math.nan

    def is_same(self, other: "Target | None") -> bool:
        """Whether another says the same."""
        if other is None:
            return False
        return all(one == two or (math.isnan(one) and math.isnan(two)) for one, two in zip(self, other, strict=True))


class Pilot:
    """Steers the simulated body as an autopilot does.

    Args:
        drone: The body.
        timeline: Its time.
        flavour: As which autopilot.
        say: Called with a severity and a text for the ground station.
        real_s: Returns seconds by which links are judged.
        mishaps: What befalls it, on the timeline's seconds. They change what it tells and obeys; a way that it is on is
            not steered by a wrong position in the meantime.
    """

    def __init__(
        self,
        drone: Drone,
        timeline: Timeline,
        flavour: Flavour,
        *,
        say: Callable[[int, str], None],
        real_s: Callable[[], float],
        mishaps: Mishaps = NO_MISHAPS,
    ) -> None:
        self.mishaps = mishaps
        self.drone, self.timeline, self.flavour = drone, timeline, flavour
        self.parameters = Parameters(flavour, drone.profile.speed_mps)
        self._say, self._real_s = say, real_s
        self.mode = "LOITER" if flavour.is_px4 else ("STABILIZE" if flavour.flies else "MANUAL")
        self.is_armed = False
        self.speed_mps = drone.profile.speed_mps
        self.hits, self.hit = 0, ""
        self._target: Target | None = None
        self._alarms: list[Alarm] = []
        self._lapse: Alarm | None = None
        #: Since when it has not been on its way to anywhere, where it is not.
        self.rests_since_s = 0.0
        self.motion_ends_s: float | None = None
        self._station_s: float | None = None
        self._setpoint_s: float | None = None
        self._armed_at_s, self._used_s = 0.0, 0.0

    # What it says of itself.

    @property
    def now_s(self) -> float:
        """The time, seconds."""
        return self.timeline.now_s

    @property
    def is_busy(self) -> bool:
        """Whether it is on its way to somewhere."""
        return self.motion_ends_s is not None

    @property
    def is_landed(self) -> bool:
        """Whether it stands on the ground; what drives always does."""
        return not self.flavour.flies or self.drone.is_landed(self.now_s)

    @property
    def is_guided(self) -> bool:
        """Whether a program steers."""
        return self.mode == self.flavour.guided

    @property
    def battery(self) -> float:
        """What is left of the battery, 0 to 1."""
        if low := self.mishaps.at(MishapKind.BATTERY_LOW, self.now_s):
            return low.amount
        used_s = self._used_s + (self.now_s - self._armed_at_s if self.is_armed else 0.0)
        return max(0.0, 1.0 - used_s / _ENDURANCE_S)

    def belief(self) -> State:
        """Return where it takes itself to be."""
        here = self.drone.belief(self.now_s)
        told = self.mishaps.told(_pose(here), self.now_s)
        return here._replace(x_m=told.x_m, heading_rad=told.heading_rad)

    def _for_body(self, pose: Pose) -> Pose:
        """Return a pose in the frame that the body steers by, which no mishap leads astray."""
        astray = self.mishaps.told(Pose(0.0, 0.0), self.now_s)
        return replace(pose, x_m=pose.x_m - astray.x_m, heading_rad=pose.heading_rad - astray.heading_rad)

    # Commands. Each returns an answer of the enumeration MAV_RESULT.

    def arm(self, *, forced: bool = False) -> int:
        """Switch the motors on."""
        del forced
        if not self.is_armed:
            self.is_armed, self._armed_at_s = True, self.now_s
            self._say(INFO, "Arming motors")
        return ACCEPTED

    def disarm(self, *, forced: bool = False) -> int:
        """Switch the motors off; in the air only where it is forced to."""
        if not self.is_armed:
            return ACCEPTED
        if not forced and not self.is_landed:
            self._say(CRITICAL, "Disarming denied: not landed")
            return FAILED
        self.stand()
        if not self.is_landed:
            self._begin(lambda now_s: self.drone.climb(now_s, 0.0, speed_mps=10.0))
        self.is_armed = False
        self._used_s += self.now_s - self._armed_at_s
        self._say(INFO, "Disarming motors")
        return ACCEPTED

    def change_mode(self, mode: str) -> int:
        """Take another mode."""
        if mode == self.mode:
            return ACCEPTED
        is_offboard = self.flavour.is_px4 and mode == self.flavour.guided
        if is_offboard and (self._setpoint_s is None or self._real_s() - self._setpoint_s > _FRESH_S):
            self._say(CRITICAL, "Switching to mode 'Offboard' is currently not possible")
            return REJECTED_NOW
        self.stand()
        self.mode = mode
        if mode in {"RTL", "SMART_RTL"} and self.is_armed:
            self._come_home()
        elif mode == "LAND" and self.is_armed:
            self._land()
        elif mode == "TAKEOFF" and self.is_armed:
            self._begin(lambda now_s: self.drone.climb(now_s, _TAKEOFF_M), then=self._hold)
        return ACCEPTED

    def take_off(self, height_m: float) -> int:
        """Rise to a height above home."""
        if not self.flavour.flies:
            return UNSUPPORTED
        if not (self.is_armed and (self.is_guided or self.flavour.is_px4)):
            self._say(ERROR, "Takeoff needs motors and the guided mode")
            return FAILED
        if not 0.0 < height_m <= FARTHEST_M:
            return DENIED
        if self.flavour.is_px4:
            self.mode = "TAKEOFF"
        then = self._hold if self.flavour.is_px4 else None
        self._begin(lambda now_s: self.drone.climb(now_s, height_m), then=then)
        return ACCEPTED

    def change_speed(self, speed_mps: float) -> int:
        """Go so fast from the next target on."""
        if not SLOWEST_MPS <= speed_mps <= FASTEST_MPS:
            return DENIED
        usual = self.drone.profile.speed_mps
        # Numbers on the wire have seven digits.
        self.speed_mps = usual if abs(speed_mps - usual) < 1e-6 * usual else speed_mps
        return ACCEPTED

    def go(self, target: Target) -> bool:
        """Go somewhere, where a program steers; return whether it is heeded. The same target again changes nothing."""
        self._setpoint_s = self._real_s()
        may = self.is_guided and self.is_armed
        if not may or (self.is_landed and self.flavour.flies and not self.flavour.is_px4):
            return False
        self._forget_lapse()
        if target.is_same(self._target):
            return True
        self._target = target
        here = self.belief()
        has_place, has_heading = not math.isnan(target.x_m), not math.isnan(target.heading_rad)
        is_level = not self.flavour.flies or abs(target.z_m - here.z_m) < _THERE_M
        is_there = not has_place or (math.hypot(target.x_m - here.x_m, target.y_m - here.y_m) < _THERE_M and is_level)
        if not is_there:
            way_m = math.hypot(target.x_m - here.x_m, target.y_m - here.y_m)
            if way_m > self.speed_mps * _LONGEST_S:
                return False
            self._go(target, here)
        elif has_heading and abs(bearing_between_rad(here.heading_rad, target.heading_rad)) > _FACED_RAD:
            facing = self._for_body(Pose(0.0, 0.0, 0.0, target.heading_rad)).heading_rad
            self._begin(lambda now_s: self.drone.turn(now_s, normalise_heading_rad(facing)))
        else:
            self.stand()
            self._target = target
        return True

    def go_at(self, east_mps: float, north_mps: float, up_mps: float, heading_rad: float = math.nan) -> bool:
        """Go with a velocity, where a program steers an ArduPilot; return whether it is heeded.

        It is given up where it is not said anew within `GUID_TIMEOUT`. It is served as the way to where the machine
        would then come to stand, with the speed that ways have.
        """
        if self.flavour.is_px4:
            return False
        lapse_s, speed_mps = self.parameters["GUID_TIMEOUT"].value, math.hypot(east_mps, north_mps)
        if speed_mps > FASTEST_MPS:
            return False
        here, braking_mps2 = self.belief(), FollowerSettings.of(self.drone.profile).braking_mps2
        for_s = lapse_s + speed_mps / (2.0 * braking_mps2)
        place = here.x_m + east_mps * for_s, here.y_m + north_mps * for_s, here.z_m + up_mps * lapse_s
        if not self.go(Target(*place, heading_rad)):
            return False
        if self.is_busy:
            self._lapse = self.timeline.at(self.now_s + lapse_s, self.stand)
        return True

    def _forget_lapse(self) -> None:
        lapse, self._lapse = self._lapse, None
        if lapse is not None:
            self.timeline.cancel(lapse)

    def stand(self) -> None:
        """Stop where it is."""
        self._forget_lapse()
        self._drop()
        self._target = None
        self.drone.stop(self.now_s)

    # Links.

    def hear_station(self) -> None:
        """Take note of the ground station's heartbeat."""
        self._station_s = self._real_s()

    def watch_links(self) -> None:
        """Do what is to be done where the ground station or setpoints are lost."""
        if not self.is_armed or self.timeline.is_held:
            return
        now_s = self._real_s()
        if self._has_lost_setpoints(now_s):
            self._miss_setpoints()
            return
        action = self.parameters.station_action
        if self._station_s is None or action == NOTHING or self.mode in {"RTL", "LAND", self.flavour.hold}:
            return
        if now_s - self._station_s > self.parameters.station_lost_s:
            self._miss_station(action)

    def lose_link(self) -> None:
        """Do what is to be done where nobody is heard from now on, on the timeline's seconds.

        For a link that is lost while time is held: it then goes on, whoever held it cannot let it go any more.
        """
        self.timeline.let_go()
        if not self.is_armed:
            return
        if self.flavour.is_px4 and self.is_guided:
            due_s = self.parameters["COM_OF_LOSS_T"].value
            self.timeline.at(self.now_s + due_s, self._miss_setpoints)
        elif (action := self.parameters.station_action) != NOTHING:
            due_s = self.parameters.station_lost_s
            self.timeline.at(self.now_s + due_s, lambda: self._miss_station(action))

    def _miss_setpoints(self) -> None:
        self._say(CRITICAL, "Offboard control lost: hold")
        self.change_mode("LOITER")

    def _miss_station(self, action: int) -> None:
        self._say(CRITICAL, "GCS Failsafe")
        land = "LAND" if self.flavour.flies else self.flavour.hold
        self.change_mode({HOLD: self.flavour.hold, HOME: "RTL", LANDING: land}[action])

    def _has_lost_setpoints(self, now_s: float) -> bool:
        if not (self.flavour.is_px4 and self.is_guided) or self._setpoint_s is None:
            return False
        return now_s - self._setpoint_s > self.parameters["COM_OF_LOSS_T"].value

    # Motion.

    def _go(self, target: Target, here: State) -> None:
        drone = self.drone
        if self.flavour.is_px4 and self.flavour.flies:
            self.change_speed(min(self.parameters["MPC_XY_VEL_MAX"].value, FASTEST_MPS))
        # A rover that is given a place takes no heading.
        face = self.flavour.flies and not math.isnan(target.heading_rad)
        heading_rad = normalise_heading_rad(target.heading_rad) if face else here.heading_rad
        z_m = max(0.0, target.z_m) if self.flavour.flies else 0.0
        is_above = math.hypot(target.x_m - here.x_m, target.y_m - here.y_m) < _THERE_M
        if is_above and not face:
            self._begin(lambda now_s: drone.climb(now_s, z_m))
            return
        pose = self._for_body(Pose(target.x_m, target.y_m, z_m, heading_rad))
        speed_mps = self.speed_mps

        def begin(now_s: float) -> Flight:
            flight = drone.fly_on(now_s, pose, speed_mps=speed_mps, face=face)
            return flight or drone.fly(now_s, [pose], speed_mps=speed_mps, face=face)

        self._begin(begin)

    def _come_home(self) -> None:
        home, z_m = self.drone.start, self.drone.state(self.now_s).z_m
        pose = self._for_body(Pose(home.x_m, home.y_m, z_m, home.heading_rad))
        then = self._land if self.flavour.flies else None
        self._begin(lambda now_s: self.drone.fly(now_s, [pose], speed_mps=self.speed_mps, face=False), then=then)

    def _land(self) -> None:
        if not self.flavour.flies:
            return
        self._begin(lambda now_s: self.drone.climb(now_s, 0.0, speed_mps=CLIMB_MPS), then=self._landed)

    def _landed(self) -> None:
        self.disarm()

    def _hold(self) -> None:
        self.mode = self.flavour.hold

    def _begin(self, begin: Callable[[float], Flight], *, then: Callable[[], None] | None = None) -> None:
        """Begin a motion, which ends what it was doing."""
        self._drop()
        flight = begin(self.now_s)
        ends_s = self.motion_ends_s = flight.start_s + flight.answer_s

        def over() -> None:
            self._drop()
            if flight.hit is not None:
                self.hits, self.hit = self.hits + 1, flight.hit.name
                self._say(CRITICAL, f"Collision: {flight.hit.name}"[:50])
            elif then is not None:
                then()

        self._alarms = [self.timeline.at(ends_s, over)]

    def _drop(self) -> None:
        if self.is_busy:
            self.rests_since_s = self.now_s
        alarms, self._alarms, self.motion_ends_s = self._alarms, [], None
        for alarm in alarms:
            self.timeline.cancel(alarm)


def _pose(state: State) -> Pose:
    return Pose(state.x_m, state.y_m, state.z_m, state.heading_rad)
