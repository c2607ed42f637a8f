"""How the agent explores."""

import math
from dataclasses import dataclass

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within, kind_faults

_SWITCHES = ("straight_distance", "look_back_after_stop", "check_after_planning", "straight_legs")


@dataclass(frozen=True, slots=True)
class ExplorerSettings:
    """How the agent looks, steps, halts and gives up; (P) is the paper's, (C) the authors' code's, (O) ours.

    Attributes:
        views: N, headings per look, 1 to 24 (C: 3).
        sweep_rad: Range of motion that the headings span, radians, in [0, 2π] (C: 120°).
        step_min_m: Shortest step to a frontier, metres; None takes it by level (C: 10, for levels 1, 2 and 4: 5).
        step_max_m: Longest step, metres; None takes it by level (C: 15, for levels 1, 2 and 4: 20).
        t_max_s: Mission time above which the mission is failed (P: 30 minutes).
        max_steps: Steps after which the budget is spent.
        looks_to_confirm: Looks that must agree before "Found Goal" is declared, at least 1 (O: 2).
        sharpness_per_m: k of σ(d) (C: 0.5).
        half_distance_m: d0 of σ(d), metres (C: 60).
        straight_distance: Whether d is the straight distance instead of the length of the way along known edges; the
            authors fly straight, so that theirs is both (P leaves it open).
        known_radius_m: A frontier this near to an earlier leg costs at least σ(d0), metres; 0 for never, which is the
            paper's Q − σ(d) (O).
        merge_radius_m: Path points nearer than this are one (O).
        revisit_radius_m: A new frontier nearer than this to an older path point was already visited (O).
        look_back_after_stop: Whether the look after a leg that something stopped takes in what lies behind, too, with N
            views more: what lies ahead is then known to be blocked (O).
        check_after_planning: Whether views are checked when planning is over, one by one until one is found, as in the
            authors' code, instead of all at once while planning goes on; CT grows by every check (C).
        straight_legs: Whether a remote frontier is flown to straight, as the authors' drone does, instead of along
            known edges; d is then the straight distance, too (C).
        max_faults_in_a_row: Faults of parts without a sound step between them that end the mission (O).
    """

    views: int = 3
    sweep_rad: float = math.radians(120.0)
    step_min_m: float | None = None
    step_max_m: float | None = None
    t_max_s: float = 1800.0
    max_steps: int = 2000
    looks_to_confirm: int = 2
    sharpness_per_m: float = 0.5
    half_distance_m: float = 60.0
    straight_distance: bool = False
    known_radius_m: float = 0.0
    merge_radius_m: float = 1.5
    revisit_radius_m: float = 3.0
    look_back_after_stop: bool = False
    check_after_planning: bool = False
    straight_legs: bool = False
    max_faults_in_a_row: int = 3

    def __post_init__(self) -> None:
        low, high = self.step_range_m(None)
        sweep = f"{math.degrees(self.sweep_rad):.10g}°" if is_within(self.sweep_rad) else repr(self.sweep_rad)
        t_max = (
            f"{self.t_max_s:g} s ({self.t_max_s / 60.0:g} minutes)" if is_within(self.t_max_s) else f"{self.t_max_s} s"
        )
        steps = is_within(low, 0.5, 200.0) and is_within(high, 0.5, 200.0) and low <= high
        checks = (
            (is_within(self.views, 1, 24, whole=True), f"views is {self.views!r}", "1 to 24"),
            (is_within(self.sweep_rad, 0.0, 2 * math.pi), f"sweep is {sweep}", "0° to 360°"),
            (steps, f"steps are {low} to {high} m", "0.5 m ≤ shortest ≤ longest ≤ 200 m"),
            (
                is_within(self.t_max_s, 0.0, 86_400.0) and self.t_max_s > 0.0,
                f"t_max is {t_max}",
                "above 0, at most 86,400 s (1,440 minutes)",
            ),
            (is_within(self.max_steps, 1, 100_000, whole=True), f"max_steps is {self.max_steps!r}", "1 to 100,000"),
            (
                is_within(self.looks_to_confirm, 1, 10, whole=True),
                f"looks_to_confirm is {self.looks_to_confirm!r}",
                "1 to 10",
            ),
            (is_within(self.sharpness_per_m, 0.0, 100.0), f"k is {self.sharpness_per_m}", "0 to 100 per metre"),
            (is_within(self.half_distance_m, 0.0, 1e6), f"d0 is {self.half_distance_m} m", "0 to 1,000,000 m"),
            (is_within(self.known_radius_m, 0.0, 50.0), f"known radius is {self.known_radius_m} m", "0 to 50 m"),
            (is_within(self.merge_radius_m, 0.0, 50.0), f"merge radius is {self.merge_radius_m} m", "0 to 50 m"),
            (is_within(self.revisit_radius_m, 0.0, 50.0), f"revisit radius is {self.revisit_radius_m} m", "0 to 50 m"),
            (
                is_within(self.max_faults_in_a_row, 1, 100, whole=True),
                f"max_faults_in_a_row is {self.max_faults_in_a_row!r}",
                "1 to 100",
            ),
        )
        faults = [Fault(what, expected) for sound, what, expected in checks if not sound]
        for name in _SWITCHES:
            faults += kind_faults(name, getattr(self, name), bool, "true or false")
        if faults:
            raise SettingsError("exploration settings", faults)

    def step_range_m(self, level: int | None) -> tuple[float, float]:
        """Return the shortest and the longest step for a goal of a level (C)."""
        low, high = (5.0, 20.0) if level in (1, 2, 4) else (10.0, 15.0)
        return (
            low if self.step_min_m is None else self.step_min_m,
            high if self.step_max_m is None else self.step_max_m,
        )

    def step_m(self, q: float | None, level: int | None) -> float:
        """Return how far ahead a frontier stands: min + (1 − Q/5)·(max − min); the longest where Q is missing (C)."""
        low, high = self.step_range_m(level)
        return high if q is None else low + (1.0 - min(5.0, max(0.0, q)) / 5.0) * (high - low)

    def bearings_rad(self, turn_rad: float = 0.0) -> list[float]:
        """Return the bearings of a look's views from left to right, turned by ``turn_rad``."""
        if self.views == 1:
            return [turn_rad]
        # A full circle must not look in its first direction twice.
        gaps = self.views if self.sweep_rad >= 2 * math.pi - 1e-9 else self.views - 1
        return [turn_rad + self.sweep_rad * (index / gaps - 0.5) for index in range(self.views)]

    def other_turns_rad(self) -> list[float]:
        """Return the turns by which a look is repeated at a place where nothing is left: behind, then in between."""
        half_gap_rad = self.sweep_rad / max(1, self.views - 1) / 2.0
        return [math.pi, half_gap_rad, math.pi + half_gap_rad]
