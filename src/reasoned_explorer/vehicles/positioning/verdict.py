"""Whether a position is good enough to move by, and if not, why."""

import math
from dataclasses import dataclass, fields
from enum import StrEnum

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.control.localization import PoseEstimate
from reasoned_explorer.vehicles.positioning.fix import FixQuality


class Grade(StrEnum):
    """What a position is good for: to move, not to move, or nothing because it is old."""

    GOOD = "good"
    POOR = "poor"
    STALE = "stale"


@dataclass(frozen=True, slots=True)
class PositionVerdict:
    """A grade and its reason.

    Attributes:
        grade: Whether the machine may move by it.
        reason: Why not, for people; all reasons, the gravest first; empty where it is good.
    """

    grade: Grade
    reason: str = ""

    @property
    def is_good(self) -> bool:
        """Whether the machine may move."""
        return self.grade is Grade.GOOD


@dataclass(frozen=True, slots=True)
class PositionLimits:
    """From when on a position is not good any more.

    Attributes:
        position_sigma_m: Largest uncertainty of the position, metres.
        heading_sigma_rad: Largest uncertainty of the heading, radians.
        least_quality: Fixes of a lower quality will not do.
        poor_after_s: So long after the last believed fix it is poor, seconds. One fix a second needs 1.5.
        stale_after_s: So long after it is stale.
        refused_s: Measurements having been refused for so long it is poor: they are wrong, or the filter is.
        imu_silence_s: So long after the last turn rate it is poor.
        settle_s: So long after the filter had to start over it is poor.

    Raises:
        SettingsError: If a value is out of range.
    """

    position_sigma_m: float = 3.0
    heading_sigma_rad: float = math.radians(10.0)
    least_quality: FixQuality = FixQuality.SINGLE
    poor_after_s: float = 0.8
    stale_after_s: float = 3.0
    refused_s: float = 0.5
    imu_silence_s: float = 0.3
    settle_s: float = 3.0

    def __post_init__(self) -> None:
        faults = [
            Fault(f"{item.name} = {getattr(self, item.name)}", "a number > 0")
            for item in fields(self)
            if item.name != "least_quality" and not getattr(self, item.name) > 0.0
        ]
        if self.least_quality is FixQuality.NONE:
            faults.append(Fault("least_quality is none", "single or better"))
        if self.stale_after_s < self.poor_after_s:
            faults.append(Fault(f"stale_after_s = {self.stale_after_s}", f"at least {self.poor_after_s}"))
        if faults:
            raise SettingsError("limits of a position", faults)


@dataclass(frozen=True, slots=True)
class Evidence:
    """What a verdict is made of.

    Attributes:
        estimate: What the filter believes; None where it has not begun.
        missing: What it waits for to begin, for people.
        quality: Of the last fix; None before the first.
        fix_age_s: Seconds since the last fix that was believed; infinite before the first.
        fix_refused_s: For how long fixes have been refused.
        fix_off_m: How far the last refused fix was off.
        compass_refused_s: For how long the compass has been refused.
        imu_age_s: Seconds since the last turn rate.
        restart_age_s: Seconds since the filter had to start over; infinite where it never had to.
    """

    estimate: PoseEstimate | None
    missing: str
    quality: FixQuality | None
    fix_age_s: float
    fix_refused_s: float
    fix_off_m: float
    compass_refused_s: float
    imu_age_s: float
    restart_age_s: float


def judge(evidence: Evidence, limits: PositionLimits) -> PositionVerdict:
    """Return the verdict on a position."""
    if evidence.estimate is None:
        return PositionVerdict(Grade.STALE, f"no position yet: {evidence.missing}")
    reasons = _reasons(evidence, evidence.estimate, limits)
    if evidence.fix_age_s > limits.stale_after_s:
        return PositionVerdict(Grade.STALE, "; ".join(reasons))
    return PositionVerdict(Grade.POOR, "; ".join(reasons)) if reasons else PositionVerdict(Grade.GOOD)


def _reasons(evidence: Evidence, estimate: PoseEstimate, limits: PositionLimits) -> list[str]:
    reasons = []
    if evidence.fix_age_s > limits.poor_after_s:
        reasons.append(f"no believable fix for {evidence.fix_age_s:.1f} s")
    if evidence.fix_refused_s >= limits.refused_s:
        reasons.append(f"fixes have been {evidence.fix_off_m:.1f} m off for {evidence.fix_refused_s:.1f} s")
    quality = evidence.quality
    if quality is not None and quality < limits.least_quality:
        reasons.append(f"the receiver has {quality.as_text}, {limits.least_quality.as_text} is asked for")
    if evidence.compass_refused_s >= limits.refused_s:
        reasons.append(f"the compass has been at odds with turn rate and course for {evidence.compass_refused_s:.1f} s")
    if evidence.imu_age_s > limits.imu_silence_s:
        reasons.append(f"no turn rate for {evidence.imu_age_s:.1f} s")
    if evidence.restart_age_s < limits.settle_s:
        reasons.append(f"the filter had to start over {evidence.restart_age_s:.1f} s ago")
    if not estimate.position_sigma_m <= limits.position_sigma_m:
        reasons.append(f"position uncertain by {estimate.position_sigma_m:.1f} m")
    if not estimate.heading_sigma_rad <= limits.heading_sigma_rad:
        reasons.append(f"heading uncertain by {math.degrees(estimate.heading_sigma_rad):.0f}°")
    return reasons
