"""A served AirSim in a thread of its own, for programs that are its clients at the same time."""

from reasoned_explorer.serving.background import BackgroundServer

__all__ = ["BackgroundServer"]
