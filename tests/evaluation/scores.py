"""Outcomes to score."""

from reasoned_explorer.evaluation.scoring import MissionOutcome, MissionScore, score


def outcome(mission_id: str = "a", **values) -> MissionOutcome:
    """A success after 900 s of 1800 s, on a way twice as long as needed, unless ``values`` say otherwise."""
    given_values = {
        "level": 1,
        "vehicle": "drone",
        "declared": True,
        "in_place": True,
        "oracle_success": True,
        "oracle_seen": True,
        "path_length_m": 200.0,
        "reference_length_m": 100.0,
        "remaining_m": 0.0,
        "computing_s": 300.0,
        "travelling_s": 600.0,
        "planner_computing_s": 120.0,
        "distance_to_goal_m": 4.0,
        "in_place_at": ((5.0, True), (20.0, True)),
    }
    return MissionOutcome(mission_id, **{**given_values, **values})


def scored(mission_id: str = "a", **values) -> MissionScore:
    return score(outcome(mission_id, **values))


#: A halt 3 m before the success region.
FAILED = {
    "in_place": False,
    "in_place_at": ((5.0, False), (20.0, True)),
    "distance_to_goal_m": 18.0,
    "remaining_m": 3.0,
}
