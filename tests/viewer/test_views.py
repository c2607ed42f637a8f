"""Pictures of views: the kept ones where there are some, else drawn from where the vehicle really stood."""

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.runs import MissionFiles, UnknownIdError
from reasoned_explorer.viewer.views import Views, camera_of, kept_path, viewpoint
from reasoned_explorer.viewer.worlds import Worlds
from reasoned_explorer.world.opening import open_world
from tests.viewer.small_runs import SHORT


@pytest.fixture(scope="module")
def pictured(tmp_path_factory: pytest.TempPathFactory) -> tuple[EpisodeRecord, Path]:
    """A mission that kept its pictures."""
    folder = tmp_path_factory.mktemp("pictured") / "pictures"
    settings = replace(SHORT, planner="nearest-frontier", picture_px=224)
    mission = Mission("Find me a bench", open_world("plaza:3@200"), settings, pictures=folder)
    return mission.run().record, folder


def _files(record: EpisodeRecord, pictures: Path | None) -> MissionFiles:
    return MissionFiles("a", "A", record_bytes(record), pictures=pictures)


def _pixels(data: bytes | None) -> np.ndarray:
    assert data is not None
    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image.convert("RGB"), dtype=np.float64)


def test_a_kept_picture_is_shown_as_it_was_kept(pictured: tuple[EpisodeRecord, Path]) -> None:
    record, folder = pictured
    files, views = _files(record, folder), Views(Worlds())
    assert views.state(files, record.header) == "kept"
    assert views.picture(files, record, 0, 1) == (folder / "0000-0000-0001.png").read_bytes()
    looks = sorted({path.name.rpartition("-")[0] for path in folder.glob("*.png")})
    assert len(looks) == sum(len({view.key[:2] for view in step.views}) for step in record.steps)


def test_what_is_drawn_anew_is_what_was_seen(pictured: tuple[EpisodeRecord, Path]) -> None:
    """The heading that the vehicle believed in is not quite the true one: all but the same, and like no other view."""
    record, folder = pictured
    kept, drawn, views = _files(record, folder), _files(record, None), Views(Worlds())
    assert views.state(drawn, record.header) == "drawn"
    seen = [step.step for step in record.steps if step.views]
    for step in (seen[0], seen[-1]):
        was, other = _pixels(views.picture(kept, record, step, 0)), _pixels(views.picture(kept, record, step, 2))
        again = _pixels(views.picture(drawn, record, step, 0, width_px=224))
        assert again.shape == was.shape
        assert np.abs(again - was).mean() < 0.25 * np.abs(again - other).mean()


def test_a_picture_can_be_asked_for_smaller(pictured: tuple[EpisodeRecord, Path], tmp_path: Path) -> None:
    record, _ = pictured
    large = tmp_path / "0000-0000-0000.png"
    Image.new("RGB", (640, 480), (200, 0, 0)).save(large)
    views, files = Views(Worlds()), _files(record, tmp_path)
    assert _pixels(views.picture(files, record, 0, 0, width_px=320)).shape == (240, 320, 3)
    assert _pixels(views.picture(files, record, 0, 0)).shape == (480, 640, 3)
    assert _pixels(views.picture(_files(record, None), record, 0, 0, width_px=300)).shape == (300, 300, 3)


def test_what_is_no_picture_is_not_sent(pictured: tuple[EpisodeRecord, Path], tmp_path: Path) -> None:
    record, _ = pictured
    folder = tmp_path / "pictures"
    folder.mkdir()
    (tmp_path / "secret.png").write_bytes(b"\x89PNG\r\n\x1a\n a secret")
    (folder / "0000-0000-0000.png").write_text("<script>")
    (folder / "0000-0000-0001.png").symlink_to(tmp_path / "secret.png")
    (folder / "0000-0000-0002.png").write_bytes(b"\x89PNG\r\n\x1a\n broken")
    afield = replace(record, header=replace(record.header, world_digest=""))
    views, files = Views(Worlds()), _files(record, folder)
    for index in range(3):
        assert views.picture(files, afield, 0, index) is None
    assert kept_path(files, record, 0, 1) is None


def test_a_mission_without_world_and_pictures_has_none(pictured: tuple[EpisodeRecord, Path]) -> None:
    record, _ = pictured
    afield = replace(record, header=replace(record.header, world="none", world_digest=""))
    views, files = Views(Worlds()), _files(afield, None)
    assert views.state(files, afield.header) == "none"
    assert views.picture(files, afield, 0, 0) is None


@pytest.mark.parametrize(("step", "index"), [(-1, 0), (0, -1), (0, 99), (10_000, 0)])
def test_a_view_that_there_was_not_is_not_found(pictured: tuple[EpisodeRecord, Path], step: int, index: int) -> None:
    record, folder = pictured
    with pytest.raises(UnknownIdError):
        Views(Worlds()).picture(_files(record, folder), record, step, index)


def test_views_are_from_where_the_vehicle_truly_was(record: EpisodeRecord) -> None:
    x_m, y_m, z_m, _ = record.header.start
    first = viewpoint(record, 0, record.steps[0].views[0])
    assert (first.x_m, first.y_m, first.z_m) == (x_m, y_m, z_m)
    assert first.heading_rad == record.steps[0].views[0].heading_rad
    end = record.steps[0].legs[-1].track[-1]
    second = viewpoint(record, 1, record.steps[0].views[0])
    assert (second.x_m, second.y_m, second.z_m) == (end.x_m, end.y_m, end.z_m)


def test_a_vehicle_that_is_not_known_here_has_the_usual_camera(record: EpisodeRecord) -> None:
    assert camera_of(replace(record.header, vehicle="somebody's own")).width_px > 0
