"""Reasoned Explorer: outdoor object navigation with language models that imagine what lies beyond.

The names below are the public API; nothing else is promised to stay. Importing the package loads none of its rooms:
each name is loaded when it is first used.

```python
import reasoned_explorer as rex

world = rex.generate_world("park", seed=7)
result = rex.run_mission("Find me somewhere to take a nap", world)
print(result.summary.end, result.summary.casr)
```
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from reasoned_explorer.evaluation.mission import Mission as Mission
    from reasoned_explorer.evaluation.mission import MissionResult as MissionResult
    from reasoned_explorer.evaluation.mission import run_mission as run_mission
    from reasoned_explorer.evaluation.mission_settings import MissionSettings as MissionSettings
    from reasoned_explorer.evaluation.record_file import read_record as read_record
    from reasoned_explorer.exploration.settings import ExplorerSettings as ExplorerSettings
    from reasoned_explorer.geometry import Pose as Pose
    from reasoned_explorer.model import InputError as InputError
    from reasoned_explorer.model import PartError as PartError
    from reasoned_explorer.model import ReasonedExplorerError as ReasonedExplorerError
    from reasoned_explorer.model.record import EpisodeRecord as EpisodeRecord
    from reasoned_explorer.world.atlas import Atlas as Atlas
    from reasoned_explorer.world.drawing import draw_world as draw_world
    from reasoned_explorer.world.files import load_world as load_world
    from reasoned_explorer.world.files import save_world as save_world
    from reasoned_explorer.world.generator import generate_world as generate_world
    from reasoned_explorer.world.opening import open_world as open_world
    from reasoned_explorer.world.osm.importer import import_osm as import_osm
    from reasoned_explorer.world.summary import summarise as summarise
    from reasoned_explorer.world.world import World as World

__version__ = "0.1.0"

_HOMES = {
    "Atlas": "world.atlas",
    "EpisodeRecord": "model.record",
    "ExplorerSettings": "exploration.settings",
    "InputError": "model",
    "Mission": "evaluation.mission",
    "MissionResult": "evaluation.mission",
    "MissionSettings": "evaluation.mission_settings",
    "PartError": "model",
    "Pose": "geometry",
    "ReasonedExplorerError": "model",
    "World": "world.world",
    "draw_world": "world.drawing",
    "generate_world": "world.generator",
    "import_osm": "world.osm.importer",
    "load_world": "world.files",
    "open_world": "world.opening",
    "read_record": "evaluation.record_file",
    "run_mission": "evaluation.mission",
    "save_world": "world.files",
    "summarise": "world.summary",
}

__all__ = [
    "Atlas",
    "EpisodeRecord",
    "ExplorerSettings",
    "InputError",
    "Mission",
    "MissionResult",
    "MissionSettings",
    "PartError",
    "Pose",
    "ReasonedExplorerError",
    "World",
    "draw_world",
    "generate_world",
    "import_osm",
    "load_world",
    "open_world",
    "read_record",
    "run_mission",
    "save_world",
    "summarise",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
