"""What 200 missions come to where a share of the calls fails, beside the same missions where none does.

Run::

    python benchmarks/bench_faults.py [--missions 200] [--share 0.2] [--steps 5] [--kinds FAULT,FAULT]

A fake server on this machine answers for the model: levels that follow from the question, and nothing is ever found.
What goes wrong is drawn from what is asked (`tests.calls.stub_server.FAULTS`). Each call is charged one second here,
whatever it took, and missions end after so many steps: otherwise waiting for a second try would change what a body that
hovers sees next. Printed: how many missions ended, how many calls were lost for good and how, whether any node of a
tree has a score that no call answered, and how many missions decided otherwise than without faults; those that lost no
call must all decide the same.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar
from unittest.mock import patch

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.calls.stub_server import FAULTS, Behaviour, StubServer, sober

from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.clock import VirtualClock, run_live
from reasoned_explorer.evaluation.mission import Mission, MissionResult
from reasoned_explorer.evaluation.mission_settings import CLOCKS, MissionSettings
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

T = TypeVar("T")


class OneSecondACall(VirtualClock):
    """Virtual time in which a live call takes one second, however long it took; one after the other in truth."""

    name = "mixed"

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:
        """Make a call, and let a second pass."""
        result = run_live(call)
        await self.think(1.0)
        return result, 1.0


#: Short waits: what is counted here is outcomes, and a fault costs a wait.
ASKING = AskingSettings(try_s=0.5, back_off_s=0.02, deadline_s=20.0)
GOALS = ("Find me a bench", "Find me a tree", "Find me somewhere to take a nap", "Find me a street lamp near a bench")


def run_all(behaviour: Behaviour, *, missions: int, steps: int, at_once: int) -> list[MissionResult]:
    """Run missions against a server of a behaviour, in order of their seeds."""
    atlases = [Atlas(open_world(f"{district}:42@300")) for district in ("park", "plaza")]
    with StubServer(behaviour) as server, ThreadPoolExecutor(at_once) as pool:

        def run(number: int) -> MissionResult:
            settings = MissionSettings(
                minds="openai:fake",
                planner="llm-rrt",
                planner_settings={"depth": 1, "children": 1},
                clock="mixed",
                explorer=ExplorerSettings(max_steps=steps, t_max_s=86_400.0),
                seed=number,
            )
            desk = ModelDesk(base_url=server.base_url, asking=ASKING, abilities=found_out)
            return Mission(GOALS[number % len(GOALS)], atlases[number % 2], settings, desk=desk).run()

        # What the model can do is found out once, before anything goes wrong.
        server.behaviour = Behaviour(answer=sober)
        first = ModelDesk(base_url=server.base_url, asking=ASKING)
        found_out = {"openai:fake": first.prepare(["openai:fake"])[0].abilities}
        server.behaviour = behaviour
        return list(pool.map(run, range(missions)))


def decisions(result: MissionResult) -> list[object]:
    """Return what was decided: where each step began, and what it chose."""
    return [(step.pose, step.choice) for step in result.record.steps]


def lost(result: MissionResult) -> list[str]:
    """Return why calls of a mission have no answer."""
    return [call.fault.partition(":")[0] for step in result.record.steps for call in step.calls if call.fault]


def invented(result: MissionResult) -> int:
    """Return how many scores there are that no call of an evaluator answered."""
    steps = result.record.steps
    scores = sum(node.score is not None for step in steps for node in step.tree)
    answered = sum(call.role == "evaluator" and call.fault is None for step in steps for call in step.calls)
    return max(0, scores - answered)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=200)
    parser.add_argument("--share", type=float, default=0.2)
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--at-once", type=int, default=8)
    parser.add_argument("--kinds", default=",".join(FAULTS))
    options = parser.parse_args()
    sizes = {"missions": options.missions, "steps": options.steps, "at_once": options.at_once}
    kinds = tuple(options.kinds.split(","))
    with patch.dict(CLOCKS, {"mixed": OneSecondACall}):
        sound = run_all(Behaviour(answer=sober), **sizes)
        faulty = run_all(Behaviour(answer=sober, fault_share=options.share, faults=kinds), **sizes)
    ends = Counter(result.summary.end.value for result in faulty)
    calls = sum(len(step.calls) for result in faulty for step in result.record.steps)
    why = Counter(reason for result in faulty for reason in lost(result))
    retries = sum(call.retries for result in faulty for step in result.record.steps for call in step.calls)
    other = [place for place, (a, b) in enumerate(zip(sound, faulty, strict=True)) if decisions(a) != decisions(b)]
    without_loss = [place for place in other if not lost(faulty[place])]
    print(f"{options.share:.0%} of the tries fail: {len(faulty)} of {options.missions} missions ended: {dict(ends)}")
    print(f"  calls {calls:,}, tried again {retries:,} times, lost for good {why.total()}: {dict(why.most_common())}")
    print(f"  scores that nobody gave: {sum(map(invented, faulty))}")
    print(f"  missions that lost a call: {sum(bool(lost(result)) for result in faulty)}")
    print(
        f"  missions that decided otherwise: {len(other)}, of which {len(without_loss)} had lost no call {without_loss}"
    )


if __name__ == "__main__":
    main()
