"""A mission as it is replayed: its record word for word, and what follows from it."""

import json
from typing import Any

from pydantic_core import to_json

from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.runs import MissionFiles
from reasoned_explorer.viewer.worths import explorer_settings, penalty_curve, worths_of


def replay_json(files: MissionFiles, record: EpisodeRecord, *, pictures: str = "none") -> bytes:
    """Return the replay of a mission as the page reads it.

    ``header``, ``steps`` and ``summary`` are the record's own. ``derived`` adds the curve of σ(d), for each step what
    its frontiers were worth when it chose and from where that was seen, and by which key comparable missions are found.

    Args:
        files: Of the mission.
        record: What its record holds, a last line that was cut off left out.
        pictures: Whether its pictures are ``kept``, can be ``drawn``, or ``none``.
    """
    header: Any = None
    summary: Any = None
    steps = []
    for line in files.record.split(b"\n")[:-1]:
        kind, payload = next(iter(json.loads(line).items()))
        if kind == "step":
            steps.append(payload)
        elif kind == "header":
            header = payload
        else:
            summary = payload
    derived_steps = [
        {"values": worths, "here": step.pose[:2]} for step, worths in zip(record.steps, worths_of(record), strict=True)
    ]
    return to_json(
        {
            "id": files.id,
            "name": files.name,
            "method": files.method,
            "header": header,
            "steps": steps,
            "summary": summary,
            "complete": record.complete,
            "derived": {
                "sigma": penalty_curve(explorer_settings(record.header)),
                "steps": derived_steps,
                "pictures": pictures,
                "pair_key": files.pair_key,
            },
        }
    )
