"""What tests of minds are made with."""

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import Ledger, MindContext, latency_profile
from reasoned_explorer.model import Scene

STREET = (
    "The image shows a paved pedestrian street. In the foreground, close to the viewer on the left, there is a bench "
    "next "
    "to a trash can under a tree. A little further on, on the right, a fountain stands in the middle of a plaza. In "
    "the "
    "distance, two people and a bicycle rack can be seen straight ahead. A pavement leads straight ahead; grass lies "
    "to "
    "the left and a road to the right. In the background there are apartment buildings and the sky."
)
WALL = "The wall of a building fills most of the view and blocks the way ahead."
KOSMOS = (
    "An image of a park with a bench sitting next to a tree. In the background there are buildings and a street with "
    "cars "
    "parked on the side."
)


def mind_context(profile: str = "instant", seed: int = 0) -> MindContext:
    return MindContext(VirtualClock(), latency_profile(profile), Ledger(), seed=seed)


def scene(text: str, *key: int, fault: str | None = None) -> Scene:
    return Scene(text, key or (0, 0, 0), Pose(0.0, 0.0), fault=fault)
