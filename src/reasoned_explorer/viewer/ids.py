"""What asks for something names it by an id, and what the same answer is told by."""

import re
from collections.abc import Callable

from fastapi import HTTPException, Request, Response

_ID = re.compile(r"[a-z0-9-]{1,64}")


def checked_id(text: str) -> str:
    """Return an id.

    Raises:
        HTTPException: 404 if it does not look like one.
    """
    if not _ID.fullmatch(text):
        raise HTTPException(404, "that is no id")
    return text


def tagged(request: Request, tag: str, make: Callable[[], bytes], media_type: str) -> Response:
    """Return an answer that is only sent (and made) where the asker does not have it yet.

    Args:
        request: Says what the asker has.
        tag: Changes whenever the answer does.
        make: Makes the answer.
        media_type: Of the answer.
    """
    headers = {"ETag": f'"{tag}"', "Cache-Control": "private, no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return Response(make(), media_type=media_type, headers=headers)
