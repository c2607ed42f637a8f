"""One mission of one method, as it stands in a run's store: what every table and figure is made from.

A row depends on nothing but the mission: no wall time, no process, no order, so that the same benchmark gives the same
rows wherever it runs.
"""

import json
import math
from dataclasses import asdict, dataclass, fields
from typing import Any

from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.model import Fault, InputError


@dataclass(frozen=True, slots=True)
class MissionRow:
    """One mission of one method.

    Attributes:
        method: Name of the method, e.g. ``"llm-rrt"``; see `reasoned_explorer.evaluation.methods`.
        mission_id: Of the episode and its repetition; the same for all methods, so that they can be paired.
        place: The world or neighbourhood that it took place in; missions of a place are not independent.
        city: What the place is part of, e.g. ``"generated"`` or ``"monaco"``.
        district: Kind of place, e.g. ``"park"``; empty where it has none.
        band: How far it is to the goal: ``"near"``, ``"middle"`` or ``"far"``.
        goal: The sentence.
        seed: Of the mission.
        planner: Label of the planner.
        minds: Label of the minds.
        captioner: Label of the captioner.
        ct_label: How CT came about.
        attribution: Of the world's data; empty where it needs none.
        end: How the mission ended, a value of `MissionEnd`.
        reason: In words.
        judge: What the judge said.
        declared: "Found Goal" was said.
        compliant: Shunned ground was kept off; None where the goal says nothing of ground.
        steps: Of the mission.
        calls: Of models, all roles.
        tokens_in: Sent to models.
        tokens_out: Received from them.
        usd: US dollars, of the calls whose cost is known.
        evaluator_sum: Sum of all scores that the evaluator gave, 1 to 5 each.
        evaluator_count: How many scores.
        small_collisions: With what is less than 3 m long (benches, trunks, people).
        large_collisions: With walls, vehicles and other large things.
        score: Its metrics.
        unpriced: How many calls there were whose cost is not known: no price, or no answer.
        lost_calls: How many calls of real models have no answer; None where an older version wrote the row.
    """

    method: str
    mission_id: str
    place: str
    city: str
    district: str
    band: str
    goal: str
    seed: int
    planner: str
    minds: str
    captioner: str
    ct_label: str
    attribution: str
    end: str
    reason: str
    judge: str
    declared: bool
    compliant: bool | None
    steps: int
    calls: int
    tokens_in: int
    tokens_out: int
    usd: float
    evaluator_sum: float
    evaluator_count: int
    small_collisions: int
    large_collisions: int
    score: MissionScore
    unpriced: int = 0
    lost_calls: int | None = None

    @property
    def level(self) -> int:
        """OUTDOOR's level of the goal, 1 to 4."""
        return self.score.level

    def as_json(self) -> str:
        """Return one line of JSON; what is infinite becomes null."""
        plain = asdict(self)
        plain["score"] = {
            name: None if isinstance(value, float) and math.isinf(value) else value
            for name, value in plain["score"].items()
        }
        return json.dumps(plain, sort_keys=True, ensure_ascii=False, allow_nan=False)

    @classmethod
    def from_json(cls, line: str) -> "MissionRow":
        """Return the row of `as_json`.

        Raises:
            InputError: If the line is no row.
        """
        try:
            plain: dict[str, Any] = json.loads(line)
            score = dict(plain["score"])
            score["success_at"] = tuple((float(radius_m), bool(hit)) for radius_m, hit in score["success_at"])
            for name in ("reference_length_m", "distance_to_goal_m"):
                score[name] = math.inf if score[name] is None else score[name]
            plain["score"] = MissionScore(**score)
            return cls(**plain)
        except (ValueError, TypeError, KeyError) as error:
            expected = "a row as MissionRow.as_json writes it, with " + ", ".join(item.name for item in fields(cls))
            raise InputError("row of a mission", [Fault(f"{line[:80]!r}: {error}", expected)]) from error
