"""The page: sections of text, figures and tables, put into one HTML document that needs nothing else."""

import hashlib
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from reasoned_explorer.evaluation.paper import PAPER_NOTE, PAPER_SOURCE
from reasoned_explorer.evaluation.report.charts import Chart, svg_panels
from reasoned_explorer.evaluation.report.curves import Observation, limit_text
from reasoned_explorer.evaluation.report.links import link
from reasoned_explorer.evaluation.report.looks import HUES, INKS, Look
from reasoned_explorer.evaluation.report.missions import missions_json
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.tables import Table
from reasoned_explorer.evaluation.report.trajectories import Picture


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """A part of the page under a heading of its own.

    Attributes:
        key: Its anchor.
        title: Its heading.
        texts: Paragraphs.
        charts: Figures.
        tables: Tables that stand open.
        folded: Tables that a reader opens.
        pictures: Trajectories.
        observations: What the paper claims and what is seen.
    """

    key: str
    title: str
    texts: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[Table, ...] = ()
    folded: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    observations: tuple[Observation, ...] = ()


def page_html(study: Study, looks: dict[str, Look], sections: Sequence[Section], paper: Sequence[Table]) -> str:
    """Return the page. Everything that people or models wrote is escaped; the same study gives the same text."""
    style, script = _text("page.css").replace("/*colours*/", _colours()), _text("page.js")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    numbers = _numbers(sections)
    template = environment.from_string(_text("page.html"))
    return template.render(
        about=study.about,
        study=study,
        facts=_facts(study),
        methods=_methods(study),
        looks=looks,
        sections=sections,
        paper=paper,
        paper_note=PAPER_NOTE,
        paper_source=PAPER_SOURCE,
        numbers=numbers,
        panels={chart.key: [Markup(svg) for svg in svg_panels(chart)] for part in sections for chart in part.charts},  # noqa: S704
        images={
            picture.key: "data:image/webp;base64," + b64encode(picture.webp).decode()
            for part in sections
            for picture in part.pictures
        },
        link=link,
        # Written by `_text` and `script_json`; neither can close its element.
        style=Markup(style),  # noqa: S704
        script=Markup(script),  # noqa: S704
        missions=Markup(missions_json(study)),  # noqa: S704
        style_hash=_csp_hash(style),
        script_hash=_csp_hash(script),
    )


@cache
def _text(name: str) -> str:
    return (files("reasoned_explorer.evaluation.report") / name).read_text(encoding="utf-8")


def _csp_hash(text: str) -> str:
    return "sha256-" + b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _colours() -> str:
    """The style sheet's variables for light and dark; the same colours as in the figures."""
    light, dark = ("".join(f"--{name}:{pair[side]};" for name, pair in {**HUES, **INKS}.items()) for side in (0, 1))
    return f":root{{{light}}}\n@media (prefers-color-scheme: dark){{:root{{{dark}}}}}"


def _numbers(sections: Sequence[Section]) -> dict[str, int]:
    """Number figures and tables in the order in which they stand."""
    numbers: dict[str, int] = {}
    charts = [
        key
        for section in sections
        for key in (*(chart.key for chart in section.charts), *(picture.key for picture in section.pictures))
    ]
    tables = [table.key for section in sections for table in (*section.tables, *section.folded)]
    numbers.update({f"figure-{key}": place for place, key in enumerate(charts, start=1)})
    numbers.update({f"table-{key}": place for place, key in enumerate(tables, start=1)})
    return numbers


def _facts(study: Study) -> list[tuple[str, str]]:
    """Return what the run is, in short."""
    rows = [entry.row for entry in study.entries]

    def said(values: Sequence[str], most: int = 4) -> str:
        listed = sorted({value for value in values if value})
        return ", ".join(listed[:most]) + (f" and {len(listed) - most} more" if len(listed) > most else "")

    per_method = sorted({len(study.of(method)) for method in study.methods})
    spread = f"{per_method[0]:,}" if len(per_method) == 1 else f"{per_method[0]:,} to {per_method[-1]:,}"
    return [
        ("missions", f"{len(rows):,}"),
        ("methods", f"{len(study.methods)}, {spread} missions each"),
        ("levels", ", ".join(str(level) for level in study.levels)),
        ("places", f"{len(study.places):,}: {said(study.cities) or 'no city'}"),
        ("T_max", limit_text(study)),
        ("vehicle", said([row.score.vehicle for row in rows])),
        ("captions", said([row.captioner for row in rows])),
        ("CT", said([row.ct_label for row in rows])),
        *study.about.ceilings,
    ]


def _methods(study: Study) -> list[tuple[str, str, str]]:
    """Return for each method what its planner and its minds are called."""
    found = []
    for method in study.methods:
        rows = [entry.row for entry in study.of(method)]
        # The minds behind a planner's name stand in a column of their own.
        planners = sorted({row.planner.partition(" [")[0] for row in rows})
        found.append((method, ", ".join(planners), ", ".join(sorted({row.minds for row in rows}))))
    return found
