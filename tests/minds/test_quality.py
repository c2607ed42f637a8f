"""The embedded minds must stay about as good as they were measured to be (`python -m tests.minds.quality` measures)."""

from statistics import fmean

import pytest

from reasoned_explorer.minds.embedded import default_senses
from reasoned_explorer.minds.embedded.embedding import model_folder
from tests.minds.quality import goal_aucs, halting_f1, hard_aucs, labelled_goals, labelled_scenes, pooled_auc

WORDS_ONLY = default_senses(with_embedder=False)


def test_the_labels_are_whole():
    names = {goal.name for goal in labelled_goals()}
    assert {goal.level for goal in labelled_goals()} == {1, 2, 3, 4}
    assert len(labelled_scenes()) >= 60
    for scene in labelled_scenes():
        assert scene.shows <= names
        assert scene.within_reach <= scene.shows


@pytest.mark.parametrize("paraphrased", [False, True])
def test_ranking(paraphrased):
    aucs = goal_aucs(WORDS_ONLY, paraphrased=paraphrased)
    assert fmean(aucs.values()) >= 0.96
    assert min(aucs.values()) >= 0.80


def test_scores_compare_across_goals():
    assert pooled_auc(WORDS_ONLY) >= 0.95


@pytest.mark.parametrize("paraphrased", [False, True])
def test_halting(paraphrased):
    f1, wrong = halting_f1(WORDS_ONLY, paraphrased=paraphrased)
    assert f1 >= 0.88, "\n".join(wrong)


@pytest.mark.skipif(model_folder() is None, reason="the weights of MiniLM are not installed")
def test_embeddings_help_where_the_lexicon_ends():
    with_embedder = default_senses(with_embedder=True)
    assert fmean(hard_aucs(with_embedder).values()) >= fmean(hard_aucs(WORDS_ONLY).values()) + 0.15
    assert fmean(goal_aucs(with_embedder).values()) >= 0.96
