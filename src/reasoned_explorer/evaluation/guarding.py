"""A mission's vehicle that is somewhere else, with a guard in front of it."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.evaluation.vehicle_address import Errand, VehicleAddress
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.safety.area import Circle
from reasoned_explorer.vehicles.safety.building import guarded
from reasoned_explorer.vehicles.safety.guard import Confirm, GuardedVehicle
from reasoned_explorer.vehicles.safety.limits import SafetyLimits
from reasoned_explorer.vehicles.safety.operator_stop import OperatorStop
from reasoned_explorer.vehicles.safety.watch import RangeAhead

if TYPE_CHECKING:
    from reasoned_explorer.evaluation.mission_course import MissionCourse


@dataclass(frozen=True, slots=True)
class Guarding:
    """Which vehicle, and what it may do.

    Attributes:
        address: Where the vehicle is.
        limits: What it may do.
        fence_m: It stays within so far of where the mission begins, metres; None for what the limits say.
        dry_run: Look, plan and report, but never move.
        confirm: Asks a person before each leg.
        stop: The operator's.
        may_move: Whether a machine that may be real may be made to move.
        home: Where in the mission's frame the vehicle's own begins; None where the mission says.

    Raises:
        SettingsError: If the fence is out of range.
    """

    address: VehicleAddress
    limits: SafetyLimits = field(default_factory=SafetyLimits)
    fence_m: float | None = None
    dry_run: bool = False
    confirm: Confirm | None = None
    stop: OperatorStop | None = None
    may_move: bool = False
    home: Pose | None = None

    def __post_init__(self) -> None:
        if self.fence_m is not None and not is_within(self.fence_m, 2.0, 1e5):
            raise SettingsError("guard", [Fault(f"a fence of {self.fence_m!r:.40}", "metres in [2, 100000]")])

    def vehicle(self, mission: "MissionCourse") -> GuardedVehicle:
        """Return the vehicle of a mission, which connects when it is started.

        Raises:
            SettingsError: If the vehicle cannot keep to the limits, or pictures are wanted that it does not take.
            MissingDependencyError: If the library of its wire is not installed.
        """
        settings = mission.settings
        shows = is_model_name(settings.captioner) or mission.keeps_pictures
        if shows and not self.address.has_camera:
            expected = "a simulated captioner and no --images"
            remedy = "or give a --camera, where its wire has none"
            fault = Fault(f"no pictures come from {self.address}", expected, remedy)
            raise SettingsError("vehicle", [fault])
        content = mission.content()
        if content is not None:
            # Once for nothing: what it compiles and loads would keep the machine's link waiting for as long.
            content(mission.start, mission.profile.camera)
        errand = Errand(
            mission.clock,
            mission.start,
            shows,
            content,
            self.may_move,
            mission.origin,
            settings.picture_px,
            self.home or mission.home,
        )
        return guarded(
            lambda profile: self.address.vehicle(profile, errand),
            mission.profile,
            self.limits_at(mission.start),
            clock=mission.clock,
            stop=self.stop,
            confirm=self.confirm,
            dry_run=self.dry_run,
            range_ahead_m=self._range_ahead(mission),
        )

    def _range_ahead(self, mission: "MissionCourse") -> RangeAhead | None:
        """Return what looks ahead in the world for a machine that does not itself; None where it is no simulator's.

        On real time the machine may be real: what a world has at a place need not stand there.
        """
        is_simulated = not self.address.may_be_real or mission.settings.clock != "real"
        return mission.range_ahead() if is_simulated and not self.address.looks_ahead else None

    def limits_at(self, start: Pose) -> SafetyLimits:
        """Return the limits of a vehicle that begins somewhere."""
        if self.fence_m is None:
            return self.limits
        return replace(self.limits, fence=Circle(start.x_m, start.y_m, self.fence_m))
