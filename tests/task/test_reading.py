from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import GoalError
from reasoned_explorer.task.catalogue import goals
from reasoned_explorer.task.contradictions import contradictions
from reasoned_explorer.task.goal_spec import AWAY_M, NEAR_M, Relation
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground


def only_condition(text):
    conditions = {condition for item in read_goal(text).sought for condition in item.conditions}
    assert len(conditions) == 1
    return conditions.pop()


@pytest.mark.parametrize(
    ("text", "class_name"),
    [
        ("Find me a fountain", "fountain"),
        ("find a rubbish bin!", "waste_basket"),
        ("FIRE HYDRANT", "fire_hydrant"),
        ("Where are the nearest benches?", "bench"),
        ("could you please find me an ATM", "atm"),
        ("Take me to the café", "cafe"),
        ("I’m looking for a children’s playground", "playground"),
    ],
)
def test_a_noun_is_an_object_of_level_1(text, class_name):
    spec = read_goal(text)
    assert (spec.level, spec.class_names) == (1, (class_name,))


@pytest.mark.parametrize("item", OBJECT_CLASSES.values(), ids=lambda item: item.name)
def test_every_class_can_be_asked_for_by_its_own_name(item):
    for said in (item.noun, item.plural):
        assert item.name in read_goal(f"Find me {said}").class_names


@pytest.mark.parametrize(
    ("text", "relation", "classes", "distance_m", "negated"),
    [
        ("a bench near a trash can", Relation.NEAR, ("waste_basket",), NEAR_M, False),
        ("a bench with a fountain next to it", Relation.NEAR, ("fountain",), NEAR_M, False),
        ("a bench away from the fountain", Relation.NEAR, ("fountain",), AWAY_M, True),
        ("a bench without a trash can nearby", Relation.NEAR, ("waste_basket",), NEAR_M, True),
        ("a bench within 12 m of a fountain", Relation.NEAR, ("fountain",), 12.0, False),
        ("a bench less than 8.5 metres from a fountain", Relation.NEAR, ("fountain",), 8.5, False),
        ("a bench more than 20m from a bus stop", Relation.NEAR, ("bus_stop",), 20.0, True),
        ("a bench beneath a tree", Relation.UNDER, ("tree",), NEAR_M, False),
        ("near a fountain, find me a bench", Relation.NEAR, ("fountain",), NEAR_M, False),
        ("a bench near a kiosk or a cafe", Relation.NEAR, ("cafe", "kiosk"), NEAR_M, False),
    ],
)
def test_a_relation_is_a_condition_of_level_2(text, relation, classes, distance_m, negated):
    condition = only_condition(text)
    assert (condition.relation, condition.classes) == (relation, classes)
    assert (condition.distance_m, condition.negated) == (distance_m, negated)
    assert read_goal(text).level == 2


def test_two_relations_must_both_hold():
    (item,) = read_goal("a bench under a tree and near a fountain and a kiosk").sought
    assert [c.classes for c in item.conditions] == [("tree",), ("fountain",), ("kiosk",)]


def test_not_on_the_grass_is_about_the_bench_or_the_way_by_its_place():
    assert only_condition("a bench not on the grass").negated
    assert read_goal("find a bench, not on the grass").shunned == {Ground.GRASS}


@pytest.mark.parametrize(
    ("text", "shunned"),
    [
        ("find a bench, avoid the grass", {Ground.GRASS}),
        ("find a bench but do not walk on the road or the lawn", {Ground.ROAD, Ground.GRASS}),
        ("find a bench without crossing the street", {Ground.ROAD}),
        ("keep off the flower beds and find a bench", {Ground.GARDEN}),
        ("never step on the grass and find me a bench", {Ground.GRASS}),
        ("find a bench, but don't take the stairs", {Ground.STEPS}),
    ],
)
def test_ground_to_keep_off(text, shunned):
    spec = read_goal(text)
    assert (spec.level, set(spec.shunned), set(spec.wanted)) == (3, shunned, set())


@pytest.mark.parametrize(
    "text",
    [
        "Find me a fire hydrant, but stay on the road",
        "stay on the road until you find a fire hydrant",
        "find a hydrant without leaving the road",
        "keep strictly to the street and look for a hydrant",
    ],
)
def test_ground_to_stay_on(text):
    spec = read_goal(text)
    assert spec.class_names == ("fire_hydrant",)
    assert spec.wanted == {Ground.ROAD, Ground.CYCLEWAY, Ground.PARKING}


def test_a_narrower_word_takes_away_from_a_wider_one():
    spec = read_goal("stay on the paths, but not on the steps, and find a bench")
    assert Ground.STEPS not in spec.wanted
    assert spec.shunned == {Ground.STEPS}


