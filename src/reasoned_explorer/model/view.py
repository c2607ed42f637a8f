"""What a camera took, and what it is said to show."""

from dataclasses import dataclass, field
from typing import Any

from reasoned_explorer.geometry import Pose


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera.

    Attributes:
        width_px: Width of the picture, pixels.
        height_px: Height of the picture, pixels.
        horizontal_fov_rad: Horizontal field of view, radians, in (0, π).
    """

    width_px: int = 224
    height_px: int = 224
    horizontal_fov_rad: float = 1.5707963267948966


@dataclass(frozen=True, slots=True)
class View:
    """One look in one heading.

    Attributes:
        key: What tells this view from all others of a mission: (step, look, index).
        pose: Of the camera, facing where it looks.
        camera: The camera.
        image: RGB picture, shape (height, width, 3), uint8, or None where the vehicle takes none. It may have more
            pixels than the camera says, of the same field of view.
        content: What a simulator knows to be in the view; only the simulated captioner may read it.
    """

    key: tuple[int, int, int]
    pose: Pose
    camera: Camera = field(default_factory=Camera)
    image: Any = None
    content: Any = None


@dataclass(frozen=True, slots=True)
class Undescribed:
    """What stands for the description of a view that has none.

    Attributes:
        fault: Why.
    """

    fault: str


@dataclass(frozen=True, slots=True)
class Scene:
    """What a view is said to show, or what is imagined beyond it: text, and where it belongs.

    Attributes:
        text: The description; empty where there is none.
        key: (step, look, view) of a described scene; imagined scenes append (child, depth).
        waypoint: One step ahead of the view: where the robot would stand. Minds must not read it (the oracle, which
            says so in its name, does).
        depth: 0 for a described scene, 1 and more for an imagined one.
        fault: Why there is no description, or None.
        viewpoint: Where the camera stood; like the waypoint, not for minds.
    """

    text: str
    key: tuple[int, ...]
    waypoint: Pose
    depth: int = 0
    fault: str | None = None
    viewpoint: Pose | None = None
