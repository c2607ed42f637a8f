"""The route of a mission that is being written: Server-Sent Events, as `EventSource` in a browser reads them."""

import asyncio
import json
import time
from collections.abc import AsyncIterator

from fastapi import APIRouter, HTTPException, Request, Response
from fastapi.responses import StreamingResponse

from reasoned_explorer.viewer.live import LiveFeed

#: The file is looked at this often, seconds.
_POLL_S = 0.25
#: Whoever watches hears at least this often, seconds.
_ALIVE_S = 2.0
#: Who has lost us asks again after this, milliseconds.
_RETRY_MS = 1000
#: More do not watch at once.
_MOST_WATCHERS = 32
_HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}


def live_routes(feed: LiveFeed) -> APIRouter:
    """Return the route of a feed."""
    router = APIRouter()
    watching = 0

    @router.get("/api/live")
    async def live(request: Request) -> Response:
        if watching >= _MOST_WATCHERS:
            raise HTTPException(503, f"{_MOST_WATCHERS} are watching already", headers={"Retry-After": "5"})
        after = request.headers.get("last-event-id", "")
        return StreamingResponse(
            events(int(after) if after.isdecimal() and len(after) < 10 else 0),
            media_type="text/event-stream",
            headers=_HEADERS,
        )

    async def events(after: int) -> AsyncIterator[str]:
        nonlocal watching
        watching += 1
        try:
            reader = feed.reader(after=after)
            yield f"retry: {_RETRY_MS}\n\n"
            told_s = -_ALIVE_S
            while not feed.is_closed:
                for line in await asyncio.to_thread(reader.lines):
                    # Who reads slowly is waited for here, and nowhere else.
                    yield f"id: {line.number}\nevent: {line.kind}\ndata: {line.text}\n\n"
                if time.monotonic() - told_s >= _ALIVE_S:
                    told_s = time.monotonic()
                    age_s = await asyncio.to_thread(feed.age_s)
                    said = {"age_s": None if age_s is None else round(age_s, 1)}
                    yield f"event: alive\ndata: {json.dumps(said)}\n\n"
                await asyncio.sleep(_POLL_S)
        finally:
            watching -= 1

    return router
