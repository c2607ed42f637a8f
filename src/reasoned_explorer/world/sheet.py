"""The sheet of paper that a map picture is printed on: its frame, its lettering and how it gets into a file.

The layout is made in points on a sheet 12 inches wide and does not depend on how many pixels the picture has.
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

from reasoned_explorer.model.checks import is_there, is_within
from reasoned_explorer.model.disk import disk_error
from reasoned_explorer.model.errors import Fault, InputError
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.drawing_style import Palette, font, printable, set_in, width_pt
from reasoned_explorer.world.symbols import Symbol, compound_path
from reasoned_explorer.world.world import Bounds

FloatArray = NDArray[np.float64]

WIDTH_IN = 12.0
WIDTH_PT = WIDTH_IN * 72.0
SUFFIXES = (".png", ".svg", ".pdf")
#: Pictures narrower than this cannot be read, wider ones do not fit into memory.
WIDTH_RANGE_PX = (300, 12000)
#: For each format what matplotlib would write by itself and must not, and where the attribution goes.
_METADATA = {".png": ("Software", "Copyright"), ".svg": ("Date", "Rights"), ".pdf": ("CreationDate", "Subject")}


@contextmanager
def plain_settings() -> Iterator[None]:
    """Draw with matplotlib's own defaults whatever a person's settings file says, and put everything back after."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(
            {
                "text.parse_math": False,
                "text.hinting": "none",  # letters are as wide at every size
                "svg.hashsalt": "reasoned-explorer",
                "path.simplify": False,
            }
        )
        yield


class Sheet:
    """A sheet with an overlay whose unit is the point, its origin at the lower left.

    Args:
        height_pt: Height; the width is always `WIDTH_PT`.
        palette: Colours.
    """

    def __init__(self, height_pt: float, palette: Palette) -> None:
        self.height_pt = height_pt
        self.palette = palette
        self.figure = Figure(figsize=(WIDTH_IN, height_pt / 72.0), facecolor=palette.paper)
        FigureCanvasAgg(self.figure)
        self.page = self.figure.add_axes((0.0, 0.0, 1.0, 1.0), zorder=10)
        self.page.set_xlim(0.0, WIDTH_PT)
        self.page.set_ylim(0.0, height_pt)
        self.page.set_axis_off()

    def map_axes(self, left_pt: float, bottom_pt: float, width: float, height: float, bounds: Bounds) -> Axes:
        """Return axes for a map in a box of the sheet; the box must have the shape of the bounds."""
        axes = self.figure.add_axes(
            (left_pt / WIDTH_PT, bottom_pt / self.height_pt, width / WIDTH_PT, height / self.height_pt)
        )
        axes.set_xlim(bounds.min_x_m, bounds.max_x_m)
        axes.set_ylim(bounds.min_y_m, bounds.max_y_m)
        axes.set_facecolor(self.palette.paper)
        axes.set_xticks([])
        axes.set_yticks([])
        for spine in axes.spines.values():
            spine.set_linewidth(0.8)
            spine.set_edgecolor(self.palette.soft_ink)
            spine.set_zorder(50)
        return axes

    def write(
        self,
        x_pt: float,
        y_pt: float,
        text: str,
        *,
        size_pt: float,
        face: str = "sans",
        colour: str | None = None,
        align: str = "left",
        room_pt: float | None = None,
    ) -> float:
        """Write a line on the sheet and return its width in points.

        Args:
            x_pt: Where it is aligned to.
            y_pt: Its baseline.
            text: Any text; it is made printable.
            size_pt: Size of the letters.
            face: As for `font`.
            colour: The palette's ink if None.
            align: ``left``, ``center`` or ``right``.
            room_pt: If the line is wider than this its letters are made smaller, by a third at most, and then cut.
        """
        text = printable(text)
        if room_pt is not None:
            wide = width_pt(text, face, size_pt)
            if wide > room_pt:
                size_pt *= max(room_pt / wide, 0.67)
            while text and width_pt(text, face, size_pt) > room_pt:
                text = text[:-2].rstrip() + "\u2026" if len(text) > 2 else ""
        put_text(
            self.page, x_pt, y_pt, text, size_pt=size_pt, face=face, colour=colour or self.palette.ink, align=align
        )
        return width_pt(text, face, size_pt)

    def rule(
        self, left_pt: float, right_pt: float, y_pt: float, *, colour: str | None = None, width: float = 0.6
    ) -> None:
        """Draw a thin line across."""
        self.page.plot([left_pt, right_pt], [y_pt, y_pt], color=colour or self.palette.rule, lw=width)

    def badge(self, x_pt: float, y_pt: float, symbol: Symbol, radius_pt: float) -> None:
        """Put a symbol on the sheet."""
        draw_badges(self.page, np.array([[x_pt, y_pt]]), symbol, radius_pt, zorder=3.0)


