"""What Ctrl-C does: the first one is noted, the second one stops at once."""

import os
import signal
from collections.abc import Iterator

import pytest

from reasoned_explorer.model.stopping import listening, on_stop, stop_if_asked, stop_was_asked


@pytest.fixture(autouse=True)
def _as_python_starts() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def press() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_the_first_request_stops_at_the_next_safe_place_and_only_there() -> None:
    with listening():
        stop_if_asked()
        press()
        assert stop_was_asked()
        with pytest.raises(KeyboardInterrupt):
            stop_if_asked()
        stop_if_asked()  # what was begun can be ended


def test_the_second_request_stops_at_once() -> None:
    with listening():
        press()
        with pytest.raises(KeyboardInterrupt):
            press()


def test_a_request_calls_back_also_where_it_came_before() -> None:
    called: list[str] = []
    with listening():
        with on_stop(lambda: called.append("over already")):
            pass
        with on_stop(lambda: called.append("now")):
            press()
        with on_stop(lambda: called.append("later")):
            pass
    assert called == ["now", "later"]


def test_each_listening_begins_anew_and_leaves_python_as_it_was() -> None:
    with listening():
        press()
    with listening(), listening():
        assert not stop_was_asked()
        stop_if_asked()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with pytest.raises(KeyboardInterrupt):
        press()


def test_where_ctrl_c_means_something_else_it_goes_on_to_mean_that() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with listening():
        press()
        stop_if_asked()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
