"""How those who do what takes long say how far they are."""

from collections.abc import Callable

#: Told, now and then, what takes long.
Progress = Callable[[str], None]
