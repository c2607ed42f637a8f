"""``rex compare``."""

from pathlib import Path

from reasoned_explorer.cli.bench import results_of
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.tables import compared_sheet
from reasoned_explorer.model import Fault, InputError


def compare_runs(first: str, second: str) -> None:
    """Print paired differences between two runs, or two methods of runs, on the missions that both have."""
    (one, one_method), (other, other_method) = _run_and_method(first), _run_and_method(second)
    with RunStore.read(one) as ours, RunStore.read(other) as theirs:
        plan, their_plan = ours.plan, theirs.plan
        vehicles = [name for name in plan.vehicles if name in their_plan.vehicles]
        if not vehicles:
            said = f"{first} has {', '.join(plan.vehicles)}, {second} has {', '.join(their_plan.vehicles)}"
            raise InputError("comparison", [Fault(said, "runs with a vehicle in common")])
        mine, its = plan.fingerprints(), their_plan.fingerprints()
        same = {name for name, print_ in mine.items() if its.get(name) == print_}
        if not same:
            said = f"{first} is of {plan.split.label}, {second} of {their_plan.split.label}"
            expected = "runs of the same missions: worlds, goals, starts, seeds and limits"
            raise InputError("comparison", [Fault(f"no mission in common: {said}", expected)])
        notes = [f"Set differently: {line}." for line in plan.differences(their_plan)]
        # All are made before one is printed: a fault of the last must not stand under half an answer.
        sheets = [
            compared_sheet(
                results_of(ours, plan, vehicle).of_missions(same),
                results_of(theirs, their_plan, vehicle).of_missions(same),
                names=(first, second),
                methods=(one_method, other_method),
                title=vehicle,
                notes=notes,
            )
            for vehicle in vehicles
        ]
    console = Output()
    for sheet in sheets:
        print_sheet(console, sheet)


def _run_and_method(text: str) -> tuple[Path, str | None]:
    """Return the run and the method that ``RUN`` or ``RUN::METHOD`` means."""
    folder, _, name = text.partition("::")
    return Path(folder), name or None
