"""The statistics of real places that come with the package."""

import json
import math
import subprocess
import sys
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest

from reasoned_explorer.knowledge.cooccurrence import cooccurrence_from, load_cooccurrence
from reasoned_explorer.world.taxonomy import CLASS_NAMES, Ground

_ROOT = Path(__file__).resolve().parents[2]
_FILE = _ROOT / "src" / "reasoned_explorer" / "knowledge" / "cooccurrence.json"


def test_it_comes_from_the_two_places_that_one_may_learn_from_and_thanks_the_mappers() -> None:
    known = load_cooccurrence()
    assert [source["file"] for source in known.sources] == ["helsinki-centre.osm.pbf", "munich-centre.osm.pbf"]
    assert "OpenStreetMap contributors" in known.attribution
    assert load_cooccurrence() is known
    with pytest.raises(FrozenInstanceError):
        known.radius_m = 5.0  # type: ignore[misc]


def test_names_are_the_worlds_names_and_numbers_are_sane() -> None:
    data = json.loads(_FILE.read_text(encoding="utf-8"))
    grounds = {ground.name.lower() for ground in Ground}
    for table in ("class_given_class", "class_given_class_ahead"):
        assert set(data[table]) <= set(CLASS_NAMES)
        assert {name for row in data[table].values() for name in row} <= set(CLASS_NAMES)
    for table in ("class_near_ground", "class_on_ground"):
        assert set(data[table]) <= grounds
    for table in ("class_given_class", "class_given_class_ahead", "class_near_ground", "class_on_ground"):
        assert all(0.0 < lift < 500.0 for row in data[table].values() for lift in row.values())
    assert sum(data["ground_share"].values()) == pytest.approx(1.0, abs=0.01)
    assert all(value > 0.0 for value in data["density_per_km2"].values())


def test_it_knows_what_everybody_knows() -> None:
    known = load_cooccurrence()
    assert known.lift("bench", "bench") > 5.0
    assert known.lift("cafe", "restaurant") > 2.0
    assert known.lift("lawn", "restaurant") < 0.7
    assert known.ground_lift("grass", "bench") > 1.5
    assert known.on_ground_lift("water", "tree") < 0.5
    assert known.lift_ahead("restaurant", "bar") > 1.0
    assert known.distance_to["cafe"]["building"] < known.distance_to["bench"]["building"]


def test_what_is_not_known_is_neutral() -> None:
    known = load_cooccurrence()
    assert known.lift("unicorn", "bench") == known.lift("bench", "unicorn") == 1.0
    assert known.lift_ahead("unicorn", "bench") == 1.0
    assert known.ground_lift("lava", "bench") == known.on_ground_lift("lava", "bench") == 1.0
    assert known.neighbours("unicorn") == {}


def test_another_schema_is_refused() -> None:
    with pytest.raises(ValueError, match="schema is 99"):
        cooccurrence_from({"schema": 99})


def test_the_script_repeats_itself(osm_folder: Path, tmp_path: Path) -> None:
    written = []
    for seed in ("1", "2"):
        output = tmp_path / f"{seed}.json"
        subprocess.run(
            [sys.executable, str(_ROOT / "scripts" / "compute_cooccurrence.py"),
             str(osm_folder / "uvic-campus.osm.pbf"), "--output", str(output)],
            check=True, capture_output=True, env={"PYTHONHASHSEED": seed, "PYTHONPATH": str(_ROOT / "src")},
        )  # fmt: skip
        written.append(output.read_bytes())
    assert written[0] == written[1]
    assert math.isfinite(json.loads(written[0])["density_per_km2"]["bench"])
