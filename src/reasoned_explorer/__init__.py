"""Reasoned Explorer: outdoor object navigation with language models that imagine what lies beyond."""

__version__ = "0.1.0"
