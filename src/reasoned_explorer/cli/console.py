"""Where commands print."""

import os
from contextlib import suppress

from rich.console import Console


class Output(Console):
    """A console that goes on in silence when whoever reads it (head, less) has seen enough: the work is still done."""

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(highlight=False, stderr=stderr)

    def on_broken_pipe(self) -> None:
        """Send all that is still to be said nowhere."""
        self.quiet = True
        # What is in a buffer would be written, and fail, once more when the process ends.
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.file.fileno())
