"""From a name to a model, or to why there is none."""

import io
import json
import logging
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from reasoned_explorer.calls.local import LocalModel, LocalSettings, hub_name, load_local, loading, only_describes
from reasoned_explorer.model import MissingDependencyError, SettingsError
from tests.calls.local import tiny

Local = Callable[..., LocalModel]

ASK = """
import asyncio, json, sys
from reasoned_explorer.calls.chat import ChatRequest
from reasoned_explorer.calls.local import load_local
from reasoned_explorer.model import SettingsError
try:
    model = load_local(sys.argv[1])
    answer = asyncio.run(model.ask(ChatRequest("evaluator", (0,), "", "Is there a bench?", "test/1", max_tokens=4)))
    print(json.dumps([model.fingerprint, answer.fault, answer.model]))
except SettingsError as error:
    print(json.dumps([str(error)]))
"""


def test_a_name_of_the_hub_begins_with_hf() -> None:
    assert hub_name("hf:HuggingFaceTB/SmolVLM-256M-Instruct") == "HuggingFaceTB/SmolVLM-256M-Instruct"
    assert hub_name("openai:gpt-4o-mini") is None
    assert hub_name("hf:") is None
    with pytest.raises(SettingsError, match="hf: and a name"):
        load_local("embedded")


@pytest.mark.parametrize("package", ["torch", "transformers"])
def test_a_missing_package_is_named_with_the_command_that_installs_it(
    package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("torch", "transformers"):
        if name == package:
            monkeypatch.setitem(sys.modules, name, None)
        elif name not in sys.modules:
            monkeypatch.setitem(sys.modules, name, pytest)  # anything that is there
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[local\]'") as raised:
        load_local("hf:microsoft/kosmos-2-patch14-224")
    assert raised.value.package == package


def test_all_faults_of_settings_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        LocalSettings(dtype="int8", most=0, linger_s=-1.0)
    assert len(raised.value.faults) == 3


def test_reading_the_package_loads_nothing_heavy() -> None:
    code = (
        "import sys, reasoned_explorer.calls.local; print([m for m in ('torch', 'transformers') if m in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


@pytest.mark.parametrize("holds", ["nothing", "something else", "an unknown kind", "a translator", "no weights"])
def test_a_folder_without_a_model_is_said_to_be_none(holds: str, tmp_path: Path, local: Local) -> None:
    if holds == "something else":
        (tmp_path / "notes.txt").write_text("no model")
    elif holds == "an unknown kind":
        (tmp_path / "config.json").write_text(json.dumps({"model_type": "crystal-ball"}))
    elif holds == "a translator":
        (tmp_path / "config.json").write_text(json.dumps({"model_type": "t5", "is_encoder_decoder": True}))
    elif holds == "no weights":
        tiny.make_text_model(tmp_path)
        (tmp_path / "model.safetensors").unlink()
    with pytest.raises(SettingsError, match="cannot be loaded"):
        load_local(f"hf:{tmp_path}")


def test_the_fingerprint_tells_other_weights_and_other_precision(tmp_path: Path, local: Local) -> None:
    folder = tiny.make_text_model(tmp_path / "one")
    copied = Path(shutil.copytree(folder, tmp_path / "other"))
    file = copied / "model.safetensors"
    one = load_local(f"hf:{folder}").fingerprint.removeprefix(f"hf:{folder} ")
    same = load_local(f"hf:{copied}").fingerprint.removeprefix(f"hf:{copied} ")
    assert one == same
    halved = load_local(f"hf:{folder}", LocalSettings(dtype="float16")).fingerprint.removeprefix(f"hf:{folder} ")
    assert halved != one
    content = bytearray(file.read_bytes())
    content[-1] ^= 1
    file.write_bytes(bytes(content))
    shutil.move(copied, tmp_path / "changed")
    changed = load_local(f"hf:{tmp_path / 'changed'}")
    assert changed.fingerprint.removeprefix(f"{changed.name} ") != one


def test_what_only_describes_is_told_by_the_configuration_without_weights(tmp_path: Path, local: Local) -> None:
    folder = tiny.make_kosmos_2(tmp_path / "kosmos-2")
    (folder / "model.safetensors").unlink()
    assert only_describes(f"hf:{folder}")
    assert not only_describes(f"hf:{tiny.make_text_model(tmp_path / 'llama')}")
    with pytest.raises(SettingsError, match="cannot be loaded"):
        only_describes(f"hf:{tmp_path}")


def test_the_hubs_library_is_silent_about_each_try_and_then_as_loud_as_before() -> None:
    hub = pytest.importorskip("huggingface_hub")
    before = hub.logging.get_verbosity()
    told = hub.logging.get_logger("huggingface_hub.utils._http")
    shown = io.StringIO()
    handler = logging.StreamHandler(shown)
    told.addHandler(handler)
    try:
        with loading._one_error("hf:org/tiny"):
            told.warning("Retrying in 1s [Retry 1/5].")
        with pytest.raises(SettingsError, match="cannot be loaded: OSError: nobody there"), loading._one_error("hf:x"):
            raise OSError("nobody there")
        assert shown.getvalue() == ""
        assert hub.logging.get_verbosity() == before
        told.warning("as before")
        assert shown.getvalue() == "as before\n"
    finally:
        told.removeHandler(handler)


def test_a_model_is_loaded_once(local: Local) -> None:
    assert local("llama") is local("llama")


def test_what_the_hub_cache_holds_is_read_there_and_what_it_lacks_is_said(tmp_path: Path, local: Local) -> None:
    commit = "0123456789abcdef0123456789abcdef01234567"
    kept = tmp_path / "hub" / "models--tiny--llama"
    tiny.make_text_model(kept / "snapshots" / commit)
    (kept / "refs").mkdir()
    (kept / "refs" / "main").write_text(commit)
    # A hub that nobody answers at: asking it would fail.
    environment = {**os.environ, "HF_HOME": str(tmp_path), "HF_ENDPOINT": "http://127.0.0.1:9"}

    def told(name: str, **more: str) -> list[str | None]:
        shown = subprocess.run(
            [sys.executable, "-c", ASK, name],
            capture_output=True,
            text=True,
            check=True,
            env={**environment, **more},
        )
        answer: list[str | None] = json.loads(shown.stdout.splitlines()[-1])
        return answer

    fingerprint, fault, model = told("hf:tiny/llama")
    assert (fault, model) == (None, "tiny/llama@0123456789ab")
    assert str(fingerprint).startswith("hf:tiny/llama 0123456789ab float32")
    (message,) = told("hf:tiny/missing", HF_HUB_OFFLINE="1")
    assert "'hf:tiny/missing' cannot be loaded" in str(message)
