"""One long-lived client for each endpoint and event loop, and one pacer for each model there.

A client that is made anew for every call is twenty times slower, and a limit is only kept by whoever sees all the
calls. Clients end with their event loop (`loop.shutdown_asyncgens`, which `asyncio.run` calls), or with the process.
"""

import asyncio
import atexit
import contextlib
from collections.abc import AsyncGenerator
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

from reasoned_explorer.calls.endpoint import Endpoint
from reasoned_explorer.calls.pacing import Limits, Pacer
from reasoned_explorer.model import MissingDependencyError

_GOODBYE_S = 1.0
_NO_KEY = "none"  # the SDK insists on one; servers on this machine do not care


@dataclass(eq=False, slots=True)
class Connection:
    """A client and what is known of how fast it may ask.

    Attributes:
        client: ``openai.AsyncOpenAI``.
    """

    client: Any
    _pacers: dict[tuple[str, Limits], Pacer] = field(default_factory=dict)
    _end: AsyncGenerator[None, None] | None = None

    def pacer(self, model: str, limits: Limits) -> Pacer:
        """Return the pacer of a model: everybody who asks it waits in the same line."""
        pacer = self._pacers.get((model, limits))
        if pacer is None:
            pacer = self._pacers[model, limits] = Pacer(limits)
        return pacer

    async def aclose(self) -> None:
        """Close the client."""
        if self._end is not None:
            await self._end.aclose()


_CONNECTIONS: WeakKeyDictionary[asyncio.AbstractEventLoop, dict[Endpoint, Connection]] = WeakKeyDictionary()


def check_sdk() -> None:
    """Refuse to go on without the SDK.

    Raises:
        MissingDependencyError: If ``openai`` or its ``aiohttp`` backend is not installed.
    """
    try:
        import aiohttp
        import openai
    except ImportError:
        raise MissingDependencyError(
            "asking an OpenAI-compatible endpoint", "openai", "pip install 'reasoned-explorer[openai]'"
        ) from None
    del aiohttp, openai


async def connection_to(endpoint: Endpoint) -> Connection:
    """Return the connection to an endpoint from the event loop that runs, made when it is first asked for."""
    connections = _CONNECTIONS.setdefault(asyncio.get_running_loop(), {})
    connection = connections.get(endpoint)
    if connection is None:
        connection = connections[endpoint] = Connection(_client(endpoint))
        connection._end = _until_the_end(endpoint, connections, connection.client)
        await anext(connection._end)
    return connection


def _client(endpoint: Endpoint) -> Any:
    from openai import AsyncOpenAI, DefaultAioHttpClient

    client = AsyncOpenAI(
        api_key=endpoint.key() or _NO_KEY,
        base_url=endpoint.base_url,
        max_retries=0,  # retried here, where the deadline and the pace are known: the SDK's time-outs multiply
        # A redirect would carry pictures to a place that nobody agreed to; and what goes to this machine must not
        # take the way over a proxy.
        http_client=DefaultAioHttpClient(follow_redirects=False, trust_env=not endpoint.is_local),
    )
    if not endpoint.is_openai:
        # Taken from the environment by the SDK; nobody else's business.
        client.organization = client.project = None
    return client


async def _until_the_end(
    endpoint: Endpoint, connections: dict[Endpoint, Connection], client: Any
) -> AsyncGenerator[None, None]:  # fmt: skip
    try:
        yield
    finally:
        connections.pop(endpoint, None)
        await client.close()


@atexit.register
def _close_all() -> None:
    """Close what is left in loops that still run in threads of their own."""
    for loop, connections in list(_CONNECTIONS.items()):
        for connection in list(connections.values()):
            with contextlib.suppress(Exception):
                if loop.is_running():
                    asyncio.run_coroutine_threadsafe(connection.aclose(), loop).result(_GOODBYE_S)
                elif not loop.is_closed():
                    loop.run_until_complete(connection.aclose())
