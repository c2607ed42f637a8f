"""What a state of the robot says to a localizer."""

from reasoned_explorer.vehicles.positioning.measurements import ImuSample, OdometryReading
from reasoned_explorer.vehicles.unitree.messages import HighState


def sensed(state: HighState, *, time_s: float) -> tuple[ImuSample, OdometryReading]:
    """Return the turn rate and the legs' velocity of a state that was received at a time.

    Accelerations are left out: those of a trotting body say little of where it goes. A state holds no compass.
    """
    return (
        ImuSample(time_s, state.turn_radps),
        OdometryReading(time_s, state.forward_mps, state.right_mps),
    )
