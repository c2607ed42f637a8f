"""A person's word before pictures of real places leave this machine."""

import sys
from collections.abc import Sequence

import typer

from reasoned_explorer.cli.answers import complain
from reasoned_explorer.model import Fault, SettingsError


def agree_to_send(model: str, places: Sequence[str], *, yes: bool) -> None:
    """Say once that pictures of real places are to be sent to another machine, and ask.

    Args:
        model: Who is sent them.
        places: Of which there are pictures.
        yes: It was agreed beforehand (``--yes``); it is still said.

    Raises:
        SettingsError: If the answer is no, or there is none.
        KeyboardInterrupt: If a person asks to stop instead.
    """
    shown = ", ".join(places[:3]) + (f" and {len(places) - 3} more" if len(places) > 3 else "")
    complain(f"note: pictures of {shown} are to be sent to {model}")
    if yes:
        return
    if not _is_answered() or not _says_yes():
        fault = Fault(f"pictures of {shown} for {model}", "a yes to sending them", "--yes, or a model on this machine")
        raise SettingsError("captioner", [fault])


def _says_yes() -> bool:
    """Return whether the answer is yes; where the input ends instead, it is not."""
    try:
        return typer.confirm("Send them?", default=False, err=True)
    except typer.Abort as abort:
        typer.echo(err=True)  # the question's line is not ended by an answer
        if isinstance(abort.__context__, EOFError):
            return False
        raise KeyboardInterrupt from abort


def _is_answered() -> bool:
    """Return whether there is somebody to ask."""
    return sys.stdin is not None and sys.stdin.isatty()
