"""Charts: one look for a method everywhere, text as it was written, the same bytes twice."""

import re
import xml.etree.ElementTree as ET

import pytest

from reasoned_explorer.evaluation.report.charts import Chart, Panel, png_bytes, svg_panels
from reasoned_explorer.evaluation.report.contents import sections_of
from reasoned_explorer.evaluation.report.looks import HUES, INKS, looks_of
from reasoned_explorer.evaluation.report.study import Study
from tests.evaluation.report.rows import ABOUT, METHODS, many_rows

EVERY_METHOD = (
    "llm-rrt", "llm-rrt-authors", "llm-mcts", "llm-as-eval", "nearest-frontier", "follow-paths", "object-density",
    "random", "oracle", "foresight-30m", "foresight-60m", "llm-rrt+perfect-halt", "llm-as-eval+perfect-halt",
    "llm-rrt-echo", "llm-rrt-shuffled", "llm-as-eval-matched", "ours-1", "ours-2",
)  # fmt: skip
BOUNDS = ("oracle", "foresight-30m", "foresight-60m", "llm-rrt+perfect-halt", "llm-as-eval+perfect-halt")


def _charts() -> list[Chart]:
    study = Study(many_rows(12), ABOUT)
    return [
        chart for section in sections_of(study, looks_of(study.methods, study.bounds), None) for chart in section.charts
    ]


def test_no_two_methods_look_the_same() -> None:
    looks = looks_of(EVERY_METHOD, BOUNDS)
    assert len({(look.name, look.marker, look.fill) for look in looks.values()}) == len(EVERY_METHOD)
    assert looks["llm-rrt+perfect-halt"].name == looks["llm-rrt-echo"].name == looks["llm-rrt"].name
    assert {looks[name].name for name in ("oracle", "foresight-30m", "foresight-60m")} == {"ink"}


def test_a_known_method_looks_the_same_whoever_stands_beside_it() -> None:
    alone, among = looks_of(("llm-as-eval",), ()), looks_of(EVERY_METHOD, BOUNDS)
    assert alone["llm-as-eval"] == among["llm-as-eval"]


def test_colours_stand_out_from_the_ground() -> None:
    def light(colour: str) -> float:
        channels = [int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    def contrast(first: str, second: str) -> float:
        high, low = sorted((light(first), light(second)), reverse=True)
        return (high + 0.05) / (low + 0.05)

    for side in (0, 1):
        paper = INKS["paper"][side]
        # WCAG 2.2: 3 for graphics, 4.5 for text.
        assert all(contrast(pair[side], paper) >= 3.0 for pair in HUES.values())
        assert contrast(INKS["ink"][side], paper) >= 7.0
        assert contrast(INKS["soft"][side], paper) >= 4.5


def test_every_chart_says_what_is_seen() -> None:
    charts = _charts()
    assert [chart.key for chart in charts] == [
        "differences", "sr-osr", "casr-over-tmax", "ct-casr", "success-over-radius", "causes", "collisions",
    ]  # fmt: skip
    for chart in charts:
        assert any(method in chart.alt for method in METHODS)
        assert re.search(r"\d", chart.alt), "the alt text gives figures"


def test_panels_are_well_formed_and_have_ids_of_their_own() -> None:
    ids: list[str] = []
    for chart in _charts():
        for svg in svg_panels(chart):
            root = ET.fromstring(svg)  # noqa: S314
            mine = [element.get("id", "") for element in root.iter() if element.get("id")]
            used = set(re.findall(r"url\(#([^)]+)\)", svg)) | set(re.findall(r'href="#([^"]+)"', svg))
            assert used <= set(mine)
            assert not re.search(r"<(script|style|metadata|image)\b", svg)
            ids += mine
    assert len(set(ids)) == len(ids)


def test_what_people_write_is_never_markup_nor_colour() -> None:
    evil = "<script>alert(1)</script> #0072b2 $x_1$ &amp;"
    (svg,) = svg_panels(Chart("evil", "", "", (Panel(evil[:34], lambda axes: axes.plot([0, 1], color="#0072b2")),)))
    assert "<script" not in svg
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in svg
    assert "stroke: var(--blue)" in svg
    assert "#0072b2" in svg, "only colours become variables, text stays"


@pytest.mark.parametrize("key", ["sr-osr", "causes"])
def test_the_same_chart_gives_the_same_bytes(key: str) -> None:
    first, second = (next(chart for chart in _charts() if chart.key == key) for _ in range(2))
    assert svg_panels(first) == svg_panels(second)
    assert png_bytes(first) == png_bytes(second)
    assert png_bytes(first).startswith(b"\x89PNG")
    assert b"Software" not in png_bytes(first)
