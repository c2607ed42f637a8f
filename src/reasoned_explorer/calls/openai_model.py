"""Models behind an endpoint that speaks OpenAI's chat completions: OpenAI, vLLM, llama.cpp, Ollama, LM Studio, others.

Whatever goes wrong at the other end becomes a fault of the answer: its kind, a colon and what is known. Kinds are
those of `completion.read_completion` and

==================  ============================================================
``timeout``         no answer in time; tried again
``connection``      it broke or could not be made; tried again
``server error``    5xx; tried again
``rate limit``      no turn came within the patience of the settings
``quota``           the account has nothing left
``no access``       401 or 403: the key is missing, wrong or not allowed to
``redirected``      3xx: nothing is sent to another place than the one agreed to
``rejected``        any other 4xx
==================  ============================================================
"""

import asyncio
import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.completion import Reading, parameters, read_completion, shortened, words_of_error
from reasoned_explorer.calls.connections import Connection, check_sdk, connection_to
from reasoned_explorer.calls.decisions import decision_parameters, read_decision
from reasoned_explorer.calls.endpoint import AskingSettings, Endpoint, Structure, endpoint_at
from reasoned_explorer.calls.pacing import NoTurnError, Sign
from reasoned_explorer.calls.prices import Price, PriceTable, known_prices
from reasoned_explorer.model import Fault, SettingsError

PREFIX = "openai:"
_OPTIONAL = ("temperature", "seed", "top_logprobs", "logprobs", "response_format")
_LONGEST_BACK_OFF_S = 8.0
_EMPTY_TRIES = 2  # a model that said nothing is likely to do so again; a server that stumbled is not
_TOKENS_A_PICTURE = 300.0  # a guess, used only until the server has told what such calls take
_OVERLOADED = {408, 503, 504, 529}
_CANNOT_READ = {400, 422, 500}  # what servers answer where the model's own template refuses what it is given


@dataclass(frozen=True, slots=True)
class _End:
    """How one try ended."""

    sign: Sign
    fault: str | None = None
    again: bool = False
    headers: Mapping[str, str] = field(default_factory=dict)
    body: bytes | None = None
    refused_parameter: str | None = None
    cannot_read: bool = False


@dataclass(slots=True)
class _Spent:
    tokens_in: int = 0
    tokens_out: int = 0
    asked: int = 0
    tries: int = 0
    uncounted: bool = False
    empty: int = 0

    def add(self, reading: Reading) -> None:
        self.tokens_in += reading.tokens_in
        self.tokens_out += reading.tokens_out
        self.uncounted |= not reading.counted


