"""``rex rate``: the page on which people judge missions."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering
from reasoned_explorer.cli.view_app import Host, Open, Port


def add_rate(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(rate)


@answering
def rate(
    run_folder: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run of rex bench.")],
    *,
    rater: Annotated[
        str | None, typer.Option(help="Who rates; nobody else can on this page.", show_default="the page asks")
    ] = None,
    seed: Annotated[
        int,
        typer.Option(help="Of the order. Give all raters of a run the same: then they see the same missions first."),
    ] = 0,
    methods: Annotated[str, typer.Option(help="Only missions of these, with commas.")] = "",
    levels: Annotated[str, typer.Option(help="Only these levels, with commas: 4, say.")] = "",
    count: Annotated[
        int | None,
        typer.Option(help="Only so many, of all methods and levels alike; the same ones for every rater."),
    ] = None,
    declared: Annotated[
        bool,
        typer.Option(
            "--declared",
            help="Only missions in which the robot said it had found it: the others are no success anyway.",
        ),
    ] = False,
    host: Host = "127.0.0.1",
    port: Port = None,
    open_: Open = False,
) -> None:
    """Have people judge the missions of a run on a page in a browser, blind to the method. Ctrl-C ends it.

    One mission at a time: what was asked, where the robot ended, what is to be seen there. The answers are kept in the
    run at once, and rex report shows them beside what the judge says. Several people may rate at the same time.

    Exit code 2: bad input, or the address cannot be listened on. 130: ended with Ctrl-C.
    """
    from reasoned_explorer.cli.rate import RateOptions, rate_run
    from reasoned_explorer.cli.view import PageOptions

    page = PageOptions(host=host, port=port, opens=open_)
    rate_run(run_folder, RateOptions(rater, seed, methods, levels, count, declared, page))
