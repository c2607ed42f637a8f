"""``rex minds``: models that minds call."""

from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering
from reasoned_explorer.cli.model_arguments import BaseUrl, KeyVariable, Prices

minds_app = typer.Typer(help="Models that minds call.", no_args_is_help=True)


@minds_app.callback()
def _minds() -> None:
    pass


@minds_app.command()
@answering
def check(
    name: Annotated[str, typer.Argument(metavar="MODEL", help="E.g. openai:gpt-4o-mini.")],
    *,
    base_url: BaseUrl = None,
    key_variable: KeyVariable = None,
    prices: Prices = None,
) -> None:
    """Ask a model, in about fifteen short calls, what it can do, and estimate what a mission with it takes."""
    from reasoned_explorer.cli.model_lines import check_model
    from reasoned_explorer.cli.models import ModelOptions

    check_model(name, ModelOptions(base_url=base_url, key_variable=key_variable, prices=prices))