def test_an_abstraction_is_of_level_4_and_keeps_its_conditions():
    spec = read_goal("Find me somewhere to sit under a tree, but avoid the road")
    assert (spec.level, spec.affordance, spec.shunned) == (4, "sit", {Ground.ROAD})
    assert all(item.conditions[-1].classes == ("tree",) for item in spec.sought)


def test_a_thing_named_for_a_purpose_is_graded_by_the_purpose():
    spec = read_goal("find me a bench where I can have a picnic")
    assert {item.class_name for item in spec.sought} == {"bench"}
    assert sorted(item.grade for item in spec.sought) == [1, 2]


def test_a_quiet_bench_is_away_from_roads():
    condition = only_condition("find me a quiet bench")
    assert (condition.grounds, condition.distance_m, condition.negated) == ((Ground.ROAD,), 15.0, True)


def test_a_tennis_court_is_a_pitch_with_an_attribute():
    (item,) = read_goal("find a tennis court").sought
    assert (item.class_name, item.attributes[0].key) == ("pitch", "sport")


def test_a_thing_may_be_called_by_its_name():
    (item,) = read_goal("Find me the fountain called Fischbrunnen, avoid the grass").sought
    assert item.attributes[0].values == ("fischbrunnen",)


def test_alternatives_are_all_sought():
    assert read_goal("find a bench or a picnic table").class_names == ("bench", "picnic_table")


def test_what_is_not_graded_is_told():
    assert read_goal("find a red bench").unread == ("red",)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("   ", "empty"),
        ("?!", "nothing that the judge can recognise"),
        ("asdf qwer", "nothing that the judge can recognise"),
        ("find me a bencj", "did you mean bench"),
        ("stay on the road", "nothing that the judge can recognise"),
        ("find me a car park", "is ground"),
        ("find a bench and a fountain", "several things"),
        ("somewhere to eat and take a nap", "two things"),
        ("a bench behind the church", "behind"),
        ("a bench on the other side of the road", "not understood"),
        ("a bench near a blorp", "'blorp' is not known"),
        ("find a bench, avoid the lava", "is no ground"),
        ("find a bench, keep away from the people", "is no ground"),
        ("stay on the grass and avoid the grass and find a bench", "both to be kept to and to be avoided"),
        ("a bench within 500 m of a tree", "up to 100 m"),
        ("a bench under the road", "under ground"),
        ("bench " * 80, "at most 300"),
    ],
)
def test_what_cannot_be_graded_is_refused_with_the_reason(text, told):
    with pytest.raises(GoalError) as caught:
        read_goal(text)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Find me a bench near", "'near' what"),
        ("Find me a bench next to the", "'next to' what"),
        ("Find me a bench near, avoid the grass", "'near' what"),
        ("Find me a bench that is near", "'that is near' what"),
        ("Find me a bench with", "'with' what"),
        ("somewhere to take a nap near", "'near' what"),
        ("Find me a bench behind the", "'behind' what"),
        ("Find me a bench for", "'for' what"),
        ("Find me a bench and", "'and' what"),
        ("Find me a bench but not", "'but not' what"),
        ("Find me a bench, follow", "'follow' what"),
    ],
)
def test_a_sentence_that_breaks_off_is_refused(text, told):
    with pytest.raises(GoalError, match="nothing follows") as caught:
        read_goal(text)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["something to sit on", "somewhere I can sit in", "is there a bench around", "a bench outside", "a bench near me",
     "a bench with a tree near", "a bench in a quiet place", "a bench with armrests", "a bench that I can use"],
)  # fmt: skip
def test_what_ends_in_a_preposition_may_be_whole(text):
    assert "bench" in read_goal(text).class_names


@pytest.mark.parametrize(
    "text",
    ["Don't find me a bench", "do not look for a bench", "Please don't show me a red bench", "I don't want a bench",
     "Find me no bench", "Find me anything but a bench", "something other than a bench", "a bench that is not a bench"],
)  # fmt: skip
def test_what_is_not_to_be_found_is_no_goal(text):
    with pytest.raises(GoalError, match="not to be found"):
        read_goal(text)


@pytest.mark.parametrize(
    "text", ["No, find me a bench", "I don't know where the bench is", "Don't worry, just find me a bench"]
)
def test_a_denial_of_something_else_is_none_of_the_goal(text):
    assert read_goal(text).class_names == ("bench",)


@pytest.mark.parametrize(
    "text",
    ["Find me a bench without a bench", "benches with no bench", "a bench near a tree and not near a tree",
     "a bench under a tree, away from trees", "a bench in the sun, in the shade", "a quiet bench near the road",
     "a bench with a backrest without a backrest", "stay on the grass but not on the grass and find a bench",
     "a bench within 10 m of a kiosk and more than 20 m from a kiosk"],
)  # fmt: skip
def test_what_contradicts_itself_is_refused(text):
    with pytest.raises(GoalError, match=r"one of the two"):
        read_goal(text)


