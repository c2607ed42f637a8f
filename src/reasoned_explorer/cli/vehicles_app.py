"""``rex vehicle``: vehicles that are somewhere else."""

from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering

vehicles_app = typer.Typer(help="Vehicles that are somewhere else.", no_args_is_help=True)

Fence = Annotated[
    float | None, typer.Option("--fence", help="A vehicle at an address stays within so many metres of the start.")
]
MaxSpeed = Annotated[
    float | None, typer.Option("--max-speed", help="A vehicle at an address is no faster, metres a second.")
]


@vehicles_app.callback()
def _vehicles() -> None:
    """Vehicles that are somewhere else."""


@vehicles_app.command()
@answering
def check(
    vehicle: Annotated[str, typer.Argument(help="Where it is: airsim://HOST:41451, mavlink:udpin:0.0.0.0:14550 …")],
    *,
    fence: Fence = None,
    max_speed: MaxSpeed = None,
) -> None:
    """Go through what has to be right before it moves: link, position, camera, limits, battery, stop switch.

    It is asked and looks; it does not move. Exit code 0: nothing is wrong. 2: bad input. 3: something is wrong.
    """
    from reasoned_explorer.cli.vehicles import VehicleOptions, check_vehicle

    check_vehicle(VehicleOptions(vehicle, fence_m=fence, max_speed_mps=max_speed))
