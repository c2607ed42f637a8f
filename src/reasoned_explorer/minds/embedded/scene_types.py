"""What one may expect in which kind of surroundings (``data/scene_types.txt``; common sense, not measured)."""

from functools import cache

from reasoned_explorer.minds.embedded.lexicon import data_lines


@cache
def expectations() -> dict[str, dict[str, float]]:
    """Return, for a concept that is seen, the log odds of what one may expect there against anywhere outdoors."""
    table: dict[str, dict[str, float]] = {}
    for line in data_lines("scene_types"):
        scene, graded = line.split("|")
        parts = graded.split()
        table[scene] = {concept: float(odds) for concept, odds in zip(parts[::2], parts[1::2], strict=True)}
    return table
