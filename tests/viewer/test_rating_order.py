"""The order in which raters see missions, and the names that missions have there."""

import secrets
from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.viewer.rating_order import BLOCK, Rateable, item_ids, order_for

METHODS = ("llm-rrt", "llm-as-eval", "nearest-frontier")
RUN = [
    Rateable(("drone", method, f"park:{number}|{level}{number:03d}"), level)
    for method in METHODS
    for level in (1, 2, 3, 4)
    for number in range(15)
]
names = st.text(min_size=1, max_size=20)
runs = st.lists(
    st.builds(
        lambda method, mission, level: Rateable(("drone", method, mission), level),
        st.sampled_from(METHODS),
        st.text(max_size=6),
        st.integers(1, 4),
    ),
    unique_by=lambda one: one.key,
    max_size=60,
)


@given(names, runs, st.integers(-5, 5), st.randoms(use_true_random=False))
def test_every_mission_comes_once_and_the_order_of_rows_does_not_matter(rater, run, seed, luck) -> None:  # type: ignore[no-untyped-def]
    order = order_for(rater, run, seed=seed)
    assert sorted(one.key for one in order) == sorted(one.key for one in run)
    turned = list(run)
    luck.shuffle(turned)
    assert order_for(rater, turned, seed=seed) == order


@given(names, names)
def test_each_rater_has_an_order_of_their_own(one: str, other: str) -> None:
    assert (order_for(one, RUN, seed=0) == order_for(other, RUN, seed=0)) == (one == other)


def test_another_seed_makes_another_order() -> None:
    assert order_for("Ann", RUN, seed=0) != order_for("Ann", RUN, seed=1)
    assert order_for("Ann", RUN, seed=1) == order_for("Ann", RUN, seed=1)


def test_who_stops_early_has_seen_of_all_methods_and_levels_alike() -> None:
    strata = len(METHODS) * 4
    block = strata * 2  # the least number of whole rounds with 20 missions
    assert block >= BLOCK
    for seen in (block, 2 * block, 3 * block):
        counts = Counter(one.stratum for one in order_for("Ann", RUN, seed=3)[:seen])
        assert set(counts.values()) == {seen // strata}


def test_who_stops_early_has_seen_what_others_who_stopped_early_have_seen() -> None:
    ann, bob = (order_for(name, RUN, seed=3)[:48] for name in ("Ann", "Bob"))
    assert ann != bob
    assert set(ann) == set(bob)


@given(st.integers(1, 200))
def test_a_count_gives_all_raters_the_same_missions_of_each_kind_alike(count: int) -> None:
    ann, bob = (order_for(name, RUN, seed=3, count=count) for name in ("Ann", "Bob"))
    assert set(ann) == set(bob)
    assert len(ann) == min(count, len(RUN))
    counts = Counter(one.stratum for one in ann)
    if count >= 12:
        assert max(counts.values()) - min(counts.values()) <= 1


def test_names_tell_nothing_of_the_method_to_who_has_not_the_key() -> None:
    secret = secrets.token_bytes(32)
    ids = item_ids([one.key for one in RUN], secret)
    assert list(ids.values()) == [one.key for one in RUN]
    assert all(set(name) <= set("0123456789abcdef") and len(name) == 32 for name in ids)
    assert not set(ids) & set(item_ids([one.key for one in RUN], secrets.token_bytes(32)))
    assert item_ids([one.key for one in RUN], secret) == ids


def test_parts_of_keys_do_not_run_into_each_other() -> None:
    ids = item_ids([("drone", "ab", "c"), ("drone", "a", "bc")], b"key")
    assert len(ids) == 2
