"""``rex minds``: models that minds call."""

from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering

minds_app = typer.Typer(help="Models that minds call.", no_args_is_help=True)


@minds_app.callback()
def _minds() -> None:
    pass


@minds_app.command()
@answering
def check(
    name: Annotated[str, typer.Argument(metavar="MODEL", help="E.g. openai:gpt-4o-mini.")],
    *,
    base_url: Annotated[
        str | None, typer.Option(help="Where it is, e.g. http://localhost:8000/v1.", show_default="OpenAI's")
    ] = None,
) -> None:
    """Ask a model, in about fifteen short calls, what it can do, and estimate what a mission with it takes."""
    from reasoned_explorer.cli.models import check_model

    check_model(name, base_url=base_url)
