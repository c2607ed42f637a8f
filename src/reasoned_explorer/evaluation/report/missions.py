"""All missions of a report: as the data that the page filters, and as a file."""

import json
import math
from collections.abc import Hashable, Iterable
from dataclasses import asdict, fields

from reasoned_explorer.evaluation.report.causes import Cause
from reasoned_explorer.evaluation.report.curves import LIMITS_MIN
from reasoned_explorer.evaluation.report.scores import at_limit
from reasoned_explorer.evaluation.report.study import Entry, Study
from reasoned_explorer.evaluation.report.tables import Value
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.scoring import MissionScore


class _Words:
    """Strings that are kept once and named by their place."""

    def __init__(self, words: Iterable[Hashable] = ()) -> None:
        self.places: dict[Hashable, int] = {}
        for word in words:
            self.place(word)

    def place(self, word: Hashable) -> int:
        return self.places.setdefault(word, len(self.places))


def missions_json(study: Study) -> str:
    """Return the missions as JSON that may stand inside a ``<script>`` element whatever people wrote in them.

    Strings stand once; each mission is a short list, in the order of ``columns``. What a filter tests is worked out
    here, so that the page finds exactly the missions that a number was made from.
    """
    methods, causes = _Words(study.methods), _Words(Cause)
    places, cities, goals, ids, words = _Words(study.places), _Words(study.cities), _Words(), _Words(), _Words()
    radii = sorted({radius_m for entry in study.entries for radius_m, _ in entry.score.success_at})
    limits_s = sorted({60.0 * limit for limit in LIMITS_MIN} | {entry.score.time_limit_s for entry in study.entries})
    rows = []
    for entry in study.entries:
        row, score = entry.row, entry.score
        hits = dict(score.success_at)
        within = [limit_s <= score.time_limit_s and at_limit(score, limit_s).success for limit_s in limits_s]
        rows.append(
            [
                methods.place(entry.method),
                ids.place(row.mission_id),
                row.level,
                places.place(row.place),
                cities.place(row.city),
                goals.place(row.goal),
                causes.place(entry.cause),
                int(score.success),
                int(score.oracle_success),
                int(score.oracle_seen),
                _mask(hits.get(radius_m, False) for radius_m in radii),
                _mask(within),
                round(score.spl, 3),
                round(score.casr, 3),
                round(score.computing_s, 1),
                round(score.travelling_s, 1),
                round(score.path_length_m, 1),
                round(score.reference_length_m, 1) if math.isfinite(score.reference_length_m) else None,
                row.steps,
                row.calls,
                row.small_collisions,
                row.large_collisions,
                words.place(row.judge),
                words.place(row.reason),
            ]
        )
    data = {
        "methods": list(methods.places),
        "causes": [[cause.key, cause.value] for cause in Cause],
        "places": list(places.places),
        "cities": list(cities.places),
        "goals": list(goals.places),
        "ids": list(ids.places),
        "words": list(words.places),
        "radii": radii,
        "limits": limits_s,
        "rows": rows,
    }
    return script_json(data)


def script_json(data: object) -> str:
    """Return JSON without a character that could end a script element or begin markup."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _mask(hits: Iterable[bool]) -> int:
    return sum(1 << place for place, hit in enumerate(hits) if hit)


_ROW_FIELDS = tuple(item.name for item in fields(MissionRow) if item.name != "score")
_SCORE_FIELDS = tuple(item.name for item in fields(MissionScore) if item.name not in {"mission_id", "success_at"})


def missions_head(study: Study) -> tuple[str, ...]:
    """Return the heads of the file of missions: every field of a row and of its score."""
    return (*_ROW_FIELDS, *_SCORE_FIELDS, *(f"success_at_{radius_m:g}_m" for radius_m in _radii(study)), "cause")


def missions_records(study: Study) -> list[tuple[Value, ...]]:
    """Return the lines of that file; what is infinite is empty."""
    radii = _radii(study)
    return [_record(entry, radii) for entry in study.entries]


def _record(entry: Entry, radii: list[float]) -> tuple[Value, ...]:
    score = asdict(entry.score)
    hits = dict(entry.score.success_at)
    return (
        *(_plain(getattr(entry.row, name)) for name in _ROW_FIELDS),
        *(_plain(score[name]) for name in _SCORE_FIELDS),
        *(_plain(hits.get(radius_m)) for radius_m in radii),
        entry.cause.value,
    )


def _plain(value: Value) -> Value:
    if isinstance(value, bool):
        return int(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _radii(study: Study) -> list[float]:
    return sorted({radius_m for entry in study.entries for radius_m, _ in entry.score.success_at})
