"""Captioners by name."""

import subprocess
import sys

import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.model import UnknownNameError
from reasoned_explorer.perception.context import CaptionerContext
from reasoned_explorer.perception.registry import CAPTIONERS


@pytest.mark.parametrize("name", ["perfect", "noisy"])
def test_builtin_captioners_can_be_made(name):
    captioner = CAPTIONERS.load(name)(CaptionerContext(VirtualClock(), seed=1))
    assert captioner.name == name
    assert captioner.label == f"simulated captioner ({name})"


def test_every_entry_says_what_it_is():
    assert {"noisy", "perfect"} <= set(CAPTIONERS.names())
    assert all(entry.summary for entry in CAPTIONERS.entries())


def test_a_misspelt_name_gets_the_near_miss():
    with pytest.raises(UnknownNameError, match="did you mean perfect"):
        CAPTIONERS.load("perfct")


def test_an_unknown_captioner_answers_with_the_forms_of_models_too():
    with pytest.raises(UnknownNameError, match="or openai:MODEL or hf:NAME"):
        CAPTIONERS.load("kosmos-2")


def test_listing_loads_no_simulator():
    program = (
        "import sys; from reasoned_explorer.perception.registry import CAPTIONERS; CAPTIONERS.names();"
        "assert not [m for m in sys.modules if 'simulation' in m or m == 'numba'], 'loaded too much'"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
