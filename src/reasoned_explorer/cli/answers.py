"""How commands answer: exit codes, and errors that a person can act on."""

import functools
import os
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from typing import ParamSpec

import typer

from reasoned_explorer.model import PartError, ReasonedExplorerError, RecordWriteError
from reasoned_explorer.model.disk import in_words, is_badly_chosen
from reasoned_explorer.model.stopping import listening, stop_was_asked

P = ParamSpec("P")


class ExitCode(IntEnum):
    """What a process ends with."""

    FOUND = 0
    NOT_FOUND = 1
    BAD_INPUT = 2
    PART_FAILED = 3
    BUDGET_SPENT = 4
    STOPPED = 130


def answering(command: Callable[P, None]) -> Callable[P, None]:
    """Return a command whose errors are answered in words and with their exit code, and that stops when asked to."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        with listening():
            try:
                try:
                    command(*args, **kwargs)
                finally:
                    # What was said may still be on its way to a disk that is full.
                    if sys.stdout is not None:
                        sys.stdout.flush()
            except (typer.Exit, typer.Abort, typer.BadParameter):
                raise
            except BrokenPipeError:
                # Whoever read the output (head, less) has seen enough.
                sys.stderr.close()
                raise typer.Exit(ExitCode.FOUND) from None
            except (Exception, KeyboardInterrupt) as error:
                raise typer.Exit(_answer(error)) from error

    return run


def _answer(error: BaseException) -> ExitCode:
    """Say what went wrong and return the exit code."""
    if isinstance(error, KeyboardInterrupt) or stop_was_asked():
        # Asked twice, work stops wherever it is; compiled code makes another error of that.
        complain("stopped")
        return ExitCode.STOPPED
    if isinstance(error, ReasonedExplorerError):
        complain(str(error))
        return code_of(error)
    if isinstance(error, OSError):
        _drop_output()
        complain(f"{error.filename}: {error.strerror}" if error.filename else in_words("the output", error))
        return ExitCode.BAD_INPUT if is_badly_chosen(error) else ExitCode.PART_FAILED
    # A mistake in a part, ours or somebody else's: who mends it needs to know where.
    traceback.print_exception(error)
    complain(f"a part failed: {type(error).__name__}: {error}")
    return ExitCode.PART_FAILED


def _drop_output() -> None:
    """Send what is still to be said nowhere: when the process ends, writing it would fail once more."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def code_of(error: ReasonedExplorerError) -> ExitCode:
    """Return the exit code that an error asks for."""
    return ExitCode.PART_FAILED if isinstance(error, PartError | RecordWriteError) else ExitCode.BAD_INPUT


def complain(message: str) -> None:
    """Say on the error output what is wrong."""
    typer.echo(f"rex: {message}", err=True)


def positive_or_none(value: float | None) -> float | None:
    """Return a value as it is; NaN and infinities are bad parameters."""
    if value is not None and not (value == value and abs(value) != float("inf")):  # noqa: PLR0124 - NaN
        raise typer.BadParameter("must be a finite number")
    return value
