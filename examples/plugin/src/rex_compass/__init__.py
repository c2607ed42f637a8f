"""A planner, a mind, a captioner, a vehicle and a world, each as small as it can be."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.model import Assessment, Goal, Scene, Verdict, View, likert_from_score
from reasoned_explorer.perception.context import CaptionerContext
from reasoned_explorer.planning import FrontierScore, Plan
from reasoned_explorer.vehicles import PROFILES, VehicleProfile
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Region, World, WorldObject


class DueNorth:
    """Prefers frontiers that lie to the north."""

    name = "due-north"
    label = "due-north [no model]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Score 5 for north, 1 for south."""
        return Plan(tuple(FrontierScore(3.0 + 2.0 * math.cos(scene.waypoint.heading_rad)) for scene in scenes))


def make_planner(minds: Minds) -> DueNorth:
    """A planner's factory is called with minds, and with the settings that people give as keywords."""
    return DueNorth()


class EasilyPleased:
    """Likes every scene, imagines more of the same, and finds the goal where its last word is in the text."""

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:
        """Score 4 for everything."""
        return [Assessment(likert_from_score(4.0)) for _ in scenes]

    async def imagine(self, goal: Goal, scenes: Sequence[Scene], *, count: int) -> Sequence[Sequence[Scene]]:
        """Imagine what is there already."""
        return [
            [replace(scene, key=(*scene.key, child), depth=scene.depth + 1) for child in range(count)]
            for scene in scenes
        ]

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        """Look for the last word of the goal."""
        word = goal.text.split()[-1]
        return [Verdict(word in scene.text, 1.0 if word in scene.text else 0.0, word) for scene in scenes]


def make_minds(context: MindContext) -> Minds:
    """A mind's factory is called with a context: clock, latency profile, ledger, seed."""
    mind = EasilyPleased()
    return Minds("easily pleased, no language model", mind, mind, mind)


class Terse:
    """Says of each view only what is nearest in it, up to ten metres."""

    name = "terse"
    label = "terse (simulated)"

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str]:
        """Describe all views at once."""
        close = [[thing for thing in view.content.sightings if thing.distance_m <= 10.0] for view in views]
        names = [things[0].class_name.replace("_", " ") if things else "nothing" for things in close]
        return [f"In the foreground there is a {name}." for name in names]


def make_captioner(context: CaptionerContext) -> Terse:
    """A captioner's factory is called with a context: how to charge time, and the seed."""
    return Terse()


def make_vehicle_profile() -> VehicleProfile:
    """A vehicle's factory returns a profile for the simulator."""
    return replace(PROFILES["go1"], name="tortoise", summary="slow and steady", speed_mps=0.1)


def make_world(*, seed: int, size_m: float) -> World:
    """A world's factory is called with a seed and a size."""
    half_m = size_m / 2.0
    meadow = Region(
        Ground.GRASS, np.array([[-half_m, -half_m], [half_m, -half_m], [half_m, half_m], [-half_m, half_m]])
    )
    bench = WorldObject(0, "bench", 0.0, half_m / 2.0, math.pi, (1.8, 0.6, 0.85))
    return World(
        name=f"meadow:{seed}",
        bounds=Bounds(-half_m, -half_m, half_m, half_m),
        regions=(meadow,),
        ways=(),
        buildings=(),
        objects=(bench,),
        source="a meadow with one bench",
        seed=seed,
    )
