from pathlib import Path

import pytest

pytest.importorskip("fastapi", reason="the extra view is not installed")
pytest.importorskip("uvicorn", reason="the extra view is not installed")

from reasoned_explorer.model.record import EpisodeRecord
from tests.viewer.small_runs import make_bench, make_record


@pytest.fixture(scope="session")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight missions of two planners, with their records; nobody changes it."""
    return make_bench(tmp_path_factory.mktemp("benches") / "small")


@pytest.fixture(scope="session")
def record() -> EpisodeRecord:
    """A mission in plaza:3@200."""
    return make_record()
