"""How long the embedded minds take for a step of 18 visionary, 18 evaluator and 3 checker calls, and for reading.

Run it with ``python benchmarks/bench_minds.py``; nothing is asserted. Times are of the processor, so that
a busy machine does not count.
"""

import statistics
import time
from collections.abc import Callable

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import Ledger, MindContext, Minds, latency_profile
from reasoned_explorer.minds.embedded import default_senses, minds_with, reading
from reasoned_explorer.minds.embedded.embedding import model_folder
from reasoned_explorer.minds.embedded.lexicon import data_lines
from reasoned_explorer.model import Goal, Scene

GOALS = ("Find me a fountain near a bench, but stay off the road", "Find me somewhere to take a nap", "Find a mailbox")
STEPS = 200


def median_us(work: Callable[[], object], repeats: int = 300) -> float:
    seconds = []
    for _ in range(repeats):
        start_s = time.process_time()
        work()
        seconds.append(time.process_time() - start_s)
    return statistics.median(seconds) * 1e6


async def step(minds: Minds, goal: Goal, scenes: list[Scene]) -> None:
    first = await minds.visionary.imagine(goal, scenes, count=3)
    children = [child for row in first for child in row]
    second = await minds.visionary.imagine(goal, children, count=1)
    await minds.evaluator.evaluate(goal, [*children, *(row[0] for row in second)])
    await minds.checker.check(goal, scenes)


def time_steps(with_embedder: bool, goals: tuple[str, ...]) -> tuple[float, float]:  # noqa: FBT001
    """Return the median and the mean milliseconds of a step in which every caption is new."""
    lines = data_lines("background_scenes")
    seconds: list[float] = []
    for number, text in enumerate(goals):
        clock = VirtualClock()
        context = MindContext(clock, latency_profile("gpt-2023"), Ledger(), seed=number)
        minds = minds_with(context, default_senses(with_embedder=with_embedder))

        async def mission(minds: Minds = minds, text: str = text) -> None:
            for count in range(STEPS):
                scenes = [
                    # Two captions in one: each step's texts are new, their sentences recur, as in a mission.
                    Scene(f"{lines[(count * 7 + view) % 60]} {lines[(count * 11 + 3 * view + 1) % 59]}",
                          (count, 0, view), Pose(0.0, 0.0))
                    for view in range(3)
                ]  # fmt: skip
                start_s = time.process_time()
                await step(minds, Goal(text), scenes)
                seconds.append(time.process_time() - start_s)

        clock.run(mission())
    warm = seconds[len(seconds) // 10 :]
    return statistics.median(warm) * 1e3, statistics.fmean(warm) * 1e3


def main() -> None:
    caption = (
        "The image shows a paved pedestrian street. In the foreground, close to the viewer on the left, there is a "
        "bench "
        "next to a trash can under a tree. A little further on, on the right, a fountain stands in the middle of a "
        "plaza. "
        "In the distance, two people and a bicycle rack can be seen straight ahead. A pavement leads straight ahead; "
        "grass "
        "lies to the left and a road to the right. In the background there are apartment buildings and the sky."
    )

    def cold() -> None:
        reading._read_sentence.cache_clear()
        reading.read_scene.cache_clear()
        reading.read_scene(caption)

    def known_sentences() -> None:
        reading.read_scene.cache_clear()
        reading.read_scene(caption)

    print(f"read a caption, nothing known      {median_us(cold):8.1f} us")
    print(f"read a caption, sentences known    {median_us(known_sentences):8.1f} us")
    for with_embedder in (False, True):
        if with_embedder and model_folder() is None:
            print("MiniLM is not installed: not measured")
            continue
        name = "with MiniLM" if with_embedder else "words and lexicon only"
        median_ms, mean_ms = time_steps(with_embedder, GOALS)
        print(f"a step (18 + 18 + 3 calls), {name}: median {median_ms:.2f} ms, mean {mean_ms:.2f} ms")


if __name__ == "__main__":
    main()
