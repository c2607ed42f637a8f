"""The level-4 table: what serves an underspecified goal, graded 0 to 2 (data, rubric and source: ``grades.toml``)."""

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from reasoned_explorer.model import Fault, GoalError
from reasoned_explorer.task.goal_spec import NEAR_M, Condition, Relation, Sought
from reasoned_explorer.world.taxonomy import Ground

_CONDITION = re.compile(r"(?P<neg>not )?(?P<rel>near|under|on) (?P<what>[\w., ]+?)(?:@(?P<metres>[\d.]+))?")


@dataclass(frozen=True, slots=True)
class Affordance:
    """One thing that a person may want to do.

    Attributes:
        name: Identifier, e.g. ``"nap"``.
        asks: What is asked for, e.g. ``"somewhere to take a nap"``.
        phrases: Ways to say it, as words.
        rows: What serves it, with grades.
    """

    name: str
    asks: str
    phrases: tuple[tuple[str, ...], ...]
    rows: tuple[Sought, ...]


@cache
def affordances() -> dict[str, Affordance]:
    """Return the table that comes with this package, by name."""
    text = files("reasoned_explorer.task").joinpath("grades.toml").read_text(encoding="utf-8")
    return {item.name: item for item in read_table(text)}


def read_table(text: str) -> tuple[Affordance, ...]:
    """Return the affordances of a table in TOML (the format stands in ``grades.toml``).

    Raises:
        GoalError: With everything that is wrong with it.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise GoalError("table of grades", [Fault(str(error), "valid TOML")]) from error
    faults: list[Fault] = []
    found: list[Affordance] = []
    listed = data.get("affordance")
    for entry in listed if isinstance(listed, list) else []:
        if not _is_entry(entry):
            faults.append(Fault(f"entry {entry!r:.80}", "name, asks (text), phrases and rows (lists of text)"))
            continue
        rows = []
        for row in entry["rows"]:
            try:
                rows.append(_row(row))
            except GoalError as error:
                faults += [
                    Fault(f"{entry['name']}: row {row!r}: {fault.what}", fault.expected) for fault in error.faults
                ]
        if not any(row.grade == 2 for row in rows):
            faults.append(Fault(f"{entry['name']}: no row has grade 2", "something that passes"))
        phrases = tuple(tuple(phrase.split()) for phrase in entry["phrases"])
        found.append(Affordance(entry["name"], entry["asks"], phrases, tuple(rows)))
    names = [item.name for item in found]
    faults += [
        Fault(f"{name!r} stands twice", "each name once") for name in sorted({n for n in names if names.count(n) > 1})
    ]
    if not found:
        faults.append(Fault("the table is empty", "at least one [[affordance]]"))
    if faults:
        raise GoalError("table of grades", faults)
    return tuple(found)


def _is_entry(entry: Any) -> bool:
    return (
        isinstance(entry, dict)
        and all(isinstance(entry.get(key), str) for key in ("name", "asks"))
        and all(
            isinstance(entry.get(key), list) and all(isinstance(item, str) for item in entry[key])
            for key in ("phrases", "rows")
        )
    )


def _row(text: str) -> Sought:
    """Return a row; ``"class: grade | condition; condition | why"``."""
    head, _, rest = text.partition("|")
    listed, _, why = rest.partition("|")
    class_name, _, grade = (part.strip() for part in head.partition(":"))
    if grade not in {"0", "1", "2"}:
        raise GoalError("row", [Fault(f"grade {grade!r}", "0, 1 or 2")])
    conditions = tuple(_condition(part.strip()) for part in listed.split(";") if part.strip())
    return Sought(class_name, int(grade), conditions, why=why.strip())


def _condition(text: str) -> Condition:
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise GoalError("row", [Fault(f"condition {text!r}", "'[not] near|under|on WHAT[, WHAT][@metres]'")])
    classes, grounds, buildings = [], [], False
    for what in (part.strip() for part in match["what"].split(",")):
        if what == "building":
            buildings = True
        elif what.startswith("ground."):
            name = what.removeprefix("ground.").upper()
            if name not in Ground.__members__:
                raise GoalError("row", [Fault(f"unknown ground {what!r}", "a ground of the taxonomy")])
            grounds.append(Ground[name])
        else:
            classes.append(what)
    return Condition(
        Relation(match["rel"]),
        tuple(sorted(classes)),
        tuple(sorted(grounds)),
        buildings,
        float(match["metres"] or NEAR_M),
        match["neg"] is not None,
    )
