"""The web application: what is asked for under which address."""

from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import Any

from fastapi import APIRouter, FastAPI, HTTPException, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, JSONResponse
from starlette.exceptions import HTTPException as StarletteHTTPException
from starlette.middleware.gzip import GZipMiddleware

from reasoned_explorer import __version__
from reasoned_explorer.model import InputError, PartError, ReasonedExplorerError
from reasoned_explorer.viewer.ids import checked_id
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.live import LiveFeed
from reasoned_explorer.viewer.mission_routes import Desk, mission_routes
from reasoned_explorer.viewer.runs import UnknownIdError
from reasoned_explorer.viewer.security import Guard

_JSON = "application/json"
#: What is shorter fits into a packet or two as it is.
_LEAST_GZIP_BYTES = 2048


def create_app(
    library: Library, *, guard: Guard, live: LiveFeed | None = None, extra_routers: Iterable[APIRouter] = ()
) -> FastAPI:
    """Return the application that shows a library.

    It answers everybody: hand a server ``guard.protects(app)``, as `guarded` does.

    Args:
        library: What is shown.
        guard: Whose secret our own page may read.
        live: A mission that is being written.
        extra_routers: What else is answered, e.g. the rating of missions.
    """
    app = FastAPI(title="reasoned-explorer", docs_url=None, redoc_url=None, openapi_url=None, redirect_slashes=False)
    app.state.guard = guard
    add_error_answers(app, library.root)
    app.include_router(_about_routes(library, guard, live))
    app.include_router(_run_routes(library))
    app.include_router(mission_routes(Desk(library)))
    if live is not None:
        from reasoned_explorer.viewer.live_routes import live_routes

        app.include_router(live_routes(live))
    for router in extra_routers:
        app.include_router(router)
    app.include_router(page_routes())
    return app


def add_error_answers(app: FastAPI, root: Path | None = None) -> None:
    """Have every error answered with one sentence and the right status.

    Args:
        app: The application.
        root: Where its files lie is not said.
    """

    async def refused(_request: Request, error: Exception) -> Response:
        status = error.status_code if isinstance(error, StarletteHTTPException) else 500
        said = str(error.detail) if isinstance(error, StarletteHTTPException) else "the server failed"
        return JSONResponse({"error": said}, status, headers=getattr(error, "headers", None))

    async def not_ours(_request: Request, error: Exception) -> Response:
        said = str(error) if root is None else str(error).replace(str(root), root.name)
        return JSONResponse({"error": said}, _status_of(error))

    async def not_valid(_request: Request, error: Exception) -> Response:
        faults = error.errors() if isinstance(error, RequestValidationError) else []
        said = "; ".join(f"{'.'.join(map(str, fault['loc'][1:]))}: {fault['msg']}" for fault in faults)
        return JSONResponse({"error": said or "the request is not understood"}, 422)

    app.add_exception_handler(StarletteHTTPException, refused)
    app.add_exception_handler(ReasonedExplorerError, not_ours)
    app.add_exception_handler(RequestValidationError, not_valid)
    # Beyond this, the server's own answer to it is not for people; the guard notes what happened.
    app.add_exception_handler(Exception, refused)


def _status_of(error: Exception) -> int:
    if isinstance(error, UnknownIdError):
        return 404
    # What lies in the folder is at fault, not whoever asks; and a disk that fails may work again.
    return 422 if isinstance(error, InputError) else 503 if isinstance(error, PartError) else 500


def _about_routes(library: Library, guard: Guard, live: LiveFeed | None) -> APIRouter:
    router = APIRouter()

    @router.get("/api/about")
    def about() -> dict[str, Any]:
        mission = None
        if live is not None:
            run_id, mission_id = library.mission_ids(live.path.parent)
            mission = {"run": run_id, "mission": mission_id}
        return {
            "version": __version__,
            "root": library.name,
            "live": live is not None,
            "live_mission": mission,
            "token_needed": guard.token is not None,
        }

    @router.get("/api/csrf")
    def csrf() -> dict[str, str]:
        return {"token": guard.csrf}

    return router


def _run_routes(library: Library) -> APIRouter:
    # Plain functions: they read disks, and run in threads of their own.
    router = APIRouter(prefix="/api/runs")

    @router.get("")
    def runs() -> list[dict[str, Any]]:
        return [dict(run.about()) for run in library.runs()]

    @router.get("/{run}")
    def one_run(run: str) -> Response:
        return Response(library.run(checked_id(run)).listing_json(), media_type=_JSON)

    return router


def page_routes() -> APIRouter:
    """Return what serves the page itself: the files of one fixed folder, by the names that are in it."""
    router = APIRouter()
    folder = Path(str(files("reasoned_explorer.viewer") / "pages"))
    # What may be asked for is listed once: a name that is not in the list leads nowhere.
    known = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}

    @router.get("/", include_in_schema=False)
    def index() -> Response:
        return _file(known, "index.html")

    @router.get("/pages/{name:path}", include_in_schema=False)
    def page(name: str) -> Response:
        return _file(known, name)

    return router


_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".woff2": "font/woff2",
    ".json": _JSON,
    ".txt": "text/plain; charset=utf-8",
    ".md": "text/plain; charset=utf-8",
}


def _file(known: dict[str, Path], name: str) -> Response:
    path = known.get(name)
    if path is None or not path.is_file():
        raise HTTPException(404, "there is no such page")
    # Asked for again each time, and not sent again while it is the same.
    kind = _TYPES.get(path.suffix, "application/octet-stream")
    return FileResponse(path, media_type=kind, headers={"Cache-Control": "no-cache"})


def guarded(app: FastAPI, guard: Guard) -> Any:
    """Return an application that answers only those who may ask, in few bytes where the link may be slow."""
    return guard.protects(GZipMiddleware(app, minimum_size=_LEAST_GZIP_BYTES, compresslevel=4))
