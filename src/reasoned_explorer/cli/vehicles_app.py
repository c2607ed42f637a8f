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
Gps = Annotated[
    str | None,
    typer.Option("--gps", help="The satellite receiver of a Go1: gpsd://HOST:2947 or serial:/dev/ttyUSB1:38400."),
]
Ntrip = Annotated[
    str | None,
    typer.Option(
        "--ntrip",
        help="Corrections for a receiver on a serial line: ntrip://HOST:2101/MOUNTPOINT. Name and password come from "
        "the environment only: NTRIP_USER, NTRIP_PASSWORD.",
    ),
]
CameraAt = Annotated[
    str | None,
    typer.Option(
        "--camera",
        help="What looks ahead of a vehicle by go1 or mavlink: /dev/video0 or rtsp://HOST:554/PATH. Name and password "
        "come from the environment only: CAMERA_USER, CAMERA_PASSWORD.",
    ),
]
CameraFov = Annotated[
    float | None,
    typer.Option("--camera-fov", help="How wide that sees, degrees; what the profile does not is cut off."),
]


@vehicles_app.callback()
def _vehicles() -> None:
    """Vehicles that are somewhere else."""


@vehicles_app.command()
@answering
def check(
    vehicle: Annotated[
        str, typer.Argument(help="Where it is: airsim://HOST:41451, mavlink:udpin:0.0.0.0:14550, go1://HOST …")
    ],
    *,
    fence: Fence = None,
    max_speed: MaxSpeed = None,
    gps: Gps = None,
    ntrip: Ntrip = None,
    camera: CameraAt = None,
    camera_fov: CameraFov = None,
) -> None:
    """Go through what has to be right before it moves: link, position, camera, limits, battery, stop switch.

    It is asked and looks; it does not move. Exit code 0: nothing is wrong. 2: bad input. 3: something is wrong.
    """
    from reasoned_explorer.cli.vehicles import VehicleOptions, check_vehicle

    check_vehicle(
        VehicleOptions(
            vehicle,
            fence_m=fence,
            max_speed_mps=max_speed,
            gps=gps,
            ntrip=ntrip,
            camera=camera,
            camera_fov_deg=camera_fov,
        )
    )
