"""Mission pictures: all that happened is in sight, what came of it is said, and the same bytes come out twice."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.collections import PathCollection
from matplotlib.text import Text

from reasoned_explorer.evaluation.mission_map import (
    LEAST_EXTENT_M,
    MapFrontier,
    MapGoal,
    MissionTrace,
    compose_mission,
    draw_mission,
    happened_in,
    moved_into,
)
from reasoned_explorer.evaluation.mission_marks import STAR, arc_path, score_colour, turned, verdict
from reasoned_explorer.evaluation.mission_signs import (
    HALT_PT,
    STEP_PT,
    TRACK_PT,
    halt_place,
    is_on_the_way,
    stands_on_a_step,
)
from reasoned_explorer.evaluation.mission_trace import FRONTIER_STATES
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.errors import PartError, RecordError
from reasoned_explorer.world.painting import Board
from reasoned_explorer.world.sheet import WIDTH_PT, Sheet, plain_settings
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject

THANKS = "© OpenStreetMap contributors, ODbL 1.0"


def park() -> World:
    lawn = np.array([(-200.0, -200.0), (200.0, -200.0), (200.0, 200.0), (-200.0, 200.0)])
    house = np.array([(30.0, 60.0), (60.0, 60.0), (60.0, 80.0), (30.0, 80.0)])
    path = np.array([(-200.0, 0.0), (0.0, 10.0), (200.0, 0.0)])
    bench = WorldObject(0, "bench", 80.0, 30.0, attributes={"name": "Bench $1"})
    tree = WorldObject(1, "tree", 40.0, -20.0, size_m=(8.0, 8.0, 10.0))
    return World(
        "park",
        Bounds(-200, -200, 200, 200),
        (Region(Ground.GRASS, lawn),),
        (Way("footway", Ground.PATH, path, 3.0, "Long Walk"),),
        (Building(house, 9.0),),
        (bench, tree),
        attribution=THANKS,
    )


def mission(**changes: object) -> MissionTrace:
    points = tuple((12.0 * step, 6.0 * math.sin(step)) for step in range(7))
    frontiers = tuple(
        MapFrontier(x + 8.0, y + side * 9.0, 1.57, q, 0.1 * k, state)
        for k, ((x, y), side, q, state) in enumerate(
            zip(
                points,
                (1, -1, 1, -1, 1, -1, 1),
                (1.0, 2.0, 3.0, 4.0, 5.0, None, 2.5),
                (*FRONTIER_STATES,) * 2,
                strict=False,
            )
        )
    )
    area = np.array([(70.0, 40.0), (90.0, 40.0), (90.0, 55.0), (70.0, 55.0)])
    trace = MissionTrace(
        title="Find me somewhere to take a nap",
        subtitle="llm-rrt · embedded minds · drone-authors",
        track=np.array(points),
        path_points=points,
        edges=tuple((points[k], points[k + 1]) for k in range(6)),
        frontiers=frontiers,
        goals=(MapGoal(80.0, 5.0, None, "bench", 2, True), MapGoal(80.0, 47.0, area, "lawn", 1, False)),
        success_radius_m=15.0,
        start=Pose(0.0, 0.0, 1.0, 1.5),
        end=Pose(72.0, -1.7, 1.0, 1.5),
        shortest_way=np.array([(0.0, 0.0), (66.0, 4.0)]),
        declared=True,
        success=True,
        facts=(("CT", "312 s"), ("SPL", "0.81")),
        notes=("embedded minds, no language model",),
    )
    return replace(trace, **changes)  # type: ignore[arg-type]


def texts_of(world: World, trace: MissionTrace) -> list[str]:
    with plain_settings():
        sheet = compose_mission(world, trace)
        return [text.get_text() for text in sheet.figure.findobj(Text) if text.get_text()]


def test_the_picture_says_what_was_sought_what_came_of_it_and_whom_to_thank(tmp_path: Path) -> None:
    draw_mission(park(), mission(), tmp_path / "mission.png", width_px=500)
    assert (tmp_path / "mission.png").read_bytes().startswith(b"\x89PNG")
    texts = texts_of(park(), mission())
    words = ["Find me somewhere to take a nap", "Found", "CT", "312 s", "0.81", "Start", "Halt", "bench", "7"]
    for expected in (*words, THANKS, "embedded minds, no language model", "goal, halo R = 15 m"):
        assert expected in texts


@pytest.mark.parametrize(
    ("declared", "success", "expected"),
    [
        (True, True, "Found"),
        (True, False, "Declared, but not there"),
        (True, None, "Declared, not judged"),
        (False, False, "Ended without finding it"),
        (False, None, "Ended without finding it"),
    ],
)
def test_every_outcome_has_its_words(declared: bool, success: bool | None, expected: str) -> None:
    trace = mission(declared=declared, success=success)
    assert verdict(trace)[0] == expected
    assert expected in texts_of(park(), trace)


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_the_same_mission_gives_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    for name in ("one", "two"):
        draw_mission(park(), mission(), tmp_path / f"{name}.{suffix}", width_px=400)
    assert (tmp_path / f"one.{suffix}").read_bytes() == (tmp_path / f"two.{suffix}").read_bytes()


def test_the_legend_leaves_out_what_did_not_happen() -> None:
    texts = texts_of(park(), mission(frontiers=(), shortest_way=None, goals=(), edges=()))
    for absent in ("blocked", "given up", "shortest permitted way", "would do at a pinch", "known connection"):
        assert absent not in texts
    assert "blocked" in texts_of(park(), mission())


def test_a_mission_that_ends_where_it_starts_is_drawn(tmp_path: Path) -> None:
    trace = mission(track=np.empty((0, 2)), path_points=(), edges=(), frontiers=(), goals=(), shortest_way=None,
                    facts=(), notes=(), end=Pose(0.0, 0.0), success_radius_m=0.0, title="", subtitle="")  # fmt: skip
    empty = World("", Bounds(0, 0, 0, 0), (), (), (), ())
    draw_mission(empty, trace, tmp_path / "still.png", width_px=300)
    draw_mission(empty, replace(trace, track=np.zeros((5, 2)), shortest_way=np.zeros((1, 2))), tmp_path / "still.svg")
    shown = happened_in(trace)
    assert shown.contains(0.0, 0.0)
    assert shown.width_m < LEAST_EXTENT_M


def test_a_long_mission_with_hundreds_of_marks_is_drawn(tmp_path: Path) -> None:
    points = tuple((2.0 * k, 40.0 * math.sin(k / 20)) for k in range(200))
    frontiers = tuple(MapFrontier(x, y + 5.0, 0.1 * k, 1 + k % 5, 0.5, FRONTIER_STATES[k % 4])
                      for k, (x, y) in enumerate(points))  # fmt: skip
    goals = tuple(MapGoal(4.0 * k, -30.0, None, f"bench {k}", 2, False) for k in range(100))
    trace = mission(track=np.array(points), path_points=points, frontiers=frontiers, goals=goals)
    draw_mission(park(), trace, tmp_path / "long.png", width_px=400)


@pytest.mark.parametrize(
    "words", ["$^{", "\U0001f634 nap", "אנא מצא ספסל", "a" * 300, "word " * 200, "tab\t\x00\x07", "\ud800"]
)
def test_odd_words_are_only_words(tmp_path: Path, words: str) -> None:
    trace = mission(title=words, subtitle=words, notes=(words,) * 5, facts=((words, words),) * 30,
                    goals=(MapGoal(80.0, 5.0, None, words, 2, True),))  # fmt: skip
    draw_mission(replace(park(), attribution=words), trace, tmp_path / "odd.png", width_px=300)


def test_all_faults_are_named_at_once(tmp_path: Path) -> None:
    trace = mission(
        track=np.array([(0.0, math.nan)]),
        shortest_way=np.zeros((2, 3)),
        frontiers=(MapFrontier(0.0, math.inf, 0.0, 3.0, None, "lost"),),
        goals=(MapGoal(math.nan, 0.0, np.zeros((2, 2)), "x", 2, False),),
        start=Pose(math.nan, 0.0),
        success_radius_m=-1.0,
    )
    with pytest.raises(RecordError) as caught:
        draw_mission(park(), trace, tmp_path / "no" / "mission.bmp", width_px=10**6)
    assert len(caught.value.faults) == 3 + 8
    for part in ("track", "shortest_way", "frontiers[0].state 'lost'", "goals[0]", "start", "success_radius_m"):
        assert part in str(caught.value)


def test_a_full_disk_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(PartError, match="No space left on device; make room"):
        draw_mission(park(), mission(), tmp_path / "mission.png", width_px=300)
    assert list(tmp_path.iterdir()) == []


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(st.floats(-5e3, 5e3), st.floats(-5e3, 5e3)), min_size=1, max_size=12))
def test_everything_that_happened_is_in_sight(points: list[tuple[float, float]]) -> None:
    shown = happened_in(mission(track=np.array(points), path_points=tuple(points)))
    assert all(shown.contains(x, y) for x, y in points)
    assert shown.contains(80.0 + 15.0, 5.0), "the goal that was reached, with its halo"


def shown_on(world: World, trace: MissionTrace) -> tuple[Sheet, Board]:
    with plain_settings():
        sheet = compose_mission(world, trace)
    (axes,) = (each for each in sheet.figure.axes if each is not sheet.page)
    (west, east), (south, north) = axes.get_xlim(), axes.get_ylim()
    width_pt = axes.get_position().width * WIDTH_PT
    return sheet, Board(axes, Bounds(west, south, east, north), (east - west) / width_pt, sheet.palette)


@pytest.mark.parametrize("corner", [(0.0, 0.0), (200.0, 200.0), (-200.0, 200.0), (199.0, -60.0)])
def test_marks_at_the_edge_of_the_world_are_whole(corner: tuple[float, float]) -> None:
    there = np.array(corner)
    points = tuple(map(tuple, there * (1 - np.linspace(0.4, 0.0, 7))[:, None]))
    trace = mission(track=np.array(points), path_points=points, edges=(), shortest_way=None, goals=(),
                    frontiers=(MapFrontier(*corner, 0.0, 3.0, 0.5),),
                    start=Pose(*points[0]), end=Pose(*corner))  # fmt: skip
    _, board = shown_on(park(), trace)
    for x_m, y_m in points:
        assert board.shows_point(x_m, y_m, margin_m=-15.0 * board.metres_per_point)
    halt = halt_place(board, trace)
    assert board.shows_point(*halt, margin_m=-HALT_PT * board.metres_per_point)


def test_ways_on_outside_the_world_are_left_out_and_counted() -> None:
    outside = tuple(MapFrontier(205.0 + k, 0.0, 0.0, 3.0, 0.5, "blocked") for k in range(3))
    trace = mission(frontiers=(*mission().frontiers, *outside)).within(park().bounds)
    assert trace.frontiers == mission().frontiers
    assert trace.left_out == 3
    assert trace.within(park().bounds).left_out == 3
    assert "no world; 3 ways on left out" in texts_of(park(), trace)
    assert not any("left out" in text for text in texts_of(park(), mission()))


def test_numbers_leave_the_track_in_sight() -> None:
    """Where decisions lie close together every fifth has its number, and the last always."""
    points = tuple((4.0 * k, 9.0 * math.sin(k / 4)) for k in range(23))
    trace = mission(track=np.array(points), path_points=points, start=Pose(*points[0]), end=Pose(*points[-1]),
                    frontiers=(), goals=(), edges=(), shortest_way=None, facts=())  # fmt: skip
    sheet, board = shown_on(park(), trace)
    numbers = {text.get_text() for text in board.axes.findobj(Text) if text.get_text().isdigit()}
    assert numbers == {"5", "10", "15", "20", "23"}
    assert sheet is not None


def test_a_world_smaller_than_the_map_stands_in_its_middle() -> None:
    moved = moved_into(Bounds(-60.0, 0.0, 100.0, 160.0), Bounds(0.0, 0.0, 100.0, 100.0),
                       kept=Bounds(40.0, 40.0, 60.0, 60.0), rim_m=10.0)  # fmt: skip
    assert (moved.min_x_m, moved.max_x_m) == (-30.0, 130.0)
    assert (moved.min_y_m, moved.max_y_m) == (-30.0, 130.0)


@settings(deadline=None, max_examples=200)
@given(
    st.tuples(st.floats(-100.0, 90.0), st.floats(1.0, 100.0)),
    st.floats(0.0, 30.0),
    st.floats(0.0, 60.0),
)
def test_the_frame_keeps_clear_of_what_happened(kept: tuple[float, float], margin_m: float, rim_m: float) -> None:
    low, high = kept[0], min(kept[0] + kept[1], 100.0)
    shown = Bounds(low - margin_m, low - margin_m, high + margin_m, high + margin_m)
    moved = moved_into(shown, Bounds(-100.0, -100.0, 100.0, 100.0), kept=Bounds(low, low, high, high), rim_m=rim_m)
    assert moved.width_m == pytest.approx(shown.width_m)
    assert moved.min_x_m <= low - min(rim_m, margin_m) + 1e-9
    assert moved.max_x_m >= high + min(rim_m, margin_m) - 1e-9


@pytest.mark.parametrize("heading_deg", range(0, 360, 30))
def test_the_sign_of_the_halt_hides_no_piece_of_the_way(heading_deg: int) -> None:
    """The last decisions lie in every direction from the end, the sign beside them."""
    towards = np.array([math.sin(math.radians(heading_deg)), math.cos(math.radians(heading_deg))])
    points = tuple(map(tuple, towards * np.linspace(60.0, 0.0, 9)[:, None]))
    trace = mission(track=np.array(points), path_points=points, edges=(), shortest_way=None,
                    start=Pose(*points[0]), end=Pose(0.0, 0.0))  # fmt: skip
    _, board = shown_on(park(), trace)
    halt = np.array(halt_place(board, trace))
    way = np.array(points[0]) * np.linspace(0.0, 1.0, 200)[:, None]
    assert np.hypot(*(way - halt).T).min() > (HALT_PT + TRACK_PT) * board.metres_per_point
    steps = np.array(points[:-1])
    assert np.hypot(*(steps - halt).T).min() > (HALT_PT + STEP_PT) * board.metres_per_point


def test_a_goal_on_the_way_lies_under_it() -> None:
    trace = mission(goals=(MapGoal(48.0, -1.7, None, "bench", 2, True), MapGoal(60.0, 70.0, None, "bench", 2, False)))
    sheet, board = shown_on(park(), trace)
    assert [is_on_the_way(board, trace, goal) for goal in trace.goals] == [True, False]
    stars = {tuple(item.get_offsets()[0]): item.get_zorder() for item in board.axes.collections
             if isinstance(item, PathCollection) and STAR in item.get_paths()}  # fmt: skip
    assert stars[48.0, -1.7] < 7.0 < stars[60.0, 70.0]
    assert sheet is not None


def test_the_number_of_the_last_decision_can_be_read() -> None:
    trace = mission(end=Pose(*mission().path_points[-1]))
    _, board = shown_on(park(), trace)
    assert stands_on_a_step(board, trace)
    assert not stands_on_a_step(board, replace(trace, end=Pose(90.0, 40.0)))


def test_better_scores_are_lighter_and_none_is_grey() -> None:
    def lightness(colour: str) -> float:
        red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    shades = [lightness(score_colour(1.0 + 0.5 * step)) for step in range(9)]
    assert shades == sorted(shades)
    assert score_colour(-3.0) == score_colour(1.0)
    assert score_colour(99.0) == score_colour(5.0)
    assert score_colour(None) == "#b9bdc2"


def test_marks_turn_like_a_compass_and_dials_like_a_clock() -> None:
    east = turned(arc_path(0.0), math.pi / 2)
    assert np.allclose(east.vertices[0], (1.0, 0.0))
    assert np.allclose(arc_path(0.25).vertices[-1], (1.0, 0.0))
    assert np.allclose(arc_path(7.0).vertices[-1], (0.0, 1.0))
