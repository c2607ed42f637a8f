"""Made-up walks with the readings of all sensors, whose errors are correlated in time as real receivers' are.

The receivers' errors are those published (see `reasoned_explorer.vehicles.positioning.receivers` for the sources): a
first-order Gauss-Markov process per axis, and white noise. Of a source's two axes the root mean square is taken.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from reasoned_explorer.geometry import bearing_between_rad
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.localizer import Localizer, LocalizerSettings
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS, ReceiverModel
from reasoned_explorer.vehicles.positioning.track import Measurement
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings

TICK_HZ = 50
FIX_EVERY, COMPASS_EVERY, ODOMETRY_EVERY = 10, 10, 5


@dataclass(frozen=True, slots=True)
class Truth:
    """How a receiver really errs.

    Attributes:
        quality: Of its fixes.
        model: Its errors.
    """

    quality: FixQuality
    model: ReceiverModel


#: By name. The white part of RTK is assumed to be a third of the whole.
TRUTHS = {
    "RTK fixed": Truth(FixQuality.FIXED, ReceiverModel(0.0044, 0.0124, 115.0)),
    "RTK fixed, slow": Truth(FixQuality.FIXED, ReceiverModel(0.0044, 0.0124, 15.0 * 60.0)),
    "RTK float": Truth(FixQuality.FLOAT, ReceiverModel(0.035, 0.100, 115.0)),
    "RTK float, disturbed": Truth(FixQuality.FLOAT, ReceiverModel(0.096, 0.272, 115.0)),
    "single": Truth(FixQuality.SINGLE, ReceiverModel(0.4, 4.7, 1100.0)),
}


@dataclass(frozen=True, slots=True)
class Walk:
    """Where the machine was, 50 times a second.

    Attributes:
        x_m: East, shape (n,).
        y_m: North, shape (n,).
        heading_rad: Heading, not wrapped, shape (n,).
        forward_mps: Speed ahead, shape (n,).
        rate_radps: Turn rate, clockwise, shape (n,).
    """

    x_m: np.ndarray
    y_m: np.ndarray
    heading_rad: np.ndarray
    forward_mps: np.ndarray
    rate_radps: np.ndarray


def walk(duration_s: float, *, speed_mps: float = 0.8) -> Walk:
    """Return a walk up and down a field: 25 s ahead, standing to look, a turn, 6 s ahead, a turn the same way."""
    count = round(duration_s * TICK_HZ)
    forward, rate = np.zeros(count), np.zeros(count)
    at, side = 0, 1.0
    turn_s = 3.0
    while at < count:
        for ahead_s, stand_s in ((25.0, 4.0), (6.0, 1.0)):
            stop = at + round(ahead_s * TICK_HZ)
            forward[at:stop] = speed_mps
            at = stop + round(stand_s * TICK_HZ)
            stop = at + round(turn_s * TICK_HZ)
            rate[at:stop] = side * math.radians(90.0) / turn_s
            at = stop
        side = -side
    # Nothing starts or stops within a tick.
    kernel = np.ones(25) / 25.0
    forward, rate = np.convolve(forward, kernel, "same"), np.convolve(rate, kernel, "same")
    heading = 0.3 + np.cumsum(rate) / TICK_HZ
    x = np.cumsum(forward * np.sin(heading)) / TICK_HZ
    y = np.cumsum(forward * np.cos(heading)) / TICK_HZ
    return Walk(x, y, heading, forward, rate)


def wander(rng: np.random.Generator, count: int, sigma: float, tau_s: float, step_s: float) -> np.ndarray:
    """Return a first-order Gauss-Markov process, begun in its steady state."""
    keep = math.exp(-step_s / tau_s)
    fresh = rng.normal(size=count) * sigma * math.sqrt(1.0 - keep * keep)
    values = np.empty(count)
    last = rng.normal() * sigma
    for number in range(count):
        last = keep * last + fresh[number]
        values[number] = last
    return values


def readings(path: Walk, truth: Truth, seed: int, *, tells_sigma: bool = True) -> list[Measurement]:
    """Return what all sensors say on a walk, in the order of time."""
    rng = np.random.Generator(np.random.PCG64(seed))
    count, model = len(path.x_m), truth.model
    fixes = range(0, count, FIX_EVERY)
    step_s = FIX_EVERY / TICK_HZ
    off = [
        wander(rng, len(fixes), model.wander_m, model.wander_tau_s, step_s)
        + rng.normal(size=len(fixes)) * model.white_m
        for _ in range(2)
    ]
    drift = rng.normal(size=(len(fixes), 2)) * model.velocity_mps
    compass_off = wander(rng, count, math.radians(2.0), 120.0, 1.0 / TICK_HZ)
    compass_white = rng.normal(size=count) * math.radians(1.0)
    gyro = rng.normal() * math.radians(0.1) + rng.normal(size=count) * math.radians(0.02) * math.sqrt(TICK_HZ)
    legs = rng.normal(size=(count, 2)) * 0.05
    scale = 1.0 + rng.normal() * 0.01
    said: list[Measurement] = []
    for tick in range(count):
        time_s = tick / TICK_HZ
        said.append(ImuSample(time_s, float(path.rate_radps[tick] + gyro[tick])))
        if tick % ODOMETRY_EVERY == 0:
            said.append(
                OdometryReading(time_s, float(path.forward_mps[tick] * scale + legs[tick, 0]), float(legs[tick, 1]))
            )
        if tick % COMPASS_EVERY == 0:
            said.append(CompassReading(time_s, float(path.heading_rad[tick] + compass_off[tick] + compass_white[tick])))
        if tick % FIX_EVERY == 0:
            number = tick // FIX_EVERY
            vx = path.forward_mps[tick] * math.sin(path.heading_rad[tick]) + drift[number, 0]
            vy = path.forward_mps[tick] * math.cos(path.heading_rad[tick]) + drift[number, 1]
            said.append(
                Fix(
                    time_s,
                    truth.quality,
                    0.0,
                    0.0,
                    float(path.x_m[tick] + off[0][number]),
                    float(path.y_m[tick] + off[1][number]),
                    sigma_m=model.sigma_m if tells_sigma else None,
                    speed_mps=math.hypot(vx, vy),
                    course_rad=math.atan2(vx, vy) % (2.0 * math.pi),
                )
            )
    return said


@dataclass(frozen=True, slots=True)
class Errors:
    """How far a localizer was off.

    Attributes:
        position_m: At each fix after the first half minute, metres.
        heading_rad: Likewise of the heading.
        says_m: How far it said that it may be off, for both axes together.
    """

    position_m: np.ndarray
    heading_rad: np.ndarray
    says_m: np.ndarray


def follow(path: Walk, said: list[Measurement], settings: LocalizerSettings, *, from_s: float = 30.0) -> Errors:
    """Return how far a localizer is off that is given readings."""
    localizer = Localizer(replace(settings, lag_s=0.0))
    position, heading, says = [], [], []
    for measurement in said:
        localizer.take(measurement)
        if isinstance(measurement, Fix) and measurement.time_s >= from_s:
            tick = round(measurement.time_s * TICK_HZ)
            estimate = localizer.at(measurement.time_s).estimate
            assert estimate is not None
            position.append(estimate.pose.distance_to_m(float(path.x_m[tick]), float(path.y_m[tick])))
            heading.append(bearing_between_rad(float(path.heading_rad[tick]), estimate.pose.heading_rad))
            says.append(math.sqrt(2.0) * estimate.position_sigma_m)
    return Errors(np.array(position), np.array(heading), np.array(says))


def rms(values: np.ndarray) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def told(truth: Truth) -> LocalizerSettings:
    """Return the settings of a localizer that is told how the receiver really errs, and learns nothing."""
    receivers = {**RECEIVERS, truth.quality: truth.model}
    return LocalizerSettings(track=TrackSettings(receivers=receivers, worst_fix_factor=1.0))


def credulous(truth: Truth) -> LocalizerSettings:
    """Return the settings of a localizer that takes all of the receiver's error to be new in each fix."""
    white = ReceiverModel(truth.model.sigma_m, 1e-4, 1.0, truth.model.velocity_mps)
    return LocalizerSettings(track=TrackSettings(receivers={**RECEIVERS, truth.quality: white}))
