"""Legs as a guard leaves them: not travelled, stopped on the way, or followed by the way home."""

from dataclasses import replace

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Leg, LegOutcome
from reasoned_explorer.vehicles.safety.plausibility import Finding


def in_words(found: Finding) -> str:
    """Return what a leg says of why it ended."""
    return f"{found.cause.value}: {found.reason}"


def not_travelled(target: Pose, why: str) -> Leg:
    """Return a leg that was not travelled."""
    return Leg(target.x_m, target.y_m, LegOutcome.STOPPED, 0.0, 0.0, (), why)


def travelled(last: Leg | None, before: Leg | None, aim: Pose, why: str) -> Leg:
    """Return the part of a leg that was travelled before it was stopped.

    Args:
        last: What the machine's driver says of its last leg.
        before: What it said before this one.
        aim: Where this one led.
        why: It was stopped.
    """
    if last is None or last is before:
        return not_travelled(aim, why)
    return replace(last, outcome=LegOutcome.STOPPED, detail=why)


def joined(leg: Leg, back: Leg) -> Leg:
    """Return a leg with the way home behind it: one command, one leg."""
    return replace(
        leg,
        duration_s=leg.duration_s + back.duration_s,
        length_m=leg.length_m + back.length_m,
        track=leg.track + tuple(point for point in back.track if not leg.track or point.t_s > leg.track[-1].t_s),
    )
