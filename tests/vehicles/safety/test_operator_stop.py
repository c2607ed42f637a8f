"""The keyboard on real pseudo terminals."""

import contextlib
import os
import termios
import time

import pytest

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.safety import KeyboardListener, OperatorStop


@pytest.fixture
def terminal():
    """Both ends of a terminal: where a person types, and where a program reads."""
    person, program = os.openpty()
    yield person, program
    for end in (person, program):
        with contextlib.suppress(OSError):  # closed by the test
            os.close(end)


def until(condition):
    for _ in range(2000):
        if condition():
            return True
        time.sleep(0.005)
    return False


@pytest.mark.parametrize("key", [b" ", b"\x1b", b"q", b"s"])
def test_one_key_stops_without_enter(terminal, key):
    person, program = terminal
    stop = OperatorStop()
    with KeyboardListener(stop, fd=program):
        assert stop.is_reachable
        os.write(person, key)
        assert until(lambda: stop.pressed)
    assert not stop.is_reachable


def test_other_keys_are_told_and_do_not_stop(terminal):
    person, program = terminal
    stop, told = OperatorStop(), []
    with KeyboardListener(stop, fd=program, on_key=told.append):
        os.write(person, b"yn")
        assert until(lambda: len(told) == 2)
    assert (told, stop.pressed) == (["y", "n"], False)


def test_the_terminal_is_as_before_afterwards(terminal):
    _, program = terminal
    before = termios.tcgetattr(program)
    with KeyboardListener(OperatorStop(), fd=program):
        assert not termios.tcgetattr(program)[3] & termios.ICANON
        assert termios.tcgetattr(program)[3] & termios.ISIG  # Ctrl-C stays what it is
    assert termios.tcgetattr(program) == before


def test_a_terminal_that_goes_away_counts_as_a_press(terminal):
    person, program = terminal
    stop = OperatorStop()
    with KeyboardListener(stop, fd=program):
        os.close(person)
        assert until(lambda: stop.pressed)
    assert "gone" in stop.why


def test_without_a_terminal_it_says_what_to_do():
    reading, writing = os.pipe()
    try:
        with pytest.raises(SettingsError, match=r"OperatorStop\.press"), KeyboardListener(OperatorStop(), fd=reading):
            pass
    finally:
        os.close(reading)
        os.close(writing)


def test_the_first_reason_is_kept_until_it_is_released():
    stop = OperatorStop()
    stop.press("the red button")
    stop.press("something else")
    assert (stop.pressed, stop.why) == (True, "the red button")
    stop.release()
    assert (stop.pressed, stop.why) == (False, "")
