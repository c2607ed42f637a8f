"""What has to be said under a table of results, whoever reads it and wherever it stands."""

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.tables import Results

_EMBEDDED = "embedded minds"


def notes_of(results: Results, plan: BenchPlan, *, finished: int) -> tuple[str, ...]:
    """Return the notes under a run's tables.

    Args:
        results: Of one vehicle.
        plan: Of the run.
        finished: Missions of this vehicle that are finished.
    """
    rows = [row for mine in results.rows.values() for row in mine]
    notes = ["Intervals are 95 %, resampled by place where there are several; a share of 0 or 1 has Wilson's."]
    total = plan.count // len(plan.vehicles)
    if finished < total:
        notes.append(f"Not finished: {finished} of {total} missions.")
    failed = sum(row.end == "fault" for row in rows)
    if failed:
        notes.append(f"{failed} missions ended with a fault of a part; they count as failures.")
    if any(_EMBEDDED in row.minds for row in rows):
        notes.append(
            "Embedded minds are no language model. They do not agree with GPT-4's scores: rank correlation -.22 to "
            "+.21 on the 72 scores in the paper's authors' log."
        )
    if any("simulated" in row.captioner for row in rows):
        notes.append("Captions are a simulated captioner's; the error rates of `noisy` are assumed.")
    if any(row.ct_label.startswith("modelled") for row in rows):
        notes.append("CT is modelled: each call is charged what a latency profile says, not what it took.")
    if any(name == "oracle" or "foresight" in name or "perfect-halt" in name for name in results.methods):
        notes.append("oracle, foresight and perfect-halt read the truth: bounds, no methods.")
    notes += sorted({row.attribution for row in rows} - {""})
    return tuple(notes)
