"""What several commands let a person say about models that are called."""

from pathlib import Path
from typing import Annotated

import typer

BaseUrl = Annotated[
    str | None,
    typer.Option(help="Where models openai:… are, e.g. http://localhost:8000/v1.", show_default="OpenAI's"),
]
KeyVariable = Annotated[
    str | None,
    typer.Option(help="Environment variable that holds their key.", show_default="OPENAI_API_KEY"),
]
Prices = Annotated[
    Path | None,
    typer.Option(help="TOML file of what models cost, in the form of calls/prices.toml; goes before that."),
]
Yes = Annotated[bool, typer.Option("--yes", help="Pictures of real places may be sent to a model on another machine.")]
SampleAnew = Annotated[
    bool, typer.Option("--sample-anew", help="Ask again what is sampled, although --cache has answers to it.")
]
