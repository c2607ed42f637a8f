"""Charts: one drawing, printed twice. As SVG for the page, where colours follow light and dark, and as one PNG file.

A chart is made of panels. On the page each panel is a picture of its own, so that a narrow window puts them under one
another; in the file they stand on one sheet.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO, StringIO

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from reasoned_explorer.evaluation.report.looks import HUES, INKS
from reasoned_explorer.world.drawing_style import printable, shortened
from reasoned_explorer.world.sheet import plain_settings

_INK, _SOFT, _RULE, _PAPER = (INKS[name][0] for name in ("ink", "soft", "rule", "paper"))
_PNG_DPI = 200


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One panel: its title, which may be any text, and who draws it into axes."""

    title: str
    draw: Callable[[Axes], None]


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """One figure.

    Attributes:
        key: Of its anchor and its file.
        caption: What it shows and how to read it.
        alt: What is seen, for those who do not see it.
        panels: At least one.
        size_in: Width and height of a panel, inches.
        columns: Panels side by side in the file.
    """

    key: str
    caption: str
    alt: str
    panels: tuple[Panel, ...]
    size_in: tuple[float, float] = (2.5, 2.0)
    columns: int = 4


def svg_panels(chart: Chart) -> tuple[str, ...]:
    """Return an ``<svg>`` element for each panel; the same chart always gives the same text.

    Colours of the palette become variables of the style sheet, text stays text, and ids are the chart's own.
    """
    printed = []
    with plain_settings():
        for place, panel in enumerate(chart.panels):
            figure = _figure(chart.size_in)
            _draw(figure.add_subplot(), panel)
            picture = StringIO()
            figure.savefig(picture, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
            printed.append(_inline(picture.getvalue(), f"{chart.key}-{place}-"))
    return tuple(printed)


def png_bytes(chart: Chart) -> bytes:
    """Return the whole chart as a PNG on light ground; the same chart always gives the same bytes."""
    columns = min(chart.columns, len(chart.panels))
    rows = math.ceil(len(chart.panels) / columns)
    with plain_settings():
        figure = _figure((chart.size_in[0] * columns, chart.size_in[1] * rows))
        for place, panel in enumerate(chart.panels):
            _draw(figure.add_subplot(rows, columns, place + 1), panel)
        picture = BytesIO()
        figure.savefig(picture, format="png", dpi=_PNG_DPI, facecolor=_PAPER, metadata={"Software": None})
    return picture.getvalue()


def _figure(size_in: tuple[float, float]) -> Figure:
    # Letters stay letters: the page sets them in its own face.
    mpl.rcParams.update({"svg.fonttype": "none", "font.size": 8.0, "font.family": "DejaVu Sans"})
    figure = Figure(figsize=size_in, layout="constrained", facecolor="none")
    FigureCanvasAgg(figure)
    return figure


def _draw(axes: Axes, panel: Panel) -> None:
    axes.set_facecolor("none")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(_SOFT)
        axes.spines[side].set_linewidth(0.6)
    axes.tick_params(colors=_SOFT, labelcolor=_INK, width=0.6, length=2.5, labelsize=7.5)
    axes.grid(visible=True, axis="y", color=_RULE, linewidth=0.5)
    axes.set_axisbelow(True)
    panel.draw(axes)
    if panel.title:
        axes.set_title(
            shortened(printable(panel.title), 34), loc="left", fontsize=8.5, fontweight="bold", color=_INK, pad=5.0
        )
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set_color(_SOFT)
        label.set_fontsize(7.5)


_VARIABLES = {light: f"var(--{name})" for name, (light, _) in {**HUES, **INKS}.items()}
_COLOUR = re.compile("|".join(_VARIABLES))
_ID = re.compile(r'( id="|url\(#|xlink:href="#)')


def _inline(svg: str, prefix: str) -> str:
    """Return the element alone: no prolog, no metadata, no fixed size; ids with a prefix."""
    svg = svg[svg.index("<svg") :]
    for element in ("metadata", "style"):  # a style sheet in here would be one of the whole page
        svg = re.sub(rf"<{element}\b.*?</{element}>\s*", "", svg, flags=re.DOTALL)
    head, body = svg.split(">", 1)
    head = re.sub(r' (width|height|version)="[^"]*"', "", head)
    svg = _ID.sub(lambda match: match.group(1) + prefix, f'{head} aria-hidden="true" focusable="false">{body}')
    return _outside_text(svg)


def _outside_text(svg: str) -> str:
    """Put variables for colours into tags only: what people wrote between them stays as it is."""
    return re.sub(
        r"<[^>]*>", lambda tag: _COLOUR.sub(_variable, tag.group(0)).replace("'DejaVu Sans'", "var(--sans)"), svg
    )


def _variable(match: re.Match[str]) -> str:
    return _VARIABLES[match.group(0)]
