"""What describes pictures."""

from collections.abc import Sequence
from typing import Protocol

from reasoned_explorer.model import Goal, Undescribed, View


class Captioner(Protocol):
    """Says in words what views show.

    Attributes:
        name: As registered.
        label: What results made with it are called, e.g. ``"simulated captioner (noisy)"``.
    """

    name: str
    label: str

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str | Undescribed]:
        """Return one description per view, in the views' order, or why there is none.

        All views of one call are described together; time passes on the clock that the captioner was made with.

        Raises:
            PartError: If no view can be described. The agent goes on without this look.
        """
        ...
