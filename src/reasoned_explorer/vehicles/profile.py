"""What a machine can do: speed, acceleration, turning, height, cameras. Profiles are never pooled in one number."""

import math
from dataclasses import dataclass, field

from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.model.checks import positive_faults


@dataclass(frozen=True, slots=True)
class VehicleProfile:
    """What a machine can do.

    Attributes:
        name: As registered.
        summary: One line for people, with the source of the figures.
        flies: Whether it flies low above the ground (else it walks).
        speed_mps: Cruise speed, metres a second.
        acceleration_mps2: Metres a second squared.
        turn_rate_radps: Radians a second.
        turn_acceleration_radps2: Radians a second squared.
        camera_height_m: Of its camera above the ground, metres.
        radius_m: Of its body, metres; what collides.
        collides: Whether the world stops it.
        settle_s: Seconds that it waits after each leg.
        look_s: Seconds that one look in N headings takes apart from turning.
        turns_to_look: Whether it turns its body to look in each heading (else it has a camera for each).
        camera: Its cameras.
        moves_sideways: Whether it moves in any direction whatever it faces (else it turns first).
        sway_mps: Standing deviation per axis of what wind or slipping feet add to its velocity while it moves.

    Raises:
        SettingsError: If a figure is out of range.
    """

    name: str
    summary: str
    flies: bool
    speed_mps: float
    acceleration_mps2: float
    turn_rate_radps: float
    camera_height_m: float
    radius_m: float
    collides: bool = True
    settle_s: float = 0.0
    look_s: float = 0.0
    turns_to_look: bool = False
    camera: Camera = field(default_factory=Camera)
    turn_acceleration_radps2: float = math.radians(180.0)
    moves_sideways: bool = False
    sway_mps: float = 0.0

    def __post_init__(self) -> None:
        positive = ("speed_mps", "acceleration_mps2", "turn_rate_radps", "turn_acceleration_radps2", "camera_height_m")
        not_negative = ("settle_s", "look_s", "sway_mps")
        faults = positive_faults((name, getattr(self, name)) for name in (*positive, "radius_m"))
        faults += [
            Fault(f"{name} = {getattr(self, name)}", "a finite number ≥ 0")
            for name in not_negative
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0)
        ]
        if faults:
            raise SettingsError(f"vehicle profile {self.name!r}", faults)


PROFILES = {
    profile.name: profile
    for profile in (
        VehicleProfile(
            name="drone-authors",
            summary="the authors' AirSim drone: 1 m above ground, 1 m/s, straight legs, 5 s to settle, no collisions",
            flies=True,
            speed_mps=1.0,
            acceleration_mps2=1.0,
            turn_rate_radps=math.radians(90.0),
            camera_height_m=1.0,
            radius_m=0.3,
            collides=False,
            settle_s=5.0,
            moves_sideways=True,
        ),
        VehicleProfile(
            name="go1-authors",
            summary="the authors' Unitree Go1: 0.2 m/s, about 17 s to look around",
            flies=False,
            speed_mps=0.2,
            acceleration_mps2=0.5,
            turn_rate_radps=math.radians(45.0),
            camera_height_m=0.45,
            radius_m=0.35,
            look_s=10.5,  # 17 s for three headings over 120 degrees, less what turning takes
            turns_to_look=True,
            turn_acceleration_radps2=math.radians(90.0),
            sway_mps=0.01,
        ),
        VehicleProfile(
            name="drone",
            summary="a small multirotor, ours: 1.5 m above ground, 3 m/s, a camera for each heading",
            flies=True,
            speed_mps=3.0,
            acceleration_mps2=2.0,
            turn_rate_radps=math.radians(90.0),
            camera_height_m=1.5,
            radius_m=0.3,
            settle_s=0.5,
            moves_sideways=True,
            sway_mps=0.1,
        ),
        VehicleProfile(
            name="go1",
            summary="a quadruped, ours: 0.8 m/s, turns to look",
            flies=False,
            speed_mps=0.8,
            acceleration_mps2=1.0,
            turn_rate_radps=math.radians(60.0),
            camera_height_m=0.45,
            radius_m=0.35,
            look_s=1.5,
            turns_to_look=True,
            turn_acceleration_radps2=math.radians(120.0),
            sway_mps=0.03,
        ),
    )
}
