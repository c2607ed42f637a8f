"""From pictures to words: the `Captioner` protocol and its registry."""

from reasoned_explorer.perception.captioner import Captioner

__all__ = ["Captioner"]