class OpenAIModel:
    """Asks one model of one endpoint. Any number of calls may be under way; they share a client and a pace.

    Args:
        model: By the server's name.
        endpoint: Where it is.
        settings: How it is asked.
        price: What it costs, or None where that is not known.

    Attributes:
        name: As typed, e.g. ``"openai:gpt-4o-mini"``.
        fingerprint: What decides its answers beside the request.
        is_local: Whether it is on this machine.
        endpoint: Where it is.
        price: What it costs, or None.

    Raises:
        MissingDependencyError: If the SDK is not installed.
    """

    def __init__(
        self, model: str, endpoint: Endpoint, *, settings: AskingSettings | None = None, price: Price | None = None
    ) -> None:
        check_sdk()
        self._model = model
        self._settings = settings or AskingSettings()
        self.endpoint = endpoint
        self.price = price
        self.name = PREFIX + model
        self.fingerprint = f"{self.name} at {endpoint.base_url} form {self._settings.structure}"
        self.is_local = endpoint.is_local
        self._without: frozenset[str] = frozenset()
        # Of the model, by its template: Gemma 2 knows none, and what is sent with one is an error. None: not yet known.
        self._knows_system: bool | None = None
        self._length_name = "max_completion_tokens" if endpoint.is_openai else "max_tokens"
        self._usual_tokens: dict[str, float] = {}

    def __repr__(self) -> str:
        return f"OpenAIModel({self.fingerprint!r})"

    @property
    def structure(self) -> Structure:
        """How the form of an answer is asked for."""
        return self._settings.structure

    @property
    def left_out(self) -> frozenset[str]:
        """Parameters that the server refused and that are left out since, such as the seed of models without one."""
        return self._without

    def asking(self, structure: Structure, *, most_at_once: int | None = None) -> "OpenAIModel":
        """Return the same model, asked for the form of its answers in another way, with the same client.

        Args:
            structure: How the form is asked for.
            most_at_once: At most so many calls at once; None for as many as before, with which the pace is shared, too.
        """
        limits = self._settings.limits
        if most_at_once is not None:
            limits = replace(limits, most_at_once=min(most_at_once, limits.most_at_once))
        settings = replace(self._settings, structure=structure, limits=limits)
        other = OpenAIModel(self._model, self.endpoint, settings=settings, price=self.price)
        other._without, other._length_name = self._without - {"response_format"}, self._length_name
        other._knows_system = self._knows_system
        return other

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer. Whatever goes wrong at the other end is a fault in it."""
        connection = await connection_to(self.endpoint)
        pacer = connection.pacer(self._model, self._settings.limits)
        loop = asyncio.get_running_loop()
        settings, spent = self._settings, _Spent()
        left_s, patience_s, turned_away = settings.deadline_s, settings.patience_s, False
        knows_system = self._knows_system is not False
        while True:
            expected = self._expected_tokens(request)
            asked_s = loop.time()
            try:
                ticket = await pacer.turn(tokens=expected, patience_s=patience_s, again=turned_away)
            except NoTurnError as error:
                return self._given_up(spent, f"rate limit: {error}")
            began_s = loop.time()
            end, reading = _End(Sign.NEUTRAL), None
            spent.asked += 1
            try:
                end = await self._try(connection, request, min(settings.try_s, left_s), knows_system=knows_system)
                reading = self._read(request, end, spent)
            finally:
                taken = reading.tokens_in + reading.tokens_out if reading is not None else None
                pacer.done(ticket, end.sign, tokens=taken, headers=end.headers)
            turned_away = end.sign is Sign.LIMITED
            if turned_away:
                patience_s -= loop.time() - asked_s
                if patience_s <= 0.0:  # a server that says "at once" and does not mean it
                    return self._given_up(spent, end.fault or "")
                continue
            patience_s -= began_s - asked_s
            left_s -= loop.time() - began_s
            if self._learned(end) and left_s > 0.0:
                continue
            spent.tries += 1
            if reading is not None and request.system:
                self._knows_system = knows_system
            if reading is not None and reading.fault is None:
                return self._answer(spent, reading)
            fault = end.fault or (reading.fault if reading is not None else None) or ""
            again = end.again or (reading is not None and reading.again and spent.empty < _EMPTY_TRIES)
            # Spread, so that what failed together is not tried again together.
            wait_s = min(_LONGEST_BACK_OFF_S, settings.back_off_s * 2.0 ** (spent.tries - 1)) * random.uniform(0.75, 1)
            if not again or spent.tries >= settings.tries or left_s <= wait_s:
                # Nothing that had a system was ever answered: perhaps the model knows none, as Gemma 2.
                may_know_none = end.cannot_read and request.system and knows_system and self._knows_system is None
                wait_s = settings.back_off_s  # a server that failed may be closing the connection
                if not may_know_none or left_s <= wait_s:
                    return self._given_up(spent, fault, reading)
                knows_system = False
            left_s -= wait_s
            await asyncio.sleep(wait_s)

    async def _try(self, connection: Connection, request: ChatRequest, within_s: float, *, knows_system: bool) -> _End:
        from aiohttp import ClientError
        from httpx2 import HTTPError, Response
        from openai import APIConnectionError, APIStatusError, OpenAIError

        if request.questions:
            path, sent = "/decisions", decision_parameters(request, self._model)
        else:
            path = "/chat/completions"
            sent = parameters(
                request,
                self._model,
                structure=self._settings.structure,
                length_name=self._length_name,
                without=self._without,
                knows_system=knows_system,
            )
        try:
            async with asyncio.timeout(within_s):
                # Not `chat.completions.create`: it walks over all that is sent with its types at hand, which takes as
                # long as everything else together, and nothing here has to be transformed.
                response = await connection.client.post(
                    path, cast_to=Response, body=sent, options={"timeout": within_s + 1.0}
                )
                return _End(Sign.ANSWERED, headers=response.headers, body=response.content)
        except TimeoutError:
            return _End(Sign.OVERLOADED, f"timeout: no answer within {within_s:.0f} s", again=True)
        except APIStatusError as error:
            return self._refusal(error)
        except APIConnectionError as error:
            cause = _innermost(error)
            return _End(Sign.NEUTRAL, self._fault("connection", type(cause).__name__, str(cause)), again=True)
        except (OpenAIError, ClientError, HTTPError, OSError, ValueError) as error:
            # What came is not even HTTP; the SDK lets through what its backend says of it.
            cause = _innermost(error)
            return _End(Sign.NEUTRAL, self._fault("malformed", type(cause).__name__, str(cause)), again=True)

    def _refusal(self, error: Any) -> _End:
        status, headers = int(error.status_code), error.response.headers
        detail = f"status {status}", words_of_error(error.body)
        if status == 429:
            if error.code == "insufficient_quota":
                return _End(Sign.NEUTRAL, self._fault("quota", *detail), headers=headers)
            return _End(Sign.LIMITED, self._fault("rate limit", *detail), again=True, headers=headers)
        if status >= 500 or status in {408, 409}:
            sign = Sign.OVERLOADED if status in _OVERLOADED else Sign.NEUTRAL
            fault = self._fault("server error", *detail)
            return _End(sign, fault, again=True, headers=headers, cannot_read=status in _CANNOT_READ)
        if status in {401, 403}:
            return _End(Sign.NEUTRAL, self._fault("no access", *detail))
        if status < 400:
            return _End(Sign.NEUTRAL, self._fault("redirected", f"status {status}", ""))
        fault, refused = self._fault("rejected", *detail), _refused(error)
        if status == 404 and self.endpoint.usual_url is not None:
            fault = f"{fault}; did you mean {self.endpoint.usual_url}?"
        return _End(Sign.NEUTRAL, fault, refused_parameter=refused, cannot_read=status in _CANNOT_READ)

    def _fault(self, kind: str, what: str, detail: str) -> str:
        text = shortened(self.endpoint.scrub(detail))
        return f"{kind}: {what}: {text}" if text else f"{kind}: {what}"

    def _read(self, request: ChatRequest, end: _End, spent: _Spent) -> Reading | None:
        if end.body is None:
            return None
        wants_structure = request.schema is not None and self._settings.structure != "none"
        if request.questions:
            reading = read_decision(end.body, request.questions)
        else:
            reading = read_completion(end.body, wants_structure=wants_structure)
        if reading.fault is not None:
            reading = replace(reading, fault=self.endpoint.scrub(reading.fault))
        spent.add(reading)
        spent.empty += reading.fault is not None and reading.fault.startswith("empty")
        if reading.counted:
            taken = float(reading.tokens_in + reading.tokens_out)
            self._usual_tokens[request.prompt] = 0.8 * self._usual_tokens.get(request.prompt, taken) + 0.2 * taken
        return reading

    def _learned(self, end: _End) -> bool:
        """Leave out what the server does not want, and say whether that makes another try worth while."""
        name = end.refused_parameter
        if name == "max_tokens" and self._length_name == name:
            self._length_name = "max_completion_tokens"
            return True
        if name not in _OPTIONAL or name in self._without:
            return False
        both = {"logprobs", "top_logprobs"}
        self._without |= both if name in both else {name}
        return True

    def _expected_tokens(self, request: ChatRequest) -> float:
        usual = self._usual_tokens.get(request.prompt)
        if usual is not None:
            return usual
        letters = len(request.system) + len(request.user)
        return letters / 4.0 + _TOKENS_A_PICTURE * len(request.images) + request.max_tokens / 2.0

    def _answer(self, spent: _Spent, reading: Reading) -> ChatAnswer:
        return ChatAnswer(
            text=reading.text,
            fault=reading.fault,
            tokens_in=spent.tokens_in,
            tokens_out=spent.tokens_out,
            usd=self._usd(spent),
            retries=max(0, spent.asked - 1),
            model=reading.model,
            tokens=reading.tokens,
        )

    def _given_up(self, spent: _Spent, fault: str, reading: Reading | None = None) -> ChatAnswer:
        if spent.asked > 1:
            fault = f"{fault} (asked {spent.asked} times)"
        return self._answer(spent, replace(reading or Reading(), fault=fault))

    def _usd(self, spent: _Spent) -> float | None:
        if self.price is None:
            return None
        if spent.uncounted and not self.price.is_free:
            return None  # answered without a count: what it cost is not known
        return self.price.usd(spent.tokens_in, spent.tokens_out)


def openai_model(
    name: str,
    *,
    base_url: str | None = None,
    key_variable: str | None = None,
    settings: AskingSettings | None = None,
    prices: PriceTable | None = None,
) -> OpenAIModel:
    """Return the model of a name.

    Args:
        name: ``openai:MODEL``.
        base_url: Where it is; None for ``OPENAI_BASE_URL`` or OpenAI's own.
        key_variable: Environment variable that holds the key; None for ``OPENAI_API_KEY``.
        settings: How it is asked.
        prices: What models cost; None for the table that comes with this package.

    Raises:
        SettingsError: If the name or the address is none, or a key is missing.
        MissingDependencyError: If the SDK is not installed.
    """
    model = name.removeprefix(PREFIX).strip()
    if not name.startswith(PREFIX) or not model:
        raise SettingsError("model", [Fault(f"{name!r}", "openai:MODEL, e.g. openai:gpt-4o-mini")])
    endpoint = endpoint_at(base_url, key_variable=key_variable)
    price = (prices or known_prices()).price_of(model, endpoint)
    return OpenAIModel(model, endpoint, settings=settings, price=price)


def _refused(error: Any) -> str | None:
    """Return the parameter that a server does not want, where it says so."""
    names = ("max_tokens", *_OPTIONAL)
    if error.param in names:
        return str(error.param)
    message = words_of_error(error.body)
    return next((name for name in names if f"'{name}'" in message or f"`{name}`" in message), None)


def _innermost(error: BaseException) -> BaseException:
    while error.__cause__ is not None:
        error = error.__cause__
    return error
