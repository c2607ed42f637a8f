"""Keeps the pictures that a mission's captioner was shown."""

from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from reasoned_explorer.model import Goal, RecordWriteError, Undescribed, View
from reasoned_explorer.model.disk import in_words
from reasoned_explorer.perception import Captioner

#: In the folder of a mission.
PICTURES_NAME = "pictures"


class KeepingCaptioner:
    """A captioner whose pictures are kept as they were described: ``LEGS-LOOK-VIEW.png``, as the view's key says.

    Args:
        captioner: Describes them.
        folder: Where they are kept; made with the first.
    """

    def __init__(self, captioner: Captioner, folder: Path) -> None:
        self.name, self.label = captioner.name, captioner.label
        self._captioner, self._folder = captioner, folder

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str | Undescribed]:
        """Return what the captioner says, once all pictures are kept.

        Raises:
            PartError: As the captioner.
            RecordWriteError: If a picture cannot be written.
        """
        for view in views:
            if view.image is not None:
                self._keep(view)
        return await self._captioner.describe(goal, views)

    def _keep(self, view: View) -> None:
        path = self._folder / f"{'-'.join(f'{number:04d}' for number in view.key)}.png"
        half = path.with_suffix(".half")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            # Made beside and renamed: there is never half a picture.
            # An eighth larger than it could be, in a third of the time: a mission has hundreds.
            Image.fromarray(view.image).save(half, "PNG", compress_level=2)
            half.replace(path)
        except OSError as error:
            half.unlink(missing_ok=True)
            raise RecordWriteError(f"pictures: {in_words(path, error)}") from error
