"""A mission's record while it is being written."""

from pathlib import Path


class LiveFeed:
    """A record that grows.

    Args:
        path: Of the record; it need not be there yet.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
