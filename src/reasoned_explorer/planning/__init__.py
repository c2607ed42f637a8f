"""What decides how promising each frontier is."""

from reasoned_explorer.planning.planner import FrontierScore, ImaginedNode, Plan, Planner

__all__ = ["FrontierScore", "ImaginedNode", "Plan", "Planner"]
