"""What is kept on disk comes back as it was made, and nothing else does."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from reasoned_explorer.rendering import shelf
from reasoned_explorer.rendering.models.catalogue import _maker, natural_size_m
from reasoned_explorer.rendering.shelf import kept_arrays, kept_model
from tests.rendering.things import box

ARRAYS = (np.arange(6, dtype=np.float32).reshape(2, 3), np.array(7), np.zeros((0, 3), np.int32), np.array([1, 2], "u1"))
_KEEPS = """
import sys
from pathlib import Path
import numpy as np
from reasoned_explorer.rendering import shelf
shelf.shelf_folder = lambda: Path(sys.argv[1])
for turn in range(100):
    (found,) = shelf.kept_arrays(f"number-{turn % 3}", lambda: [np.full(5000, turn % 3)])
    assert (found == turn % 3).all(), found
    if turn % 7 == 0:
        shelf._write(Path(sys.argv[1]) / f"number-{turn % 3}.kept", [np.full(5000, turn % 3)])
"""


class Workshop:
    """Makes arrays and counts how often."""

    def __init__(self, arrays: Sequence[np.ndarray] = ARRAYS) -> None:
        self.arrays, self.made = arrays, 0

    def __call__(self) -> Sequence[np.ndarray]:
        self.made += 1
        return self.arrays


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(shelf, "shelf_folder", lambda: tmp_path / "shelf")
    return tmp_path / "shelf"


def is_same(found: Sequence[np.ndarray], wanted: Sequence[np.ndarray]) -> bool:
    return len(found) == len(wanted) and all(
        one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
        for one, other in zip(found, wanted, strict=True)
    )


def test_what_was_made_once_is_read_from_then_on(folder: Path) -> None:
    workshop = Workshop()
    for _ in range(3):
        assert is_same(kept_arrays("numbers", workshop), ARRAYS)
    assert workshop.made == 1
    assert [path.name for path in folder.iterdir()] == ["numbers.kept"]


def test_what_is_read_may_be_written_to_as_what_is_made_may(folder: Path) -> None:
    kept_arrays("numbers", Workshop())
    found = kept_arrays("numbers", Workshop())
    assert all(array.flags.writeable and array.flags.aligned for array in found)


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "cut short": lambda content: content[:-70],
    "cut in its head": lambda content: content[:50],
    "of something else": lambda _: b"\x89PNG\r\n\x1a\n" + bytes(500),
    "with a bit turned at its end": lambda content: content[:-1] + bytes([content[-1] ^ 1]),
    "with another shape": lambda content: content.replace(b"[2, 3]", b"[3, 2]"),
    "by another maker": lambda content: bytes([content[0] ^ 1]) + content[1:],
    "with more behind it": lambda content: content + b"more",
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_file_that_is_not_as_it_was_written_is_made_anew(folder: Path, damage: str) -> None:
    workshop = Workshop()
    kept_arrays("numbers", workshop)
    path = folder / "numbers.kept"
    whole = path.read_bytes()
    path.write_bytes(DAMAGES[damage](whole))
    assert path.read_bytes() != whole
    assert is_same(kept_arrays("numbers", workshop), ARRAYS)
    assert workshop.made == 2
    assert path.read_bytes() == whole


def test_what_another_version_made_is_replaced(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept_arrays("numbers", Workshop())
    monkeypatch.setattr(shelf, "_maker", lambda: 64 * "0")
    newer = Workshop([np.ones(4)])
    assert is_same(kept_arrays("numbers", newer), [np.ones(4)])
    assert is_same(kept_arrays("numbers", newer), [np.ones(4)])
    assert newer.made == 1
    assert len(list(folder.iterdir())) == 1


def test_where_nothing_can_be_written_it_is_made_every_time(folder: Path) -> None:
    folder.write_text("a file where the folder should be")
    workshop = Workshop()
    for _ in range(2):
        assert is_same(kept_arrays("numbers", workshop), ARRAYS)
    assert workshop.made == 2
    assert folder.read_text() == "a file where the folder should be"


def test_where_nothing_is_kept_it_is_made_every_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shelf, "shelf_folder", lambda: None)
    workshop = Workshop()
    for _ in range(2):
        assert is_same(kept_arrays("numbers", workshop), ARRAYS)
    assert workshop.made == 2


def test_several_processes_may_write_and_read_the_same_files(tmp_path: Path) -> None:
    command = [sys.executable, "-c", _KEEPS, str(tmp_path / "shelf")]
    both = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for process in both:
        _, complaints = process.communicate()
        assert process.returncode == 0, complaints
    assert sorted(path.name for path in (tmp_path / "shelf").iterdir()) == [f"number-{k}.kept" for k in range(3)]


@pytest.mark.parametrize("name", ["bench", "tree"])
def test_a_model_comes_back_as_it_was_made(folder: Path, name: str) -> None:
    def make():
        return _maker(name).model(0, natural_size_m(name))

    made, written, read = make(), kept_model(name, make), kept_model(name, box)
    for model in (written, read):
        assert (model.size_m, model.scaling, len(model.levels)) == (made.size_m, made.scaling, len(made.levels))
        for mesh, wanted in zip(model.levels, made.levels, strict=True):
            for field in ("vertices", "triangles", "normals", "uvs", "colours", "materials"):
                assert is_same([getattr(mesh, field)], [getattr(wanted, field)])


def test_a_mesh_that_serves_for_two_levels_is_kept_once(folder: Path) -> None:
    mesh = box().levels[0]

    def make():
        return shelf.Model((mesh, mesh), (1.0, 1.0, 1.0), "uniform")

    kept_model("box", make)
    found = kept_model("box", make)
    assert found.levels[0] is found.levels[1]
    assert found.scaling == "uniform"
