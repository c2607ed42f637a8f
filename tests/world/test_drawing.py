"""Map pictures: everything that a world can hold is drawn, the thanks are on it, and the same bytes come out twice."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib import rcParams
from matplotlib.path import Path as MarkPath
from matplotlib.text import Text

from reasoned_explorer.model.errors import PartError, WorldError
from reasoned_explorer.world.drawing import compose, draw_world, fitted_bounds, legend_entries
from reasoned_explorer.world.drawing_style import FAMILY_COLOURS, Palette, mix, printable, set_in, width_pt, wrapped
from reasoned_explorer.world.lettering import Room
from reasoned_explorer.world.painting import Board
from reasoned_explorer.world.sheet import Sheet, plain_settings, scale_bar_width_pt
from reasoned_explorer.world.symbols import oriented, path_of, symbol_of
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground
from reasoned_explorer.world.textures import pitch_lines, polygon_of, shore_lines, wood_crowns
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject

THANKS = "© OpenStreetMap contributors, ODbL 1.0"
ODD_NAMES = (
    "$^{",
    r"$\frac{1}{0}$",
    "\U0001f600\U0001f333",
    "ميدان التحرير",
    "שלום $x_",
    "名" * 40,
    "a" * 300,
    "tab\tbell\x07null\x00",
    "line\nbreak",
    "\ud800",
    "\u202ereversed\u202c",
    "",
    "   ",
    "word " * 60,
)


def box(x: float, y: float, width: float, height: float) -> np.ndarray:
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], dtype=np.float64)


def town() -> World:
    """All grounds as regions and ways, all classes as objects, and buildings of every sort."""
    regions = [
        Region(ground, box(-195 + 40 * (k % 10), -95 + 40 * (k // 10), 36, 30), name=f"{ground.noun} field")
        for k, ground in enumerate(Ground)
    ]
    lake = box(-100, 20, 60, 40)
    regions.append(Region(Ground.WATER, lake, (box(-80, 30, 10, 10),), name="Lake"))
    ways = [
        Way("way", ground, np.array([(-190.0, 70.0 + k), (0.0, 75.0 + 1.5 * k), (190.0, 70.0 + k)]), 2.0 + k % 8,
            "Long Road", level=(-1, 0, 0, 0, 1, 2)[k % 6])
        for k, ground in enumerate(Ground)
    ]  # fmt: skip
    buildings = [
        Building(box(20, 10, 30, 20), 12.0, holes=(box(30, 15, 8, 8),), name="Town Hall"),
        Building(box(60, 10, 20, 20)[::-1], 90.0, kind="tower"),
        Building(box(90, 10, 20, 10), 4.0, min_height_m=3.0, kind="roof"),
    ]
    objects = []
    for code, name in enumerate(CLASS_NAMES):
        x, y = -180 + 30 * (code % 13), -80 + 40 * (code // 13)
        kind = OBJECT_CLASSES[name].kind
        outline = box(x, y, 10, 6) if kind == "area" or name == "fountain" else None
        objects.append(
            WorldObject(code, name, x, y, 0.3 * code, OBJECT_CLASSES[name].size_m, {"name": f"The {name}"}, outline)
        )
    return World("town", Bounds(-200, -100, 200, 110), tuple(regions), tuple(ways), tuple(buildings), tuple(objects),
                 source="made by hand", attribution=THANKS)  # fmt: skip


def empty(bounds: Bounds | None = None) -> World:
    return World("nowhere", bounds or Bounds(0, 0, 100, 80), (), (), (), ())


def texts_of(world: World, **options: object) -> list[str]:
    settings_ = {"bounds": world.bounds, "labels": True, "title": world.name, **options}
    with plain_settings():
        sheet = compose(world, **settings_)  # type: ignore[arg-type]
        return [text.get_text() for text in sheet.figure.findobj(Text) if text.get_text()]


def test_a_town_with_everything_is_drawn_and_thanks_are_given(tmp_path: Path) -> None:
    draw_world(town(), tmp_path / "town.png", width_px=500)
    assert (tmp_path / "town.png").read_bytes().startswith(b"\x89PNG")
    texts = texts_of(town())
    assert THANKS in texts
    assert "town" in texts
    for item in OBJECT_CLASSES.values():
        assert item.noun in texts, f"the legend lacks {item.noun}"
    for ground in Ground:
        assert ground.noun in texts, f"the legend lacks {ground.noun}"
    assert any("ground unknown on" in text.lower() for text in texts)


def test_the_legend_explains_only_what_is_there() -> None:
    texts = {entry.text for entry in legend_entries(town(), Bounds(61, 11, 79, 29))}
    assert "building" in texts
    assert "library" not in texts
    assert {entry.text for entry in legend_entries(empty(), empty().bounds)} == {"unknown ground"}
    lawn = replace(empty(), regions=(Region(Ground.GRASS, box(-1, -1, 102, 82)),))
    assert "unknown ground" not in texts_of(lawn)
    assert any("All ground known" in text for text in texts_of(lawn))


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_world_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    first, second = tmp_path / f"one.{suffix}", tmp_path / f"two.{suffix}"
    draw_world(town(), first, width_px=400)
    settings_before = dict(rcParams)
    draw_world(town(), second, width_px=400)
    assert first.read_bytes() == second.read_bytes()
    assert dict(rcParams) == settings_before


def test_a_persons_settings_neither_matter_nor_change(tmp_path: Path) -> None:
    draw_world(town(), tmp_path / "plain.png", width_px=400)
    try:
        rcParams["font.size"], rcParams["lines.linewidth"], rcParams["axes.facecolor"] = 30.0, 9.0, "red"
        draw_world(town(), tmp_path / "odd.png", width_px=400)
        assert rcParams["font.size"] == 30.0
    finally:
        rcParams["font.size"], rcParams["lines.linewidth"], rcParams["axes.facecolor"] = 10.0, 1.5, "white"
    assert (tmp_path / "plain.png").read_bytes() == (tmp_path / "odd.png").read_bytes()


def test_names_can_be_left_out() -> None:
    assert "The museum" in texts_of(town())
    assert "The museum" not in texts_of(town(), labels=False)


def test_odd_names_are_only_text(tmp_path: Path) -> None:
    world, count = town(), len(ODD_NAMES)
    objects = tuple(replace(item, attributes={"name": ODD_NAMES[item.id % count]}) for item in world.objects)
    ways = tuple(replace(way, name=ODD_NAMES[k % count]) for k, way in enumerate(world.ways))
    regions = tuple(replace(region, name=ODD_NAMES[k % count]) for k, region in enumerate(world.regions))
    draw_world(replace(world, objects=objects, ways=ways, regions=regions), tmp_path / "odd.png", width_px=300)
    for suffix in ("svg", "pdf"):
        draw_world(replace(empty(), name=ODD_NAMES[0]), tmp_path / f"odd.{suffix}")


@pytest.mark.parametrize("name", ODD_NAMES, ids=range(len(ODD_NAMES)))
def test_odd_titles_and_thanks_fit_the_sheet(tmp_path: Path, name: str) -> None:
    draw_world(replace(empty(), name=name, source=name, attribution=name), tmp_path / "odd.png", width_px=300)
    assert (tmp_path / "odd.png").stat().st_size > 1000


def test_mathematics_in_a_name_is_printed_as_it_stands() -> None:
    assert r"$\frac{1}{0}$" in texts_of(replace(empty(), name=r"$\frac{1}{0}$"))


def test_an_empty_world_is_a_sheet_of_unknown_ground(tmp_path: Path) -> None:
    draw_world(empty(), tmp_path / "empty.svg")
    assert any("unknown on 100%" in text for text in texts_of(empty()))


@pytest.mark.parametrize(
    "bounds",
    [
        Bounds(0, 0, 0, 0),
        Bounds(5, 5, 5.001, 5.001),
        Bounds(-1e6, -1e6, 1e6, 1e6),
        Bounds(0, 0, 3000, 1),
        Bounds(0, 0, 1, 3000),
        Bounds(5000, 5000, 5100, 5100),
    ],
)
def test_any_bounds_make_a_sheet(tmp_path: Path, bounds: Bounds) -> None:
    draw_world(town(), tmp_path / "map.png", bounds=bounds, width_px=300)
    assert (tmp_path / "map.png").exists()


def test_a_world_without_extent_is_drawn(tmp_path: Path) -> None:
    draw_world(empty(Bounds(0, 0, 0, 0)), tmp_path / "dot.png", width_px=300)
    draw_world(empty(Bounds(-1e6, -1e6, 1e6, 1e6)), tmp_path / "vast.png", width_px=300)


def test_broken_shapes_are_drawn_as_far_as_they_go(tmp_path: Path) -> None:
    bow_tie = np.array([(0.0, 0.0), (40.0, 40.0), (40.0, 0.0), (0.0, 40.0)])
    line = np.array([(0.0, 0.0), (40.0, 0.0)])
    point = np.array([(3.0, 3.0)] * 4)
    shapes = (bow_tie, line, point)
    grounds = (Ground.WATER, Ground.WOOD, Ground.PITCH, Ground.PLAZA)
    world = replace(
        empty(),
        regions=tuple(Region(ground, shape, (line,), name="Odd") for shape in shapes for ground in grounds),
        ways=tuple(Way("footway", Ground.PATH, shape, 2.0, "Odd Lane") for shape in shapes),
        buildings=tuple(Building(shape, 10.0, holes=(point,), name="Odd House") for shape in shapes),
        objects=tuple(
            WorldObject(k, "playground", 5.0, 5.0, outline=shape, size_m=(0.0, 0.0, 0.0))
            for k, shape in enumerate(shapes)
        ),
    )
    draw_world(world, tmp_path / "broken.png", width_px=300)


def test_all_faults_are_named_at_once(tmp_path: Path) -> None:
    with pytest.raises(WorldError) as caught:
        draw_world(town(), tmp_path / "no" / "map.gif", bounds=Bounds(math.nan, 0, 1, 1), width_px=3)
    assert len(caught.value.faults) == 4
    assert "existing folder" in str(caught.value)
    assert ".png" in str(caught.value)
    with pytest.raises(WorldError, match="west below east"):
        draw_world(town(), tmp_path / "map.png", bounds=Bounds(10, 0, -10, 5))


def test_a_full_disk_leaves_the_old_picture_and_nothing_half_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "map.png"
    target.write_bytes(b"the old one")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(PartError, match="No space left on device; make room"):
        draw_world(empty(), target, width_px=300)
    assert target.read_bytes() == b"the old one"
    assert [file.name for file in tmp_path.iterdir()] == ["map.png"]


def test_a_folder_cannot_be_overwritten(tmp_path: Path) -> None:
    (tmp_path / "map.png").mkdir()
    with pytest.raises(WorldError, match="is a folder"):
        draw_world(empty(), tmp_path / "map.png")


@settings(deadline=None, max_examples=80)
@given(st.text(max_size=60))
def test_printable_text_is_one_line_without_control_characters(text: str) -> None:
    line = printable(text)
    assert "\n" not in line
    assert "\x00" not in line
    assert printable(line) == line
    line.encode("utf-8")
    set_in("serif", text)


@settings(deadline=None, max_examples=40)
@given(st.text(alphabet="abc dMW", max_size=120), st.floats(20.0, 300.0), st.integers(1, 4))
def test_wrapped_lines_fit_and_lose_nothing_unsaid(text: str, room_pt: float, max_lines: int) -> None:
    lines = wrapped(text, "sans", 9.0, room_pt, max_lines)
    assert len(lines) <= max_lines
    for line in lines:
        assert width_pt(line, "sans", 9.0) <= room_pt + 1e-6
    whole = "".join(lines).replace(" ", "")
    assert whole == text.replace(" ", "") or whole.endswith("…")


@settings(deadline=None, max_examples=60)
@given(
    st.floats(-1e4, 1e4),
    st.floats(-1e4, 1e4),
    st.floats(0, 1e4),
    st.floats(0, 1e4),
    st.floats(0.3, 1.0),
    st.floats(1.0, 2),
)
def test_fitted_bounds_hold_what_was_asked_for(
    x: float, y: float, width: float, height: float, low: float, high: float
) -> None:
    shown = fitted_bounds(Bounds(x, y, x + width, y + height), shapes=(low, high), least_m=20.0)
    assert shown.min_x_m <= x + 1e-6
    assert shown.max_x_m >= x + width - 1e-6
    assert shown.min_y_m <= y + 1e-6
    assert shown.max_y_m >= y + height - 1e-6
    assert low - 1e-6 <= shown.height_m / shown.width_m <= high + 1e-6


@settings(deadline=None, max_examples=60)
@given(st.floats(1e-3, 1e4))
def test_scale_bars_are_round_and_fit(metres_per_point: float) -> None:
    width = scale_bar_width_pt(metres_per_point, room_pt=150.0)
    assert 60.0 <= width <= 150.0 + 1e-6
    digits = f"{width * metres_per_point:.6e}"
    assert digits[0] in "1245"
    assert set(digits[2:8]) == {"0"}


def test_every_class_has_a_pictogram_of_its_own_inside_its_disc() -> None:
    seen: dict[bytes, str] = {}
    for name in CLASS_NAMES:
        symbol = symbol_of(name)
        vertices = np.asarray(symbol.glyph.vertices)
        assert np.hypot(vertices[:, 0], vertices[:, 1]).max() < 1.0 / 0.62, name
        assert symbol.family in FAMILY_COLOURS
        twin = seen.setdefault(vertices.tobytes(), name)
        assert {twin, name} <= {"bicycle", "bicycle_rental"} or twin == name
    assert symbol_of("something new").rank == 1


def test_holes_of_paths_turn_against_their_outlines() -> None:
    shape = polygon_of(box(0, 0, 10, 10), (box(2, 2, 3, 3),))
    path = path_of(shape)
    assert path.contains_point((1.0, 1.0))
    assert list(path.codes).count(MarkPath.MOVETO) == 2
    ring = box(0, 0, 3, 2)
    assert np.array_equal(oriented(ring, anticlockwise=True), ring)
    assert np.array_equal(oriented(ring, anticlockwise=False), ring[::-1])


def test_names_and_symbols_never_share_a_place() -> None:
    with plain_settings():
        sheet = Sheet(300.0, Palette())
        bounds = Bounds(0, 0, 100, 100)
        room = Room(Board(sheet.map_axes(0, 0, 200, 200, bounds), bounds, 0.5, sheet.palette))
    assert room.take(np.array([[50.0, 50.0]]), 5.0)
    assert not room.take(np.array([[52.0, 50.0]]), 5.0)
    assert room.take(np.array([[60.0, 50.0]]), 5.0)
    assert not room.take(np.array([[99.9, 50.0]]), 5.0), "it would be cut off"
    assert room.take(np.array([[99.9, 50.0]]), 5.0, whole=False)
    assert not room.take(np.array([[-500.0, 50.0]]), 5.0, whole=False)


def test_textures_stay_in_their_regions() -> None:
    bounds = Bounds(0, 0, 100, 100)
    wood = Region(Ground.WOOD, box(10, 10, 50, 40))
    crowns = wood_crowns([wood], 6.0, bounds, shift=0.0)
    centres = crowns.mean(axis=1)
    assert len(crowns) > 30
    assert ((centres > 9.9) & (centres < (60.1, 50.1))).all()
    assert np.array_equal(crowns, wood_crowns([wood], 6.0, bounds, shift=0.0))
    edge = shore_lines([Region(Ground.WATER, box(0, 0, 100, 40))], 2.0, bounds)
    assert all((line[:, 1] > 30.0).all() for line in edge), "the world's edge is no shore"
    assert len(pitch_lines(box(0, 0, 90, 50))) == 5
    assert pitch_lines(box(0, 0, 3, 3)) == []
    assert pitch_lines(np.array([(0.0, 0.0), (90.0, 0.0), (0.0, 90.0)])) == []


def test_muted_colours_move_to_the_paper() -> None:
    assert mix("#000000", "#ffffff", 0.5) == "#808080"
    plain, pale = Palette(), Palette().muted(1.0)
    assert set(pale.ground.values()) == {plain.paper}
    assert Palette().muted(0.0) == plain
