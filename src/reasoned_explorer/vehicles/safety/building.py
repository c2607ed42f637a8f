"""A guarded vehicle from plain settings."""

from collections.abc import Callable

from reasoned_explorer.clock import Clock
from reasoned_explorer.model.record import InterventionRecord
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.guard import Confirm, GuardedVehicle
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, limited_profile
from reasoned_explorer.vehicles.safety.operator_stop import OperatorStop
from reasoned_explorer.vehicles.safety.watch import RangeAhead
from reasoned_explorer.vehicles.vehicle import Vehicle


def guarded(
    make: Callable[[VehicleProfile], Vehicle],
    profile: VehicleProfile,
    limits: SafetyLimits,
    *,
    clock: Clock,
    stop: OperatorStop | None = None,
    range_ahead_m: RangeAhead | None = None,
    keep_out_at: Callable[[float, float], bool] | None = None,
    confirm: Confirm | None = None,
    dry_run: bool = False,
    on_event: Callable[[InterventionRecord], None] | None = None,
) -> GuardedVehicle:
    """Return a guarded vehicle whose driver was made with a profile cut down to the limits.

    Args:
        make: Makes the driver for a profile.
        profile: What the machine can do.
        limits: What it may do.
        clock: The mission's.
        stop: See `GuardedVehicle`, also for the others.
        range_ahead_m: Likewise.
        keep_out_at: Likewise.
        confirm: Likewise.
        dry_run: Likewise.
        on_event: Likewise.

    Raises:
        SettingsError: If the machine cannot keep to the limits.
    """
    return GuardedVehicle(
        make(limited_profile(profile, limits)),
        limits,
        clock=clock,
        stop=stop,
        range_ahead_m=range_ahead_m,
        keep_out_at=keep_out_at,
        confirm=confirm,
        dry_run=dry_run,
        on_event=on_event,
    )
