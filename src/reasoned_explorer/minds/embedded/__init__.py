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


def make_unknowing_minds(context: MindContext) -> Minds:
    """Return the embedded minds without knowledge of places: no statistics, no expectations of kinds of scenes.

    They know words and what serves what as `make_minds` do. What these find more often on the same missions is the
    advantage of knowing what stands near what.
    """
    from reasoned_explorer.minds.embedded.embedding import model_folder

    return minds_with(context, unknowing_senses(with_embedder=model_folder() is not None))


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


@cache
def unknowing_senses(*, with_embedder: bool) -> "Senses":
    """Return what the embedded minds know without knowledge of places; the argument is that of `default_senses`."""
    from reasoned_explorer.minds.embedded.embedding import load_embedder
    from reasoned_explorer.minds.embedded.relevance import Senses

    return Senses(None, load_embedder() if with_embedder else None, scene_knowledge=False)


def minds_with(context: MindContext, senses: "Senses") -> Minds:
    """Return the embedded minds with given senses, e.g. with statistics whose labels are permuted."""
    from reasoned_explorer.minds.embedded.roles import EmbeddedMinds

    minds = EmbeddedMinds(context, senses)
    label = f"{LABEL}, {'with MiniLM' if senses.embedder is not None else 'words and lexicon only'}"
    if senses.statistics is None and not senses.scene_knowledge:
        label += ", without knowledge of places"
    return Minds(label=label, evaluator=minds, visionary=minds, checker=minds)
