"""Where a model is asked: an address that speaks OpenAI's chat completions, and the key that it wants."""

import ipaddress
import math
import os
import re
from dataclasses import dataclass, field
from typing import Literal, get_args
from urllib.parse import urlsplit

from reasoned_explorer.calls.pacing import Limits
from reasoned_explorer.model import Fault, SettingsError

OPENAI_URL = "https://api.openai.com/v1"
OPENAI_HOST = "api.openai.com"
OPENAI_KEY = "OPENAI_API_KEY"

Structure = Literal["json_schema", "json_object", "none"]
"""How an answer's form is asked for: by its schema, as any JSON object, or in words only."""

_SECRETS = re.compile(r"\b(?:(?:sk|sess|rk|pk|gsk|xai|hf)[-_]|AIza)[A-Za-z0-9*._-]{5,}|(?i:bearer)\s+\S+")


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An address and the name of its key. The key itself is read when it is used and kept nowhere.

    Attributes:
        base_url: Without a slash at its end, e.g. ``http://localhost:8000/v1``.
        key_variable: Environment variable that holds the key, or None where none is sent.
    """

    base_url: str
    key_variable: str | None = None

    @property
    def host(self) -> str:
        """The name or number of the machine, lower case."""
        return (urlsplit(self.base_url).hostname or "").lower()

    @property
    def is_local(self) -> bool:
        """Whether it is on this machine: what is sent there stays here."""
        return _is_loopback(self.host)

    @property
    def is_openai(self) -> bool:
        """Whether it is OpenAI's own."""
        return self.host == OPENAI_HOST

    @property
    def usual_url(self) -> str | None:
        """The address with the ``/v1`` that servers usually want, or None where it has one."""
        return None if "/v1" in urlsplit(self.base_url).path else f"{self.base_url}/v1"

    def key(self) -> str | None:
        """Return the key, or None where none is set or sent."""
        return (os.environ.get(self.key_variable) or "").strip() or None if self.key_variable else None

    def scrub(self, text: str) -> str:
        """Return a text of the server without its key and without whatever looks like one."""
        key = self.key()
        if key is not None:
            text = text.replace(key, "***")
        return _SECRETS.sub("***", text)


def endpoint_at(base_url: str | None = None, *, key_variable: str | None = None) -> Endpoint:
    """Return the endpoint at an address.

    The key of ``OPENAI_API_KEY`` goes to OpenAI, to this machine, and to other machines over https. Over plain http it
    goes to another machine only where its variable is named, since everybody on the way can read it.

    Args:
        base_url: Up to and with ``/v1``; None for ``OPENAI_BASE_URL`` or, where that is not set, OpenAI's own.
        key_variable: Environment variable that holds the key; None for ``OPENAI_API_KEY``.

    Raises:
        SettingsError: If the address is none, or the key that OpenAI or a named variable should hold is missing.
    """
    if base_url is not None and not base_url.strip():
        # An unset variable of a shell, say: calls must not go elsewhere, where they may be paid.
        fault = Fault("the base URL is empty", "an address such as http://localhost:8000/v1", "or leave it out")
        raise SettingsError("endpoint", [fault])
    url = (base_url or os.environ.get("OPENAI_BASE_URL") or OPENAI_URL).strip().rstrip("/")
    faults = []
    try:
        parts = urlsplit(url)
        sound = parts.scheme in {"http", "https"} and bool(parts.hostname) and (parts.port or 1) > 0
        carries_secret = bool(parts.username or parts.password or parts.query)
    except ValueError:
        sound = carries_secret = False
    if carries_secret:
        # Not shown: it may hold a password.
        faults.append(Fault("the base URL holds a user, a password or a query", "an address alone", _KEY_ADVICE))
    elif not sound:
        faults.append(Fault(f"base URL {url!r}", "an address such as http://localhost:8000/v1"))
    if faults:
        raise SettingsError("endpoint", faults)
    endpoint = Endpoint(url, key_variable or OPENAI_KEY)
    if key_variable is None and parts.scheme == "http" and not endpoint.is_local:
        endpoint = Endpoint(url, None)
    if endpoint.key() is None and (endpoint.is_openai or key_variable is not None):
        variable = key_variable or OPENAI_KEY
        raise SettingsError("endpoint", [Fault(f"no key for {endpoint.host}", f"one in {variable}", _KEY_ADVICE)])
    return endpoint


_KEY_ADVICE = "set the key in the environment; it is taken from nowhere else"


def _is_loopback(host: str) -> bool:
    if host == "localhost" or host.endswith(".localhost"):
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True, slots=True)
class AskingSettings:
    """How an endpoint is asked.

    Attributes:
        deadline_s: At most so long for a call with all its tries and the waits between them; waiting for its turn
            under a rate limit does not count.
        try_s: At most so long for one try.
        tries: At most so many tries; being turned away by a rate limit is none.
        patience_s: At most so long in all for its turn under a rate limit.
        back_off_s: Wait after the first failed try, doubled with each, up to 8 s.
        limits: What is known of its limits.
        structure: How the form of an answer is asked for where a request has a schema.
    """

    deadline_s: float = 120.0
    try_s: float = 60.0
    tries: int = 5
    patience_s: float = 900.0
    back_off_s: float = 0.5
    limits: Limits = field(default_factory=Limits)
    structure: Structure = "json_schema"

    def __post_init__(self) -> None:
        """Check the ranges.

        Raises:
            SettingsError: If a setting is out of its range, with all that are.
        """
        limits = self.limits
        above_zero = {
            "deadline_s": self.deadline_s,
            "try_s": self.try_s,
            "patience_s": self.patience_s,
            "back_off_s": self.back_off_s,
            "requests_per_minute": limits.requests_per_minute,
            "tokens_per_minute": limits.tokens_per_minute,
        }
        faults = [
            Fault(f"{name} {value}", "a number above 0")
            for name, value in above_zero.items()
            if value is not None and not (math.isfinite(value) and value > 0.0)
        ]
        counts = {"tries": self.tries, "first_at_once": limits.first_at_once, "most_at_once": limits.most_at_once}
        faults += [Fault(f"{name} {value}", "1 or more") for name, value in counts.items() if value < 1]
        if self.structure not in get_args(Structure):
            faults.append(Fault(f"structure {self.structure!r}", f"one of {', '.join(get_args(Structure))}"))
        if faults:
            raise SettingsError("endpoint settings", faults)
