"""What travelling costs: a mission's worth of legs, and where the time goes.

Run ``python benchmarks/bench_travel.py``; it prints processor time, not wall time, so that a busy machine matters less.
"""

import argparse
import math
import statistics
import time
from collections.abc import Callable

import numpy as np

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Leg, draws
from reasoned_explorer.simulation import kernels
from reasoned_explorer.simulation.motion import Body
from reasoned_explorer.simulation.sensors import SENSOR_NOISE, TICK_HZ, sensor_noise
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.vehicles.control import kernels as control
from reasoned_explorer.vehicles.profile import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Region, World, WorldObject


class _Blind:
    def look(self, pose: Pose, camera: Camera) -> ViewContent:  # noqa: ARG002 - a protocol's signature
        return ViewContent((), (), 0.0, math.inf)


def _meadow(size_m: float, trees: int) -> Atlas:
    ring = np.array([(0.0, 0.0), (size_m, 0.0), (size_m, size_m), (0.0, size_m)])
    things = tuple(
        WorldObject(
            i, "tree", size_m * draws.uniform(1, i, "x"), size_m * draws.uniform(1, i, "y"), 0.0, (6.0, 6.0, 9.0)
        )
        for i in range(trees)
    )
    bounds = Bounds(0.0, 0.0, size_m, size_m)
    return Atlas(World("meadow", bounds, (Region(Ground.GRASS, ring),), (), (), things))


def _mission(
    atlas: Atlas, name: str, *, noise: str, legs: int, length_m: float, seed: int = 0
) -> tuple[list[Leg], float]:
    """Run legs one after another through a vehicle and return them with the processor seconds they cost."""
    clock = VirtualClock()

    async def travel() -> tuple[list[Leg], float]:
        middle = 0.5 * atlas.world.bounds.max_x_m
        start = Pose(middle, middle)
        vehicle = SimulatedVehicle(
            atlas, PROFILES[name], start, clock=clock, eyes=_Blind(), seed=seed, noise=sensor_noise(noise)
        )
        started = time.process_time()
        # Turning on by 137.5 degrees from leg to leg stays about in one place and takes all directions.
        done = [await vehicle.go_to(vehicle.pose.facing(2.39996 * number).ahead(length_m)) for number in range(legs)]
        return done, time.process_time() - started

    return clock.run(travel())


def _best(action: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        started = time.process_time()
        action()
        times.append(time.process_time() - started)
    return min(times)


def _parts(name: str, noise: str) -> None:
    """Time the parts of a tick, each by itself."""
    body = Body(
        PROFILES[name], SENSOR_NOISE[noise], Pose(0.0, 0.0), seed=1, bounds=Bounds(-500.0, -500.0, 500.0, 500.0)
    )
    belief = body.filter
    settings, state, cov = belief.settings_array, belief.state, belief.covariance
    rejects, work = belief.rejects, belief.work
    rounds = 3000
    key = np.uint64(draws.key_of(1, "bench"))
    trees = np.array([(float(i), 100.0, 0.2) for i in range(50)])
    parts: dict[str, Callable[[], object]] = {
        "filter: predict": lambda: control.filter_predict(settings, state, cov, 0.05, 0.0, 0.0, 0.0),
        "filter: fix": lambda: control.filter_position(settings, state, cov, rejects, work, state[0], state[1], 0.014),
        "filter: odometry": lambda: control.filter_odometry(settings, state, cov, rejects, work, 0.0, 0.0, 0.05),
        "two normal draws": lambda: kernels.normals(key),
        "clearance of 50 discs": lambda: kernels.clearance(trees[:0, :0].reshape(0, 4), trees, 0.0, 0.0),
        "call of a compiled function": lambda: control.approach(0.0, 1.0, 0.5),
    }
    print("\nparts, called one by one from Python (the call itself included; in a leg there is none):")
    for label, action in parts.items():
        action()
        spent = _best(lambda action=action: [action() for _ in range(rounds)], 5)  # type: ignore[misc]
        print(f"  {label:<28} {spent / rounds * 1e6:6.2f} µs")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--legs", type=int, default=100)
    parser.add_argument("--length", type=float, default=12.0, help="metres a leg")
    parser.add_argument("--noise", default="rtk-fixed", choices=sorted(SENSOR_NOISE))
    parser.add_argument("--trees", type=int, default=0, help="trees on the 400 m meadow")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    atlas = _meadow(400.0, options.trees)
    started = time.perf_counter()
    _mission(atlas, "drone", noise=options.noise, legs=1, length_m=3.0)
    print(f"first leg, compiling or loading included: {time.perf_counter() - started:.2f} s")
    print(f"{options.legs} legs of {options.length:g} m, {options.noise}, {options.trees} trees:")
    head = (
        f"{'profile':<15}{'CPU':>8}{'simulated':>11}{'a tick':>9}{'points':>8}{'arrived':>9}{'cross':>9}{'localiz.':>9}"
    )
    print(head)
    for name in PROFILES:
        _mission(atlas, name, noise=options.noise, legs=2, length_m=options.length)
        costs = []
        for _ in range(options.repeats):
            legs, cost_s = _mission(
                atlas, name, noise=options.noise, legs=options.legs, length_m=options.length, seed=1
            )
            costs.append(cost_s)
        seconds = sum(leg.duration_s for leg in legs)
        points = sum(len(leg.track) for leg in legs)
        cross = math.sqrt(statistics.fmean(leg.cross_track_rms_m**2 for leg in legs))
        error = math.sqrt(statistics.fmean((leg.localization_rms_m or 0.0) ** 2 for leg in legs))
        arrived = sum(leg.outcome == "arrived" for leg in legs)
        cost_ms = 1e3 * min(costs)
        print(
            f"{name:<15}{cost_ms:6.1f}ms{seconds:10.0f}s{1e3 * cost_ms / (seconds * TICK_HZ):7.2f}µs{points:8d}"
            f"{arrived:9d}{cross:8.3f}m{error:8.3f}m"
        )
    _parts("go1", options.noise)


if __name__ == "__main__":
    main()
