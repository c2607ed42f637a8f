import numpy as np
import pytest

from reasoned_explorer.minds.embedded.embedding import load_embedder, model_folder

needs_weights = pytest.mark.skipif(model_folder() is None, reason="the weights of MiniLM are not installed")


@needs_weights
def test_embeddings_have_length_one_and_are_kept():
    embedder = load_embedder()
    assert embedder is not None
    vector = embedder.embed("fire hydrant")
    assert vector.shape == (384,)
    assert float(np.linalg.norm(vector)) == pytest.approx(1.0)
    assert embedder.embed("fire hydrant") is vector


@needs_weights
def test_likeness_is_rounded_symmetric_and_sensible():
    embedder = load_embedder()
    assert embedder is not None
    assert embedder.likeness("mailbox", "letter box") == embedder.likeness("letter box", "mailbox")
    assert embedder.likeness("bench", "bench") == 1.0
    assert embedder.likeness("mailbox", "letter box") > embedder.likeness("mailbox", "tree") + 0.2
    assert round(embedder.likeness("bench", "tree"), 4) == embedder.likeness("bench", "tree")


@needs_weights
def test_what_the_layers_compute_does_not_change():
    # Taken from this code once.
    embedder = load_embedder()
    assert embedder is not None
    assert embedder.likeness("mailbox", "letter box") == pytest.approx(0.6896, abs=2e-4)
