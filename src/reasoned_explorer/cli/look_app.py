"""``rex look``: pictures of a world."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering


def add_look(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(look)


@answering
def look(
    *,
    world: Annotated[
        str,
        typer.Option(
            help="A district (park, downtown:7, town@800 …), a .osm/.osm.pbf file, or a .rexworld file; "
            "~permuted:SEED behind it deals its labels anew."
        ),
    ] = "park:7",
    bbox: Annotated[str | None, typer.Option(help="Crop an OpenStreetMap file: lon0,lat0,lon1,lat1 (degrees).")] = None,
    seed: Annotated[int, typer.Option(help="Of the world, where its name says none.")] = 0,
    at: Annotated[
        str | None,
        typer.Option(
            help="Where the camera is: x,y,z,heading in metres and degrees; lat,lon,z,heading in a real place. The "
            "heading is clockwise from north, z above the ground; without z: x,y,heading; without both: x,y."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="The picture, .png; what belongs to it is named like it.")] = Path(
        "look.png"
    ),
    size: Annotated[
        str | None,
        typer.Option(
            metavar="WxH",
            help="Pixels of the picture, or of each view with --sweep.",
            show_default="1024x768; 2048x512 all around, 1024x1024 from above, 448x448 with --sweep",
        ),
    ] = None,
    width: Annotated[int | None, typer.Option(help="Its width alone, pixels.")] = None,
    height: Annotated[int | None, typer.Option(help="Its height alone, pixels.")] = None,
    fov: Annotated[float | None, typer.Option(help="Horizontal field of view, degrees.", show_default="90")] = None,
    pitch: Annotated[
        float | None, typer.Option(help="How far it looks up (or, below 0, down), degrees.", show_default="0")
    ] = None,
    conditions: Annotated[str, typer.Option(help="clear, overcast, dusk, fog or rain.")] = "clear",
    panorama: Annotated[bool, typer.Option("--panorama", help="All around, the heading in the middle.")] = False,
    top_down: Annotated[
        bool, typer.Option("--top-down", help="From straight above, around --at or of the whole world; heading on top.")
    ] = False,
    span: Annotated[
        float | None, typer.Option(help="Metres across, with --top-down.", show_default="the whole world")
    ] = None,
    rig: Annotated[
        str | None, typer.Option(help="The cameras of a rig side by side: authors (224x224, 90°, at -45°, 0°, 45°).")
    ] = None,
    sweep: Annotated[int | None, typer.Option(help="So many views over 120°, side by side.")] = None,
    depth: Annotated[
        bool, typer.Option("--depth", help="Also the depth: .depth.npy (metres) and .depth.png (16 bit, millimetres).")
    ] = False,
    ids: Annotated[
        bool, typer.Option("--ids", help="Also what is seen: .ids and .classes, .npy and coloured .png, and a legend.")
    ] = False,
    contact_sheet: Annotated[
        bool, typer.Option("--contact-sheet", help="Every class of objects close up, somebody beside it; no world.")
    ] = False,
) -> None:
    """Draw what a camera sees in a world.

    With --top-down the depth is how high what is seen stands above the ground: .height.npy and .height.png.
    """
    from reasoned_explorer.cli.look import LookOptions, look_from_options

    look_from_options(
        LookOptions(
            world=world,
            bbox=bbox,
            seed=seed,
            at=at,
            out=out,
            size=size,
            width_px=width,
            height_px=height,
            fov_deg=fov,
            pitch_deg=pitch,
            conditions=conditions,
            panorama=panorama,
            top_down=top_down,
            span_m=span,
            rig=rig,
            sweep=sweep,
            depth=depth,
            ids=ids,
            contact_sheet=contact_sheet,
        )
    )