def put_text(
    axes: Axes,
    x: float,
    y: float,
    text: str,
    *,
    size_pt: float,
    face: str,
    colour: str,
    align: str = "left",
    valign: str = "baseline",
    halo: str | None = None,
    halo_pt: float = 1.6,
    zorder: float = 8.0,
) -> Text:
    """Write into axes; the text is taken literally, whatever is in it."""
    face, text = set_in(face, text)
    written = axes.text(
        x,
        y,
        text,
        fontproperties=font(face),
        fontsize=size_pt,
        color=colour,
        ha=align,
        va=valign,
        parse_math=False,
        zorder=zorder,
        clip_on=True,
    )
    if halo is not None:
        written.set_path_effects([withStroke(linewidth=2 * halo_pt, foreground=halo)])
    return written


_DISC = compound_path(
    [np.column_stack([np.cos(a), np.sin(a)]) for a in [np.linspace(0, 2 * np.pi, 40, endpoint=False)]]
)


def draw_badges(
    axes: Axes, places: FloatArray, symbol: Symbol, radius_pt: float, *, zorder: float, alpha: float = 1.0
) -> None:
    """Draw a class's symbol at places, shape (n, 2), of the axes: a disc in its colour with its pictogram in white."""
    layers = [(_DISC, radius_pt, symbol.colour, "#ffffff", 0.12 * radius_pt)]
    if radius_pt >= 1.7:
        layers.append((symbol.glyph, radius_pt * 0.62, "#ffffff", "none", 0.0))
    for layer, (path, scale, colour, edge, width) in enumerate(layers):
        axes.add_collection(
            PathCollection(
                [path],
                sizes=[scale * scale],
                offsets=places,
                offset_transform=axes.transData,
                transform=IdentityTransform(),  # sizes are points, whatever the axes' scale
                facecolors=colour,
                edgecolors=edge,
                linewidths=width,
                alpha=alpha,
                zorder=zorder + 0.001 * layer,
            ),
            autolim=False,
        )


def scale_bar_width_pt(metres_per_point: float, *, room_pt: float = 150.0) -> float:
    """Return how wide a scale bar of a round length is that fits into ``room_pt`` points."""
    return _round_length_m(room_pt * metres_per_point) / metres_per_point


def draw_scale_bar(sheet: Sheet, x_pt: float, y_pt: float, metres_per_point: float, *, room_pt: float = 150.0) -> None:
    """Draw a scale bar of a round length with four fields; its lower left corner is at a point of the sheet."""
    length_m = _round_length_m(room_pt * metres_per_point)
    step = length_m / metres_per_point / 4.0
    palette = sheet.palette
    for field in range(4):
        sheet.page.add_patch(
            Rectangle(
                (x_pt + field * step, y_pt),
                step,
                3.6,
                facecolor=palette.ink if field % 2 == 0 else palette.paper,
                edgecolor=palette.ink,
                linewidth=0.6,
            )
        )
    for share, text in ((0.0, "0"), (2.0, _length_text(length_m / 2)), (4.0, _length_text(length_m, unit=True))):
        sheet.write(x_pt + share * step, y_pt + 7.0, text, size_pt=7.5, colour=palette.soft_ink, align="center")


def _round_length_m(longest_m: float) -> float:
    power = 10.0 ** np.floor(np.log10(longest_m))
    return float(power * max(factor for factor in (1.0, 2.0, 4.0, 5.0) if factor * power <= longest_m * (1 + 1e-9)))


def _length_text(length_m: float, *, unit: bool = False) -> str:
    if length_m >= 2000.0:
        return f"{length_m / 1000.0:g}" + (" km" if unit else "\u2009km")
    return f"{length_m:g}" + (" m" if unit else "")


