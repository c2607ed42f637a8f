"""Routes of one mission: its replay, the map of its world, and the pictures of its views."""

import asyncio
from collections import OrderedDict
from hashlib import blake2b
from pathlib import Path
from threading import Lock

from fastapi import APIRouter, HTTPException, Query, Request, Response

from reasoned_explorer.evaluation.record_file import RECORD_NAME, parse_record
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.ids import checked_id, tagged
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.replay import replay_json
from reasoned_explorer.viewer.runs import MissionFiles
from reasoned_explorer.viewer.views import WIDTH_RANGE_PX, Encoding, Views
from reasoned_explorer.viewer.world_map import box_of, map_json, map_tag
from reasoned_explorer.viewer.worlds import Worlds

_JSON = "application/json"
#: Records that were read last; to read a long one takes a few tenths of a second.
_MOST_RECORDS = 6
_MOST_REPLAYS = 4


class Desk:
    """Where missions of a library are opened, with what was read of the last few; safe to use from several threads.

    Args:
        library: Whose missions.
    """

    def __init__(self, library: Library) -> None:
        self.library = library
        self.worlds = Worlds()
        self.views = Views(self.worlds)
        self._records: OrderedDict[bytes, EpisodeRecord] = OrderedDict()
        self._replays: OrderedDict[bytes, bytes] = OrderedDict()
        self._lock = Lock()

    def files(self, run: str, mission: str) -> MissionFiles:
        """Return a mission by its ids.

        Raises:
            InputError: If there is none, or it has no record.
        """
        return self.library.run(checked_id(run)).mission(checked_id(mission))

    def record(self, files: MissionFiles) -> EpisodeRecord:
        """Return the record of a mission.

        Raises:
            RecordError: If it is broken.
        """
        key = blake2b(files.record, digest_size=16).digest()
        with self._lock:
            if key in self._records:
                self._records.move_to_end(key)
                return self._records[key]
        record = parse_record(files.record, Path(RECORD_NAME))
        with self._lock:
            self._records[key] = record
            while len(self._records) > _MOST_RECORDS:
                self._records.popitem(last=False)
        return record

    def replay(self, files: MissionFiles) -> bytes:
        """Return the replay of a mission as the page reads it.

        Raises:
            RecordError: If its record is broken.
        """
        record = self.record(files)
        pictures = self.views.state(files, record.header)
        key = blake2b(f"{files.id} {files.name} {pictures} ".encode() + files.record, digest_size=16).digest()
        with self._lock:
            if key in self._replays:
                return self._replays[key]
        replay = replay_json(files, record, pictures=pictures)
        with self._lock:
            self._replays[key] = replay
            while len(self._replays) > _MOST_REPLAYS:
                self._replays.popitem(last=False)
        return replay


def mission_routes(desk: Desk) -> APIRouter:
    """Return the routes of one mission."""
    router = APIRouter(prefix="/api/runs/{run}/missions/{mission}")
    drawing = asyncio.Lock()

    # Plain functions run in threads of their own: they read disks, and make worlds.
    @router.get("")
    def replay(run: str, mission: str) -> Response:
        return Response(desk.replay(desk.files(run, mission)), media_type=_JSON)

    @router.get("/map")
    def world_map(run: str, mission: str, request: Request) -> Response:
        files = desk.files(run, mission)
        record = desk.record(files)
        atlas = desk.worlds.of(files, record.header)
        if atlas is None:
            raise HTTPException(404, "the world of this mission is not known, or cannot be found any more")
        box = box_of(record, atlas.world)
        return tagged(request, map_tag(atlas.digest, box), lambda: map_json(atlas.world, box), _JSON)

    @router.get("/views/{step}/{index}.png")
    async def view(  # noqa: PLR0917 - the parts of its address
        run: str,
        mission: str,
        step: int,
        index: int,
        request: Request,
        width: int | None = Query(None, ge=WIDTH_RANGE_PX[0], le=WIDTH_RANGE_PX[1]),
    ) -> Response:
        # Whoever says how wide wants to look, not to measure: where the browser can, few bytes of it are sent.
        encoding: Encoding = "WEBP" if width and "image/webp" in request.headers.get("accept", "") else "PNG"

        def picture() -> bytes | None:
            files = desk.files(run, mission)
            return desk.views.picture(files, desk.record(files), step, index, width_px=width, encoding=encoding)

        # One at a time, and none for somebody who has scrolled on meanwhile.
        async with drawing:
            if await request.is_disconnected():
                raise HTTPException(503, "nobody waits for this picture any more")
            data = await asyncio.to_thread(picture)
        if data is None:
            raise HTTPException(404, "there is no picture of this view, and none can be drawn")
        headers = {"Cache-Control": "private, max-age=300", "Vary": "Accept"}
        return Response(data, media_type=f"image/{encoding.lower()}", headers=headers)

    return router
