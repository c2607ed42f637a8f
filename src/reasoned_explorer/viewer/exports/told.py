"""What is said in a mission, in words: what it is, what was seen, thought, decided and run into."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from reasoned_explorer import __version__
from reasoned_explorer.model.record import EpisodeRecord, FrontierRecord, LegRecord, MissionSummary, StepRecord
from reasoned_explorer.model.track import LegOutcome
from reasoned_explorer.viewer.exports.mission import ExportedMission
from reasoned_explorer.viewer.exports.moments import checked_s, decided_s, ended_s, looks

#: Whom a line of the log is from.
TOPICS = ("caption", "checker", "choice", "leg", "guard", "note", "end")
_CLOCKS = {
    "virtual": "simulated seconds since the mission began",
    "mixed": "seconds since the mission began: travel is simulated, calls of models took as long as they really did",
    "real": "real seconds since the mission began",
}


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a mission's log.

    Attributes:
        t_s: Mission time.
        topic: One of `TOPICS`.
        text: What happened.
        warns: Whether something went wrong.
    """

    t_s: float
    topic: str
    text: str
    warns: bool = False


def about(mission: ExportedMission) -> dict[str, str]:
    """Return what a mission is, by name; what is not known is left out."""
    header, summary = mission.record.header, mission.record.summary
    facts = {
        "goal": header.goal,
        "level": "" if header.level is None else f"{header.level}",
        "understood": "; ".join(header.understood),
        "mission": mission.name,
        "place": header.world if header.is_judged else "no world is known",
        "data": header.attribution,
        "planner": header.planner,
        "minds": header.minds,
        "captioner": header.captioner,
        "vehicle": header.vehicle,
        "seed": f"{header.seed}",
        "outcome": outcome(summary),
        **(_scores(summary) if summary else {}),
        "time": f"{_CLOCKS.get(header.clock, 'seconds since the mission began')}; CT {header.ct_label}",
        "frame": "metres east, north and above the ground (ENU, z up) of the place's origin",
        "track": "true positions, not estimated ones",
        "ground": _ground(mission),
        "notes": "; ".join(header.notes),
        "made_by": f"reasoned-explorer {header.versions.get('reasoned-explorer', '')}, exported by {__version__}",
    }
    if header.origin_deg is not None:
        facts["origin"] = "latitude {:.7f}, longitude {:.7f} degrees (WGS 84)".format(*header.origin_deg)
    return {name: text for name, text in facts.items() if text}


def _ground(mission: ExportedMission) -> str:
    if mission.world is not None:
        return "the world of the mission"
    if not mission.record.header.is_judged:
        return "blank: no world is known"
    return "blank: the world of the mission could not be found"


def outcome(summary: MissionSummary | None) -> str:
    """Return how a mission came out, in a sentence."""
    if summary is None:
        return "cut off: the record ends with its last whole step"
    judged = {None: "nobody judged", True: "success", False: "failure"}[summary.success]
    said = "declared “Found Goal”" if summary.declared else f"ended: {summary.end.value}"
    return ", ".join(part for part in (judged, said, summary.judge or summary.reason) if part)


def _scores(summary: MissionSummary) -> dict[str, str]:
    facts = {"path": f"{summary.path_length_m:.1f} m", "ct": f"{summary.ct_s:.1f} s", "tt": f"{summary.tt_s:.1f} s"}
    scores = {"spl": summary.spl, "casr": summary.casr}
    return {**facts, **{name: f"{value:.3f}" for name, value in scores.items() if value is not None}}


def lines(record: EpisodeRecord) -> list[Line]:
    """Return the log of a mission in the order of time."""
    said = [line for step in record.steps for line in _of_step(step)]
    said.append(Line(ended_s(record), "end", outcome(record.summary), warns=record.summary is None))
    return sorted(said, key=lambda line: line.t_s)


def _of_step(step: StepRecord) -> Iterator[Line]:
    for look in looks(step):
        for view in look.views:
            where = f"step {step.step}, {degrees(view.heading_rad)}"
            yield Line(
                look.said_s,
                "caption",
                f"{where}: {view.caption or f'no description: {view.caption_fault}'}",
                warns=view.caption_fault is not None,
            )
            if view.check_fault is not None or view.found or view.evidence:
                yield Line(
                    checked_s(step, look, view),
                    "checker",
                    f"{where}: {_check(view.found, view.confidence, view.evidence, view.check_fault)}",
                    warns=view.check_fault is not None,
                )
    if step.choice is not None:
        yield Line(decided_s(step), "choice", f"step {step.step}: {_choice(step)}")
    for leg in step.legs:
        if leg.outcome is not LegOutcome.ARRIVED:
            yield Line(_leg_end_s(leg, step), "leg", _leg(leg), warns=True)
    for stop in step.interventions:
        yield Line(stop.t_s, "guard", f"{stop.cause}: {stop.detail}; {stop.done}", warns=True)
    for note in step.notes:
        yield Line(step.ended_s, "note", f"step {step.step}: {note}")


def _check(found: bool, confidence: float, evidence: str, fault: str | None) -> str:  # noqa: FBT001
    if fault is not None:
        return f"no answer: {fault}"
    return (
        f"{'goal seen' if found else 'not the goal'} (confidence {confidence:.2f}): {evidence or 'no evidence given'}"
    )


def _choice(step: StepRecord) -> str:
    choice = step.choice
    if choice is None:
        return "nothing"
    if choice.q is None or choice.value is None:
        return f"to frontier {choice.frontier}, {choice.distance_m:.1f} m away, without a score"
    return (
        f"to frontier {choice.frontier}, {choice.distance_m:.1f} m away: "
        f"Q {choice.q:.2f} - penalty {choice.penalty:.2f} = {choice.value:.2f}"
    )


def _leg(leg: LegRecord) -> str:
    what = leg.outcome.value + (f" with {leg.detail}" if leg.outcome is LegOutcome.COLLISION else f": {leg.detail}")
    return what if leg.detail else leg.outcome.value


def _leg_end_s(leg: LegRecord, step: StepRecord) -> float:
    return leg.track[-1].t_s if leg.track else step.ended_s


def degrees(heading_rad: float) -> str:
    """Return a compass heading for people."""
    return f"heading {math.degrees(heading_rad) % 360.0:.0f}°"


def frontier_label(frontier: FrontierRecord) -> str:
    """Return what stands beside a way on."""
    score = "no score" if frontier.q is None else f"Q {frontier.q:.2f}"
    return f"{frontier.id}: {score}" + ("" if frontier.state == "open" else f", {frontier.state}")


def tree_of(step: StepRecord) -> str:
    """Return what was imagined in a step as text, a scene a line, those imagined from it indented below."""
    said = [f"step {step.step}"]
    for view in step.views:
        score = "-" if view.q is None else f"{view.q:.2f}"
        said.append(
            f"view {view.key[-1]}, {degrees(view.heading_rad)}, Q {score}: {view.caption or view.caption_fault}"
        )
        if view.plan_fault is not None:
            said.append(f"  no plan: {view.plan_fault}")
        for node in step.tree:
            if node.key[: len(view.key)] == view.key:
                worth = "-" if node.score is None else f"{node.score:.2f}"
                marks = " blocked" * node.blocked + " forbidden" * node.forbidden
                said.append(f"{'  ' * node.depth}[{worth}]{marks} {node.text or node.fault or ''}".rstrip())
    return "\n".join(said)
