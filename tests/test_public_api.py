import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import reasoned_explorer as rex
from reasoned_explorer.model import GoalError, InputError, RecordError, SettingsError, StartError, WorldError
from tests.world.worlds import courtyard


def test_every_public_name_can_be_loaded_and_has_a_docstring() -> None:
    for name in rex.__all__:
        assert getattr(rex, name).__doc__, name


def test_the_lazy_names_are_the_public_ones() -> None:
    assert sorted(rex._HOMES) == sorted(rex.__all__)


def test_importing_the_package_loads_nothing_heavy() -> None:
    heavy = ("numpy", "numba", "shapely", "matplotlib", "pydantic")
    code = f"import reasoned_explorer, sys; print([m for m in {heavy} if m in sys.modules])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_the_help_of_the_command_line_loads_nothing_heavy() -> None:
    code = (
        "import sys\nsys.argv = ['rex', '--help']\nfrom reasoned_explorer.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print([m for m in ('numpy', 'numba', 'shapely', 'matplotlib') if m in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip().endswith("[]")


NOT_A_NUMBER = float("nan")
LONG = "n" * 300
HERE = rex.Pose(55.0, 35.0)


def told(world: rex.World, **settings: Any) -> object:
    return rex.run_mission("Find me a bench", world, rex.MissionSettings(**settings), start=HERE)


#: What somebody may well hand in, and which error says so.
MISTAKES: dict[str, tuple[type[rex.InputError], Callable[[rex.World], object]]] = {
    "a name for a world": (WorldError, lambda world: rex.run_mission("Find me a bench", "park:7")),
    "no world": (WorldError, lambda world: rex.run_mission("Find me a bench", None)),
    "no goal": (GoalError, lambda world: rex.run_mission(None, world)),
    "settings that are none": (SettingsError, lambda world: rex.run_mission("Find me a bench", world, {"seed": 1})),
    "a start that is none": (StartError, lambda world: rex.run_mission("Find me a bench", world, start=(1.0, 2.0))),
    "a start of NaN": (
        StartError,
        lambda world: rex.run_mission("Find me a bench", world, start=rex.Pose(NOT_A_NUMBER, 0.0, 0.0, 0.0)),
    ),
    "a start of words": (
        StartError,
        lambda world: rex.run_mission("Find me a bench", world, start=rex.Pose("here", 0.0)),
    ),
    "a folder that is none": (
        RecordError,
        lambda world: rex.run_mission("Find me a bench", world, start=HERE, folder=7),
    ),
    "a folder with too long a name": (
        RecordError,
        lambda world: rex.run_mission("Find me a bench", world, start=HERE, folder=f"{LONG}/run"),
    ),
    "a seed of NaN": (SettingsError, lambda world: told(world, seed=NOT_A_NUMBER)),
    "a seed below zero": (SettingsError, lambda world: told(world, seed=-1)),
    "a radius of NaN": (SettingsError, lambda world: told(world, success_radius_m=NOT_A_NUMBER)),
    "a planner that is no name": (SettingsError, lambda world: told(world, planner=None)),
    "planner settings that are none": (SettingsError, lambda world: told(world, planner_settings=["depth"])),
    "explorer settings that are none": (SettingsError, lambda world: told(world, explorer={"views": 3})),
    "a view and a half": (SettingsError, lambda world: rex.ExplorerSettings(views=1.5)),
    "a time in words": (SettingsError, lambda world: rex.ExplorerSettings(t_max_s="long")),
    "a switch in words": (SettingsError, lambda world: rex.ExplorerSettings(straight_distance="yes")),
    "a map that is no file": (WorldError, lambda world: rex.import_osm(None)),
    "a map with too long a name": (WorldError, lambda world: rex.import_osm(f"{LONG}.osm")),
    "a map's seed of NaN": (WorldError, lambda world: rex.import_osm("map.osm", seed=NOT_A_NUMBER)),
    "a world that is no file": (WorldError, lambda world: rex.load_world(None)),
    "a world with too long a name": (WorldError, lambda world: rex.load_world(f"{LONG}.rexworld")),
    "a world of no name": (WorldError, lambda world: rex.open_world(None)),
    "a world's seed of NaN": (SettingsError, lambda world: rex.open_world("park", seed=NOT_A_NUMBER)),
    "a district of no name": (InputError, lambda world: rex.generate_world(["park"])),
    "a district's size of NaN": (SettingsError, lambda world: rex.generate_world("park", size_m=NOT_A_NUMBER)),
    "nothing to save": (WorldError, lambda world: rex.save_world("park:7", "park.rexworld")),
    "nowhere to save": (WorldError, lambda world: rex.save_world(world, None)),
    "too long a name to save": (WorldError, lambda world: rex.save_world(world, f"{LONG}.rexworld")),
    "nothing to draw": (WorldError, lambda world: rex.draw_world("park:7", "park.png")),
    "nowhere to draw": (WorldError, lambda world: rex.draw_world(world, None)),
    "too long a name to draw": (WorldError, lambda world: rex.draw_world(world, f"{LONG}.png")),
    "a width of NaN": (WorldError, lambda world: rex.draw_world(world, "map.png", width_px=NOT_A_NUMBER)),
    "an atlas of no world": (WorldError, lambda world: rex.Atlas("park:7")),
    "a summary of no world": (WorldError, lambda world: rex.summarise(None)),
    "a record that is no file": (RecordError, lambda world: rex.read_record(None)),
    "a record with too long a name": (RecordError, lambda world: rex.read_record(LONG)),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_cannot_be_used_is_answered_in_words_where_it_comes_in(
    mistake: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    kind, make = MISTAKES[mistake]
    with pytest.raises(kind) as raised:
        make(courtyard())
    assert all(fault.what and fault.expected for fault in raised.value.faults)
    assert list(tmp_path.iterdir()) == []


def test_all_mistakes_of_a_mission_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        told(courtyard(), seed=-1, success_radius_m=0.0, planner=3, visionary=4)
    assert len(raised.value.faults) == 4
    with pytest.raises(InputError) as both:
        rex.run_mission("Find me a bench", "park:7", "fast", start=(1.0, 2.0))
    assert len(both.value.faults) == 3
    assert "open_world" in str(both.value)
