"""Where a mission went and where it looked, from its steps."""

from reasoned_explorer.evaluation.scoring import Look
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import TrackPoint
from reasoned_explorer.model.record import StepRecord


def track_of(start: Pose, steps: list[StepRecord]) -> list[TrackPoint]:
    """Return the true way travelled; the start is in it."""
    track = [TrackPoint(0.0, start.x_m, start.y_m, start.z_m, start.heading_rad)]
    for step in steps:
        for leg in step.legs:
            track += leg.track
    return track


def looks_of(steps: list[StepRecord]) -> list[Look]:
    """Return where on `track_of` the agent looked, and in which headings; all looks of a step are from one place.

    Headings are those that the vehicle believed in: within a degree or two of the true ones.
    """
    looks, point = [], 0
    for step in steps:
        if step.views:
            looks.append(Look(point, tuple(view.heading_rad for view in step.views)))
        point += sum(len(leg.track) for leg in step.legs)
    return looks
