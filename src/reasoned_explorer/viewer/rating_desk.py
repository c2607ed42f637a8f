"""Where raters are given missions of a run, one after the other, and their answers are taken."""

import io
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import Any

from PIL import Image

from reasoned_explorer import __version__
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.ratings import Answer, MissionKey, Rating, RatingStore, rater_name
from reasoned_explorer.evaluation.record_file import parse_record
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, InputError, PartError, RecordError
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.bench_runs import unpacked
from reasoned_explorer.viewer.rating_order import Rateable, item_ids, order_for
from reasoned_explorer.viewer.rating_view import blind_map, blind_view, end_of, last_captions, outlooks
from reasoned_explorer.viewer.runs import MissionFiles, UnknownIdError
from reasoned_explorer.viewer.security import within
from reasoned_explorer.viewer.views import camera_of
from reasoned_explorer.viewer.worlds import Worlds

#: Pixels across a picture that a rater is shown.
SIDE_PX = 448
#: So many pictures and missions are kept at hand: those of a few missions, this one and the next.
_MOST_PICTURES, _MOST_MISSIONS = 64, 8


@dataclass(frozen=True, slots=True)
class Choice:
    """Which missions of a run are rated.

    Attributes:
        methods: Only these; empty for all.
        levels: Only these; empty for all.
        count: At most so many, the same for all raters; None for all.
        declared: Only those in which the robot said that it had found something: without that none is a success.
    """

    methods: tuple[str, ...] = ()
    levels: tuple[int, ...] = ()
    count: int | None = None
    declared: bool = False

    def takes(self, method: str, level: int, *, declared: bool) -> bool:
        """Return whether a mission is rated."""
        return (
            (not self.methods or method in self.methods)
            and (not self.levels or level in self.levels)
            and (declared or not self.declared)
        )


@dataclass(frozen=True, slots=True)
class _Opened:
    """A mission whose record was read."""

    files: MissionFiles
    record: EpisodeRecord


