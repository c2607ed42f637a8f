"""What a view really shows: the truth that only the simulated captioner reads."""

from dataclasses import dataclass
from typing import NamedTuple

from reasoned_explorer.world.taxonomy import Ground


class Sighting(NamedTuple):
    """One object in a view.

    A named tuple, since views hold dozens and it is made three times as fast as a frozen dataclass.

    Attributes:
        object_id: Place in the world's list of objects.
        class_name: Its class.
        bearing_rad: From the view's axis, positive to the right, in [-fov/2, fov/2] for its centre (a wide object
            whose centre is outside the picture is clipped to its edge).
        distance_m: Horizontal distance from the camera to the object's nearest point.
        width_px: Apparent width, pixels, before occlusion, clipped to the picture.
        height_px: Apparent height, pixels, likewise.
        visible_share: Share of it that is not hidden by buildings, trees or other things, in (0, 1].
        under: Class of the plant or shelter whose cover it stands under, or None.
        name: The name that a sign of it would show, as the world's data has it, or empty.
    """

    object_id: int
    class_name: str
    bearing_rad: float
    distance_m: float
    width_px: float
    height_px: float
    visible_share: float
    under: str | None = None
    name: str = ""


@dataclass(frozen=True, slots=True)
class GroundStretch:
    """The ground along one ray of a view: what it is at rising distances.

    Attributes:
        bearing_rad: Of the ray, from the view's axis.
        near: Ground about 3 m ahead.
        middle: Ground about 8 m ahead (or BUILDING behind the wall that ends the ray).
        far: Ground about 18 m ahead.
        free_m: Distance to the first wall or solid thing on the ray at the vehicle's height, at most the view's range.
        ends_at: ``"building"``, the class of the thing that ends the ray, or empty where nothing does.
    """

    bearing_rad: float
    near: Ground
    middle: Ground
    far: Ground
    free_m: float
    ends_at: str = ""


@dataclass(frozen=True, slots=True)
class ViewContent:
    """What a view really shows.

    Attributes:
        sightings: Visible objects, nearest first.
        stretches: Ground along rays to the left, ahead and to the right (bearings -30°, 0, +30°).
        building_share: Share of the view's directions that end at a building within the view's range, in [0, 1].
        nearest_building_m: Distance to the nearest wall in view, infinite where there is none.
        building_kinds: Kinds of the nearest buildings in view, nearest first, at most 3.
    """

    sightings: tuple[Sighting, ...]
    stretches: tuple[GroundStretch, ...]
    building_share: float
    nearest_building_m: float
    building_kinds: tuple[str, ...] = ()
