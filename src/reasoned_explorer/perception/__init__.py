"""From pictures to words: the `Captioner` protocol, its registry, and captioners that show pictures to a model."""

from reasoned_explorer.perception.captioner import Captioner

__all__ = ["Captioner"]
