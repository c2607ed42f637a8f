"""How commands answer: exit codes, and errors that a person can act on."""

import functools
import sys
from collections.abc import Callable
from enum import IntEnum
from typing import ParamSpec

import typer

from reasoned_explorer.model import PartError, ReasonedExplorerError, RecordWriteError

P = ParamSpec("P")


class ExitCode(IntEnum):
    """What a process ends with."""

    FOUND = 0
    NOT_FOUND = 1
    BAD_INPUT = 2
    PART_FAILED = 3
    STOPPED = 130


def answering(command: Callable[P, None]) -> Callable[P, None]:
    """Return a command whose expected errors are answered in words and with their exit code."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except ReasonedExplorerError as error:
            complain(str(error))
            raise typer.Exit(code_of(error)) from error
        except KeyboardInterrupt:
            complain("stopped")
            raise typer.Exit(ExitCode.STOPPED) from None
        except BrokenPipeError:
            # Whoever read the output (head, less) has seen enough.
            sys.stderr.close()
            raise typer.Exit(ExitCode.FOUND) from None

    return run


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
