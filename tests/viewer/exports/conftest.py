from pathlib import Path

import pytest

from tests.viewer.exports.missions import RECORD, keep, run_a_mission


@pytest.fixture(scope="session")
def run_mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a mission that was run in a generated place."""
    return run_a_mission(tmp_path_factory.mktemp("run") / "mission")


@pytest.fixture
def by_hand(tmp_path: Path) -> Path:
    """The folder of a mission on earth with everything in it, its world lost and its pictures kept."""
    return keep(tmp_path / "by-hand", RECORD, pictures=True)
