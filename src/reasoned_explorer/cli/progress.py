"""A mission in lines for people; the same while it runs and when it is shown again from its record."""

import math
import textwrap
from collections import Counter
from collections.abc import Iterator

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.ledger import lost_calls
from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import LegOutcome
from reasoned_explorer.model.record import EpisodeRecord, MissionHeader, MissionSummary, StepRecord, ViewRecord

_WIDTH = 110


def header_lines(header: MissionHeader) -> Iterator[str]:
    """Yield what a mission starts with."""
    x_m, y_m, _, heading_rad = header.start
    level = f" (level {header.level})" if header.level else ""
    yield f"“{header.goal}”{level}"
    heading_deg = math.degrees(heading_rad)
    start = f"{x_m:.0f} m east, {y_m:.0f} m north"
    if header.origin_deg is not None:
        lat_deg, lon_deg = GeoOrigin(*header.origin_deg).geodetic_from_enu_deg(x_m, y_m)
        start = f"{lat_deg:.5f}, {lon_deg:.5f}"
    yield f"  world    {header.world}, start {start}, heading {heading_deg:.0f}°"
    for note in header.notes:
        yield from textwrap.wrap(note, _WIDTH, initial_indent="  note     ", subsequent_indent="           ")
    yield f"  agent    {header.planner}"
    yield f"  eyes     {header.captioner}; vehicle {header.vehicle}"
    yield f"  clock    {header.clock}, CT {header.ct_label}; seed {header.seed}"
    reference = "none" if header.reference_length_m is None else f"{header.reference_length_m:.0f} m"
    if header.is_judged:
        yield f"  judge    {len(header.goal_objects)} things here satisfy the goal; shortest way {reference}"
    else:
        yield "  judge    nobody: no world is known; the goal is read as"
    for line in header.understood[:4]:
        yield f"           {_clipped(line)}"
    if len(header.understood) > 4:
        yield f"           and {len(header.understood) - 4} more ways to satisfy it"
    if header.attribution:
        yield f"  map      {header.attribution}"


class Progress:
    """The steps of one mission in lines, with the distance travelled so far."""

    def __init__(self) -> None:
        self._path_m = 0.0

    def lines(self, step: StepRecord) -> Iterator[str]:
        """Yield a step."""
        self._path_m += sum(leg.length_m for leg in step.legs)
        yield from step_lines(step, path_m=self._path_m)


def step_lines(step: StepRecord, *, path_m: float | None = None) -> Iterator[str]:
    """Yield a step: what is seen ahead, what was chosen and why, what it took.

    Args:
        step: The step.
        path_m: Metres travelled since the mission's start, or None to leave them out.
    """
    ahead = _ahead(step)
    gone_m = sum(leg.length_m for leg in step.legs)
    yield f"step {step.step:3d}  {_clock(step.started_s)}  {_clipped(ahead) if ahead else '(no look)'}"
    choice = step.choice
    if choice is not None:
        q = "?" if choice.q is None else f"{choice.q:.2f}"
        value = "?" if choice.value is None else f"{choice.value:.2f}"
        chosen = f"frontier {choice.frontier} in {choice.distance_m:.0f} m: Q {q} − σ(d) {choice.penalty:.2f} = {value}"
        trouble = next((leg for leg in step.legs if leg.outcome is not LegOutcome.ARRIVED), None)
        went = (
            f"{gone_m:.0f} m" if trouble is None else f"{gone_m:.0f} m, then {trouble.outcome.value} {trouble.detail}"
        )
        so_far = "" if path_m is None else f", {path_m:.0f} m so far"
        yield f"          → {chosen}; went {went.rstrip()}; CT {step.ct_s:.0f} s, TT {step.tt_s:.0f} s{so_far}"
    for view in step.views:
        if view.found:
            yield f"          ! goal seen ({view.confidence:.2f}): {_clipped(view.evidence)}"
    for event in step.interventions:
        yield f"          # guard: {_clipped(event.detail)} ({event.cause}); {event.done}"
    for note in step.notes:
        yield f"          · {_clipped(note)}"


