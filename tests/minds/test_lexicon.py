import pytest

from reasoned_explorer.minds.embedded.affordances import affordances, affordances_in
from reasoned_explorer.minds.embedded.lexicon import (
    ancestors,
    concepts,
    data_lines,
    ground_words,
    likeness,
    mended_word,
    plural_of,
    thing_phrases,
    word_table,
)
from reasoned_explorer.minds.embedded.scene_types import expectations
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground


@pytest.mark.parametrize("name", list(OBJECT_CLASSES))
def test_the_lexicon_covers_the_taxonomy(name):
    concept = concepts()[name]
    assert word_table()[OBJECT_CLASSES[name].noun] == concept.name
    assert word_table()[OBJECT_CLASSES[name].plural] == concept.name


def test_grounds_are_those_of_the_taxonomy():
    names = {ground.name for ground in Ground}
    assert {concept.ground for concept in concepts().values()} - {None} <= names
    assert {name for grounds in ground_words().values() for name in grounds} <= names


def test_data_speaks_only_of_known_concepts():
    known = set(concepts())
    for concept in concepts().values():
        assert ancestors(concept.name) <= known
    for line in data_lines("kin"):
        sought, seen, degree = line.split()
        assert {sought, seen} <= known
        assert 0.0 < float(degree) < 1.0
    for affordance in affordances().values():
        assert affordance.cues
        assert {name for name, _ in affordance.strengths} <= known
        assert all(0.0 < strength <= 1.0 for _, strength in affordance.strengths)
        assert max(strength for _, strength in affordance.strengths) >= 0.8
    for scene, expected in expectations().items():
        assert {scene, *expected} <= known


def test_likeness_knows_kinds_and_kin():
    assert likeness("bench", "bench") == 1.0
    assert likeness("tree", "palm") == 1.0
    assert 0.0 < likeness("palm", "tree") < 0.8
    assert 0.0 < likeness("artwork", "monument") < 0.8
    assert likeness("bench", "fire_hydrant") == 0.0


@pytest.mark.parametrize(
    ("singular", "plural"),
    [
        ("bench", "benches"),
        ("berry", "berries"),
        ("toy", "toys"),
        ("flight of steps", "flights of steps"),
        ("bus", "buses"),
    ],
)
def test_plurals(singular, plural):
    assert plural_of(singular) == plural


def test_the_longest_phrase_counts():
    table = thing_phrases()
    assert table.at(["drinking", "fountain"], 0) == (2, "drinking_water")
    assert table.at(["a", "fountain"], 1) == (1, "fountain")
    assert table.at(["zebra"], 0) is None


def test_one_slip_in_a_word_is_mended():
    assert mended_word("fountian") == "fountain"
    assert mended_word("hydrnt") == "hydrant"
    assert mended_word("benchh") == "bench"
    assert mended_word("bnch") is None  # too short to be sure
    assert mended_word("helicopter") is None


def test_the_main_wish_comes_before_qualities():
    assert affordances_in("somewhere to sit in the shade") == ("sit", "shade")
    assert affordances_in("a quiet place to read my book") == ("read", "quiet")
    assert affordances_in("play soccer") == ("sports",)
    assert affordances_in("lock up our bicycles") == ("lock_bike",)
    assert affordances_in("nothing of the kind") == ()
