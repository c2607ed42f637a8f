"""Loads a model by its name on the Hugging Face hub, or from a folder.

Weights are read as safetensors only, and no code that comes with a model is run. Where the hub's cache on this machine
holds all of a model, the hub is not asked at all; with ``HF_HUB_OFFLINE=1`` it never is.
"""

import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from reasoned_explorer.calls.local.coding import Coder, ConversationCoder, GroundingCoder
from reasoned_explorer.calls.local.generating import Generator
from reasoned_explorer.calls.local.model import LocalModel
from reasoned_explorer.model import Fault, MissingDependencyError, SettingsError

T = TypeVar("T")

PREFIX = "hf:"
_INSTALL = "pip install 'reasoned-explorer[local]'"
_GROUNDING = "kosmos-2"
_SMOLVLM = "smolvlm"
# A file of at most so many bytes is read whole for the fingerprint, a larger one at both ends.
_WHOLE_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class LocalSettings:
    """How a model is run on this machine.

    Attributes:
        device: As torch calls it, e.g. ``"cuda:1"``; empty for a graphics card where there is one, else the CPU.
        dtype: ``"float32"``, ``"bfloat16"`` or ``"float16"``; empty for float32 on a CPU, else bfloat16 where the
            card has it, else float16.
        most: Questions answered in one batch, at most; 1 or more. A batch that does not fit into the
            device's memory is halved until it does.
        linger_s: Nothing more having arrived for so long, seconds, a batch is complete; 0 to 1.

    Raises:
        SettingsError: If a value is out of its range, with all that are.
    """

    device: str = ""
    dtype: str = ""
    most: int = 16
    linger_s: float = 0.01

    def __post_init__(self) -> None:
        known = ("", "float32", "bfloat16", "float16")
        checks = (
            (self.dtype in known, f"dtype is {self.dtype!r}", "float32, bfloat16, float16, or nothing"),
            (isinstance(self.most, int) and self.most >= 1, f"most is {self.most!r}", "a whole number from 1"),
            (0.0 <= self.linger_s <= 1.0, f"linger_s is {self.linger_s!r}", "seconds from 0 to 1"),
        )
        faults = [Fault(what, expected) for sound, what, expected in checks if not sound]
        if faults:
            raise SettingsError("settings of models on this machine", faults)


def hub_name(name: str) -> str | None:
    """Return what stands behind ``hf:`` in a name, or None where it does not begin so.

    >>> hub_name("hf:microsoft/kosmos-2-patch14-224")
    'microsoft/kosmos-2-patch14-224'
    """
    return name.removeprefix(PREFIX) if name.startswith(PREFIX) and len(name) > len(PREFIX) else None


def load_local(name: str, settings: LocalSettings | None = None) -> LocalModel:
    """Return a model that runs on this machine, loaded once in a process.

    Pictures are read by what ``AutoModelForImageTextToText`` knows, Kosmos-2 and SmolVLM among them; anything else is
    a model of text, loaded by ``AutoModelForCausalLM``.

    Args:
        name: ``hf:`` and a name on the hub or a folder; a branch, tag or commit of the hub may follow after ``@``.
        settings: How it is run.

    Raises:
        MissingDependencyError: If torch or transformers is not installed.
        SettingsError: If there is no such model, or it cannot be run here.
    """
    where = _checked(name)
    with _one_error(name):
        return _load(name, where, settings or LocalSettings())  # kept: the second time it is there


def only_describes(name: str) -> bool:
    """Return whether a model describes pictures and does nothing else, by its configuration: no weights are read.

    Args:
        name: As for `load_local`.

    Raises:
        MissingDependencyError, SettingsError: As `load_local`.
    """
    where = _checked(name)
    with _one_error(name):
        return _wherever(where, lambda source: _is_grounding(_config(source)))


def _checked(name: str) -> str:
    """Return what stands behind ``hf:``, once what has to be installed is there."""
    where = hub_name(name)
    if where is None:
        raise SettingsError("model", [Fault(f"{name!r}", "hf: and a name on the Hugging Face hub or a folder")])
    for package in ("torch", "transformers"):
        if find_spec(package) is None:
            raise MissingDependencyError(name, package, _INSTALL)
    return where


@contextmanager
def _one_error(name: str) -> Iterator[None]:
    """Make one error of whatever goes wrong with a model's files."""
    try:
        with _quiet_hub():
            yield
    except (OSError, ValueError, ImportError, RuntimeError, KeyError) as error:
        reason = " ".join(str(error).split())
        fault = Fault(
            f"{name!r} cannot be loaded: {type(error).__name__}: {reason[:400]}",
            "a model of transformers with safetensors, on the hub or in a folder",
            "check the name, and that its files are here or the hub can be reached",
        )
        raise SettingsError("model", [fault]) from error


@contextmanager
def _quiet_hub() -> Iterator[None]:
    """Keep the hub's library from telling of each try to reach the hub: if all are in vain, the error says so."""
    from huggingface_hub import logging

    level = logging.get_verbosity()
    logging.set_verbosity(max(level, logging.ERROR))
    try:
        yield
    finally:
        logging.set_verbosity(level)