def step_details(step: StepRecord) -> Iterator[str]:
    """Yield everything of a step: each view's caption and the imagined tree with its scores."""
    yield from step_lines(step)
    for view in step.views:
        q = "-" if view.q is None else f"{view.q:.2f}"
        flags = " blocked" * view.blocked + " forbidden" * view.forbidden
        yield f"  view {view.key}, heading {math.degrees(view.heading_rad):.0f}°, Q {q}{flags}"
        yield from textwrap.wrap(
            view.caption or f"({view.caption_fault})", _WIDTH, initial_indent="    ", subsequent_indent="    "
        )
        for node in step.tree:
            if node.key[: len(view.key)] == view.key:
                score = "-" if node.score is None else f"{node.score:.2f}"
                indent = "    " + "  " * node.depth
                yield from textwrap.wrap(
                    f"[{score}] {node.text or node.fault}",
                    _WIDTH,
                    initial_indent=indent,
                    subsequent_indent=indent + "       ",
                )
    for leg in step.legs:
        error = "" if leg.localization_rms_m is None else f", localization {leg.localization_rms_m:.3f} m"
        yield (
            f"  leg to ({leg.target[0]:.1f}, {leg.target[1]:.1f}): {leg.outcome.value} {leg.detail}".rstrip()
            + f", {leg.length_m:.1f} m in {leg.duration_s:.1f} s, off the line {leg.cross_track_rms_m:.2f} m{error}"
        )


def summary_lines(record: EpisodeRecord) -> Iterator[str]:
    """Yield how a mission ended and what it scored."""
    summary = record.summary
    if summary is None:
        last = len(record.steps) - 1
        yield f"INCOMPLETE: the record ends after step {last}; its process was killed, or its disk was full"
        return
    yield from _outcome_lines(summary)
    reference = "none" if summary.reference_length_m is None else f"{summary.reference_length_m:.0f} m"
    left = "" if summary.distance_to_goal_m is None else f", ended {summary.distance_to_goal_m:.0f} m from a goal"
    if not record.header.is_judged:
        reference = "not known"
    yield f"  path     {summary.path_length_m:.0f} m travelled, shortest way {reference}{left}"
    spent_s, calls = summary.ct_s + summary.tt_s, ", ".join(f"{n} {role}" for role, n in summary.calls.items())
    yield f"  time     CT {summary.ct_s:.0f} s ({record.header.ct_label}) + TT {summary.tt_s:.0f} s = {_clock(spent_s)}"
    yield f"  calls    {calls or 'none'}"
    yield from _model_lines(record)
    yield f"  scores   {_scores(summary)}   [{record.header.minds}]"
    if summary.collisions:
        yield f"  bumps    {len(summary.collisions)}: {_clipped(', '.join(summary.collisions))}"


def _model_lines(record: EpisodeRecord) -> Iterator[str]:
    """Yield what the calls of real models took, and how many of them were lost; nothing where there were none."""
    calls = [call for step in record.steps for call in step.calls if is_model_name(call.model)]
    if not calls:
        return
    sent, got = sum(call.tokens_in for call in calls), sum(call.tokens_out for call in calls)
    least = "at least " if any(call.usd is None for call in calls) else ""
    usd = math.fsum(call.usd or 0.0 for call in calls)
    faults = Counter((call.fault or "").partition(":")[0] for call in lost_calls(calls))
    lost = ", ".join(f"{count} {kind}" for kind, count in faults.most_common())
    yield f"  models   {len(calls)} calls, {sent:,} tokens sent and {got:,} got, {least}${usd:.4f}"
    if lost:
        yield f"  lost     {faults.total()} calls have no answer: {_clipped(lost)}"


def _scores(summary: MissionSummary) -> str:
    if summary.success is None or summary.oracle_success is None or summary.spl is None or summary.casr is None:
        return "not judged: SR, OSR, SPL and CASR are not known"
    return f"SR {summary.success:d}  OSR {summary.oracle_success:d}  SPL {summary.spl:.2f}  CASR {summary.casr:.2f}"


def _outcome_lines(summary: MissionSummary) -> Iterator[str]:
    if summary.declared and summary.success:
        yield f"Found Goal: {summary.judge}"
    elif summary.declared and summary.success is None:
        yield f"declared “Found Goal”; {summary.judge}"
    elif summary.declared:
        yield f"declared “Found Goal”, but the judge disagrees: {summary.judge}"
    else:
        yield f"not found ({summary.end.value}): {summary.reason}"
    if summary.declared:
        yield f"  evidence {_clipped(summary.reason)}"


def _ahead(step: StepRecord) -> str:
    first_look = [view for view in step.views if view.key[1] == 0]
    if not first_look:
        return ""
    view: ViewRecord = first_look[(len(first_look) - 1) // 2]
    return view.caption or f"({view.caption_fault})"


def _clipped(text: str) -> str:
    return textwrap.shorten(text, _WIDTH, placeholder=" …")


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60:02d}:{int(seconds) % 60:02d}"
