"""What a benchmark runs: a split, methods, and who does what; written down before the first mission starts.

The plan decides every mission of the run. It is kept in the run's store, so that a run that was killed goes on with the
very same missions, and so that two runs can be held against each other.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from typing import Any

from reasoned_explorer.evaluation.methods import Method, method, models_called
from reasoned_explorer.evaluation.mission_settings import MissionSettings, errors_of
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Fault, Gathering, InputError, SettingsError
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.task.split import Split, SplitEpisode
from reasoned_explorer.vehicles.registry import vehicle_profile

#: Changes whenever the same plan would be run differently.
PLAN_VERSION = 1


@dataclass(frozen=True, slots=True)
class Task:
    """One mission of a run.

    Attributes:
        vehicle: Name of the profile.
        method: Name of the method.
        mission_id: Episode and repetition; the same for all methods and vehicles.
        episode: Place in the split's list of episodes.
        seed: With 0 the mission draws what its episode says; any other seed makes other draws on the same mission.
    """

    vehicle: str
    method: str
    mission_id: str
    episode: int
    seed: int

    @property
    def key(self) -> tuple[str, str, str]:
        """What a store knows it by."""
        return self.vehicle, self.method, self.mission_id


@dataclass(frozen=True)
class BenchPlan:
    """What a benchmark runs.

    Attributes:
        split: The episodes.
        methods: Names, in the order of the table's rows.
        vehicles: Names of profiles; each has a table of its own.
        base: Who does what where a method does not say otherwise; planner, seed and vehicle in it do not count.
        seeds: Each episode is run once with each of these; see `Task.seed`.
        keep_traces: Whether the record of each mission is kept.
    """

    split: Split
    methods: tuple[str, ...]
    vehicles: tuple[str, ...] = ("drone",)
    base: MissionSettings = field(default_factory=MissionSettings)
    seeds: tuple[int, ...] = (0,)
    keep_traces: bool = True

    def __post_init__(self) -> None:
        """Check every name and number, so that nothing is found out in the middle of a run.

        Raises:
            InputError: With everything that is wrong.
        """
        found = Gathering()
        for vehicle in self.vehicles:
            found.check(partial(vehicle_profile, vehicle))
        # Of the base, what the methods and the plan decide does not count.
        own = MissionSettings()
        plain = replace(
            self.base, planner=own.planner, planner_settings={}, vehicle=own.vehicle, seed=own.seed, agent=own.agent
        )
        found.add(*errors_of(plain))
        for name in self.methods:
            chosen = found.take(partial(method, name), None)
            if chosen is not None:
                found.add(*errors_of(chosen.settings(plain)))
        faults = found.faults
        seeds = tuple(str(seed) for seed in self.seeds)
        for what, listed in (("planners", self.methods), ("vehicles", self.vehicles), ("seeds", seeds)):
            if not listed or len(set(listed)) < len(listed):
                faults.append(Fault(f"{what} are {', '.join(listed) or 'none'}", "at least one, each once"))
        if any(not 0 <= seed < 1 << 63 for seed in self.seeds):
            faults.append(Fault(f"seeds are {', '.join(seeds)}", "whole numbers from 0 to 2^63 - 1"))
        if faults:
            raise SettingsError("benchmark", faults)

    def tasks(self) -> Iterator[Task]:
        """Return every mission, those of one place together: a worker that has its world goes on with it."""
        by_place: dict[str, list[int]] = {}
        for index, item in enumerate(self.split.episodes):
            by_place.setdefault(item.place, []).append(index)
        for indices in by_place.values():
            for vehicle in self.vehicles:
                for name in self.methods:
                    for seed in self.seeds:
                        for index in indices:
                            yield Task(vehicle, name, self.mission_id(index, seed), index, seed)

    @property
    def count(self) -> int:
        """How many missions there are."""
        return len(self.split.episodes) * len(self.methods) * len(self.vehicles) * len(self.seeds)

    def mission_id(self, index: int, seed: int) -> str:
        """Return what an episode with a seed is known by."""
        name = self.split.episodes[index].episode.id
        return name if seed == 0 else f"{name}/seed{seed}"

    def fingerprints(self) -> dict[str, str]:
        """Return for each mission id what decides the mission itself: its world, goal, start, seed and limits.

        Missions of two runs are the same where these are; who does what in them is another matter (`differences`).
        """
        return {
            self.mission_id(index, seed): self._fingerprint(index, seed)
            for index in range(len(self.split.episodes))
            for seed in self.seeds
        }

    def _fingerprint(self, index: int, seed: int) -> str:
        item = self.split.episodes[index]
        plain = {**item.episode.as_dict(), "world_digest": self.split.world_digests[item.place]}
        plain.pop("reference_length_m")  # follows from the rest
        said = json.dumps({**plain, "again": seed}, sort_keys=True, allow_nan=False)
        return hashlib.sha256(said.encode()).hexdigest()

    def differences(self, other: "BenchPlan") -> list[str]:
        """Return in words what else two plans have their missions do differently: minds, captions, times, limits."""
        mine, its = self.as_dict()["base"], other.as_dict()["base"]
        lines = [(name, mine[name], its[name]) for name in mine if name != "explorer"]
        lines += [(name, mine["explorer"][name], its["explorer"][name]) for name in mine["explorer"]]
        return [f"{name}: {one} / {another}" for name, one, another in lines if one != another]

    def episode_of(self, task: Task) -> SplitEpisode:
        """Return a mission's episode."""
        return self.split.episodes[task.episode]

    def settings_of(self, task: Task) -> MissionSettings:
        """Return who does what in a mission."""
        episode = self.episode_of(task).episode
        seed = episode.seed if task.seed == 0 else key_of(episode.seed, "again", task.seed)
        # 63 bits, so that a database's whole numbers hold it.
        base = replace(self.base, vehicle=task.vehicle, seed=seed >> 1)
        return self.method_of(task).settings(base)

    def method_of(self, task: Task) -> Method:
        """Return a mission's method."""
        return self._methods[task.method]

    @cached_property
    def _methods(self) -> dict[str, Method]:
        return {name: method(name) for name in self.methods}

    @property
    def digest(self) -> str:
        """SHA-256 over all that decides the rows, hexadecimal."""
        plain = self.as_dict()
        plain["split"] = self.split.digest
        plain.pop("keep_traces")
        return hashlib.sha256(json.dumps(plain, sort_keys=True, allow_nan=False).encode()).hexdigest()

    def digest_of(self, task: Task) -> str:
        """SHA-256 over all that decides one mission, hexadecimal; other methods and missions of the run do not."""
        plain = {"version": PLAN_VERSION, "task": asdict(task), "settings": asdict(self.settings_of(task))}
        plain["mission"] = self._fingerprint(task.episode, task.seed)
        return hashlib.sha256(json.dumps(plain, sort_keys=True, allow_nan=False).encode()).hexdigest()

    @property
    def models(self) -> tuple[str, ...]:
        """The models that its missions call, each once."""
        return models_called(self.methods, self.base)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for a file."""
        base = asdict(self.base)
        for own in ("planner", "planner_settings", "agent", "vehicle", "seed"):
            base.pop(own)
        return {
            "version": PLAN_VERSION,
            "split": self.split.as_dict(),
            "methods": list(self.methods),
            "vehicles": list(self.vehicles),
            "base": base,
            "seeds": list(self.seeds),
            "keep_traces": self.keep_traces,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "BenchPlan":
        """Return the plan of `as_dict`.

        Raises:
            InputError: If it is no plan, or of another version.
        """
        if data.get("version") != PLAN_VERSION:
            fault = Fault(f"a plan of version {data.get('version')!r}", f"version {PLAN_VERSION}", "start a new run")
            raise InputError("benchmark", [fault])
        try:
            base = dict(data["base"])
            base["explorer"] = ExplorerSettings(**base["explorer"])
            return cls(
                split=Split.from_dict(data["split"]),
                methods=tuple(data["methods"]),
                vehicles=tuple(data["vehicles"]),
                base=MissionSettings(**base),
                seeds=tuple(data["seeds"]),
                keep_traces=bool(data["keep_traces"]),
            )
        except (KeyError, TypeError) as error:
            fault = Fault(f"{type(error).__name__}: {error}", "a plan as BenchPlan.as_dict writes it")
            raise InputError("benchmark", [fault]) from error


def longer(plan: BenchPlan, methods: Sequence[str]) -> BenchPlan:
    """Return a plan with more methods behind those that it has.

    Raises:
        InputError: If a method cannot be run.
    """
    return replace(plan, methods=(*plan.methods, *(name for name in methods if name not in plan.methods)))
