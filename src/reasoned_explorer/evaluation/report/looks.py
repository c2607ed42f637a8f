"""Colours and marks: the same for a method in every figure, told apart without seeing hue, on light ground and dark.

Eight hues after Okabe & Ito (2008) and Tol (2021), each with a marker of its own. Methods made from a planner, such as
``llm-rrt+perfect-halt`` or ``llm-rrt-echo``, keep its hue and have a hollow or half-filled marker and a broken line.
Bounds are drawn in ink.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from reasoned_explorer.evaluation.report.causes import Cause

#: Name of a hue: on light ground, on dark ground.
HUES: dict[str, tuple[str, str]] = {
    "blue": ("#0072b2", "#5aaee6"),
    "vermillion": ("#d55e00", "#f08a4b"),
    "green": ("#00855f", "#3cc49a"),
    "amber": ("#b57a00", "#efb73e"),
    "purple": ("#b5578d", "#de8fbd"),
    "sky": ("#2c8dc4", "#8ccdf2"),
    "wine": ("#882255", "#d0709c"),
    "olive": ("#7a7a2b", "#b8b85c"),
}
#: Inks of the figures, likewise.
INKS: dict[str, tuple[str, str]] = {
    "ink": ("#22272e", "#e9e6df"),
    "soft": ("#646b74", "#a3a9b1"),
    "rule": ("#d8d4ca", "#3b4049"),
    "ghost": ("#c9c6be", "#4a4f58"),
    "paper": ("#fdfcf9", "#16191e"),
}

_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "p")
_KNOWN = {
    "llm-rrt": "blue",
    "llm-as-eval": "vermillion",
    "llm-mcts": "green",
    "nearest-frontier": "amber",
    "follow-paths": "purple",
    "llm-rrt-authors": "sky",
    "object-density": "wine",
    "random": "olive",
}
_DASHES: tuple[str | tuple[int, tuple[float, ...]], ...] = (
    "-",
    (0, (5.0, 1.6)),
    (0, (1.6, 1.4)),
    (0, (5, 1.5, 1.5, 1.5)),
)

Fill = Literal["full", "none", "left", "bottom", "right", "top"]
_FILLS: tuple[Fill, ...] = ("full", "none", "left", "bottom", "right", "top")


@dataclass(frozen=True, slots=True)
class Look:
    """How a method is drawn.

    Attributes:
        colour: ``"#rrggbb"`` on light ground.
        name: Of the colour, for the style sheet.
        marker: Of matplotlib.
        fill: How the marker is filled, a fill style of matplotlib; ``"full"`` for the first method of a hue.
        dashes: A line style of matplotlib.
    """

    colour: str
    name: str
    marker: str
    fill: Fill
    dashes: str | tuple[int, tuple[float, ...]]


def looks_of(methods: Sequence[str], bounds: Collection[str]) -> dict[str, Look]:
    """Return a look for each method; a known name always has the same."""
    families = {method: _family(method.split(" · ", 1)[0]) for method in methods}
    free = [hue for hue in HUES if hue not in {_KNOWN.get(family) for family in families.values()}] or list(HUES)
    strangers = [
        family
        for family in dict.fromkeys(families.values())
        if family not in _KNOWN and any(families[name] == family and name not in bounds for name in methods)
    ]
    hues = dict(_KNOWN) | {family: free[place % len(free)] for place, family in enumerate(strangers)}
    used: dict[str, int] = {}
    looks = {}
    for method in sorted(methods, key=lambda name: (families[name] != name, methods.index(name))):
        hue = hues.get(families[method], "ink")
        variant = used.get(hue, 0)
        used[hue] = variant + 1
        colour, marker = (INKS["ink"][0], "*") if hue == "ink" else (HUES[hue][0], _MARKERS[list(HUES).index(hue)])
        looks[method] = Look(colour, hue, marker, _FILLS[variant % len(_FILLS)], _DASHES[variant % len(_DASHES)])
    return looks


def _family(method: str) -> str:
    """Return the planner that a method is made from, by its name."""
    base = method.split("+", 1)[0]
    if base in _KNOWN:
        return base
    parents = [name for name in _KNOWN if base.startswith((f"{name}-", f"{name}/"))]
    return max(parents, key=len, default=base)


@dataclass(frozen=True, slots=True)
class CauseLook:
    """How a cause is drawn: its colour, that of letters on it, and a hatch of matplotlib."""

    colour: str
    letters: str
    hatch: str = ""


# Letters on colours that are the same on light ground and on dark: not the ink, which turns pale on dark ground.
_DARK = "#1f242b"
#: False halts are brown, time over is purple (ColorBrewer's PuOr, safe for the colour-blind); having been there is pale
#: and hatched.
CAUSE_LOOKS: dict[Cause, CauseLook] = {
    Cause.FOUND: CauseLook("#00785a", "#ffffff"),
    Cause.FALSE_HALT_BEEN: CauseLook("#f1a340", _DARK, "////"),
    Cause.FALSE_HALT_NEVER: CauseLook("#b35806", "#ffffff"),
    Cause.SHUNNED_GROUND: CauseLook("#e7d4a0", _DARK, "...."),
    Cause.TIME_OVER_BEEN: CauseLook("#b2abd2", _DARK, "////"),
    Cause.TIME_OVER_NEVER: CauseLook("#542788", "#ffffff"),
    Cause.BUDGET: CauseLook("#5b6068", "#ffffff"),
    Cause.NOTHING_LEFT: CauseLook("#9aa0a6", _DARK, "\\\\\\\\"),
    Cause.FAULT: CauseLook("#3b3f46", "#ffffff", "xxxx"),
    Cause.INTERRUPTED: CauseLook("#d0d3d6", _DARK),
}
