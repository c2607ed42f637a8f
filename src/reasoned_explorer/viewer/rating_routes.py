"""The application on which people rate missions: what is asked for under which address.

Nothing else of a run is served beside it: a rater who could open the list of missions would not be blind any more.
"""

import asyncio
from typing import Any, Literal

from fastapi import APIRouter, FastAPI, HTTPException, Query, Request, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, ConfigDict, Field

from reasoned_explorer import __version__
from reasoned_explorer.evaluation.ratings import (
    BEST,
    LONGEST_COMMENT,
    LONGEST_NAME,
    QUESTION,
    QUESTION_TEXT,
    WORST,
    Answer,
    rater_name,
)
from reasoned_explorer.viewer.app import add_error_answers, page_routes
from reasoned_explorer.viewer.ids import checked_id
from reasoned_explorer.viewer.rating_desk import RatingDesk
from reasoned_explorer.viewer.security import Guard

_Rater = Query(max_length=4 * LONGEST_NAME)


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Name(_Strict):
    name: str = Field(max_length=4 * LONGEST_NAME)


class _Said(_Strict):
    rater: str = Field(max_length=4 * LONGEST_NAME)
    answer: Literal["yes", "partly", "no"]
    how_well: int = Field(ge=WORST, le=BEST)
    comment: str = Field("", max_length=LONGEST_COMMENT)


def create_rating_app(desk: RatingDesk, *, guard: Guard, rater: str | None = None) -> FastAPI:
    """Return the application.

    It answers everybody: hand a server ``guard.protects(app)``.

    Args:
        desk: Gives missions and takes answers.
        guard: Whose secret the page may read.
        rater: The one person who rates; None where the page asks for a name.
    """
    app = FastAPI(title="reasoned-explorer", docs_url=None, redoc_url=None, openapi_url=None, redirect_slashes=False)
    add_error_answers(app)
    app.include_router(rating_routes(desk, guard=guard, rater=rater))

    @app.get("/", include_in_schema=False)
    def home() -> Response:
        return RedirectResponse("/pages/rate.html", 303)

    @app.get("/rate", include_in_schema=False)
    def page() -> Response:
        return RedirectResponse("/pages/rate.html", 303)

    app.include_router(page_routes())
    return app


def rating_routes(desk: RatingDesk, *, guard: Guard, rater: str | None = None) -> APIRouter:
    """Return the routes of the rating page; see `create_rating_app`."""
    router = APIRouter()

    @router.get("/api/csrf")
    def csrf() -> dict[str, str]:
        return {"token": guard.csrf}

    @router.get("/api/rate/about")
    def about() -> dict[str, Any]:
        return {
            "version": __version__,
            "question": QUESTION_TEXT,
            "question_number": QUESTION,
            "rater": rater,
            "missions": desk.count,
            "left_out": desk.left_out,
            "longest_comment": LONGEST_COMMENT,
            "longest_name": LONGEST_NAME,
        }

    router.include_router(_rater_routes(desk, rater))
    router.include_router(_world_routes(desk))
    return router


def _rater_routes(desk: RatingDesk, rater: str | None) -> APIRouter:
    """Return what hangs on who asks. Plain functions run in threads of their own: they read disks."""
    router = APIRouter(prefix="/api/rate")

    def allowed(name: str) -> str:
        """Return a rater's name; where the command named one, nobody else rates."""
        tidy = rater_name(name)
        if rater is not None and tidy != rater:
            raise HTTPException(403, "this page was opened for somebody else")
        return tidy

    @router.post("/rater")
    def rater_is(given: _Name) -> dict[str, Any]:
        return _progress(desk, allowed(given.name))

    @router.get("/items")
    def items(rater: str = _Rater) -> dict[str, Any]:
        return _progress(desk, allowed(rater))

    @router.get("/next")
    def next_item(rater: str = _Rater) -> dict[str, Any]:
        found = _progress(desk, allowed(rater))
        rated = found["rated"]
        place = rated.index(0) if 0 in rated else None
        return {"item": None if place is None else found["items"][place], "place": place, "of": len(rated)}

    @router.get("/items/{item}")
    def one_item(item: str, rater: str = _Rater) -> dict[str, Any]:
        return desk.view(checked_id(item), allowed(rater))

    @router.put("/items/{item}")
    @router.post("/items/{item}")
    def take(item: str, said: _Said) -> dict[str, Any]:
        kept = desk.take(checked_id(item), allowed(said.rater), Answer(said.answer), said.how_well, said.comment)
        return {"saved": True, "at": kept.at.isoformat(), "item": item, "rated": len(desk.rated(kept.rater))}

    return router


def _world_routes(desk: RatingDesk) -> APIRouter:
    """Return what shows where a mission ended, the same for everybody."""
    router = APIRouter(prefix="/api/rate/items/{item}")
    drawing = asyncio.Lock()

    @router.get("/map")
    def world_map(item: str) -> dict[str, Any]:
        found = desk.map(checked_id(item))
        if found is None:
            raise HTTPException(404, "the world of this mission cannot be found any more")
        return found

    @router.get("/pictures/{place}.png")
    async def picture(item: str, place: int, request: Request) -> Response:
        # One at a time, and none for somebody who has gone on meanwhile.
        async with drawing:
            if await request.is_disconnected():
                raise HTTPException(503, "nobody waits for this picture any more")
            data = await asyncio.to_thread(desk.picture, checked_id(item), place)
        if data is None:
            raise HTTPException(404, "there is no picture of this place, and none can be drawn")
        return Response(data, media_type="image/png", headers={"Cache-Control": "private, max-age=3600"})

    return router


def _progress(desk: RatingDesk, rater: str) -> dict[str, Any]:
    """Return a rater's missions in order, and which of them have an answer."""
    order, rated = desk.items(rater), desk.rated(rater)
    return {"rater": rater, "items": order, "rated": [int(item in rated) for item in order]}
