import asyncio
import math

import pytest

from reasoned_explorer.model import SettingsError
from reasoned_explorer.serving.airsim.timeline import Timeline


def on_a_timeline(script, speed=math.inf):
    async def run():
        return await script(Timeline(speed))

    return asyncio.run(run())


def test_as_fast_as_asked_time_jumps_to_what_is_waited_for_in_order():
    async def script(time):
        heard, over = [], asyncio.Event()
        time.at(60.0, lambda: (heard.append(("late", time.now_s)), over.set()))
        time.at(5.0, lambda: heard.append(("early", time.now_s)))
        assert time.now_s == 0.0
        await over.wait()
        return heard

    assert on_a_timeline(script) == [("early", 5.0), ("late", 60.0)]


def test_held_time_passes_only_as_long_as_it_is_let_go_on():
    async def script(time):
        heard = []
        time.hold()
        time.at(1.0, lambda: heard.append(time.now_s))
        await asyncio.sleep(0.01)
        assert (heard, time.now_s, time.is_held) == ([], 0.0, True)
        await time.go_on_for(0.6)
        assert (heard, time.now_s) == ([], 0.6)
        await time.go_on_for(0.6)
        return heard, time.now_s, time.is_held

    assert on_a_timeline(script) == ([1.0], 1.2, True)


def test_what_is_due_has_happened_when_the_step_is_over():
    async def script(time):
        heard = []
        time.hold()
        time.at(0.5, lambda: heard.append("due"))
        step = time.go_on_for(0.5)
        step.add_done_callback(lambda _: heard.append("stepped"))
        await step
        await asyncio.sleep(0)
        return heard

    assert on_a_timeline(script) == ["due", "stepped"]


def test_what_is_cancelled_neither_happens_nor_draws_time_on():
    async def script(time):
        heard = []
        alarm = time.at(100.0, lambda: heard.append("never"))
        time.cancel(alarm)
        await asyncio.sleep(0.01)
        return heard, time.now_s

    assert on_a_timeline(script) == ([], 0.0)


def test_with_a_speed_time_passes_so_many_times_faster():
    async def script(time):
        done = asyncio.get_running_loop().create_future()
        time.at(20.0, lambda: done.set_result(time.now_s))
        return await done

    assert on_a_timeline(script, speed=1000.0) >= 20.0


def test_with_a_speed_a_step_is_lived_through():
    async def script(time):
        time.hold()
        heard, begun_s = [], time.now_s
        time.at(begun_s + 5.0, lambda: heard.append("due"))
        await time.go_on_for(10.0)
        return heard, time.now_s - begun_s

    assert on_a_timeline(script, speed=1000.0) == (["due"], pytest.approx(10.0, abs=1e-9))


@pytest.mark.parametrize("speed", [0.0, -1.0, math.nan, "fast", 1e6])
def test_a_speed_that_is_none_is_refused(speed):
    with pytest.raises(SettingsError, match="clock's speed"):
        on_a_timeline(lambda time: None, speed)
