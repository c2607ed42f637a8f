"""The mission that is to be exported, and what is there of it besides its record."""

import difflib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.evaluation.bench.store import NOTHING_FINISHED, STORE_NAME, RunStore
from reasoned_explorer.evaluation.picture_folder import PICTURES_NAME
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.evaluation.report.of_run import RunTraces
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import Fault, InputError, RecordError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.model.record import EpisodeRecord, MissionHeader, ViewRecord
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.opening import KEPT_SUFFIX, open_world
from reasoned_explorer.world.world import World

#: Beside a record, where ``rex run`` keeps the world that it used.
_WORLD_NAME = f"world{KEPT_SUFFIX}"


@dataclass(frozen=True, slots=True, eq=False)
class ExportedMission:
    """A mission, as it is written for other programs.

    Attributes:
        record: All that was kept of it; perhaps cut off.
        name: What it is called in its run; with the record it makes the name of what is written.
        world: Where it took place; None where none is known or it cannot be had any more.
        pictures: The folder of the pictures that were kept; None where there is none.
    """

    record: EpisodeRecord
    name: str
    world: World | None = None
    pictures: Path | None = None

    def picture(self, view: ViewRecord) -> bytes | None:
        """Return the PNG that was kept of a view, or None."""
        if self.pictures is None:
            return None
        # A picture that is gone or cannot be read is as good as one that was not kept.
        with suppress(OSError):
            return (self.pictures / f"{'-'.join(f'{number:04d}' for number in view.key)}.png").read_bytes()
        return None


@dataclass(frozen=True, slots=True)
class Choice:
    """Which mission of a benchmark is meant; what is None need not be said where only one is left.

    Attributes:
        mission_id: Of the episode, as in the column ``mission_id`` of results.
        method: The planner as it was named when the benchmark was started.
        vehicle: The vehicle's profile.
    """

    mission_id: str | None = None
    method: str | None = None
    vehicle: str | None = None

    @property
    def given(self) -> dict[str, str]:
        """What is said, by the options that say it."""
        options = {"--mission": self.mission_id, "--planner": self.method, "--vehicle": self.vehicle}
        return {name: value for name, value in options.items() if value is not None}


def find_mission(
    place: Path,
    choice: Choice | None = None,
    *,
    world: str | None = None,
    bbox: tuple[float, float, float, float] | None = None,
) -> ExportedMission:
    """Return the mission that a person means.

    Args:
        place: The folder of a mission that ``rex run`` made, its record, or the folder of a run of ``rex bench``.
        choice: Which mission of a benchmark.
        world: Where the mission took place, as `open_world` takes it; by default what lies beside the record, what the
            record names or, of a benchmark, what its plan names.
        bbox: lon0, lat0, lon1, lat1 in degrees that ``world``, an OpenStreetMap file, was cropped to.

    Raises:
        RecordError: If there is no such mission, several are meant, or its record was not kept or cannot be read.
        WorldError: If the world that is named is another one.
        InputError: If the world that is named cannot be opened.
    """
    choice = choice or Choice()
    if is_there(place / STORE_NAME):
        found = _of_bench(place, choice, look_for_world=world is None)
    else:
        if choice.given:
            fault = Fault(f"{' and '.join(choice.given)} for {place}", f"a run of rex bench, with a {STORE_NAME}")
            raise RecordError("export", [fault])
        found = _of_folder(place, look_for_world=world is None)
    if world is None:
        return found
    return ExportedMission(found.record, found.name, _given_world(found.record, world, bbox), found.pictures)


def _of_folder(place: Path, *, look_for_world: bool) -> ExportedMission:
    record = read_record(place)
    folder = place if place.is_dir() else place.parent
    pictures = folder / PICTURES_NAME
    world = _world_beside(record.header, folder) if look_for_world else None
    return ExportedMission(record, folder.absolute().name, world, pictures if pictures.is_dir() else None)


def _world_beside(header: MissionHeader, folder: Path) -> World | None:
    """Return a record's world from the file beside it, or made again by its name; None where neither is possible."""
    if not header.is_judged:
        return None
    for spec in (str(folder / _WORLD_NAME), header.world):
        # Whatever the reason, a mission can be shown without its ground.
        with suppress(InputError):
            world = open_world(spec)
            if world_digest(world) == header.world_digest:
                return world
    return None


def _given_world(record: EpisodeRecord, spec: str, bbox: tuple[float, float, float, float] | None) -> World:
    subject = f"--world {spec}"
    if not record.header.is_judged:
        fault = Fault("the mission knew no world", "a mission that took place in a world", "leave it out")
        raise RecordError(subject, [fault])
    world = open_world(spec, bbox=bbox)
    if world_digest(world) != record.header.world_digest:
        remedy = "give the file and --bbox that the mission was run with"
        fault = Fault("it is not the world of the mission", f"{record.header.world!r} as it was then", remedy)
        raise RecordError(subject, [fault])
    return world


def _of_bench(folder: Path, choice: Choice, *, look_for_world: bool) -> ExportedMission:
    with RunStore.read(folder) as store:
        row = _the_one(list(store.rows(vehicle=choice.vehicle, method=choice.method)), store, choice)
        record = store.record(row)
        name = f"{row.score.vehicle}/{row.method}/{row.mission_id}"
        if record is None:
            fault = Fault(f"the record of {name} was not kept", "a run made without --no-traces")
            raise RecordError("export", [fault])
        return ExportedMission(record, name, RunTraces(store).world(row) if look_for_world else None)


def _the_one(rows: Sequence[MissionRow], store: RunStore, choice: Choice) -> MissionRow:
    """Return the only row that is meant.

    Raises:
        RecordError: If there is none, or more than one.
    """
    meant = [row for row in rows if choice.mission_id in {None, row.mission_id}]
    if len(meant) == 1:
        return meant[0]
    if meant:
        raise RecordError("export", [_too_many(meant)])
    every = list(store.rows())
    if not every:
        raise RecordError("run", [NOTHING_FINISHED])
    names = {
        "--mission": sorted({row.mission_id for row in every}),
        "--planner": sorted({row.method for row in every}),
        "--vehicle": sorted({row.score.vehicle for row in every}),
    }
    faults = [
        _unknown(option, value, names[option]) for option, value in choice.given.items() if value not in names[option]
    ]
    given = ", ".join(f"{option} {value}" for option, value in choice.given.items())
    raise RecordError("export", faults or [Fault(f"no finished mission has {given}", "one that is finished")])


def _too_many(rows: Sequence[MissionRow]) -> Fault:
    kinds = {
        "--mission": {row.mission_id for row in rows},
        "--planner": {row.method for row in rows},
        "--vehicle": {row.score.vehicle for row in rows},
    }
    open_ = [f"{option} {min(values)}" for option, values in kinds.items() if len(values) > 1]
    return Fault(f"{len(rows):,} missions are meant", "one", f"say which, e.g. {' '.join(open_)}")


def _unknown(option: str, value: str, known: Sequence[str]) -> Fault:
    near = difflib.get_close_matches(value, known, n=3, cutoff=0.4)
    listed = ", ".join(known) if len(known) <= 12 else f"one of {len(known)}, such as {known[0]}"
    return Fault(f"{option} {value}", listed, f"did you mean {' or '.join(near)}?" if near else "")
