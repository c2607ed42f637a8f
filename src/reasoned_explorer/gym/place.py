"""Where an episode takes place and what is sought there, and all that can be wrong with that."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import Fault, Gathering, GoalError, SettingsError, StartError, WorldError
from reasoned_explorer.model.checks import is_there, is_within, kind_faults
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import check_world_name, open_world
from reasoned_explorer.world.world import World

#: What an episode's options may name.
OPTIONS = ("goal", "world", "start")
#: A goal has at most so many characters (`task.reading`).
GOAL_LENGTH = 300
#: And these alone: an observation's space must name them.
GOAL_CHARACTERS = "".join(map(chr, [*range(0x20, 0x7F), *range(0xA1, 0x100)])) + "‘’“”–—…"
_WORLD_FORM = "a name like park:7, a file, a World or an Atlas"
_START_FORM = "a Pose, or x_m, y_m and, if you like, heading_rad, all finite"


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Where, what for, and from where.

    Attributes:
        world: A world by name or file, a world, or an atlas of one.
        goal: The sentence.
        start: A pose; or x, y (metres) and heading (radians); None draws one by the seed.
    """

    world: Any
    goal: Any
    start: Any = None

    def check(self, found: Gathering) -> None:
        """Check all that can be known before the world is there; what is wrong is kept in ``found``."""
        found.check(self._check_world)
        found.check(self._check_goal)
        found.check(lambda: self.start_pose)

    def with_options(self, options: Mapping[str, Any] | None) -> "Place":
        """Return the place that the options of a reset ask for.

        Raises:
            InputError: If they cannot be used; all faults at once.
        """
        if options is None:
            return self
        found = Gathering()
        if not isinstance(options, Mapping):
            raise SettingsError("options", [Fault(f"{options!r:.60}", f"a mapping of {', '.join(OPTIONS)}")])
        unknown = [Fault(f"{name!r:.60}", f"one of {', '.join(OPTIONS)}") for name in options if name not in OPTIONS]
        if unknown:
            found.add(SettingsError("options", unknown))
        asked = replace(self, **{name: options[name] for name in OPTIONS if name in options})
        asked.check(found)
        found.finish("options")
        return asked

    @property
    def start_pose(self) -> Pose | None:
        """The start as a pose.

        Raises:
            StartError: If it is none.
        """
        if self.start is None or isinstance(self.start, Pose):
            return self.start
        numbers: Sequence[Any] = ()
        with suppress(TypeError):
            numbers = tuple(self.start)
        if len(numbers) not in {2, 3} or not all(is_within(number) for number in numbers):
            raise StartError("start", [Fault(f"{self.start!r:.60}", _START_FORM)])
        x_m, y_m, heading_rad = (*map(float, numbers), 0.0)[:3]
        return Pose(x_m, y_m, 0.0, normalise_heading_rad(heading_rad))

    def atlas(self) -> Atlas:
        """Return an atlas of the world; environments of one process share those of worlds that have a name.

        Raises:
            WorldError: If the file cannot be used.
        """
        if isinstance(self.world, Atlas):
            return self.world
        if isinstance(self.world, World):
            return _atlas_of(self.world)
        path = Path(self.world)
        edited = path.stat().st_mtime_ns if is_there(path) else 0
        return _atlas_named(self.world, edited)

    def _check_world(self) -> None:
        if isinstance(self.world, str):
            check_world_name(self.world)
        elif faults := kind_faults("world", self.world, (World, Atlas), _WORLD_FORM):
            raise WorldError("world", faults)

    def _check_goal(self) -> None:
        read_goal(self.goal)
        strange = sorted(set(self.goal) - set(GOAL_CHARACTERS))
        if strange:
            what = f"it has the characters {''.join(strange)!r:.60}"
            raise GoalError("goal", [Fault(what, "Latin letters, digits and punctuation")])


@lru_cache(maxsize=4)
def _atlas_named(name: str, edited: int) -> Atlas:  # noqa: ARG001 - a file that was edited is another world
    return Atlas(open_world(name))


@lru_cache(maxsize=4)
def _atlas_of(world: World) -> Atlas:
    return Atlas(world)
