from pathlib import Path

import pytest

from reasoned_explorer.calls.endpoint import Endpoint
from reasoned_explorer.calls.prices import known_prices, read_prices
from reasoned_explorer.model import SettingsError

OPENAI = Endpoint("https://api.openai.com/v1")
OWN = Endpoint("http://localhost:8000/v1")


def test_a_known_price_has_a_date_and_a_source() -> None:
    price = known_prices().price_of("gpt-4o-mini", OPENAI)
    assert price is not None
    assert price.as_of is not None
    assert "http" in price.source
    assert price.usd(1_000_000, 1_000_000) == pytest.approx(0.75)


@pytest.mark.parametrize("model", ["gpt-4o-mini-2024-07-18", "gpt-4o-min", "", "GPT-4O"])
def test_what_is_not_known_is_not_guessed(model: str) -> None:
    assert known_prices().price_of(model, OPENAI) is None


def test_the_same_model_at_another_host_has_no_known_price() -> None:
    assert known_prices().price_of("gpt-4o-mini", Endpoint("https://example.org/v1")) is None


def test_this_machine_costs_nothing() -> None:
    price = known_prices().price_of("whatever", OWN)
    assert price is not None
    assert price.is_free


TABLE = """
[[price]]
host = "example.org"
model = "m"
usd_per_million_in = 1
usd_per_million_out = 2.5
as_of = 2026-05-01
source = "the contract"
"""


def test_a_table_of_ones_own_goes_before_the_known_one(tmp_path: Path) -> None:
    file = tmp_path / "prices.toml"
    file.write_text(TABLE + TABLE.replace("example.org", "api.openai.com").replace('"m"', '"gpt-4o"'))
    prices = read_prices(file)
    assert prices.price_of("m", Endpoint("https://example.org/v1")) is not None
    changed, other = prices.price_of("gpt-4o", OPENAI), prices.price_of("gpt-4o-mini", OPENAI)
    assert changed is not None
    assert changed.source == "the contract"
    assert other == known_prices().price_of("gpt-4o-mini", OPENAI)


def test_all_that_is_wrong_with_a_table_is_told(tmp_path: Path) -> None:
    file = tmp_path / "prices.toml"
    file.write_text(TABLE.replace("= 1\n", "= -1\n").replace('source = "the contract"', "").replace("2.5", "nan"))
    with pytest.raises(SettingsError) as caught:
        read_prices(file)
    assert len(caught.value.faults) == 3
    assert "usd_per_million_in" in str(caught.value)


def test_a_price_in_quotes_and_a_second_price_are_told_together(tmp_path: Path) -> None:
    file = tmp_path / "prices.toml"
    again = TABLE.replace("example.org", "Example.ORG").replace("2.5", "'2.5'")
    file.write_text(TABLE.replace("= 1\n", "= '1'\n") + again)
    with pytest.raises(SettingsError) as caught:
        read_prices(file)
    said = [fault.what.removeprefix(f"{file}: ") for fault in caught.value.faults]
    assert [each.split(":")[0] for each in said] == [
        "price.0.usd_per_million_in",
        "price.1.usd_per_million_out",
        "price.1",
    ]
    assert said[-1] == "price.1: m at Example.ORG has a price already, price.0"


def test_models_of_other_hosts_may_have_the_same_name(tmp_path: Path) -> None:
    file = tmp_path / "prices.toml"
    file.write_text(TABLE + TABLE.replace("example.org", "example.com"))
    assert len(read_prices(file)) == len(known_prices()) + 2


@pytest.mark.parametrize("text", ["[[price", "price = 3", None])
def test_what_is_no_table_is_refused(tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "prices.toml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(SettingsError):
        read_prices(file)


@pytest.mark.parametrize("host", ["https://example.org", "example.org:8000", "example.org/v1", "127.0.0.1:8000", ""])
def test_a_host_is_named_without_scheme_port_and_path(tmp_path: Path, host: str) -> None:
    file = tmp_path / "prices.toml"
    file.write_text(TABLE.replace("example.org", host))
    with pytest.raises(SettingsError, match="without scheme and port"):
        read_prices(file)


def test_a_host_may_be_an_address(tmp_path: Path) -> None:
    file = tmp_path / "prices.toml"
    file.write_text(TABLE.replace("example.org", "::1") + TABLE.replace("example.org", "10.0.0.7"))
    prices = read_prices(file)
    assert prices.price_of("m", Endpoint("http://10.0.0.7:8000/v1")) is not None
    assert prices.price_of("m", Endpoint("http://[::1]:8000/v1")) is not None
