import subprocess
import sys

_NAMES = (
    *("follower_start", "follower_step", "filter_predict", "filter_stand"),
    *("filter_position", "filter_velocity", "filter_odometry", "filter_compass"),
)
# In a process of its own: here another test may have used them before.
_PROGRAM = f"""
from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.follower import FollowerSettings, PidFollower
from reasoned_explorer.vehicles.control.localization import FilterSettings, PoseFilter
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.vehicles.unitree.vehicle import Go1Vehicle

profile = vehicle_profile("go1")
Go1Vehicle(profile, clock=VirtualClock())
known = [len(getattr(kernels, name).overloads) for name in {_NAMES!r}]
follower = PidFollower(FollowerSettings.of(profile))
follower.face(Pose(1.0, 2.0), 0.5)
follower.step(Pose(1.0, 2.0), yaw_rate_radps=0.1, dt_s=0.01)
believed = PoseFilter(FilterSettings(), Pose(3.0, 4.0), position_sigma_m=0.5, heading_sigma_rad=0.2)
believed.predict(0.01, yaw_rate_radps=0.1, forward_mps2=0.2)
believed.stand(1.5)
believed.position(3.1, 4.1, sigma_m=0.02)
believed.course(0.3, 1.2, sigma_mps=0.1)
believed.odometry(0.4, 0.1, sigma_mps=0.1)
believed.compass(0.6, sigma_rad=0.05)
print(known == [len(getattr(kernels, name).overloads) for name in {_NAMES!r}] == [1] * {len(_NAMES)})
"""


def test_a_driver_is_ready_before_it_connects_and_moving_compiles_nothing_more() -> None:
    ended = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True)
    assert ended.stdout.split() == ["True"]
