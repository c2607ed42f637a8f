"""What answers the three questions of the method, and what it costs. Importing this loads no mind."""

from reasoned_explorer.calls.ledger import CallRecord, Ledger, RoleTotals
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.minds.latency import LATENCY_PROFILES, LatencyProfile, RoleLatency, latency_profile
from reasoned_explorer.minds.mind import Evaluator, GoalChecker, Visionary
from reasoned_explorer.minds.registry import MINDS, make_minds

__all__ = [
    "LATENCY_PROFILES",
    "MINDS",
    "CallRecord",
    "Evaluator",
    "GoalChecker",
    "LatencyProfile",
    "Ledger",
    "MindContext",
    "Minds",
    "RoleLatency",
    "RoleTotals",
    "Visionary",
    "latency_profile",
    "make_minds",
]
