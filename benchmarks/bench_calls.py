"""What calls to an endpoint cost and how well they overlap, on a server of this machine in a process of its own.

Run it with ``python benchmarks/bench_calls.py``; nothing is asserted, but each line says whether its bar is met:

- CPU time of this process for a call, beside that of a client made anew for every call;
- throughput at rate-limited servers, over what they let in (bar: 95 %);
- a planning step's wall time over its critical path at 1 s a call (bar: 1.05 for N = 3 and 5 views), beside the same
  calls in the order of the authors' published code (captions one by one; an expansion with its evaluations; L rollouts,
  each a visionary and an evaluator call that begin again at the child, ``src/RRT.py``; checks one by one).
"""

import argparse
import asyncio
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.calls.openai_model import OpenAIModel, openai_model
from reasoned_explorer.calls.pacing import Limits

ROOT = Path(__file__).resolve().parents[1]
CHILDREN, DEPTH = 3, 2
SYSTEM = "You judge what a robot sees. " * 20
PICTURE = b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 240  # 60 kB, about what a view of 320 x 240 takes

Step = Callable[[OpenAIModel, int], Awaitable[None]]


@dataclass(eq=False)
class Server:
    """A server in a process of its own, and what it has to say at its end."""

    base_url: str
    told: dict[str, int]


@contextmanager
def serving(*options: str) -> Iterator[Server]:
    """Run the stub server until the block ends."""
    command = [sys.executable, "-m", "tests.calls.stub_server", *options]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None  # noqa: S101
        server = Server(process.stdout.readline().strip(), {})
        try:
            yield server
        finally:
            rest, _ = process.communicate()
            server.told.update(json.loads(rest or "{}"))


def question(role: str, *key: int, picture: bool = False) -> ChatRequest:
    user = f"Scene {key}: a bench stands beside a path, a fountain further on. " * 4
    return ChatRequest(role, key, SYSTEM, user, f"{role}/1", images=(PICTURE,) if picture else ())


def verdict(met: bool) -> str:  # noqa: FBT001
    return "met" if met else "NOT MET"


async def answered(calls: list[Awaitable[ChatAnswer]]) -> None:
    answers = await asyncio.gather(*calls)
    lost = [answer.fault for answer in answers if answer.fault is not None]
    if lost:
        raise SystemExit(f"{len(lost)} calls were lost, the first one to: {lost[0]}")


