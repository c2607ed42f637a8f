"""Keys stand in the environment and nowhere else: whatever is written or shown goes through `scrub` first.

A server may repeat the key that it was sent in the text of its error; a proxy may put it into an address.
"""

import os
import re
from collections.abc import Iterable

from reasoned_explorer.calls.chat import ChatAnswer

#: Names of environment variables that hold keys, e.g. ``OPENAI_API_KEY``, ``HF_TOKEN``, ``AWS_SECRET_ACCESS_KEY``.
_SECRET_NAME = re.compile(r"(^|_)(API_?KEY|ACCESS_?KEY|KEY|TOKEN|SECRET|PASSWORD|PASSWD|CREDENTIALS?)$", re.IGNORECASE)
#: Shorter values are no keys ("none", "EMPTY", "sk-local"), and are found in ordinary text.
_SHORTEST = 9
HIDDEN = "[key hidden]"


def secrets() -> tuple[str, ...]:
    """Return the keys in the environment, longest first."""
    found = {value for name, value in os.environ.items() if len(value) >= _SHORTEST and _SECRET_NAME.search(name)}
    return tuple(sorted(found, key=lambda value: (-len(value), value)))


def scrub(text: str, keys: Iterable[str] | None = None) -> str:
    """Return a text without the keys in the environment, each replaced by ``[key hidden]``.

    Args:
        text: What is to be written or shown.
        keys: What to hide instead of `secrets`.
    """
    for key in secrets() if keys is None else keys:
        text = text.replace(key, HIDDEN)
    return text


def scrubbed(answer: ChatAnswer) -> ChatAnswer:
    """Return an answer without the keys in the environment; the same one where it holds none."""
    keys = secrets()
    texts = (answer.text, answer.fault or "", answer.model, *(place.token for place in answer.tokens))
    if not any(key in text for key in keys for text in texts):
        return answer
    return ChatAnswer(
        scrub(answer.text, keys),
        None if answer.fault is None else scrub(answer.fault, keys),
        answer.tokens_in,
        answer.tokens_out,
        answer.usd,
        answer.retries,
        scrub(answer.model, keys),
    )
