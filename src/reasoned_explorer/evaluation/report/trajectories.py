"""Two methods on the same mission, side by side on the same map (the paper's Fig. 5)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO

from PIL import Image

from reasoned_explorer.evaluation.mission_map import LEAST_EXTENT_M, MissionTrace, happened_in
from reasoned_explorer.evaluation.mission_marks import draw_halt, paint_mission, verdict
from reasoned_explorer.evaluation.mission_panel import MARGIN_PT, legend_entries
from reasoned_explorer.evaluation.record_map import trace_of
from reasoned_explorer.evaluation.report.about import TraceSource
from reasoned_explorer.evaluation.report.study import Entry, Study
from reasoned_explorer.evaluation.wording import amount, share
from reasoned_explorer.world.drawing import fitted_bounds
from reasoned_explorer.world.drawing_style import Palette, wrapped
from reasoned_explorer.world.lettering import Room, letter_streets, place_badges
from reasoned_explorer.world.painting import Board, paint_world
from reasoned_explorer.world.sheet import WIDTH_IN, WIDTH_PT, Sheet, draw_scale_bar, plain_settings
from reasoned_explorer.world.world import Bounds, World

_GAP_PT = 16.0
_LEGEND_COLUMNS = 6
_MUTED = 0.34
_WIDTH_PX = 2000
#: On the page: sharp on a screen, and a tenth of the bytes.
_PAGE_WIDTH_PX = 1600
_PAGE_QUALITY = 80
#: Records are looked for in so many missions a level, those first in which the two methods differ most.
_MOST_TRIES = 25


@dataclass(frozen=True, slots=True)
class Picture:
    """Two trajectories.

    Attributes:
        key: Of its anchor and its file.
        caption: What it shows.
        alt: What is seen.
        entries: The two missions, left and right.
        png: For the file.
        webp: For the page.
    """

    key: str
    caption: str
    alt: str
    entries: tuple[Entry, Entry]
    png: bytes
    webp: bytes


def pair_of(study: Study) -> tuple[str, str] | None:
    """Return the two methods that are shown, left and right; None where the run has not two of one vehicle.

    Those that the report asks for; else llm-as-eval and llm-rrt, as the paper; else the first two.
    """
    for vehicle in dict.fromkeys(study.vehicle[method] for method in study.methods):
        names = {study.stored[name]: name for name in study.methods if study.vehicle[name] == vehicle}
        wanted = study.about.side_by_side or ("llm-as-eval", "llm-rrt")
        if all(name in names for name in wanted):
            return names[wanted[0]], names[wanted[1]]
        if len(names) >= 2 and study.about.side_by_side is None:
            first, second, *_ = names.values()
            return first, second
    return None


def ranked_missions(study: Study, pair: tuple[str, str], level: int) -> list[tuple[Entry, Entry]]:
    """Return the missions of a level that both methods have, those first in which the two differ most.

    By CASR of the mission, then by SPL, then by how near they ended; of equals the first by id.
    """
    left, right = ({entry.row.mission_id: entry for entry in study.of(name, level=level)} for name in pair)
    both = [(left[key], right[key]) for key in sorted(left.keys() & right.keys())]
    return sorted(both, key=lambda pair: tuple(-gap for gap in _gaps(*pair)))


def _gaps(first: Entry, second: Entry) -> tuple[float, float, float]:
    a, b = first.score, second.score
    # A goal that cannot be reached is as far for both.
    away = (0.0, 0.0) if a.distance_to_goal_m == b.distance_to_goal_m else (a.distance_to_goal_m, b.distance_to_goal_m)
    return abs(a.casr - b.casr), abs(a.spl - b.spl), abs(away[0] - away[1])


def pictures(study: Study, traces: TraceSource) -> Iterator[Picture]:
    """Yield a picture for each level that has a mission with the records of both methods."""
    pair = pair_of(study)
    if pair is None:
        return
    for level in study.levels:
        for entries in ranked_missions(study, pair, level)[:_MOST_TRIES]:
            first, second = (traces.record(entry.row) for entry in entries)
            world = traces.world(entries[0].row) if first and second else None
            if first is None or second is None or world is None:
                continue
            png, webp = _printed(world, (trace_of(first, world), trace_of(second, world)), entries)
            told = [f"{entry.method}: {_outcome(entry)}" for entry in entries]
            yield Picture(
                key=f"trajectories-level-{level}",
                caption=f"Level {level}: “{entries[0].row.goal}”. Left {told[0]}; right {told[1]}. Of the missions of "
                "this level, the one in which the two differ most.",
                alt=f"Two maps of the same place with the ways of both methods. Left, {told[0]}. Right, {told[1]}.",
                entries=entries,
                png=png,
                webp=webp,
            )
            break


def _outcome(entry: Entry) -> str:
    score = entry.score
    return (
        f"{entry.cause.value}, {amount(score.path_length_m)} m travelled, CT {amount(score.computing_s)} s, "
        f"TT {amount(score.travelling_s)} s, {entry.row.steps} steps, CASR {share(score.casr)}"
    )


def _printed(
    world: World, pair: tuple[MissionTrace, MissionTrace], entries: tuple[Entry, Entry]
) -> tuple[bytes, bytes]:
    with plain_settings():
        sheet = _compose(world, pair, entries)
        picture = BytesIO()
        sheet.figure.savefig(
            picture, format="png", dpi=_WIDTH_PX / WIDTH_IN, metadata={"Software": None}, facecolor=sheet.palette.paper
        )
    with Image.open(BytesIO(picture.getvalue())) as whole:
        size = (_PAGE_WIDTH_PX, round(_PAGE_WIDTH_PX * whole.height / whole.width))
        small = BytesIO()
        whole.convert("RGB").resize(size, Image.Resampling.LANCZOS).save(small, "WEBP", quality=_PAGE_QUALITY, method=6)
    return picture.getvalue(), small.getvalue()


def _compose(world: World, pair: tuple[MissionTrace, MissionTrace], entries: tuple[Entry, Entry]) -> Sheet:
    """Return the sheet: the goal sentence, two maps with the same bounds, one legend."""
    wide = (WIDTH_PT - 2 * MARGIN_PT - _GAP_PT) / 2
    shown = _hull(happened_in(pair[0]), happened_in(pair[1]))
    shown = fitted_bounds(shown, shapes=(0.7, 1.1), least_m=LEAST_EXTENT_M)
    high = wide * shown.height_m / shown.width_m
    headline = wrapped(f"“{pair[0].title}”", "serif-bold", 19.0, WIDTH_PT - 2 * MARGIN_PT, 2)
    thanks = wrapped(world.attribution, "sans-bold", 8.0, WIDTH_PT - 2 * MARGIN_PT, 2)
    palette = Palette()
    legend = _legend(Sheet(100.0, palette), pair)
    rows = -(-len(legend) // _LEGEND_COLUMNS)
    foot = 20.0 + 15.0 * rows + 12.0 * len(thanks)
    head = 14.0 + 23.0 * len(headline) + 40.0
    sheet = Sheet(foot + high + head, palette)
    for place, line in enumerate(headline):
        sheet.write(MARGIN_PT, sheet.height_pt - 34.0 - 23.0 * place, line, size_pt=19.0, face="serif-bold")
    for place, (trace, entry) in enumerate(zip(pair, entries, strict=True)):
        left = MARGIN_PT + place * (wide + _GAP_PT)
        _write_title(sheet, trace, entry, (left, foot + high + 7.0), wide)
        _draw_map(sheet, world, trace, shown, (left, foot, wide, high))
    draw_scale_bar(sheet, WIDTH_PT - MARGIN_PT - 108.0, foot - 14.0, shown.width_m / wide, room_pt=100.0)
    column = (WIDTH_PT - 2 * MARGIN_PT - 120.0) / _LEGEND_COLUMNS
    for place, (text, draw) in enumerate(_legend(sheet, pair)):
        x, y = MARGIN_PT + column * (place % _LEGEND_COLUMNS), foot - 17.0 - 15.0 * (place // _LEGEND_COLUMNS)
        draw(x + 12.0, y + 3.0)
        sheet.write(x + 27.0, y, text, size_pt=7.6, room_pt=column - 31.0)
    for place, line in enumerate(thanks):
        y = 9.0 + 12.0 * (len(thanks) - 1 - place)
        sheet.write(MARGIN_PT, y, line, size_pt=8.0, face="sans-bold", colour=palette.soft_ink)
    return sheet


def _write_title(sheet: Sheet, trace: MissionTrace, entry: Entry, corner: tuple[float, float], wide: float) -> None:
    """Write over a map whose it is and what came of it."""
    x, y = corner
    draw_halt(sheet.page, (x + 10.0, y + 11.0), trace)
    named = sheet.write(x + 26.0, y + 12.5, entry.method, size_pt=11.0, face="sans-bold", room_pt=0.5 * wide)
    outcome, colour = entry.cause.value, verdict(trace)[1]
    sheet.write(x + 26.0 + named + 8.0, y + 12.5, outcome, size_pt=10.0, colour=colour, room_pt=wide - named - 36.0)
    score = entry.score
    facts = (
        f"{score.path_length_m:.0f} m travelled · CT {score.computing_s:.0f} s · TT {score.travelling_s:.0f} s · "
        f"{entry.row.steps} steps · CASR {share(score.casr)}"
    )
    sheet.write(x + 26.0, y + 1.0, facts, size_pt=8.2, colour=sheet.palette.soft_ink, room_pt=wide - 28.0)


def _draw_map(
    sheet: Sheet, world: World, trace: MissionTrace, shown: Bounds, box: tuple[float, float, float, float]
) -> None:
    axes = sheet.map_axes(*box, shown)
    board = Board(axes, shown, shown.width_m / box[2], sheet.palette.muted(_MUTED))
    paint_world(board, world)
    room = Room(board)
    near = board.metres_per_point < 0.7
    place_badges(board, world.objects, Room(board), share=0.7, alpha=0.55 if near else 0.4, dots=near)
    paint_mission(board, trace, room)
    letter_streets(board, world.ways, room, colour="#7b8088", limit=16)


def _legend(sheet: Sheet, pair: tuple[MissionTrace, MissionTrace]) -> list[tuple[str, Callable[[float, float], None]]]:
    """Return what either map has in it, once."""
    entries: dict[str, Callable[[float, float], None]] = {}
    for trace in pair:
        for text, draw in legend_entries(sheet, trace):
            entries.setdefault(text, draw)
    return list(entries.items())


def _hull(first: Bounds, second: Bounds) -> Bounds:
    return Bounds(
        min(first.min_x_m, second.min_x_m),
        min(first.min_y_m, second.min_y_m),
        max(first.max_x_m, second.max_x_m),
        max(first.max_y_m, second.max_y_m),
    )
