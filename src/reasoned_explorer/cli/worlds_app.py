"""``rex worlds``: generate, import, inspect and draw worlds."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering

worlds_app = typer.Typer(help="Generate, import, inspect and draw worlds.", no_args_is_help=True)

_Spec = Annotated[
    str,
    typer.Argument(
        metavar="WORLD",
        help="A district (park, downtown:7, town@800 …), an OSM file, or a .rexworld file; ~permuted:SEED may "
        "stand behind it.",
    ),
]
_Bbox = Annotated[str | None, typer.Option(help="Crop an OpenStreetMap file: lon0,lat0,lon1,lat1 (degrees).")]
_Seed = Annotated[int, typer.Option(min=0, help="Of generation, and of seeded defaults of an import.")]


@worlds_app.command("list")
@answering
def list_() -> None:
    """List the districts that can be generated, and worlds that other packages bring."""
    from reasoned_explorer.cli.worlds import list_worlds

    list_worlds()


@worlds_app.command()
@answering
def generate(
    district: Annotated[str, typer.Argument(help="See rex worlds list; park:7@600 is seed 7, 600 m across.")],
    *,
    seed: _Seed = 0,
    size: Annotated[float, typer.Option(help="Metres across, 100 to 1000.")] = 400.0,
    out: Annotated[Path | None, typer.Option(help="Keep it as a .rexworld file.")] = None,
) -> None:
    """Generate a world and say what is in it."""
    from reasoned_explorer.cli.worlds import generate_and_keep

    generate_and_keep(district, seed=seed, size_m=size, out=out)


@worlds_app.command("import")
@answering
def import_(
    osm_file: Annotated[Path, typer.Argument(help="An OpenStreetMap extract: .osm, .osm.gz, .osm.bz2 or .osm.pbf.")],
    *,
    bbox: _Bbox = None,
    seed: _Seed = 0,
    out: Annotated[Path | None, typer.Option(help="Keep it as a .rexworld file.")] = None,
) -> None:
    """Import a real place, and say what is in it and what was lost on the way."""
    from reasoned_explorer.cli.worlds import import_and_keep

    import_and_keep(osm_file, bbox=bbox, seed=seed, out=out)


@worlds_app.command()
@answering
def inspect(spec: _Spec, *, bbox: _Bbox = None, seed: _Seed = 0) -> None:
    """Say what is in a world, and how much of its ground is unknown."""
    from reasoned_explorer.cli.worlds import inspect_world

    inspect_world(spec, bbox=bbox, seed=seed)


@worlds_app.command()
@answering
def draw(
    spec: _Spec,
    out: Annotated[Path, typer.Argument(help="The picture: .png, .svg or .pdf.")],
    *,
    bbox: _Bbox = None,
    seed: _Seed = 0,
    width: Annotated[int, typer.Option(min=200, max=10000, help="Pixels.")] = 2400,
    labels: Annotated[bool, typer.Option(help="Names of streets and places.")] = True,
) -> None:
    """Draw a map of a world."""
    from reasoned_explorer.cli.worlds import draw_map

    draw_map(spec, out, bbox=bbox, seed=seed, width_px=width, labels=labels)
