import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.minds.embedded import default_senses, minds_with
from reasoned_explorer.minds.embedded.lexicon import data_lines
from reasoned_explorer.minds.embedded.reading import FAR, MIDDLE, NEAR, read_scene
from reasoned_explorer.minds.embedded.relevance import Senses
from reasoned_explorer.minds.embedded.visionary import WORDS, imagine_texts
from reasoned_explorer.model import Goal
from tests.minds.helpers import KOSMOS, STREET, WALL, mind_context, scene

WORDS_ONLY = default_senses(with_embedder=False)
LINES = data_lines("background_scenes")


def _imagine(text: str, *key: int, count: int = 3, seed: int = 0) -> tuple[str, ...]:
    return imagine_texts(text, seed=seed, key=key or (0, 0, 0), count=count, senses=WORDS_ONLY)


def test_the_middle_comes_close_and_the_ground_goes_on():
    for text in _imagine(STREET):
        reading = read_scene(text)
        fountains = [mention.distance for mention in reading.mentions if mention.concept == "fountain"]
        assert NEAR in fountains
        assert reading.ground_ahead is not None


def test_the_distance_comes_to_the_middle_more_often_than_not():
    reached = sum(
        any(m.concept == "church" and m.distance == MIDDLE for m in read_scene(text).mentions)
        for step in range(60)
        for text in _imagine("In the distance there is a church. A path leads straight ahead.", step, 0, 0, count=1)
    )
    assert 40 <= reached <= 60


def test_near_things_are_passed_in_the_end():
    text = "Close by on the left, there is a telephone booth. A pavement leads straight ahead."
    seen = []
    for depth in range(5):
        (text,) = _imagine(text, depth, count=1)
        seen.append(any(m.concept == "telephone" and m.distance == NEAR for m in read_scene(text).mentions))
    assert not all(seen)


def test_a_blocked_way_stays_blocked():
    assert all(read_scene(text).blocked for text in _imagine(WALL))


@settings(deadline=None, max_examples=60)
@given(st.sampled_from([*LINES, STREET, KOSMOS]), st.integers(0, 2**31), st.integers(0, 500), st.integers(2, 4))
def test_children_differ_are_short_and_can_be_read(text, seed, step, count):
    texts = _imagine(text, step, 0, 1, count=count, seed=seed)
    assert len(set(texts)) == count
    for imagined in texts:
        assert len(imagined.split()) <= WORDS + 12
        assert read_scene(imagined).mentions


def test_the_same_key_imagines_the_same_whatever_else_was_asked():
    first = _imagine(STREET, 3, 0, 1)
    _imagine(STREET, 9, 0, 0)
    assert _imagine(STREET, 3, 0, 1) == first
    assert _imagine(STREET, 3, 0, 2) != first
    assert _imagine(STREET, 3, 0, 1, seed=1) != first


def test_what_comes_into_view_suits_the_surroundings():
    def share(text: str, concepts: set[str]) -> float:
        news = [
            mention.concept
            for step in range(150)
            for imagined in _imagine(text, step, 0, 0, count=2)
            for mention in read_scene(imagined).mentions
            if mention.distance in {MIDDLE, FAR}
        ]
        return sum(concept in concepts for concept in news) / len(news)

    food = {"restaurant", "cafe", "bar", "shop"}
    shopping = (
        "Close by there is a restaurant next to a bar. Close by there is a cafe. A pavement leads straight ahead."
    )
    playing = "Close by there is a playground with a swing. Close by there is a lawn. A path leads straight ahead."
    assert share(shopping, food) > 1.5 * share(playing, food)


def test_what_is_denied_is_not_imagined_to_come_close():
    for text in _imagine("There is no church here. A path leads straight ahead.", count=3):
        assert not any(m.concept == "church" and m.distance == NEAR for m in read_scene(text).mentions)


@pytest.mark.parametrize("text", ["", "Gibberish.", "12 34"])
def test_even_nothing_leads_somewhere(text):
    assert len(set(_imagine(text, count=3))) == 3


def test_without_statistics_common_things_are_imagined():
    texts = imagine_texts(STREET, seed=0, key=(0, 0, 0), count=3, senses=Senses())
    assert len(set(texts)) == 3


def test_the_same_is_imagined_beyond_the_same_view_wherever_it_was_seen():
    minds = minds_with(mind_context(), WORDS_ONLY).visionary
    goal = Goal("Find me a bench", 1)
    scenes = [scene(STREET, 0, 0, 0), scene(STREET, 7, 0, 2)]
    first, second = asyncio.run(minds.imagine(goal, scenes, count=3))
    assert [child.text for child in first] == [child.text for child in second]
    assert len({child.text for child in first}) == 3
    deeper = asyncio.run(minds.imagine(goal, first, count=1))
    assert len({children[0].text for children in deeper}) == 3
