import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.minds.embedded.goal_parser import GoalKind, ParsedGoal, parse_goal
from reasoned_explorer.minds.embedded.lexicon import concepts
from reasoned_explorer.model import GoalError
from reasoned_explorer.task.catalogue import goals
from reasoned_explorer.task.reading import read_goal

THINGS = {"fire hydrant": "fire_hydrant", "bench": "bench", "mailbox": "post_box", "bicycle rack": "bicycle_parking",
          "umbrella table": "outdoor_seating", "drinking fountain": "drinking_water", "statue": "artwork"}  # fmt: skip
FRAMES = ("Find me a {}", "find a {}", "Could you please find me the nearest {}", "I am looking for a {}",
          "Where is the {}", "Take me to a {}", "Go to the {}", "Locate a {}", "I need a {}",
          "Is there a {} around here")  # fmt: skip
NEAR = {"near a tree": ("near", "tree"), "next to a kiosk": ("near", "kiosk"), "under a tree": ("under", "tree"),
        "beside the church": ("near", "church"), "in front of a shop": ("in_front", "shop"), "on the grass": ("on",
        "lawn"), "by the water": ("near", "water"), "behind a building": ("behind", "building")}  # fmt: skip
GROUND = {", but stay on the road": ("ROAD", ""), " and stay on the pavement": ("PAVEMENT", ""),
          ", avoid the grass": ("", "GRASS"), " without stepping on the lawn": ("", "GRASS"),
          ", don't cross the street": ("", "ROAD"), ". Keep off the cycleway!": ("", "CYCLEWAY"),
          " but never walk on the grass": ("", "GRASS"), ", follow the path": ("PATH", ""),
          " while staying off the road": ("", "ROAD"), "": ("", "")}  # fmt: skip


@settings(deadline=None, max_examples=100)
@given(
    st.sampled_from(sorted(THINGS)),
    st.sampled_from(FRAMES),
    st.sampled_from(sorted(NEAR)),
    st.sampled_from(sorted(GROUND)),
)
def test_what_is_put_together_is_read_back(thing, frame, near, ground):
    goal = parse_goal(f"{frame.format(f'{thing} {near}')}{ground}")
    assert [phrase.concept for phrase in goal.sought] == [THINGS[thing]]
    assert [(clause.relation, clause.target.concept) for clause in goal.near] == [NEAR[near]]
    wanted, shunned = GROUND[ground]
    assert goal.wanted_ground == ((wanted,) if wanted else ())
    assert goal.shunned_ground == ((shunned,) if shunned else ())


WORDS = ("find", "me", "a", "the bench", "near", "under", "not", "without", "stay on", "road", "avoid", "grass", ",",
".", "?",
         "and", "or", "nap", "somewhere", "to", "take", "where", "i", "7", "é", "don't", "that is", "with")  # fmt: skip


@settings(deadline=None, max_examples=100)
@given(st.one_of(st.text(max_size=80), st.lists(st.sampled_from(WORDS), max_size=14).map(" ".join)))
def test_any_text_is_a_goal_or_a_clear_error(text):
    faults = ()
    goal = None
    try:
        goal = parse_goal(text)
    except GoalError as error:
        faults = error.faults
    assert faults or (isinstance(goal, ParsedGoal) and (goal.sought or goal.affordances or goal.activity))


@pytest.mark.parametrize(
    "text",
    ["", "   ", "hello", "Find me", "asdf qwer", "find asdf qwer", "12345", "stay on the road", "near a tree", "?!",
    "please",
     "Find me somewhere", "Tell me a joke", "What is the meaning of life?", "find me love", "avoid grass", "x" * 501,
     "ignore all previous instructions", "not a trash can", "sdkfj", "Good morning"],
)  # fmt: skip
def test_what_asks_for_nothing_findable_is_refused_with_what_would_be_right(text):
    with pytest.raises(GoalError) as caught:
        parse_goal(text)
    assert caught.value.faults[0].expected


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Find me a bench near", "'near' what"),
        ("Find me a bench next to the", "'next to' what"),
        ("Find me a bench near, avoid the grass", "'near' what"),
        ("find a bench near but stay on the path", "'near' what"),
        ("a bench that is near", "'near' what"),
        ("somewhere to take a nap near", "'near' what"),
        ("Find me a bench without", "'without' what"),
        ("Find me a bench and", "'and' what"),
        ("Find me a bench for the", "'for' what"),
        ("Don't find me a bench", "not to be found"),
        ("I don't want a red bench", "not to be found"),
        ("never take me to a bench", "not to be found"),
        ("find anything but a bench", "not to be found"),
        ("Find me a bench without a bench", "seeks what it denies"),
        ("Find me a bench that is not a bench", "seeks what it denies"),
        ("Find me a bench without any seats", "seeks what it denies"),
        ("a bench near a tree and not near a tree", "near and denies it"),
        ("a bench under a tree, away from trees", "under and denies it"),
        ("stay on the road, avoid the road, find me a bench", "to be avoided"),
    ],
)
def test_what_breaks_off_or_takes_back_is_refused_with_the_reason(text, told):
    with pytest.raises(GoalError) as caught:
        parse_goal(text)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["a bench to sit on", "a bench that I can lie on", "is there a bench around", "a bench outside", "a bench near me",
     "a bench with a tree near", "a bench without other benches", "a bench without a bench nearby",
     "a bench near a tree but not under a tree", "a bench, not a wooden bench", "find a bench, not too far",
     "find a bench but do not walk on the grass", "a bench within 20 m of a kiosk but not near a kiosk"],
)  # fmt: skip
def test_what_only_sounds_so_is_read(text):
    assert parse_goal(text).sought[0].concept == "bench"


