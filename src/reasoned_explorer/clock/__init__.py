"""Real, virtual and mixed time behind one face; the agent is written once against `Clock`."""

from reasoned_explorer.clock.clock import Clock, MixedClock, RealClock, VirtualClock

__all__ = ["Clock", "MixedClock", "RealClock", "VirtualClock"]
