"""Real, virtual and mixed time behind one face; the agent is written once against `Clock`."""

from reasoned_explorer.clock.clock import Clock, MixedClock, RealClock, VirtualClock
from reasoned_explorer.clock.live_thread import run_live
from reasoned_explorer.clock.stepped import SteppedClock

__all__ = ["Clock", "MixedClock", "RealClock", "SteppedClock", "VirtualClock", "run_live"]
