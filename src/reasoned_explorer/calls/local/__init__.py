"""Models that run on this machine, by the names that they have on the Hugging Face hub.

Reading this package loads neither torch nor transformers: both come with the first model.
"""

from reasoned_explorer.calls.local.loading import LocalSettings, hub_name, load_local, only_describes
from reasoned_explorer.calls.local.model import LocalModel

__all__ = ["LocalModel", "LocalSettings", "hub_name", "load_local", "only_describes"]