@dataclass(frozen=True, slots=True)
class _Source:
    """Where a model's files are: a folder, or a name on the hub with a branch, tag or commit."""

    where: str
    revision: str
    is_here: bool

    def read(self, kind: Any, **options: Any) -> Any:
        """Return what a class of transformers makes of the files."""
        return kind.from_pretrained(self.where, revision=self.revision, local_files_only=self.is_here, **options)


def _wherever(where: str, read: Callable[[_Source], T]) -> T:
    """Return what is read from a folder, or from the hub's cache, or from the hub where the cache lacks something."""
    if Path(where).is_dir():
        return read(_Source(where, "main", is_here=True))
    hub, _, revision = where.partition("@")
    try:
        return read(_Source(hub, revision or "main", is_here=True))
    except OSError:
        return read(_Source(hub, revision or "main", is_here=False))


@cache
def _load(name: str, where: str, settings: LocalSettings) -> LocalModel:
    return _wherever(where, lambda source: _loaded(name, source, settings))


def _config(source: _Source) -> Any:
    from transformers import AutoConfig

    return source.read(AutoConfig)


def _is_grounding(config: Any) -> bool:
    """Return whether a model is one of the kind that describes pictures and does nothing else."""
    return str(config.model_type) == _GROUNDING


def _loaded(name: str, source: _Source, settings: LocalSettings) -> LocalModel:
    import torch
    from transformers import (
        MODEL_FOR_IMAGE_TEXT_TO_TEXT_MAPPING,
        AutoModelForCausalLM,
        AutoModelForImageTextToText,
        AutoTokenizer,
    )

    device = torch.device(settings.device or _best_device())
    dtype = getattr(torch, settings.dtype or _best_dtype(device.type))
    config = _config(source)
    if getattr(config, "is_encoder_decoder", False):
        raise ValueError(f"{config.model_type} is a model that translates one text into another; it cannot be asked")
    family, sees = str(config.model_type), type(config) in MODEL_FOR_IMAGE_TEXT_TO_TEXT_MAPPING
    coder: Coder
    if not sees:
        coder = ConversationCoder(source.read(AutoTokenizer))
    else:
        processor = _processor(source, config)
        coder = (
            GroundingCoder(processor) if _is_grounding(config) else ConversationCoder(processor.tokenizer, processor)
        )
    kind = AutoModelForImageTextToText if sees else AutoModelForCausalLM
    model = source.read(kind, config=config, dtype=dtype, use_safetensors=True).to(device).eval()
    version = _version(source)[:12]
    return LocalModel(
        Generator(model, coder, name=f"{source.where}@{version}"),
        name=name,
        fingerprint=f"{name} {version} {str(dtype).removeprefix('torch.')} {device.type}",
        family=family,
        sees=sees,
        only_describes=isinstance(coder, GroundingCoder),
        most=settings.most,
        linger_s=settings.linger_s,
    )


def _best_device() -> str:
    import torch

    if torch.cuda.is_available():
        return "cuda"
    return "mps" if torch.backends.mps.is_available() else "cpu"


def _best_dtype(device: str) -> str:
    import torch

    if device == "cpu":
        return "float32"
    return "bfloat16" if device == "cuda" and torch.cuda.is_bf16_supported() else "float16"


def _processor(source: _Source, config: Any) -> Any:
    """Return what reads pictures and text for a model, without torchvision where that is not installed."""
    from transformers import AutoImageProcessor, AutoProcessor, AutoTokenizer, Idefics3Processor

    if config.model_type != _SMOLVLM:
        return source.read(AutoProcessor)
    # SmolVLM's own also reads films, for which it needs torchvision and more; for pictures it is Idefics 3's.
    vision = config.vision_config
    places = (vision.image_size // vision.patch_size) ** 2 // config.scale_factor**2
    tokenizer = source.read(AutoTokenizer)
    images = source.read(AutoImageProcessor)
    return Idefics3Processor(images, tokenizer, image_seq_len=places, chat_template=tokenizer.chat_template)


def _version(source: _Source) -> str:
    """Return what tells these weights from others: the hub's commit, or a digest of the folder's files."""
    from huggingface_hub import hf_hub_download

    if Path(source.where).is_dir():
        return _digest(Path(source.where))
    # By now the cache holds the file, in a folder that is named by the commit.
    return Path(
        hf_hub_download(source.where, "config.json", revision=source.revision, local_files_only=True)
    ).parent.name


def _digest(folder: Path) -> str:
    digest = hashlib.sha256()
    for path in sorted(folder.iterdir()):
        if path.is_file():
            size = path.stat().st_size
            digest.update(f"{path.name} {size}\n".encode())
            with path.open("rb") as file:
                digest.update(file.read(_WHOLE_BYTES))
                if size > _WHOLE_BYTES:
                    file.seek(-_WHOLE_BYTES, 2)
                    digest.update(file.read())
    return digest.hexdigest()[:12]
