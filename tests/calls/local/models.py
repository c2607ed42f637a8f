"""Tiny models, made once and loaded as those of the hub are."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.calls.local import LocalModel, LocalSettings, load_local
from tests.calls.local import tiny

_MAKERS: dict[str, Callable[[Path], Path]] = {
    "kosmos-2": tiny.make_kosmos_2,
    "idefics3": lambda folder: tiny.make_smolvlm(folder, newer=False),
    "smolvlm": lambda folder: tiny.make_smolvlm(folder, newer=True),
    "llama": tiny.make_text_model,
    "llama, no system": lambda folder: tiny.make_text_model(folder, template=tiny.USERS_ONLY),
    "llama, no template": lambda folder: tiny.make_text_model(folder, template=None),
    "llama, short": lambda folder: tiny.make_text_model(folder, positions=64),
}


@pytest.fixture(scope="session")
def local(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., LocalModel]:
    """Loads a tiny model by its kind."""
    pytest.importorskip("torch", reason="needs torch: pip install 'reasoned-explorer[local]'")
    pytest.importorskip("transformers", reason="needs transformers: pip install 'reasoned-explorer[local]'")
    folder = tmp_path_factory.mktemp("models")
    made: dict[str, Any] = {}

    def load(kind: str, settings: LocalSettings | None = None) -> LocalModel:
        if kind not in made:
            made[kind] = _MAKERS[kind](folder / str(len(made)))
        return load_local(f"hf:{made[kind]}", settings)

    return load