@pytest.mark.parametrize(
    "text",
    ["a bench without other benches nearby", "a bench without a bench nearby", "a bench away from the benches",
     "a bench near a tree but not under a tree", "a bench within 20 m of a kiosk but not near a kiosk",
     "a tree not under a tree"],
)  # fmt: skip
def test_what_only_sounds_like_a_contradiction_is_read(text):
    assert read_goal(text).level == 2


def test_a_denied_relation_is_turned_round_whatever_stands_between():
    assert only_condition("a bench and not near a kiosk").negated
    assert only_condition("a bench not right next to a kiosk").negated
    assert only_condition("a bench, not very quiet") == replace(only_condition("a quiet bench"), negated=False)
    assert read_goal("I don't want to walk on the grass, find me a bench").shunned == {Ground.GRASS}


SENTENCES = sorted({s.rstrip(".!?") for g in goals() for s in g.sentences})


@settings(max_examples=100)
@given(st.sampled_from(SENTENCES), st.sampled_from([" next to", " near the", ", under", " but not", ", and"]))
def test_no_sentence_may_break_off(sentence, ending):
    with pytest.raises(GoalError):
        read_goal(sentence + ending)


@pytest.mark.parametrize("item", OBJECT_CLASSES.values(), ids=lambda item: item.name)
def test_nothing_is_sought_without_itself_or_against_ones_wish(item):
    for text in (
        f"Find a {item.noun} without a {item.noun}",
        f"Don't find a {item.noun}",
        f"I don't need {item.plural}",
    ):
        with pytest.raises(GoalError):
            read_goal(text)


def test_several_faults_are_told_at_once():
    with pytest.raises(GoalError) as caught:
        read_goal("find a bench near a blorp, avoid the lava")
    assert len(caught.value.faults) == 2


def test_what_is_no_text_is_refused():
    with pytest.raises(GoalError, match="it is int"):
        read_goal(3)


@settings(max_examples=100)
@given(st.text(max_size=120))
def test_any_text_is_read_or_refused(text):
    try:
        spec = read_goal(text)
    except GoalError:
        return
    assert spec.class_names


@settings(max_examples=100)
@given(st.lists(st.sampled_from(sorted({w for g in goals() for s in g.sentences for w in s.split()})), max_size=14))
def test_any_heap_of_known_words_is_read_or_refused(heap):
    try:
        spec = read_goal(" ".join(heap))
    except GoalError:
        return
    assert spec.class_names
    assert not spec.wanted & spec.shunned


_JOINTS = ("not", "don't", "without", "near", "under", "and", "or", ",", "no", "except", "other than", "but", "avoid",
           "stay on", "the bench", "a tree", "the grass", "find me", "quiet", "in the sun", "the", "me", "nearby",
           "within 10 m of", "anything but", "to", "behind")  # fmt: skip


@settings(max_examples=300)
@given(st.lists(st.sampled_from(_JOINTS), max_size=10))
def test_any_heap_of_joints_is_read_without_contradiction_or_refused(heap):
    try:
        spec = read_goal(" ".join(heap))
    except GoalError:
        return
    assert spec.class_names
    assert not any(contradictions(row.conditions, row.attributes) for row in spec.sought)


@settings(max_examples=50)
@given(st.sampled_from([s for g in goals() for s in g.sentences]), st.sampled_from([str.upper, str.lower, str.title]))
def test_case_and_spaces_do_not_matter(sentence, change):
    there, here = read_goal(sentence), read_goal("  " + change(sentence).replace(" ", "   ") + " ")
    assert (there.sought, there.wanted, there.shunned) == (here.sought, here.wanted, here.shunned)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("Find me a fountian", "fountain"),
        ("Find me a fire hydrent", "fire hydrant"),
        ("find a trahs can near a tree", "trash can"),
        ("find me a mailbx", "mailbox"),
        ("find me a bench near a fountian", "fountain"),
        ("find me somewhere to take a napp", "nap"),
    ],
)
def test_a_slip_of_the_finger_is_answered_with_what_was_meant(text, meant):
    with pytest.raises(GoalError) as caught:
        read_goal(text)
    assert f"did you mean {meant}" in str(caught.value)
    assert len(str(caught.value)) < 350


def test_what_is_known_is_told_by_a_few_examples():
    with pytest.raises(GoalError, match=r"bench, fountain, .* \(\d+ in all\)") as caught:
        read_goal("Find me a zebra")
    assert "did you mean" not in str(caught.value)
