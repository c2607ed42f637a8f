"""Settings of planners as people type them."""

import json
from collections.abc import Sequence
from typing import Any

from reasoned_explorer.model import Fault, SettingsError


def parse_planner_settings(pairs: Sequence[str]) -> dict[str, Any]:
    """Return ``{"depth": 1}`` for ``["depth=1"]``; values are JSON, or text where they are not.

    Raises:
        SettingsError: If a pair has no equals sign or no name, or a name is given twice.
    """
    settings: dict[str, Any] = {}
    faults = []
    for pair in pairs:
        key, sign, value = pair.partition("=")
        name = key.strip().replace("-", "_")
        if not sign or not name:
            faults.append(Fault(f"{pair!r}", "name=value, e.g. depth=1"))
        elif name in settings:
            faults.append(Fault(f"{name!r} is given twice", "each setting once"))
        else:
            settings[name] = _value(value)
    if faults:
        raise SettingsError("--set", faults)
    return settings


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
