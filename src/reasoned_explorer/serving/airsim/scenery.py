"""What stands in the world, as it is called on the wire, where it is, and which number it has in segmentation."""

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import Obstacles
    from reasoned_explorer.world.world import World

#: Numbers are bytes on the wire; 0 is the sky's.
MOST_IDS = 256
GROUND_NAME = "Ground"
_LONGEST_PATTERN, _MOST_REPETITIONS = 200, 4


def name_of_object(world: "World", place: int) -> str:
    """Return what an object is called: its class and its place in the world's list."""
    return f"{world.objects[place].class_name}_{place}"


def name_of_building(place: int) -> str:
    """Return what a building is called."""
    return f"building_{place}"


def name_of_wall(world: "World", near: "Obstacles", row: int) -> str:
    """Return whose wall it is that a body ran into."""
    place = int(near.wall_object[row])
    return name_of_object(world, place) if place >= 0 else name_of_building(int(near.wall_building[row]))


def name_of_disc(world: "World", near: "Obstacles", row: int) -> str:
    """Return what round thing it is that a body ran into."""
    return name_of_object(world, int(near.disc_object[row]))


class Scenery:
    """The things of a world by name, and their segmentation numbers.

    Args:
        atlas: Of the world.
    """

    def __init__(self, atlas: "Atlas") -> None:
        world = atlas.world
        buildings = [name_of_building(place) for place in range(len(world.buildings))]
        objects = [name_of_object(world, place) for place in range(len(world.objects))]
        #: Names in the order of the renderer's instance ids, which begin with the sky and the ground.
        self.names = ["Sky", GROUND_NAME, *buildings, *objects]
        self._place = {name: place for place, name in enumerate(self.names)}
        self._world = world
        self._ids: NDArray[np.int64] = np.empty(0, np.int64)
        self.reset()

    def reset(self) -> None:
        """Give everything the number that it had at the start."""
        ids = np.arange(len(self.names), dtype=np.int64)
        ids[1:] = 1 + (ids[1:] - 1) % (MOST_IDS - 1)
        self._ids = ids

    def matching(self, pattern: str) -> list[str]:
        """Return the names that a regular expression matches as a whole; the sky is no thing.

        Raises:
            ValueError: If it is no regular expression, or one that would take long.
        """
        matches = _matcher(pattern)
        return [name for name in self.names[1:] if matches(name)]

    def pose_of(self, name: str) -> Pose | None:
        """Return where a thing is: its middle on the ground, facing as it does; None where there is none."""
        place = self._place.get(name)
        if place is None or place < 2:
            return None
        world, count = self._world, len(self._world.buildings)
        if place - 2 < count:
            outer = world.buildings[place - 2].outer
            x_m, y_m = (0.5 * (outer.min(axis=0) + outer.max(axis=0))).tolist()
            return Pose(x_m, y_m, 0.0, 0.0)
        item = world.objects[place - 2 - count]
        return Pose(float(item.x_m), float(item.y_m), 0.0, float(item.heading_rad))

    def id_of(self, name: str) -> int:
        """Return the segmentation number of a thing; -1 where there is none."""
        place = self._place.get(name)
        return -1 if place is None else int(self._ids[place])

    def number(self, name: str, number: int, *, is_pattern: bool) -> bool:
        """Give things a segmentation number; return whether there was any of that name.

        Raises:
            ValueError: If it is to be a regular expression and is none.
        """
        names = self.matching(name) if is_pattern else [name] if name in self._place else []
        for one in names:
            self._ids[self._place[one]] = number
        return bool(names)

    def numbered(self, instances: NDArray[np.int32]) -> NDArray[np.uint8]:
        """Return the segmentation numbers of a picture's instance ids."""
        found: NDArray[np.uint8] = self._ids.astype(np.uint8)[instances]
        return found


def _matcher(pattern: str) -> Callable[[str], object]:
    """Return what tells whether a name matches, case aside, as AirSim takes it.

    A repeated group can take longer than anybody waits, and so can many repetitions.
    """
    if len(pattern) > _LONGEST_PATTERN or re.search(r"\)\s*[*+{?]", pattern):
        raise ValueError("a regular expression that is long or repeats a group")
    if len(re.findall(r"[*+{]", pattern)) > _MOST_REPETITIONS:
        raise ValueError(f"a regular expression with more than {_MOST_REPETITIONS} repetitions")
    try:
        return re.compile(pattern, re.IGNORECASE).fullmatch
    except (re.error, OverflowError, RecursionError) as error:
        raise ValueError(f"no regular expression: {error}") from error