class RatingDesk:
    """Gives raters missions and takes their answers; safe to use from several threads.

    Args:
        store: Takes the answers; of the run whose missions are rated.
        now: Tells the time, UTC.
        secret: What the run's missions are named by on the page, where it has no secret for that yet.
        seed: Of the order.
        choice: Which missions.

    Raises:
        InputError: If there is no such mission, or none of them has a record.
    """

    def __init__(
        self,
        store: RatingStore,
        *,
        now: Callable[[], datetime],
        secret: bytes,
        seed: int = 0,
        choice: Choice | None = None,
    ) -> None:
        self._store, self._now, self.seed, self.choice = store, now, seed, choice or Choice()
        self._root = store.folder.resolve()
        self._places: dict[MissionKey, str] = {}
        #: How many missions cannot be shown, since their records were not kept.
        self.left_out = 0
        with RunStore.read(store.folder) as run:
            self._split = run.plan.split
            self._missions = tuple(self._rateable(run))
        self._ids = item_ids([mission.key for mission in self._missions], store.secret("rating_key", secret))
        self._names = {key: name for name, key in self._ids.items()}
        self._worlds = Worlds()
        self._opened: OrderedDict[MissionKey, _Opened] = OrderedDict()
        self._pictures: OrderedDict[tuple[MissionKey, int], bytes] = OrderedDict()
        self._lock, self._drawing = Lock(), Lock()
        self._order = lru_cache(maxsize=64)(self._order_for)

    def _rateable(self, run: RunStore) -> list[Rateable]:
        """Return what can be rated.

        Raises:
            InputError: If that is nothing.
        """
        found, chosen = [], 0
        for vehicle, method, mission_id, figures in run.figures(("score.level", "declared", "place")):
            if figures is None or not self.choice.takes(method, figures[0], declared=bool(figures[1])):
                continue
            chosen += 1
            key = (vehicle, method, mission_id)
            if within(self._root, run.trace_path(*key)) is None:
                self.left_out += 1
                continue
            self._places[key] = str(figures[2])
            found.append(Rateable(key, int(figures[0])))
        if not found:
            what = f"none of {chosen} missions has a record" if chosen else "no mission is chosen"
            expected = "a run with records (rex bench --traces)" if chosen else "methods and levels that the run has"
            raise InputError("missions to rate", [Fault(what, expected)])
        return found

    @property
    def count(self) -> int:
        """How many missions each rater is given."""
        return len(self._missions) if self.choice.count is None else min(self.choice.count, len(self._missions))

    def items(self, rater: str) -> list[str]:
        """Return the names of the missions that a rater is given, in order.

        Raises:
            InputError: If that is no name of a rater.
        """
        return list(self._order(rater_name(rater)))

    def rated(self, rater: str) -> set[str]:
        """Return the names of the missions that a rater has rated already.

        Raises:
            InputError: If that is no name of a rater.
        """
        return {self._names[key] for key in self._store.rated_by(rater_name(rater)) if key in self._names}

    def view(self, item: str, rater: str) -> dict[str, Any]:
        """Return what a rater is shown of a mission, and what they said of it before.

        Raises:
            UnknownIdError: If there is no such mission.
            InputError: If that is no name of a rater, or the record is broken.
        """
        opened = self._open(item)
        said = self._store.latest_of(rater_name(rater), self._key(item))
        atlas, end = self._worlds.of(opened.files, opened.record.header), end_of(opened.record)
        pictures = atlas is not None and atlas.world.bounds.contains(end.x_m, end.y_m)
        looks = outlooks(opened.record, camera_of(opened.record.header)) if pictures else []
        return {
            "item": item,
            **blind_view(opened.record),
            "pictures": [look.label for look in looks],
            "captions": [] if pictures else last_captions(opened.record),
            "mine": None
            if said is None
            else {"answer": said.answer.value, "how_well": said.how_well, "comment": said.comment},
        }

    def map(self, item: str) -> dict[str, Any] | None:
        """Return the map of a mission; None where its world cannot be had.

        Raises:
            UnknownIdError: If there is no such mission.
        """
        opened = self._open(item)
        atlas = self._worlds.of(opened.files, opened.record.header)
        return None if atlas is None else blind_map(opened.record, atlas.world)

    def picture(self, item: str, place: int) -> bytes | None:
        """Return one of the pictures all round the end, PNG; None where its world cannot be had.

        Raises:
            UnknownIdError: If there is no such mission or picture.
        """
        key, opened = self._key(item), self._open(item)
        header = opened.record.header
        looks = outlooks(opened.record, camera_of(header))
        if not 0 <= place < len(looks):
            raise UnknownIdError("picture", [Fault("there is no such picture", f"0 to {len(looks) - 1}")])
        # One at a time: who asks for the same waits for one drawing of it.
        with self._drawing:
            if (key, place) not in self._pictures:
                drawn = self._draw(opened, looks[place].pose)
                if drawn is None:
                    return None
                self._pictures[key, place] = drawn
                while len(self._pictures) > _MOST_PICTURES:
                    self._pictures.popitem(last=False)
            return self._pictures[key, place]

    def take(self, item: str, rater: str, answer: Answer, how_well: int, comment: str) -> Rating:
        """Take an answer; when this returns, it is on the disk.

        Raises:
            UnknownIdError: If there is no such mission.
            InputError: If something of it cannot be kept, with everything that is wrong.
            RecordWriteError: If the run cannot be written.
        """
        # Whole milliseconds, as they are kept.
        now = self._now()
        at = now.replace(microsecond=now.microsecond // 1000 * 1000)
        comment = comment.replace("\r\n", "\n").strip()
        said = Rating(rater_name(rater), *self._key(item), answer, how_well, comment, at, __version__)
        self._store.add(said)
        return said

    def _order_for(self, rater: str) -> tuple[str, ...]:
        order = order_for(rater, self._missions, seed=self.seed, count=self.choice.count)
        return tuple(self._names[mission.key] for mission in order)

    def _key(self, item: str) -> MissionKey:
        """Return the mission that a name on the page stands for.

        Raises:
            UnknownIdError: If there is none.
        """
        if item not in self._ids:
            raise UnknownIdError("mission", [Fault("there is no such mission to rate", "one of those that were given")])
        return self._ids[item]

    def _open(self, item: str) -> _Opened:
        key = self._key(item)
        with self._lock:
            if key in self._opened:
                self._opened.move_to_end(key)
                return self._opened[key]
        with RunStore.read(self._store.folder) as run:
            path = within(self._root, run.trace_path(*key))
        if path is None:
            raise RecordError("record", [Fault("the record of this mission is gone", "a run that is whole")])
        data = unpacked(path)
        place = self._split.place(self._places[key])
        opened = _Opened(MissionFiles(item, "", data, place=place), parse_record(data, Path(path.name)))
        with self._lock:
            self._opened[key] = opened
            while len(self._opened) > _MOST_MISSIONS:
                self._opened.popitem(last=False)
        return opened

    def _draw(self, opened: _Opened, pose: Pose) -> bytes | None:
        header = opened.record.header
        atlas = self._worlds.of(opened.files, header)
        if atlas is None or not atlas.world.bounds.contains(pose.x_m, pose.y_m):
            return None
        # The renderer is loaded when a picture is drawn, not before.
        from reasoned_explorer.simulation.painter import Painter

        try:
            conditions = str(header.settings.get("conditions", "clear"))
            pixels = Painter(atlas, side_px=SIDE_PX, conditions=conditions).paint(pose, camera_of(header))
        except (InputError, PartError):
            return None  # conditions that this version does not know, say
        file = io.BytesIO()
        Image.fromarray(pixels).save(file, "PNG", compress_level=3)
        return file.getvalue()
