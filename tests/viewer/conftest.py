from pathlib import Path

import pytest

pytest.importorskip("fastapi", reason="the extra view is not installed")
pytest.importorskip("uvicorn", reason="the extra view is not installed")

from reasoned_explorer.model.record import EpisodeRecord
from tests.viewer.page_runs import bench_run, mission_of


@pytest.fixture(scope="session")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve missions of two planners, with their records; nobody changes it."""
    return bench_run(tmp_path_factory.mktemp("benches") / "small")


@pytest.fixture(scope="session")
def record(tmp_path_factory: pytest.TempPathFactory) -> EpisodeRecord:
    """A mission of two minutes in plaza:3@200."""
    return mission_of(tmp_path_factory.mktemp("mission"))
