"""What the library shows: runs, and the missions in them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from reasoned_explorer.model import InputError
from reasoned_explorer.task.split import Place
from reasoned_explorer.viewer.listing import Listing


class UnknownIdError(InputError):
    """An id that nothing in the library has."""


@dataclass(frozen=True, slots=True)
class MissionFiles:
    """A mission, and where what is kept of it lies.

    Attributes:
        id: In its run.
        name: For people.
        record: Its record as it was written; perhaps cut off.
        pictures: The folder of the pictures that were kept, or None.
        world: A kept world beside the record, or None.
        method: Of the benchmark; the planner's name elsewhere.
        pair_key: The same for missions that can be compared: those of one episode.
        place: Of the benchmark's split: where its world comes from.
    """

    id: str
    name: str
    record: bytes = field(repr=False)
    pictures: Path | None = None
    world: Path | None = None
    method: str = ""
    pair_key: str = ""
    place: Place | None = None


class Run(Protocol):
    """Missions that are shown together."""

    @property
    def id(self) -> str:
        """Made by the library."""
        ...

    @property
    def name(self) -> str:
        """For people: where it lies in the library's folder."""
        ...

    @property
    def kind(self) -> str:
        """``bench``, ``mission`` or ``missions``."""
        ...

    @property
    def folder(self) -> Path:
        """Where it lies."""
        ...

    def about(self) -> Mapping[str, Any]:
        """Return what the list of runs says of it: id, name, kind, missions, methods, made_by, perhaps fault."""
        ...

    def listing(self) -> Listing:
        """Return its missions.

        Raises:
            InputError: If it cannot be read.
            PartError: If the disk fails.
        """
        ...

    def listing_json(self) -> bytes:
        """Return the listing as the page reads it.

        Raises:
            InputError: If it cannot be read.
            PartError: If the disk fails.
        """
        ...

    def mission(self, mission_id: str) -> MissionFiles:
        """Return a mission.

        Raises:
            InputError: If there is none, it has no record, or that cannot be read.
        """
        ...
