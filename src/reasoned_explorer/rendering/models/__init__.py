"""What every class of objects looks like: models made in code, in several variants and levels of detail."""

from reasoned_explorer.rendering.models.catalogue import model_of, natural_size_m, tints_of, variants_of

__all__ = ["model_of", "natural_size_m", "tints_of", "variants_of"]
