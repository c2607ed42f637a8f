"""Minds that ask a language model: prompts with versions, fenced data, tolerant reading, no made-up answer."""

from reasoned_explorer.minds.prompted.roles import Asker, PromptedMinds, PromptedSettings, Tally, prompted_minds

__all__ = ["Asker", "PromptedMinds", "PromptedSettings", "Tally", "prompted_minds"]
