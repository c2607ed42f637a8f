"""What stands in front of every machine: limits, watches, the operator's stop, and a list to go through before."""

from reasoned_explorer.vehicles.safety.area import Area, Circle, Polygon
from reasoned_explorer.vehicles.safety.building import guarded
from reasoned_explorer.vehicles.safety.cause import Cause
from reasoned_explorer.vehicles.safety.guard import GuardedVehicle
from reasoned_explorer.vehicles.safety.limits import SafetyLimits, limited_profile
from reasoned_explorer.vehicles.safety.operator_stop import KeyboardListener, OperatorStop
from reasoned_explorer.vehicles.safety.preflight import CheckItem, CheckVerdict, preflight
from reasoned_explorer.vehicles.safety.telemetry import ReportsTelemetry, Telemetry, telemetry_of

__all__ = [
    "Area",
    "Cause",
    "CheckItem",
    "CheckVerdict",
    "Circle",
    "GuardedVehicle",
    "KeyboardListener",
    "OperatorStop",
    "Polygon",
    "ReportsTelemetry",
    "SafetyLimits",
    "Telemetry",
    "guarded",
    "limited_profile",
    "preflight",
    "telemetry_of",
]
