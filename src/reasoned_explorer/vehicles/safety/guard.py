"""A vehicle with a guard before it: no command reaches the machine that the guard has not looked at."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import replace

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, Leg, LegOutcome, PartError, SettingsError, View
from reasoned_explorer.model.record import InterventionRecord, MissionEnd
from reasoned_explorer.vehicles.safety.area import AllowedGround
from reasoned_explorer.vehicles.safety.cause import Cause
from reasoned_explorer.vehicles.safety.checks import check_guardable
from reasoned_explorer.vehicles.safety.frozen_picture import FrozenPicture
from reasoned_explorer.vehicles.safety.legs import in_words, joined, not_travelled, travelled
from reasoned_explorer.vehicles.safety.limits import SafetyLimits
from reasoned_explorer.vehicles.safety.operator_stop import OperatorStop
from reasoned_explorer.vehicles.safety.plausibility import Finding
from reasoned_explorer.vehicles.safety.telemetry import Halts, Refreshes, telemetry_of
from reasoned_explorer.vehicles.safety.watch import RangeAhead, Watch
from reasoned_explorer.vehicles.safety.watching import watched
from reasoned_explorer.vehicles.vehicle import Vehicle

#: Asks a person whether to go from one pose to another.
Confirm = Callable[[Pose, Pose], Awaitable[bool]]
#: Troubles that waiting does not mend.
_LASTING = frozenset({Cause.OPERATOR, Cause.BATTERY, Cause.MODELS})
#: How often a machine that stands and waits is asked again, seconds.
_AGAIN_S = 1.0
#: Legs shorter than this need not be travelled, metres.
_NO_LEG_M = 0.05


class GuardedVehicle(Vehicle):
    """Guards a vehicle; see the package's documentation for what it does where.

    Args:
        vehicle: The machine, whose profile is within the limits (`limited_profile`).
        limits: What it may do.
        clock: The mission's, one that runs things at the same time (not a stepped one).
        stop: The operator's.
        range_ahead_m: Says how far something stands before a pose, in its heading; None for nothing in sight.
        keep_out_at: Says of a point (x, y) whether it must not be gone to.
        confirm: Asks a person before each leg; None for nobody.
        dry_run: Look, plan and report, but never move.
        on_event: Told of each intervention as it happens.

    Raises:
        SettingsError: If the vehicle is faster than it may be, or the clock is a stepped one.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        limits: SafetyLimits,
        *,
        clock: Clock,
        stop: OperatorStop | None = None,
        range_ahead_m: RangeAhead | None = None,
        keep_out_at: Callable[[float, float], bool] | None = None,
        confirm: Confirm | None = None,
        dry_run: bool = False,
        on_event: Callable[[InterventionRecord], None] | None = None,
    ) -> None:
        check_guardable(vehicle, limits, clock)
        self.profile, self.limits, self.stop = vehicle.profile, limits, stop or OperatorStop()
        self.dry_run = dry_run
        self._inner, self._clock, self._confirm, self._on_event = vehicle, clock, confirm, on_event
        self.ground = AllowedGround(limits.fence, limits.keep_out, keep_out_at, limits.margin_m)
        self._watch = Watch(vehicle.profile, limits, self.ground, range_ahead_m)
        self._home: Pose | None = None
        self._is_down = False
        self._camera: Finding | None = None
        self._link: Finding | None = None
        self._battery: Finding | None = None
        self._frozen = FrozenPicture()
        self._models_lost, self._models_why = 0, ""
        self._ending: tuple[MissionEnd, str] | None = None
        self._taken = 0
        #: All interventions, oldest first.
        self.events: list[InterventionRecord] = []
        #: Where a dry run would have gone.
        self.planned: list[Pose] = []
        #: The last leg; after a cancelled `go_to` the part of it that was travelled.
        self.last_leg: Leg | None = None

    @property
    def pose(self) -> Pose:
        """Where the machine believes to be."""
        return self._inner.pose

    async def start(self) -> None:
        """Start the machine; in a dry run only connect.

        Raises:
            PartError: If it does not start, the stop is pressed, or it is where it must not be.
        """
        if self.stop.pressed:
            raise PartError("guard", f"not started: {self.stop.why}")
        await (self._inner.connect() if self.dry_run else self._inner.start())
        self._home = self.pose
        trouble = self.ground.trouble(self.pose.x_m, self.pose.y_m)
        if trouble is not None and not self.dry_run:
            self._note(Finding(*trouble), "not started")
            with suppress(PartError):
                await self._inner.close()
            raise PartError("guard", f"the machine is {trouble[1]}")

    async def close(self) -> None:
        """Leave the machine safe."""
        await self._inner.close()

    # For whoever runs the mission.

    def note_model_call(self, *, answered: bool, why: str = "") -> None:
        """Take in whether a model call came back; too many lost ones in a row and the machine stands."""
        self._models_lost = 0 if answered else self._models_lost + 1
        self._models_why = why

    def trust_position(self) -> None:
        """Believe the position again that the machine tells, jump or not: a person has looked."""
        self._watch.plausibility.forget()

    def must_end(self) -> tuple[MissionEnd, str] | None:
        """Return how the mission must end since the machine may go nowhere any more, and why."""
        if self.stop.pressed:
            return MissionEnd.INTERRUPTED, self.stop.why
        return self._ending

    def take_interventions(self) -> Sequence[InterventionRecord]:
        """Return the interventions since this was last called."""
        fresh, self._taken = self.events[self._taken :], len(self.events)
        return fresh

    # Looking.

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Take one view in each heading; in a dry run, a machine that turns to look sees its own heading only.

        Raises:
            SettingsError: If a heading is not finite.
            PartError: If the camera or the link fails, the stop is pressed, or the picture is frozen.
        """
        if self.dry_run and self.profile.turns_to_look:
            headings_rad = [self.pose.heading_rad] * len(headings_rad)
        started_s = self._clock.now_s()

        def trouble() -> Finding | None:
            if self.stop.pressed:
                return Finding(Cause.OPERATOR, self.stop.why)
            if self._clock.now_s() - started_s > self.limits.look_s:
                return Finding(Cause.CAMERA, f"no picture within {self.limits.look_s:g} s")
            return None

        try:
            views = await watched(self._inner.look(headings_rad), trouble, self._clock, self.limits.check_s)
        except PartError as fault:
            await self._take_fault(fault, looking=True)
            raise
        if isinstance(views, Finding):
            await self._halt()
            self._note(views, "stands")
            self._camera = views if views.cause is Cause.CAMERA else self._camera
            raise PartError("guard", views.reason)
        self._link = self._camera = None
        if self._frozen.see(views, self.pose):
            self._camera = Finding(Cause.CAMERA, "the picture is frozen: it is the same as from elsewhere")
            self._note(self._camera, "stands")
            raise PartError("guard", self._camera.reason)
        return views

    # Going.

    async def go_to(self, target: Pose) -> Leg:
        """Go to a point as far as that is allowed; the leg says where it was really sent and why it ended.

        Cancelled on the way, the machine stops; `last_leg` tells what it travelled.

        What fails on the way is a leg that ended by a fault: so what was travelled until then is told.

        Raises:
            SettingsError: If the target is not finite.
        """
        if not is_finite(target.x_m, target.y_m, target.z_m, target.heading_rad):
            raise SettingsError("go_to", [Fault(f"target {target}", "finite coordinates and heading")])
        unfit = None if self.dry_run else await self._fit()
        if unfit is not None:
            return await self._refused_leg(target, unfit)
        aim, cut = self._allowed(target)
        if cut is not None and (self.limits.outside == "refuse" or self._is_no_leg(aim)):
            self._note(cut, "refused")
            return self._no_leg(target, cut)
        if cut is not None:
            self._note(cut, f"shortened to ({aim.x_m:.1f}, {aim.y_m:.1f})")
        if self.dry_run:
            self.planned.append(aim)
            way = f"{self.pose.distance_to_m(aim.x_m, aim.y_m):.1f} m to ({aim.x_m:.1f}, {aim.y_m:.1f})"
            self._note(Finding(Cause.DRY_RUN, f"would go {way}"), "not travelled")
            return self._no_leg(aim, Finding(Cause.DRY_RUN, f"not travelled, {way}"))
        if self._confirm is not None and not await self._confirm(self.pose, aim):
            declined = Finding(Cause.DECLINED, "a person declined the leg")
            self._note(declined, "refused")
            return self._no_leg(aim, declined)
        if self.stop.pressed:  # while the person was asked
            return await self._refused_leg(target, Finding(Cause.OPERATOR, self.stop.why))
        leg, found = await self._leg(aim)
        if found is not None and found.cause is Cause.BATTERY:
            leg = await self._bring_home(leg, found)
        elif cut is not None and leg.outcome is LegOutcome.ARRIVED:
            # It did not come to where it was to: at the last allowed point it stands.
            leg = replace(leg, outcome=LegOutcome.STOPPED, detail=in_words(cut))
        self.last_leg = leg
        return leg

    def _allowed(self, target: Pose) -> tuple[Pose, Finding | None]:
        """Return where a leg may lead, and what cuts it short."""
        aim, cut = target, None
        low_m, high_m = self.limits.lowest_m, self.limits.highest_m
        if self.profile.flies and target.z_m > 0.0 and not low_m <= target.z_m <= high_m:
            cut = Finding(Cause.HEIGHT, f"a height of {target.z_m:.1f} m is not in [{low_m:g}, {high_m:g}] m")
            aim = replace(target, z_m=min(max(target.z_m, low_m), high_m))
        reach = self.ground.reach(self.pose, target.x_m, target.y_m)
        if reach.cause is not None:
            cut = Finding(reach.cause, f"the leg leads {reach.reason}")
            aim = replace(aim, x_m=reach.x_m, y_m=reach.y_m)
        return aim, cut

    def _is_no_leg(self, aim: Pose) -> bool:
        return self.pose.distance_to_m(aim.x_m, aim.y_m) < _NO_LEG_M

    async def _fit(self) -> Finding | None:
        """Wait, standing, for a while until nothing speaks against going; return what still does."""
        until_s = self._clock.now_s() + self.limits.patience_s
        waited_for: Finding | None = None
        while True:
            found = await self._against_going()
            if found is None or found.cause in _LASTING or self._clock.now_s() >= until_s:
                return found
            if waited_for is None or waited_for.cause is not found.cause:
                self._note(found, "stands and waits")
                waited_for = found
            await self._clock.act(min(_AGAIN_S, max(0.0, until_s - self._clock.now_s())))
            if self._camera is not None and not self.stop.pressed:
                with suppress(PartError):
                    await self._inner.look([self.pose.heading_rad])
                    self._camera = None

    async def _against_going(self) -> Finding | None:
        if self.stop.pressed:
            return Finding(Cause.OPERATOR, self.stop.why)
        if self._models_lost >= self.limits.model_failures:
            why = f": {self._models_why}" if self._models_why else ""
            return Finding(Cause.MODELS, f"{self._models_lost} model calls in a row were lost{why}")
        if self._battery is not None:
            return self._battery
        if isinstance(self._inner, Refreshes):
            try:
                await self._inner.refresh()
                self._link = None
            except PartError as fault:
                self._link = Finding(Cause.LINK, str(fault))
        told = telemetry_of(self._inner)
        if not isinstance(self._inner, Refreshes) and (told.link_age_s or 0.0) <= self.limits.link_age_s:
            self._link = None
        return self._link or self._camera or self._watch.standing(told, self._clock.now_s())

    async def _leg(self, aim: Pose, *, whatever: frozenset[Cause] = frozenset()) -> tuple[Leg, Finding | None]:
        """Travel under watch; return what came of it, and why it was stopped if it was.

        Args:
            aim: Where to, already allowed.
            whatever: What is no reason to stop.
        """
        self._watch.set_off(telemetry_of(self._inner), self._clock.now_s())
        before = getattr(self._inner, "last_leg", None)

        def trouble() -> Finding | None:
            found = self._trouble(aim)
            return None if found is None or found.cause in whatever else found

        try:
            leg = await watched(self._inner.go_to(aim), trouble, self._clock, self.limits.check_s)
        except asyncio.CancelledError:
            self.last_leg = self._travelled(before, aim, "cancelled")
            raise
        except PartError as fault:
            found = await self._take_fault(fault, looking=False)
            return replace(self._travelled(before, aim, in_words(found)), outcome=LegOutcome.FAULT), found
        if isinstance(leg, Finding):
            found, at_s = leg, self._clock.now_s()
            stopped = "stopped" if await self._halt() else "told to stop, but the link is lost"
            self._note(found, stopped, at_s=at_s)
            self._link = found if found.cause is Cause.LINK else self._link
            return self._travelled(before, aim, in_words(found)), found
        if leg.outcome is LegOutcome.STOPPED and (found_too := trouble()) is not None:
            return await self._seen_first(leg, found_too), found_too
        return leg, None

    async def _seen_first(self, leg: Leg, found: Finding) -> Leg:
        """Take in that the machine's driver has stopped it, for a reason that is one of the guard's, too."""
        at_s = self._clock.now_s()
        heard = await self._halt()
        self._note(found, "stopped by its driver" if heard else "left to the machine's own failsafe", at_s=at_s)
        self._link = found if found.cause is Cause.LINK else self._link
        return replace(leg, detail=f"{in_words(found)} ({leg.detail})")

    def _trouble(self, aim: Pose) -> Finding | None:
        if self.stop.pressed:
            return Finding(Cause.OPERATOR, self.stop.why)
        if self._models_lost >= self.limits.model_failures:
            return Finding(Cause.MODELS, f"{self._models_lost} model calls in a row were lost")
        return self._watch.under_way(telemetry_of(self._inner), aim, self._clock.now_s())

    async def _halt(self) -> bool:
        """Have the machine stand, once more; return whether it heard."""
        if not isinstance(self._inner, Halts):
            return True
        try:
            await self._inner.halt()
        except PartError:
            return False
        return True

    async def _take_fault(self, fault: PartError, *, looking: bool) -> Finding:
        """Take in that a command failed, have the machine stand, and return what failed."""
        at_s = self._clock.now_s()
        heard = await self._halt()
        lost = not looking or not heard
        if looking and heard and isinstance(self._inner, Refreshes):
            try:
                await self._inner.refresh()
            except PartError:
                lost = True
        found = Finding(Cause.LINK if lost else Cause.CAMERA, str(fault))
        if lost:
            self._link = found
        else:
            self._camera = found
        self._note(found, "stopped" if heard else "left to the machine's own failsafe", at_s=at_s)
        return found

    async def _bring_home(self, leg: Leg, found: Finding) -> Leg:
        """Come home or land, with what is left of the battery; then go nowhere any more."""
        self._battery, self._ending = found, (MissionEnd.FAULT, in_words(found))
        if self.limits.when_low == "home" and self._home is not None and not self._is_down:
            reach = self.ground.reach(self.pose, self._home.x_m, self._home.y_m)
            if reach.cause is None:
                back, trouble = await self._leg(self._home, whatever=frozenset({Cause.BATTERY}))
                leg = joined(leg, back)
                if trouble is None and back.outcome is LegOutcome.ARRIVED:
                    self._note(found, "came home")
                    return leg
        self._note(found, "landed, or stands")
        self._is_down = True
        await self._inner.close()
        return leg

    async def _refused_leg(self, target: Pose, found: Finding) -> Leg:
        self._note(found, "refused")
        if found.cause is Cause.BATTERY and self._battery is None:
            return await self._bring_home(self._no_leg(target, found), found)
        if self._ending is None and found.cause is not Cause.OPERATOR:
            self._ending = MissionEnd.FAULT, in_words(found)
        return self._no_leg(target, found)

    def _no_leg(self, target: Pose, found: Finding) -> Leg:
        self.last_leg = not_travelled(target, in_words(found))
        return self.last_leg

    def _travelled(self, before: Leg | None, aim: Pose, why: str) -> Leg:
        return travelled(getattr(self._inner, "last_leg", None), before, aim, why)

    def _note(self, found: Finding, done: str, *, at_s: float | None = None) -> None:
        at_s = self._clock.now_s() if at_s is None else at_s
        event = InterventionRecord(round(at_s, 6), found.cause.value, found.reason, done)
        self.events.append(event)
        if self._on_event is not None:
            self._on_event(event)
