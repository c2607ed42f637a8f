"""Localization in real time: measurements come in when they come in, and count for when they were made."""

import heapq
import math
from dataclasses import astuple, dataclass, field

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.control.localization import PoseEstimate
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.track import Measurement, Track
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings
from reasoned_explorer.vehicles.positioning.verdict import Evidence, PositionLimits, PositionVerdict, judge

# Of measurements of one moment those that say how the machine moved come before those that say where it is.
_ORDER = {ImuSample: 0, OdometryReading: 1, CompassReading: 2, Fix: 3}
# A time so far ahead of the others is of another clock.
_AHEAD_S = 5.0


@dataclass(frozen=True, slots=True)
class LocalizerSettings:
    """How a localizer works.

    Attributes:
        track: What the sensors are worth.
        limits: From when on a position is not good any more.
        lag_s: So long a measurement may be on its way and still count for when it was made, seconds, ≥ 0.
        fix_latency_s: So long fixes are on their way from the sky to the first byte that arrives, seconds, ≥ 0; 0.1 to
            0.2 is usual.

    Raises:
        SettingsError: If a time is out of range.
    """

    track: TrackSettings = field(default_factory=TrackSettings)
    limits: PositionLimits = field(default_factory=PositionLimits)
    lag_s: float = 0.3
    fix_latency_s: float = 0.0

    def __post_init__(self) -> None:
        faults = [
            Fault(f"{name} = {getattr(self, name)}", "seconds from 0 to 2")
            for name in ("lag_s", "fix_latency_s")
            if not is_within(getattr(self, name), 0.0, 2.0)
        ]
        if faults:
            raise SettingsError("localizer", faults)


@dataclass(frozen=True, slots=True)
class Localization:
    """Where the machine is at a moment.

    Attributes:
        time_s: The moment.
        estimate: What the filter believes; None where it has not begun.
        verdict: Whether the machine may move by it.
        quality: Of the last fix; None before the first.
        fix_age_s: Since the last fix that was believed; infinite before the first.
    """

    time_s: float
    estimate: PoseEstimate | None
    verdict: PositionVerdict
    quality: FixQuality | None
    fix_age_s: float = math.inf


@dataclass(slots=True)
class LocalizerCounts:
    """What became of the measurements.

    Attributes:
        taken: Applied or waiting to be.
        late: Thrown away since what came after them was applied already.
        unusable: Thrown away since a number is not finite, or the time is of another clock.
        fixes_refused: Fixes that the filter did not believe.
        restarts: How often it had to start over.
    """

    taken: int = 0
    late: int = 0
    unusable: int = 0
    fixes_refused: int = 0
    restarts: int = 0


class Localizer:
    """Makes one position of fixes, turn rates, a compass and odometry.

    All times are of one clock, the caller's; none is read here. Measurements may come in any order within `lag_s`: what
    came is kept and applied in the order of its times, and a copy of the filter goes on from there to where the machine
    is now. The same measurements give the same position, whatever the order in which they came.

    Args:
        settings: How it works.
    """

    def __init__(self, settings: LocalizerSettings | None = None) -> None:
        self.settings = settings or LocalizerSettings()
        self.counts = LocalizerCounts()
        self._track = Track(self.settings.track)
        self._waiting: list[tuple[float, int, tuple[object, ...], int, Measurement]] = []
        self._number = 0
        self._newest_s = -math.inf

    def take(self, measurement: Measurement) -> None:
        """Take in a measurement; one that cannot be used is counted and thrown away, and never raises."""
        time_s = measurement.time_s
        if isinstance(measurement, Fix):
            time_s -= self.settings.fix_latency_s
        if not math.isfinite(time_s) or not all(map(math.isfinite, _numbers(measurement))):
            self.counts.unusable += 1
            return
        if self._newest_s > -math.inf and time_s > self._newest_s + _AHEAD_S:
            # Once may be a pause, and is let pass the second time.
            self._newest_s = time_s - _AHEAD_S
            self.counts.unusable += 1
            return
        if time_s < self._track.time_s:
            self.counts.late += 1
            return
        self._newest_s = max(self._newest_s, time_s)
        self._number += 1
        self.counts.taken += 1
        order = _ORDER[type(measurement)]
        heapq.heappush(self._waiting, (time_s, order, _key(measurement), self._number, measurement))

    def at(self, now_s: float) -> Localization:
        """Return where the machine is at a time, which is not before that of the last call.

        Args:
            now_s: Now, on the clock of the measurements.
        """
        certain_s = now_s - self.settings.lag_s
        while self._waiting and self._waiting[0][0] <= certain_s:
            time_s, *_, measurement = heapq.heappop(self._waiting)
            self._apply(self._track, time_s, measurement)
        track = self._track.copy()
        for time_s, *_, measurement in sorted(self._waiting):
            if time_s <= now_s:
                self._apply(track, time_s, measurement)
        track.go_on_to(now_s)
        self.counts.fixes_refused = track.fixes.total
        self.counts.restarts = track.fixes.restarts + track.compass.restarts
        estimate = None if track.filter is None else track.filter.estimate
        evidence = Evidence(
            estimate,
            track.missing,
            track.quality,
            now_s - track.believed_s,
            track.fixes.lasted_s(now_s),
            track.off_m,
            track.compass.lasted_s(now_s),
            now_s - track.imu_s,
            now_s - max(track.fixes.restarted_s, track.compass.restarted_s),
        )
        return Localization(now_s, estimate, judge(evidence, self.settings.limits), track.quality, evidence.fix_age_s)

    def _apply(self, track: Track, time_s: float, measurement: Measurement) -> None:
        if isinstance(measurement, Fix) and time_s != measurement.time_s:
            measurement = _moved(measurement, time_s)
        track.apply(measurement)


def _numbers(measurement: Measurement) -> list[float]:
    """Return the numbers of a measurement that the filter is given."""
    values: tuple[float | None, ...]
    if not isinstance(measurement, Fix):
        values = astuple(measurement)
    elif measurement.quality is FixQuality.NONE:
        values = ()
    else:
        fix = measurement
        values = (fix.x_m, fix.y_m, fix.sigma_m, fix.speed_mps, fix.course_rad)
    return [value for value in values if value is not None]


def _moved(fix: Fix, time_s: float) -> Fix:
    values = {name: getattr(fix, name) for name in Fix.__slots__}
    return Fix(**{**values, "time_s": time_s})


def _key(measurement: Measurement) -> tuple[object, ...]:
    """Return what orders measurements of one kind and moment, whichever came first."""
    return tuple((value is not None, value or 0.0) for value in astuple(measurement))
