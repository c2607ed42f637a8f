"""What all tests share."""

import signal
from pathlib import Path

import pytest
from hypothesis import settings

# These machines are noisy, and a test that fails must fail again: no deadlines, no chance.
settings.register_profile("house", deadline=None, derandomize=True)
settings.load_profile("house")

# What a shell starts in the background ignores Ctrl-C, and so would all that tests start.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Tiny models for the tests of calls and of perception.
pytest_plugins = ["tests.calls.local.models"]

SHARED = Path(__file__).resolve().parents[1] / ".." / "shared"


@pytest.fixture(scope="session")
def osm_folder() -> Path:
    """Where real places lie for development; tests that need them skip where they are not there."""
    folder = SHARED / "osm"
    if not folder.is_dir():
        pytest.skip("no real places beside this checkout (../shared/osm)")
    return folder
