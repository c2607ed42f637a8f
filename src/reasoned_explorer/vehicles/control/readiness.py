"""Has all compiled, or loaded, that a driver of ours calls while its machine moves."""

from functools import cache

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control.follower import FollowerSettings, PidFollower
from reasoned_explorer.vehicles.control.localization import FilterSettings, PoseFilter


@cache
def make_ready() -> None:
    """Use every kernel of the follower and of the filter once; from the second call on nothing happens.

    For drivers, before they connect: on a machine's first run compiling takes seconds, in which its link would seem to
    be lost, and the machine would be stopped.
    """
    here = Pose(0.0, 0.0)
    follower = PidFollower(
        FollowerSettings(
            speed_mps=1.0, acceleration_mps2=1.0, braking_mps2=1.0, turn_rate_radps=1.0, turn_acceleration_radps2=1.0
        )
    )
    follower.start(here, Pose(1.0, 0.0))
    follower.step(here, yaw_rate_radps=0.0, dt_s=0.02)
    believed = PoseFilter(FilterSettings(), here, position_sigma_m=1.0, heading_sigma_rad=0.1)
    believed.predict(0.02, yaw_rate_radps=0.0)
    believed.stand(0.02)
    believed.position(0.0, 0.0, sigma_m=1.0)
    believed.velocity(0.0, 0.0, sigma_mps=0.1)
    believed.odometry(0.0, sigma_mps=0.1)
    believed.compass(0.0, sigma_rad=0.1)
