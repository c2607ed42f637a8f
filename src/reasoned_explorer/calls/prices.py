"""What a call costs, from a table with dates and sources. A price that is not known is unknown, never 0."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from reasoned_explorer.calls.endpoint import Endpoint
from reasoned_explorer.model import Fault, SettingsError


@dataclass(frozen=True, slots=True)
class Price:
    """What a model costs.

    Attributes:
        usd_per_million_in: US dollars for a million tokens that are sent.
        usd_per_million_out: Likewise for what comes back.
        as_of: The day for which the source was seen to say so; None where nothing is paid.
        source: Where it stands.
    """

    usd_per_million_in: float
    usd_per_million_out: float
    as_of: date | None
    source: str

    @property
    def is_free(self) -> bool:
        """Whether nothing is paid."""
        return self.usd_per_million_in == 0.0 and self.usd_per_million_out == 0.0

    def usd(self, tokens_in: int, tokens_out: int) -> float:
        """Return what so many tokens cost, US dollars."""
        return (tokens_in * self.usd_per_million_in + tokens_out * self.usd_per_million_out) / 1e6


OWN_MACHINE = Price(0.0, 0.0, None, "runs on this machine")


#: A name or an address, without scheme, port or path.
_HOST = r"^([^/:\s]+|[0-9A-Fa-f:]*:[0-9A-Fa-f:]*:[0-9A-Fa-f:.]*)$"


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    host: str = Field(min_length=1, pattern=_HOST)
    model: str = Field(min_length=1)
    usd_per_million_in: float = Field(ge=0.0, allow_inf_nan=False, strict=True)
    usd_per_million_out: float = Field(ge=0.0, allow_inf_nan=False, strict=True)
    as_of: date
    source: str = Field(min_length=1)


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    price: list[_Entry]


class PriceTable:
    """Prices by host and model.

    Args:
        prices: Of each (host, model).
    """

    def __init__(self, prices: dict[tuple[str, str], Price]) -> None:
        self._prices = dict(prices)

    def __len__(self) -> int:
        return len(self._prices)

    def price_of(self, model: str, endpoint: Endpoint) -> Price | None:
        """Return the price of a model, or None where it is not known; on this machine 0 where no other is given."""
        return self._prices.get((endpoint.host, model), OWN_MACHINE if endpoint.is_local else None)

    def over(self, other: "PriceTable") -> "PriceTable":
        """Return a table in which these prices go before another's."""
        return PriceTable({**other._prices, **self._prices})


@cache
def known_prices() -> PriceTable:
    """Return the table that comes with this package."""
    return _read(files("reasoned_explorer.calls").joinpath("prices.toml").read_text("utf-8"), "prices.toml")


def read_prices(path: Path) -> PriceTable:
    """Return a table from a file of the same form as the one that comes with this package, over that one.

    Raises:
        SettingsError: If the file cannot be read or holds anything else, with all its faults.
    """
    try:
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError("prices", [Fault(f"{path} cannot be read: {error}", "a TOML file")]) from error
    return _read(text, str(path)).over(known_prices())


def _read(text: str, name: str) -> PriceTable:
    expected = (
        "[[price]] with host (without scheme and port), model, usd_per_million_in, usd_per_million_out, "
        "as_of and source"
    )
    try:
        plain = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SettingsError("prices", [Fault(f"{name}: {error}", expected)]) from error
    faults, entries = [], list[_Entry]()
    try:
        entries = _Table.model_validate(plain).price
    except ValidationError as error:
        faults = [
            Fault(f"{name}: {'.'.join(map(str, each['loc']))}: {each['msg']}", expected) for each in error.errors()
        ]
    faults += _named_again(plain, name)
    if faults:
        raise SettingsError("prices", faults)
    return PriceTable(
        {
            (each.host.lower(), each.model): Price(
                each.usd_per_million_in, each.usd_per_million_out, each.as_of, each.source
            )
            for each in entries
        }
    )


def _named_again(plain: Mapping[str, Any], name: str) -> list[Fault]:
    """Return a fault for each entry whose host and model an earlier one names, whatever else is wrong with them."""
    listed = plain.get("price")
    first: dict[tuple[str, str], int] = {}
    faults = []
    for place, each in enumerate(listed if isinstance(listed, list) else []):
        host, model = (each.get("host"), each.get("model")) if isinstance(each, dict) else (None, None)
        if not isinstance(host, str) or not isinstance(model, str):
            continue
        earlier = first.setdefault((host.lower(), model), place)
        if earlier != place:
            what = f"{name}: price.{place}: {model} at {host} has a price already, price.{earlier}"
            faults.append(Fault(what, "one price for a model of a host"))
    return faults
