"""The commands of `rex`. Each lives in a module of its own, which is only loaded when it is used."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer import __version__
from reasoned_explorer.cli.answers import answering
from reasoned_explorer.cli.bench_app import add_commands
from reasoned_explorer.cli.export_app import add_export
from reasoned_explorer.cli.look_app import add_look
from reasoned_explorer.cli.minds_app import minds_app
from reasoned_explorer.cli.model_arguments import BaseUrl, KeyVariable, Prices, SampleAnew, Yes
from reasoned_explorer.cli.rate_app import add_rate
from reasoned_explorer.cli.serve_app import add_serve
from reasoned_explorer.cli.vehicles_app import CameraAt, CameraFov, Fence, Gps, MaxSpeed, Ntrip, vehicles_app
from reasoned_explorer.cli.view_app import Host, Port, add_view
from reasoned_explorer.cli.worlds_app import worlds_app

app = typer.Typer(
    name="rex",
    help="Reasoned Explorer: tell a robot in a sentence what to find outdoors, and see how it finds it.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(worlds_app, name="worlds")
app.add_typer(minds_app, name="minds")
app.add_typer(vehicles_app, name="vehicle")
add_commands(app)
add_export(app)
add_look(app)
add_rate(app)
add_serve(app)
add_view(app)


def _version(*, value: bool) -> None:
    if value:
        typer.echo(f"rex {__version__}")
        raise typer.Exit


@app.callback()
def _rex(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=lambda value: _version(value=value), is_eager=True, help="Say which.")
    ] = False,
) -> None:
    pass


@app.command()
@answering
def run(
    goal: Annotated[str, typer.Argument(help='What to find, e.g. "Find me a fire hydrant, but stay on the road".')],
    *,
    world: Annotated[
        str,
        typer.Option(
            help="A district (park, downtown:7, town@800 …), a .osm/.osm.pbf file, or a .rexworld file; "
            "~permuted:SEED behind it deals its labels anew; none where none is known, as outdoors."
        ),
    ] = "park:7",
    bbox: Annotated[str | None, typer.Option(help="Crop an OpenStreetMap file: lon0,lat0,lon1,lat1 (degrees).")] = None,
    start: Annotated[
        str | None,
        typer.Option(
            help="lat,lon,heading in degrees in a real place; x,y,heading in metres and degrees elsewhere. The heading "
            "is clockwise from north and may be left out: north. What flies may start over water."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Everything that is drawn is keyed by it.")] = 0,
    planner: Annotated[str, typer.Option(help="See rex names.")] = "llm-rrt",
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="A setting of the planner, e.g. depth=1; may be repeated.")
    ] = None,
    minds: Annotated[str, typer.Option(help="Who imagines, scores and checks; see rex names.")] = "embedded",
    visionary: Annotated[str | None, typer.Option(help="Who imagines, if not --minds.")] = None,
    evaluator: Annotated[str | None, typer.Option(help="Who scores, if not --minds.")] = None,
    checker: Annotated[str | None, typer.Option(help="Who notices the goal, if not --minds.")] = None,
    captioner: Annotated[str, typer.Option(help="Who says what is seen; see rex names.")] = "noisy",
    vehicle: Annotated[
        str,
        typer.Option(
            help="A vehicle profile (see rex names), or where a vehicle is reached: airsim://HOST:41451, "
            "mavlink:udpin:0.0.0.0:14550, go1://192.168.123.161 …"
        ),
    ] = "drone",
    gps: Gps = None,
    ntrip: Ntrip = None,
    camera: CameraAt = None,
    camera_fov: CameraFov = None,
    fence: Fence = None,
    max_speed: MaxSpeed = None,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="A vehicle at an address looks, and it says where it would go; it stands."),
    ] = False,
    move: Annotated[
        bool, typer.Option("--move", help="Yes, the machine at the address may be armed and move, also a real one.")
    ] = False,
    confirm: Annotated[
        bool, typer.Option("--confirm", help="Ask at the terminal before each leg of a vehicle at an address.")
    ] = False,
    latency: Annotated[
        str, typer.Option(help="How long modelled calls take: gpt-2023, gpt-fast, instant, or seconds: 0.8s.")
    ] = "gpt-2023",
    clock: Annotated[
        str | None,
        typer.Option(help="virtual, mixed or real time.", show_default="virtual; mixed where a model is called"),
    ] = None,
    base_url: BaseUrl = None,
    key_variable: KeyVariable = None,
    prices: Prices = None,
    record: Annotated[
        Path | None,
        typer.Option(help="Keep every call to a model in this file.", show_default="calls.tape in the folder"),
    ] = None,
    resume: Annotated[
        Path | None,
        typer.Option(help="Go on with a mission that ended early from the file of its calls; they are not paid again."),
    ] = None,
    replay: Annotated[Path | None, typer.Option(help="Take every answer from such a file; nobody is called.")] = None,
    cache: Annotated[Path | None, typer.Option(help="File of answers that may be used again; made if need be.")] = None,
    sample_anew: SampleAnew = False,
    budget_usd: Annotated[float | None, typer.Option(help="End before calls cost more, US dollars.")] = None,
    budget_minutes: Annotated[float | None, typer.Option(help="End it after so many real minutes.")] = None,
    views: Annotated[int, typer.Option(help="Headings per look (N).")] = 3,
    sweep: Annotated[float, typer.Option(help="Range of motion that they span, degrees.")] = 120.0,
    t_max: Annotated[float, typer.Option(help="Mission time above which it is failed, minutes.")] = 30.0,
    max_steps: Annotated[int, typer.Option(help="Steps after which the budget is spent.")] = 2000,
    looks: Annotated[int, typer.Option(help="Looks that must agree before the goal is declared found.")] = 2,
    radius: Annotated[float, typer.Option(help="Success radius R of the judge, metres.")] = 15.0,
    out: Annotated[Path | None, typer.Option(help="Folder for record and map; runs/… by default.")] = None,
    images: Annotated[bool, typer.Option("--images/--no-images", help="Keep the pictures of all views, PNG.")] = False,
    picture_px: Annotated[int, typer.Option(help="Side of a picture, pixels.")] = 448,
    conditions: Annotated[str, typer.Option(help="In pictures: clear, overcast, dusk, fog or rain.")] = "clear",
    eyes: Annotated[
        str, typer.Option(help="What simulated captioners go by: lines or pixels; see rex names.")
    ] = "pixels",
    yes: Yes = False,
    view: Annotated[
        bool, typer.Option("--view", help="Show it on a page in a browser while it runs, and then until Ctrl-C.")
    ] = False,
    view_host: Host = "127.0.0.1",
    view_port: Port = None,
    map_: Annotated[bool, typer.Option("--map/--no-map", help="Draw the map picture.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the summary.")] = False,
) -> None:
    """Run one mission: from a sentence to "Found Goal".

    With --world none a vehicle at an address explores where nothing is known, by what its camera shows to a model; the
    agent alone says whether it has found it, and nobody judges.

    Exit code 0: found (without a world: it says so). 1: ended without. 2: bad input. 3: a part failed. 130: stopped
    with Ctrl-C.
    """
    from reasoned_explorer.cli.models import ModelOptions
    from reasoned_explorer.cli.run import RunOptions, run_from_options
    from reasoned_explorer.cli.vehicles import VehicleOptions
    from reasoned_explorer.cli.view import PageOptions

    run_from_options(
        RunOptions(
            goal=goal,
            world=world,
            bbox=bbox,
            start=start,
            seed=seed,
            planner=planner,
            planner_settings=tuple(set_ or ()),
            minds=minds,
            visionary=visionary,
            evaluator=evaluator,
            checker=checker,
            captioner=captioner,
            vehicle=VehicleOptions(
                vehicle,
                fence_m=fence,
                max_speed_mps=max_speed,
                dry_run=dry_run,
                confirm=confirm,
                move=move,
                gps=gps,
                ntrip=ntrip,
                camera=camera,
                camera_fov_deg=camera_fov,
            ),
            latency=latency,
            clock=clock,
            views=views,
            sweep_deg=sweep,
            t_max_min=t_max,
            max_steps=max_steps,
            looks=looks,
            radius_m=radius,
            out=out,
            draw=map_,
            images=images,
            picture_px=picture_px,
            conditions=conditions,
            eyes=eyes,
            quiet=quiet,
            page=PageOptions(host=view_host, port=view_port) if view else None,
            models=ModelOptions(
                base_url=base_url,
                key_variable=key_variable,
                prices=prices,
                record=record,
                replay=replay,
                resume=resume,
                cache=cache,
                sample_anew=sample_anew,
                budget_usd=budget_usd,
                budget_minutes=budget_minutes,
                yes=yes,
            ),
        )
    )


@app.command()
@answering
def show(
    run_folder: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run, or its record.jsonl.")],
    *,
    step: Annotated[int | None, typer.Option(help="Show one step with its captions and its imagined tree.")] = None,
) -> None:
    """Print a mission again from its record alone."""
    from reasoned_explorer.cli.show import show_run

    show_run(run_folder, step=step)


@app.command()
@answering
def names() -> None:
    """List what can be picked by name: planners, minds, captioners, eyes, vehicles, worlds, latency profiles."""
    from reasoned_explorer.cli.names import print_names

    print_names()


@app.command()
@answering
def doctor() -> None:
    """Say what is installed, what is missing, and how to get it."""
    from reasoned_explorer.cli.doctor import print_report

    print_report()
