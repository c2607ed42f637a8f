import statistics

from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model.draws import choice, further, key_of, normal, normals, uniform

keys = st.lists(st.one_of(st.integers(-(2**40), 2**40), st.text(max_size=8)), max_size=5)


@given(st.integers(0, 2**63), keys)
def test_draws_depend_on_nothing_but_their_keys(seed: int, parts: list[int | str]) -> None:
    assert uniform(seed, *parts) == uniform(seed, *parts)
    assert 0.0 <= uniform(seed, *parts) < 1.0


def test_the_order_and_the_number_of_keys_matter() -> None:
    assert len({key_of(1), key_of(1, 0), key_of(1, 2, 3), key_of(1, 3, 2), key_of(2, 1, 3), key_of(1, "2", 3)}) == 6


def test_uniform_draws_fill_the_unit_interval_evenly() -> None:
    draws = [uniform(7, index) for index in range(20_000)]
    assert abs(statistics.mean(draws) - 0.5) < 0.01
    assert abs(statistics.pvariance(draws) - 1 / 12) < 0.002


def test_normal_draws_have_mean_zero_and_spread_one() -> None:
    draws = [normal(7, index) for index in range(20_000)]
    assert abs(statistics.mean(draws)) < 0.03
    assert abs(statistics.pstdev(draws) - 1.0) < 0.02


@given(st.integers(0, 2**63), st.lists(keys.map(tuple), max_size=8))
def test_many_normal_draws_are_those_of_each(seed: int, many: list[tuple[int | str, ...]]) -> None:
    again = [key for key in many for _ in range(2)]
    assert normals(seed, again) == [normal(seed, *key) for key in again]


@given(st.integers(0, 2**63), keys, st.integers(-(2**40), 2**40))
def test_a_key_goes_on(seed: int, parts: list[int | str], last: int) -> None:
    assert further(key_of(seed, *parts), last) == key_of(seed, *parts, last)


def test_every_option_is_chosen_sometimes() -> None:
    assert {choice("abc", 3, index) for index in range(50)} == set("abc")


def test_a_known_draw_stays_what_it_is() -> None:
    # Published results hang on these numbers: a change of the mixing function must not go unnoticed.
    assert f"{key_of(0, 1, 'hydrant'):016x}" == "feb8ec1204a50ab5"
