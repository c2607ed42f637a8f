"""A mission that can be posed again: where, what, from where."""

import math
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, Goal, InputError
from reasoned_explorer.task.goal_spec import GoalSpec
from reasoned_explorer.task.reading import read_goal

#: The paper's limit (section V-A): 30 minutes.
TIME_LIMIT_S = 1800.0


@dataclass(frozen=True, slots=True)
class Episode:
    """One mission.

    Attributes:
        id: Unique in its split, e.g. ``"park:7/L2/bench-under-tree/0"``.
        world: The name that the world is made or opened by.
        spec: What the goal truly asks for; the robot gets `goal` only.
        start: Where it starts, and which way it faces.
        seed: Of the mission's own draws.
        reference_length_m: The shortest compliant way to success, metres; infinity where none is known.
        time_limit_s: T_max, seconds.
        success_radius_m: Metres.
    """

    id: str
    world: str
    spec: GoalSpec
    start: Pose
    seed: int
    reference_length_m: float
    time_limit_s: float = TIME_LIMIT_S
    success_radius_m: float = 15.0

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            InputError: With everything that is wrong.
        """
        numbers = {
            "start.x_m": self.start.x_m,
            "start.y_m": self.start.y_m,
            "start.z_m": self.start.z_m,
            "start.heading_rad": self.start.heading_rad,
        }
        faults = [Fault(f"{k} is {v}", "a finite number") for k, v in numbers.items() if not math.isfinite(v)]
        if not self.reference_length_m >= 0.0:
            faults.append(Fault(f"reference_length_m is {self.reference_length_m}", "0 or more"))
        for name, value in (("time_limit_s", self.time_limit_s), ("success_radius_m", self.success_radius_m)):
            if not (math.isfinite(value) and value > 0.0):
                faults.append(Fault(f"{name} is {value}", "a finite number above 0"))
        if faults:
            raise InputError(f"episode {self.id!r}", faults)

    @property
    def goal(self) -> Goal:
        """The sentence, as the robot gets it."""
        return self.spec.goal

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for a file; an infinite reference length becomes None."""
        return {
            "id": self.id,
            "world": self.world,
            "goal": self.spec.text,
            "level": self.spec.level,
            "start": [self.start.x_m, self.start.y_m, self.start.z_m, self.start.heading_rad],
            "seed": self.seed,
            "reference_length_m": self.reference_length_m if math.isfinite(self.reference_length_m) else None,
            "time_limit_s": self.time_limit_s,
            "success_radius_m": self.success_radius_m,
        }

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> "Episode":
        """Return the episode of `as_dict`; the goal is read again from its sentence.

        Raises:
            InputError: If an entry is missing or of the wrong type, with all of these.
            GoalError: If the goal cannot be read.
        """
        kinds: dict[str, type | tuple[type, ...]] = {
            "id": str,
            "world": str,
            "goal": str,
            "start": list,
            "seed": int,
            "reference_length_m": (int, float, type(None)),
            "time_limit_s": (int, float),
            "success_radius_m": (int, float),
        }
        faults = [
            Fault(f"{key} is {data.get(key)!r:.60}", "an entry as `as_dict` writes it")
            for key, kind in kinds.items()
            if key not in data or not isinstance(data[key], kind)
        ]
        start = data.get("start")
        if isinstance(start, list) and not (len(start) == 4 and all(isinstance(v, (int, float)) for v in start)):
            faults.append(Fault(f"start is {start!r:.60}", "x_m, y_m, z_m, heading_rad"))
        if faults:
            raise InputError("episode", faults)
        length = data["reference_length_m"]
        return cls(
            id=data["id"],
            world=data["world"],
            spec=read_goal(data["goal"]),
            start=Pose(*(float(v) for v in data["start"])),
            seed=data["seed"],
            reference_length_m=math.inf if length is None else float(length),
            time_limit_s=float(data["time_limit_s"]),
            success_radius_m=float(data["success_radius_m"]),
        )
