"""What vehicles share where they look: in which order they turn, what a simulator knows of a view, and cameras."""

import math
from collections.abc import Callable, Mapping
from typing import Protocol, TypeVar, runtime_checkable

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import Camera

#: Says what a simulator knows to be in a view that a camera takes at a pose; for simulated captioners only.
Content = Callable[[Pose, Camera], object]
#: The last heading must be so much nearer than the first for a look around to begin there, radians.
_CLEARLY_NEARER_RAD = 0.2

K = TypeVar("K")


@runtime_checkable
class LiveSource(Protocol):
    """A camera that is read from `open` to `close`; drivers open and close it with themselves."""

    @property
    def age_s(self) -> float:
        """Seconds since its newest picture; infinite where there is none."""

    def open(self) -> None:
        """Begin to read it. Safe to call twice."""

    def close(self) -> None:
        """Let it go. Safe to call twice."""


def open_camera(camera: object) -> None:
    """Begin to read a camera that is a `LiveSource`."""
    if isinstance(camera, LiveSource):
        camera.open()


def close_camera(camera: object) -> None:
    """Let such a camera go."""
    if isinstance(camera, LiveSource):
        camera.close()


def picture_age_s(camera: object) -> float | None:
    """Return how old the newest picture of such a camera is, seconds; None where nobody can tell."""
    if not isinstance(camera, LiveSource) or math.isinf(camera.age_s):
        return None
    return camera.age_s


def turning_order(facing_rad: float, headings_rad: Mapping[K, float]) -> list[K]:
    """Return in which order to turn to headings: from the end of the list that is nearer.

    Args:
        facing_rad: Where the vehicle faces, a compass heading in radians.
        headings_rad: Where it is to look, in the order of the sweep; likewise.
    """
    order = list(headings_rad)
    if not order:
        return order
    to_first, to_last = (abs(bearing_between_rad(facing_rad, headings_rad[end])) for end in (order[0], order[-1]))
    return order[::-1] if to_last < to_first - _CLEARLY_NEARER_RAD else order
