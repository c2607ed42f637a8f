"""The embedded minds: words, a lexicon, place statistics, sentence embeddings where present. No language model."""

from functools import cache
from typing import TYPE_CHECKING

from reasoned_explorer.minds.context import MindContext, Minds

if TYPE_CHECKING:
    from reasoned_explorer.minds.embedded.relevance import Senses

#: What results made with them are called, always.
LABEL = "embedded minds, no language model"


def make_minds(context: MindContext) -> Minds:
    """Return the embedded minds, with MiniLM where its weights are installed; their label says whether."""
    from reasoned_explorer.minds.embedded.embedding import model_folder

    return minds_with(context, default_senses(with_embedder=model_folder() is not None))


def make_words_minds(context: MindContext) -> Minds:
    """Return the embedded minds on words and lexicon only, whether MiniLM is installed or not."""
    return minds_with(context, default_senses(with_embedder=False))


@cache
def default_senses(*, with_embedder: bool) -> "Senses":
    """Return what the embedded minds know by default.

    Args:
        with_embedder: Whether sentence embeddings are to be used; without their weights they are not.
    """
    from reasoned_explorer.knowledge.cooccurrence import load_cooccurrence
    from reasoned_explorer.minds.embedded.embedding import load_embedder
    from reasoned_explorer.minds.embedded.relevance import Senses

    return Senses(load_cooccurrence(), load_embedder() if with_embedder else None)


def minds_with(context: MindContext, senses: "Senses") -> Minds:
    """Return the embedded minds with given senses, e.g. with statistics whose labels are permuted."""
    from reasoned_explorer.minds.embedded.roles import EmbeddedMinds

    minds = EmbeddedMinds(context, senses)
    label = f"{LABEL}, {'with MiniLM' if senses.embedder is not None else 'words and lexicon only'}"
    return Minds(label=label, evaluator=minds, visionary=minds, checker=minds)