def draw_north_arrow(sheet: Sheet, x_pt: float, y_pt: float, *, size_pt: float = 26.0) -> None:
    """Draw a north arrow whose middle is at a point of the sheet; the map's top is north."""
    half, palette = size_pt / 2.0, sheet.palette
    for side, colour in ((-1.0, palette.ink), (1.0, palette.paper)):
        sheet.page.add_collection(
            PolyCollection(
                [
                    [
                        (x_pt, y_pt + half),
                        (x_pt + side * half * 0.5, y_pt - half * 0.8),
                        (x_pt, y_pt - half * 0.4),
                    ]
                ],
                facecolors=colour,
                edgecolors=palette.ink,
                linewidths=0.6,
            ),
            autolim=False,
        )
    sheet.write(x_pt, y_pt + half + 3.0, "N", size_pt=9.0, face="sans-bold", align="center")


def card(sheet: Sheet, left_pt: float, bottom_pt: float, width: float, height: float, *, alpha: float = 0.86) -> None:
    """Lay a light card with round corners under what is printed onto the map."""
    sheet.page.add_patch(
        FancyBboxPatch(
            (left_pt + 3.0, bottom_pt + 3.0),
            width - 6.0,
            height - 6.0,
            boxstyle="round,pad=3,rounding_size=4",
            facecolor=sheet.palette.paper,
            edgecolor="none",
            alpha=alpha,
            zorder=0.5,
        )
    )


def check_target(path: Path, width_px: int) -> list[Fault]:
    """Return what is wrong with where a picture is to go and how wide it is to be."""
    faults: list[Fault] = []
    if path.suffix.lower() not in SUFFIXES:
        faults.append(Fault(f"picture file {str(path)!r}", f"a name that ends in {', '.join(SUFFIXES)}"))
    if not is_there(path.parent) or not path.parent.is_dir():
        faults.append(Fault(f"folder {str(path.parent)!r} is not there", "an existing folder", "create it first"))
    if is_there(path) and path.is_dir():
        faults.append(Fault(f"{str(path)!r} is a folder", "the name of a file"))
    low, high = WIDTH_RANGE_PX
    if not is_within(width_px, low, high):
        faults.append(Fault(f"picture width {width_px!r}", f"{low} to {high} pixels"))
    return faults


def save(sheet: Sheet, path: Path, *, width_px: int, title: str, thanks: str, error: type[InputError]) -> None:
    """Write the sheet into a file, whole or not at all; the same sheet always gives the same bytes.

    Args:
        sheet: What to write.
        path: PNG, SVG or PDF by its suffix.
        width_px: Width of a PNG.
        title: Kept in the file.
        thanks: Attribution, kept in the file.
        error: Raised, with the reason, when the file cannot be written there.

    Raises:
        PartError: If the disk fails, e.g. because it is full.
    """
    suffix = path.suffix.lower()
    title, thanks = printable(title), printable(thanks)
    undated, thanks_key = _METADATA[suffix]
    metadata: dict[str, str | None] = {undated: None}
    metadata.update({key: text for key, text in (("Title", title), (thanks_key, thanks)) if text})
    picture = BytesIO()
    stop_if_asked()
    sheet.figure.savefig(
        picture, format=suffix[1:], dpi=width_px / WIDTH_IN, metadata=metadata, facecolor=sheet.palette.paper
    )
    stop_if_asked()
    handle, unfinished = -1, ""
    try:
        handle, unfinished = tempfile.mkstemp(prefix=f".{path.name[:40]}.", suffix=".part", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(picture.getbuffer())
        Path(unfinished).chmod(0o644)
        Path(unfinished).replace(path)
    except OSError as reason:
        if unfinished:
            with suppress(OSError):
                Path(unfinished).unlink(missing_ok=True)
        raise disk_error("map picture", path, reason, kind=error) from reason


def swatch(sheet: Sheet, x_pt: float, y_pt: float, colour: str, *, hatch: str | None = None) -> None:
    """Draw a legend field 15 by 9 points; ``hatch`` is the colour of slanting lines in it."""
    box = Rectangle((x_pt, y_pt), 15.0, 9.0, facecolor=colour, edgecolor=sheet.palette.soft_ink, linewidth=0.4)
    sheet.page.add_patch(box)
    if hatch is not None:
        strokes = [((x_pt + 15.0 * k / 6, y_pt), (x_pt + 15.0 * k / 6 + 9.0, y_pt + 9.0)) for k in range(-3, 6)]
        for (x0, y0), (x1, y1) in strokes:
            line = sheet.page.plot([x0, x1], [y0, y1], color=hatch, lw=0.6)[0]
            line.set_clip_path(box)