def cpu_of_a_call(calls: int, at_once: int) -> None:
    """Print the CPU milliseconds of a call, for one client and for one that is made anew each time."""

    async def ours(model: OpenAIModel) -> float:
        await answered([model.ask(question("evaluator", 0, number)) for number in range(at_once)])  # warm up
        start_s = time.process_time()
        for batch in range(calls // at_once):
            await answered([model.ask(question("evaluator", batch + 1, number)) for number in range(at_once)])
        return (time.process_time() - start_s) / (calls // at_once * at_once) * 1e3

    async def anew(base_url: str) -> float:
        from openai import AsyncOpenAI, DefaultAioHttpClient

        asked, start_s = question("evaluator", 0), time.process_time()
        for _ in range(20):
            async with AsyncOpenAI(api_key="none", base_url=base_url, http_client=DefaultAioHttpClient()) as client:
                await client.chat.completions.create(
                    model="tiny",
                    messages=[{"role": "system", "content": asked.system}, {"role": "user", "content": asked.user}],
                )
        return (time.process_time() - start_s) / 20 * 1e3

    with serving() as server:
        one_ms = statistics.median(
            asyncio.run(ours(openai_model("openai:tiny", base_url=server.base_url))) for _ in range(5)
        )
        anew_ms = asyncio.run(anew(server.base_url))
    print(f"CPU of a call, {at_once} at once:    {one_ms:6.2f} ms")
    print(f"with a client made anew for each: {anew_ms:6.2f} ms ({anew_ms / one_ms:.0f} times)")


def throughput(seconds: float) -> None:
    """Print what went through at rate-limited servers over what they would have let through."""
    rate, burst = 50.0, 50.0
    known = Limits(requests_per_minute=60.0 * rate)
    cases: list[tuple[str, Limits, float, list[str]]] = [
        ("limit told by a person", known, 300.0, []),
        ("limit told by headers", Limits(), burst, ["--tells-limit"]),
        ("429 and Retry-After in ms", Limits(), burst, []),
        ("429 and Retry-After in whole s", Limits(), burst, ["--retry-after", "seconds"]),
        ("429 and nothing else", Limits(), burst, ["--retry-after", "none"]),
    ]

    async def until_done(model: OpenAIModel, calls: int) -> float:
        start_s = time.monotonic()
        await answered([model.ask(question("evaluator", number)) for number in range(calls)])
        return time.monotonic() - start_s

    for name, limits, at_first, options in cases:
        calls = round(at_first + rate * seconds)
        with serving("--latency", "0.2", "--rate", f"{rate}", "--burst", f"{at_first}", *options) as server:
            model = openai_model("openai:tiny", base_url=server.base_url, settings=AskingSettings(limits=limits))
            took_s = asyncio.run(until_done(model, calls))
        share = calls / (at_first + rate * (took_s - 0.2))
        away = server.told.get("turned away", 0)
        print(f"{name:32s} {100 * share:6.1f} % of the limit, turned away {away} of {calls}; {verdict(share >= 0.95)}")


async def our_step(model: OpenAIModel, views: int) -> None:
    """Everything that does not wait for another answer goes at the same time: the order of LLM-RRT's planner."""
    await answered([model.ask(question("caption", view, picture=True)) for view in range(views)])
    checks = asyncio.create_task(answered([model.ask(question("checker", view)) for view in range(views)]))
    nodes: list[tuple[int, ...]] = []
    level: list[tuple[int, ...]] = [(view, child) for view in range(views) for child in range(CHILDREN)]
    for _ in range(DEPTH):
        await answered([model.ask(question("visionary", *key)) for key in level])
        nodes += level
        level = [(*key, 0) for key in level]
    await answered([model.ask(question("evaluator", *key)) for key in nodes])
    await checks


def authors_step(rollouts: int) -> Step:
    """Return the order of calls of the authors' published code."""

    async def step(model: OpenAIModel, views: int) -> None:
        for view in range(views):
            await answered([model.ask(question("caption", view, picture=True))])
        children = [(view, child) for view in range(views) for child in range(CHILDREN)]
        for rollout in range(1 + rollouts):  # the first is the expansion
            for role in ("visionary", "evaluator"):
                await answered([model.ask(question(role, *key, rollout)) for key in children])
        for view in range(views):
            await answered([model.ask(question("checker", view))])

    return step


def critical_path(repeats: int, views_of: tuple[int, ...]) -> None:
    """Print a planning step's wall time over its critical path."""
    latency_s = 1.0

    async def timed(model: OpenAIModel, step: Step, views: int, times: int) -> list[float]:
        await answered([model.ask(question("caption", 0))])  # connections of a mission are there after its first step
        seconds = []
        for _ in range(times):
            start_s = time.monotonic()
            await step(model, views)
            seconds.append(time.monotonic() - start_s)
        return seconds

    with serving("--latency", f"{latency_s}") as server:
        for views in views_of:
            model = openai_model("openai:tiny", base_url=server.base_url)
            path_s = (1 + DEPTH + 1) * latency_s
            ours = asyncio.run(timed(model, our_step, views, repeats))
            ours_s = statistics.median(ours)
            theirs = {}
            for rollouts in (DEPTH - 1, DEPTH):
                theirs[rollouts] = asyncio.run(timed(model, authors_step(rollouts), views, 1))[0]
            calls = views * (2 + 2 * DEPTH * CHILDREN)
            bar = f"; {verdict(ours_s <= 1.05 * path_s)}" if views <= 5 else ""
            print(
                f"N = {views}, L = {DEPTH}, {calls} calls: median {ours_s:.3f} s, worst {max(ours):.3f} s, "
                f"critical path {path_s:.0f} s, ratio {ours_s / path_s:.3f} (worst {max(ours) / path_s:.3f}){bar}"
            )
            print(
                f"       the authors' order: {theirs[DEPTH - 1]:.2f} s for the same tree, "
                f"{theirs[DEPTH - 1] / ours_s:.2f} times; {theirs[DEPTH]:.2f} s with L = {DEPTH} rollouts, "
                f"{theirs[DEPTH] / ours_s:.2f} times"
            )


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--seconds", type=float, default=20.0, help="of each rate-limited server")
    options.add_argument("--repeats", type=int, default=5, help="of each planning step")
    options.add_argument("--calls", type=int, default=640, help="whose CPU time is measured, five times")
    given = options.parse_args()
    cpu_of_a_call(given.calls, 32)
    critical_path(given.repeats, (3, 5, 8))
    throughput(given.seconds)


if __name__ == "__main__":
    main()
