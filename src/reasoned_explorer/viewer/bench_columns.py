"""The missions of a ``rex bench`` run as columns. Whole columns are made at once: a run may have ten thousand rows."""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.report.causes import cause_among
from reasoned_explorer.viewer.listing import opaque_id, outcome_word
from reasoned_explorer.viewer.security import within

_FACTS = ("end", "score.success", "declared", "score.over_time", "compliant", "score.oracle_success")
#: Columns of the page by the figures of a row that they show as they are.
_SHOWN = {
    "level": "score.level",
    "place": "place",
    "goal": "goal",
    "end": "end",
    "spl": "score.spl",
    "casr": "score.casr",
    "ct_s": "score.computing_s",
    "tt_s": "score.travelling_s",
    "steps": "steps",
    "path_length_m": "score.path_length_m",
    "seed": "seed",
}
_FIGURES = tuple(dict.fromkeys((*_FACTS, *_SHOWN.values())))
_BROKEN = "its row in the run cannot be read"
#: Vehicle, method and mission id.
Key = tuple[str, str, str]


def read_columns(store: RunStore, root: Path) -> tuple[Mapping[str, list[Any]], list[Key]]:
    """Return the cells of all missions by the names of their columns, and the missions' keys in the same order.

    Args:
        store: Of the run.
        root: What nothing may lead out of, resolved.

    Raises:
        sqlite3.Error: If the store cannot be read.
    """
    found = store.figures(_FIGURES)
    nothing = [None] * len(_FIGURES)
    keys = [(vehicle, method, name) for vehicle, method, name, _ in found]
    rows = [figures or nothing for *_, figures in found]
    of: dict[str, list[Any]] = {name: [row[place] for row in rows] for place, name in enumerate(_FIGURES)}
    columns = {name: of[figure] for name, figure in _SHOWN.items()}
    facts = list(zip(*(of[name] for name in _FACTS), strict=True))
    # There are ten thousand rows, and a few dozen kinds of them.
    causes = {fact: _cause(*fact) for fact in set(facts)}
    columns["cause"] = [causes[fact] for fact in facts]
    columns["fault"] = [None if cause else _BROKEN for cause in columns["cause"]]
    columns["outcome"] = [
        outcome_word(success) if row[0] else None for success, row in zip(of["score.success"], rows, strict=True)
    ]
    columns["id"] = [opaque_id(*key) for key in keys]
    columns["vehicle"], columns["method"], columns["mission_id"] = ([key[place] for key in keys] for place in range(3))
    columns["has_record"] = _have_records(store, keys, root)
    return columns, keys


def _cause(  # noqa: PLR0917 - as `_FACTS`
    end: Any, success: Any, declared: Any, over_time: Any, compliant: Any, oracle_success: Any
) -> str | None:
    try:
        return cause_among(
            end,
            success=bool(success),
            declared=bool(declared),
            over_time=bool(over_time),
            compliant=compliant,
            oracle_success=bool(oracle_success),
        ).value
    except ValueError:
        return None


def _have_records(store: RunStore, keys: list[Key], root: Path) -> list[int]:
    """Return for each mission whether its record was kept, by looking into each folder once."""
    there: dict[tuple[str, str], set[str]] = {}
    names: dict[str, str] = {}
    for key in keys:
        if key[2] not in names:
            names[key[2]] = store.trace_path(*key).name
        if key[:2] not in there:
            there[key[:2]] = _names_in(within(root, store.trace_path(*key).parent))
    return [int(names[mission_id] in there[vehicle, method]) for vehicle, method, mission_id in keys]


def _names_in(folder: Path | None) -> set[str]:
    with suppress(OSError):
        if folder is not None:
            with os.scandir(folder) as entries:
                return {entry.name for entry in entries}
    return set()
