"""What became of a mission, in one word each: found, or why not. Made from its row alone.

The causes exclude each other and leave nothing over. Where two would fit the first of this order holds:

1. *found*: success.
2. Declared in time, but no success: *shunned ground* where the goal's ground was broken on the way (the judge's verdict
   names it first, too); else *false halt*, which had been in place before or never had.
3. Not declared, or declared after T_max: by how the mission ended. *Time over* had been in place, or never had.
   Ground that was broken by a mission that never declared is no cause of its own: the search had not ended.
"""

from enum import StrEnum

from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.model.record import MissionEnd


class Cause(StrEnum):
    """What became of a mission; the value is what people read."""

    FOUND = "found rightly"
    FALSE_HALT_BEEN = "false halt, had been there"
    FALSE_HALT_NEVER = "false halt, never there"
    SHUNNED_GROUND = "shunned ground"
    TIME_OVER_BEEN = "time over, had been there"
    TIME_OVER_NEVER = "time over, never there"
    BUDGET = "budget spent"
    NOTHING_LEFT = "nothing left"
    FAULT = "fault"
    INTERRUPTED = "interrupted"

    @property
    def key(self) -> str:
        """Of links and files: no spaces."""
        return self.name.lower().replace("_", "-")

    @property
    def meaning(self) -> str:
        """One sentence for people."""
        return _MEANINGS[self]


_MEANINGS = {
    Cause.FOUND: "declared in time, in place, the goal's conditions kept",
    Cause.FALSE_HALT_BEEN: "declared at the wrong place, after a moment at which declaring would have been right",
    Cause.FALSE_HALT_NEVER: "declared at the wrong place, and there was no such moment",
    Cause.SHUNNED_GROUND: "declared, but the way had crossed ground that the goal tells to keep off",
    Cause.TIME_OVER_BEEN: "T_max passed; at some moment declaring would have been right, and nothing was said",
    Cause.TIME_OVER_NEVER: "T_max passed, and there was no such moment",
    Cause.BUDGET: "the budget of calls or money was spent",
    Cause.NOTHING_LEFT: "no frontier was left to go to",
    Cause.FAULT: "a part failed",
    Cause.INTERRUPTED: "a person stopped it",
}

_UNDECLARED = {
    MissionEnd.BUDGET_SPENT: Cause.BUDGET,
    MissionEnd.NOTHING_LEFT: Cause.NOTHING_LEFT,
    MissionEnd.FAULT: Cause.FAULT,
    MissionEnd.INTERRUPTED: Cause.INTERRUPTED,
}


def cause_of(row: MissionRow) -> Cause:
    """Return what became of a mission.

    Raises:
        InputError: If the row's end is none that a mission can have.
    """
    score = row.score
    try:
        return cause_among(
            row.end,
            success=score.success,
            declared=row.declared,
            over_time=score.over_time,
            compliant=row.compliant,
            oracle_success=score.oracle_success,
        )
    except ValueError as error:
        known = ", ".join(MissionEnd)
        raise InputError("row of a mission", [Fault(f"{row.mission_id!r} ended {row.end!r}", known)]) from error


def cause_among(
    end: str, *, success: bool, declared: bool, over_time: bool, compliant: bool | None, oracle_success: bool
) -> Cause:
    """Return what became of a mission of which only so much is known; see `MissionRow` and its score.

    Raises:
        ValueError: If its end is none that a mission can have.
    """
    if success:
        return Cause.FOUND
    if declared and not over_time:
        if compliant is False:
            return Cause.SHUNNED_GROUND
        return Cause.FALSE_HALT_BEEN if oracle_success else Cause.FALSE_HALT_NEVER
    kind = MissionEnd(end)
    if kind in _UNDECLARED and not declared:
        return _UNDECLARED[kind]
    return Cause.TIME_OVER_BEEN if oracle_success else Cause.TIME_OVER_NEVER
