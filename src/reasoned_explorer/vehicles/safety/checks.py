"""Whether a vehicle can be guarded at all."""

from reasoned_explorer.clock import Clock
from reasoned_explorer.clock.stepped import SteppedClock
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, limited_profile
from reasoned_explorer.vehicles.vehicle import Vehicle


def check_guardable(vehicle: Vehicle, limits: SafetyLimits, clock: Clock) -> None:
    """Check that a vehicle can be guarded.

    Raises:
        SettingsError: If it is faster than it may be, or nothing can be watched on the clock.
    """
    profile, faults = vehicle.profile, []
    allowed = limited_profile(profile, limits)
    for name in ("speed_mps", "turn_rate_radps"):
        if getattr(profile, name) > getattr(allowed, name):
            what = f"{name} of {profile.name} is {getattr(profile, name):g}"
            remedy = "make its driver with limited_profile(profile, limits)"
            faults.append(Fault(what, f"at most {getattr(allowed, name):g}", remedy))
    if isinstance(clock, SteppedClock):
        faults.append(Fault("the clock is stepped", "one on which a leg and its watch go on at the same time"))
    if faults:
        raise SettingsError("guarded vehicle", faults)
