"""A mission as it is replayed: its record word for word, and what follows from it."""

import json
from pathlib import Path

from pydantic_core import to_json

from reasoned_explorer.evaluation.record_file import RECORD_NAME, parse_record
from reasoned_explorer.viewer.runs import MissionFiles


def replay_json(files: MissionFiles) -> bytes:
    """Return the replay of a mission as the page reads it.

    Raises:
        RecordError: If the record is broken; a last line that was cut off is left out.
    """
    record = parse_record(files.record, Path(RECORD_NAME))
    lines = [json.loads(line) for line in files.record.split(b"\n")[:-1]]
    return to_json(
        {
            "id": files.id,
            "name": files.name,
            "method": files.method,
            "header": lines[0]["header"],
            "steps": [line["step"] for line in lines[1:] if "step" in line],
            "summary": next((line["summary"] for line in lines if "summary" in line), None),
            "complete": record.complete,
            "derived": {"sigma": [], "steps": [], "pictures": "none", "pair_key": files.pair_key},
        }
    )
