"""``rex view``: the page on which missions are watched and replayed."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering

Host = Annotated[
    str, typer.Option(help="Listen on this address. Beyond this machine a token is asked for, which is printed.")
]
Port = Annotated[
    int | None,
    typer.Option(help="Listen on this port; 0 for any that is free.", show_default="8470, or any that is free"),
]
Open = Annotated[bool, typer.Option("--open", help="Open it in the browser of this machine.")]


def add_view(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(view)


@answering
def view(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="A run, a mission, or a folder of them.", show_default=True)
    ] = Path("runs"),
    *,
    host: Host = "127.0.0.1",
    port: Port = None,
    open_: Open = False,
) -> None:
    """Show runs and missions on a page in a browser: lists, replays, two missions side by side. Ctrl-C ends it.

    Exit code 2: bad input, or the address cannot be listened on. 130: ended with Ctrl-C.
    """
    from reasoned_explorer.cli.view import PageOptions, view_folder

    view_folder(folder, PageOptions(host=host, port=port, opens=open_))