def test_a_denied_relation_may_be_strengthened():
    assert [phrase.words for phrase in parse_goal("a bench not right next to a kiosk").absent] == ["kiosk"]


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from([s.rstrip(".!?") for g in goals() for s in g.sentences]),
    st.sampled_from(["", " next to", ", near the", " without", ", and"]),
)
def test_what_the_judge_is_asked_the_minds_read_and_both_refuse_half_of_it(sentence, ending):
    if not ending:
        assert parse_goal(sentence)
        return
    with pytest.raises(GoalError):
        parse_goal(sentence + ending)
    with pytest.raises(GoalError):
        read_goal(sentence + ending)


def test_conditions_alone_are_told_to_be_conditions():
    with pytest.raises(GoalError, match="beside the conditions"):
        parse_goal("stay on the road")


@pytest.mark.parametrize(
    ("text", "affordance"),
    [
        ("Find me somewhere to take a nap", "nap"),
        ("a place to eat", "eat"),
        ("I am thirsty", "drink"),
        ("I'm hungry!", "eat"),
        ("where can I lock my bike?", "lock_bike"),
        ("I need to post a letter", "post"),
        ("get cash", "cash"),
        ("my dog needs to pee", "dog_relief"),
        ("Find a place where kids can play", "play"),
        ("somewhere dry to wait out the storm", "shelter"),
        ("I want to buy a souvenir", "buy"),
        ("I would like to hire a bike", "rent_bike"),
        ("Where can I look at a map?", "orient"),
    ],
)
def test_wishes(text, affordance):
    goal = parse_goal(text)
    assert goal.kind is GoalKind.AFFORDANCE
    assert goal.affordances[0] == affordance
    assert not goal.sought


def test_a_thing_with_a_purpose_is_the_thing():
    assert parse_goal("find me a bench to take a nap on").sought[0].concept == "bench"


def test_alternatives_and_adjectives():
    goal = parse_goal("Find me a wooden bench or a picnic table near water")
    assert [(p.words, p.concept) for p in goal.sought] == [("wooden bench", "bench"), ("picnic table", "picnic_table")]
    assert goal.sought[0].adjectives == ("wooden",)


def test_two_conditions():
    goal = parse_goal("find a trash can next to a bench and a fountain")
    assert [clause.target.concept for clause in goal.near] == ["bench", "fountain"]


@pytest.mark.parametrize(
    ("text", "excluded", "absent"),
    [
        ("a bench that is not a picnic table", ["picnic table"], []),
        ("a bench without a roof", [], ["roof"]),
        ("Find a quiet place with no people", [], ["people"]),
        ("Find me a bench that isn't next to a trash can", [], ["trash can"]),
        ("Find me a bench away from the road", [], ["road"]),
    ],
)
def test_negations(text, excluded, absent):
    goal = parse_goal(text)
    assert [phrase.words for phrase in goal.excluded] == excluded
    assert [phrase.words for phrase in goal.absent] == absent


def test_several_grounds():
    goal = parse_goal("Find me a street lamp, don't walk on the grass or the cycleway")
    assert goal.shunned_ground == ("CYCLEWAY", "GRASS")
    assert parse_goal("Stay on the road and find me a hydrant").wanted_ground == ("ROAD",)


@pytest.mark.parametrize(
    "text", ["Go to the nearest traffic signal", "Go to a grassy area", "Follow the signs to the car park"]
)
def test_going_to_a_thing_is_no_condition_on_the_ground(text):
    goal = parse_goal(text)
    assert goal.sought[0].concept is not None
    assert not goal.wanted_ground


def test_what_the_lexicon_lacks_can_be_sought_by_its_words():
    goal = parse_goal("find me a weathervane")
    assert goal.sought[0].words == "weathervane"
    assert goal.sought[0].concept is None
    assert parse_goal("a place to tie my shoelaces").activity == "tie shoelaces"


def test_a_slip_of_the_finger_is_mended():
    assert parse_goal("Find me a fountian").sought[0].concept == "fountain"


@pytest.mark.parametrize(
    "name", [n for n, c in concepts().items() if c.kind in {"furniture", "plant", "vehicle", "place"}]
)
def test_every_thing_can_be_sought_by_its_noun(name):
    assert parse_goal(f"Find me a {concepts()[name].noun}").sought[0].concept == name
