"""What a robot is told to find."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Goal:
    """A goal sentence, as a person says it.

    What the sentence means is read out of it by whoever needs it: by the minds from the words alone, and by the judge
    from the truth of the task.

    Attributes:
        text: The sentence, e.g. ``"Find me a fire hydrant, but stay on the road"``.
        level: OUTDOOR's level 1-4 (paper, section II-A) where it is known.
    """

    text: str
    level: int | None = None
