"""``rex serve``: the embedded simulator on other simulators' wires."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering


def add_serve(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(serve)


@answering
def serve(
    *,
    as_: Annotated[str, typer.Option("--as", help="Whose wire: airsim, mavlink or go1.")],
    world: Annotated[
        str,
        typer.Option(
            help="A district (park, downtown:7, town@800 …), a .osm/.osm.pbf file, or a .rexworld file; "
            "~permuted:SEED behind it deals its labels anew."
        ),
    ] = "park:7",
    bbox: Annotated[str | None, typer.Option(help="Crop an OpenStreetMap file: lon0,lat0,lon1,lat1 (degrees).")] = None,
    start: Annotated[
        str | None,
        typer.Option(
            help="Where the vehicle stands: lat,lon,heading in degrees in a real place; x,y,heading in metres and "
            "degrees elsewhere.",
            show_default="the free spot nearest to the middle",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Everything that is drawn is keyed by it.")] = 0,
    vehicle: Annotated[
        str | None,
        typer.Option(help="A vehicle profile; see rex names.", show_default="drone; go1 as go1 or a rover's autopilot"),
    ] = None,
    host: Annotated[
        str, typer.Option(help="Listen on this address. Whoever reaches it moves the vehicle.")
    ] = "127.0.0.1",
    port: Annotated[
        int | None,
        typer.Option(
            help="Listen on this port; 0 for any that is free.", show_default="41451; 14550 as mavlink; 8082 as go1"
        ),
    ] = None,
    speed: Annotated[
        str | None,
        typer.Option(
            help="Simulated seconds in a real one, or max: as fast as asked. As go1, 1 or max.", show_default="1"
        ),
    ] = None,
    noise: Annotated[
        str, typer.Option(help="Of the sensors that it steers by: none, rtk-fixed, rtk-float, single.")
    ] = "rtk-fixed",
    settings: Annotated[Path | None, typer.Option(help="A settings.json as AirSim reads it.")] = None,
    flavour: Annotated[
        str, typer.Option(help="As mavlink, whose autopilot: arducopter, ardurover, px4, px4-rover.")
    ] = "arducopter",
    station: Annotated[
        str | None, typer.Option(help="As mavlink, HOST:PORT of a ground station (UDP) that is shown the vehicle.")
    ] = None,
    gps_port: Annotated[
        int | None,
        typer.Option(
            help="As go1, its receiver answers as gpsd on this port; 0 for any that is free.",
            show_default="2947; any that is free with --port 0",
        ),
    ] = None,
    generation: Annotated[
        int, typer.Option(help="The version that it says it is: 1 (AirSim, Colosseum) or 4 (Cosys-AirSim).")
    ] = 1,
    conditions: Annotated[str, typer.Option(help="In pictures: clear, overcast, dusk, fog or rain.")] = "clear",
) -> None:
    """Answer as if this were another simulator: its scripts run here, without Unreal or a GPU. Ctrl-C ends it.

    Exit code 2: bad input, or the address cannot be listened on. 130: ended with Ctrl-C.
    """
    from reasoned_explorer.cli.serve import ServeOptions, serve_from_options

    serve_from_options(
        ServeOptions(
            as_=as_,
            world=world,
            bbox=bbox,
            start=start,
            seed=seed,
            vehicle=vehicle,
            host=host,
            port=port,
            speed=speed,
            noise=noise,
            settings=settings,
            flavour=flavour,
            station=station,
            gps_port=gps_port,
            generation=generation,
            conditions=conditions,
        )
    )
