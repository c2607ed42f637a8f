"""Doing something and looking after it at the same time."""

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import Any, TypeVar

from reasoned_explorer.clock import Clock
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.safety.plausibility import Finding

T = TypeVar("T")


async def watched(
    doing: Coroutine[Any, Any, T], trouble: Callable[[], Finding | None], clock: Clock, check_s: float
) -> T | Finding:
    """Do something while its trouble is asked for again and again; where there is some, cancel it and return that.

    Args:
        doing: What is done; cancelled, it leaves the machine standing.
        trouble: Returns what is wrong, or None.
        clock: The mission's.
        check_s: How often to ask, seconds.

    Raises:
        PartError: What it raises itself.
    """
    task = asyncio.ensure_future(doing)
    try:
        while not task.done():
            pause = asyncio.ensure_future(clock.act(check_s))
            try:
                await asyncio.wait({task, pause}, return_when=asyncio.FIRST_COMPLETED)
            finally:
                await _end(pause)
            if task.done():
                break
            found = trouble()
            if found is not None:
                await _end(task)
                return found
        return task.result()
    finally:
        await _end(task)


async def _end(task: "asyncio.Future[Any]") -> None:
    """Cancel a task and wait until it has come to its end; a lost link on the way there is found out otherwise."""
    if task.done():
        return
    task.cancel()
    with suppress(PartError):
        try:
            await task
        except asyncio.CancelledError:
            # Which of the two was cancelled: the task, or, while it ends, the mission itself?
            here = asyncio.current_task()
            if here is not None and here.cancelling() and not task.done():
                raise
