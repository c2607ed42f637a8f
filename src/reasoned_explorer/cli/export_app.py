"""The command ``export``."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering


def add_export(app: typer.Typer) -> None:
    """Add the command to ``rex``."""
    app.command("export")(export_)


@answering
def export_(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="The folder of a run of rex bench, or of a mission of rex run.")
    ],
    path: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="results.csv or results.parquet: all missions of a run, a row each. mission.rrd (Rerun), mission.mcap "
            "(Foxglove), mission.geojson or mission.gpx (both for real places only): one mission.",
        ),
    ],
    *,
    mission: Annotated[
        str | None, typer.Option(help="Which mission of a run of rex bench: its mission_id, as in results.csv.")
    ] = None,
    planner: Annotated[str | None, typer.Option(help="Whose mission, where the run has several planners.")] = None,
    vehicle: Annotated[str | None, typer.Option(help="Likewise for vehicles.")] = None,
    world: Annotated[
        str | None,
        typer.Option(
            help="Where the mission took place, to show its ground: a .osm/.osm.pbf or .rexworld file, or a district.",
            show_default="what lies beside the record or is named in it",
        ),
    ] = None,
    bbox: Annotated[
        str | None, typer.Option(help="What --world was cropped to: lon0,lat0,lon1,lat1 (degrees).")
    ] = None,
) -> None:
    """Write results, or a mission, into a file for other programs, by its suffix.

    Exit code 0: it is written. 2: bad input. 3: the disk is full.
    """
    from reasoned_explorer.cli.export import ExportOptions, export_from_options

    export_from_options(ExportOptions(run, path, mission, planner, vehicle, world, bbox))
