"""Rows of missions that nobody ran, for tests of the report."""

import math
from dataclasses import replace

import numpy as np

from reasoned_explorer.evaluation.report import ReportAbout
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.scoring import MissionOutcome, score
from reasoned_explorer.model.draws import key_of

METHODS = ("llm-rrt", "llm-as-eval", "nearest-frontier", "follow-paths", "oracle")
GOALS = ("Find me a bench", "I want to take a nap", "Take me to a café, keep off the grass", "Somewhere to eat — cheap")
PLACES = (("park:3", "generated", "park"), ("uvic/0", "victoria", "campus"), ("monaco/1", "monaco", "quarter"))
ABOUT = ReportAbout(
    title="A run of the tests",
    split="mini",
    split_version="1",
    split_hash="abc123",
    command="rex bench --split mini",
    version="0.1.0",
    honesty=("No language model took part.",),
    ceilings=(("CASR of the oracle", ".80"),),
    methods=METHODS,
    bounds=("oracle",),
)


def made_row(
    method: str = "llm-rrt",
    number: int = 0,
    *,
    declared: bool = True,
    in_place: bool = True,
    been_there: bool = False,
    ct_s: float = 300.0,
    tt_s: float = 200.0,
    end: str | None = None,
    compliant: bool | None = None,
    path_m: float = 200.0,
    **changes: object,
) -> MissionRow:
    """Return a row; what is not said is a success of level ``number % 4 + 1``."""
    place, city, district = PLACES[number % len(PLACES)]
    mission_id = f"{place}|{number:04d}"
    scored = score(
        MissionOutcome(
            mission_id=mission_id,
            level=number % 4 + 1,
            vehicle="drone",
            declared=declared,
            in_place=in_place,
            oracle_success=been_there,
            path_length_m=path_m,
            reference_length_m=100.0 if number % 11 else math.inf,
            computing_s=ct_s,
            travelling_s=tt_s,
            planner_computing_s=ct_s / 2.0,
            distance_to_goal_m=8.0 if in_place else 120.0,
            in_place_at=((5.0, False), (10.0, in_place and number % 2 == 0), (15.0, in_place), (20.0, in_place)),
        )
    )
    row = MissionRow(
        method=method,
        mission_id=mission_id,
        place=place,
        city=city,
        district=district,
        band="near",
        goal=GOALS[number % 4],
        seed=number,
        planner=f"{method} [embedded minds]",
        minds="embedded minds, no language model",
        captioner="simulated captioner (noisy)",
        ct_label="modelled (gpt-2023)",
        attribution="© OpenStreetMap contributors, ODbL 1.0" if city != "generated" else "",
        end=end or ("found" if declared else "time over"),
        reason="Found Goal" if declared else "T_max of 1800 s is over",
        judge="bench 8 m away, in sight" if in_place else "the nearest is 120 m away",
        declared=declared,
        compliant=compliant,
        steps=20,
        calls=100,
        tokens_in=12_000,
        tokens_out=900,
        usd=0.04,
        evaluator_sum=60.0,
        evaluator_count=20,
        small_collisions=number % 3,
        large_collisions=number % 5,
        score=scored,
    )
    return replace(row, **changes)


def many_rows(count: int = 24, methods: tuple[str, ...] = METHODS, *, seed: int = 1) -> list[MissionRow]:
    """Return ``count`` missions of each method with all that can become of one, drawn by seed."""
    rows = []
    for at, method in enumerate(methods):
        luck = np.random.Generator(np.random.PCG64(key_of(seed, method)))
        for number in range(count):
            declared, in_place, been_there = (bool(luck.random() < chance) for chance in (0.6, 0.3 + 0.1 * at, 0.4))
            ct_s, tt_s = float(luck.uniform(60, 900)), float(luck.uniform(60, 850))
            end = None if declared else ("time over", "time over", "nothing left", "fault")[int(luck.integers(4))]
            compliant = bool(luck.random() < 0.7) if number % 4 == 2 else None
            rows.append(
                made_row(
                    method,
                    number,
                    declared=declared,
                    in_place=in_place and compliant is not False,
                    been_there=been_there,
                    ct_s=ct_s,
                    tt_s=tt_s,
                    end=end,
                    compliant=compliant,
                    path_m=float(luck.uniform(50, 1500)),
                )
            )
    return rows
