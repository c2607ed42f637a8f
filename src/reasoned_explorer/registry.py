"""Things that a person picks by name: registered by name, loaded when first used.

Built-in entries name the module and the object that hold them, so that listing costs no import. Other packages add
theirs through entry points of the group ``reasoned_explorer.<kind>`` (``planners``, ``minds``, ``captioners``,
``vehicles``, ``worlds``); the entry point's name is the name that people use.
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

from reasoned_explorer.model.errors import Fault, InputError, UnknownNameError


@dataclass(frozen=True, slots=True)
class Entry:
    """One registered name.

    Attributes:
        name: What people type.
        target: ``"module:attribute"`` of the factory.
        summary: One line for people.
        provider: The distribution that it comes from.
    """

    name: str
    target: str
    summary: str = ""
    provider: str = "reasoned-explorer"


class Registry:
    """The names of one kind.

    Args:
        kind: Singular, for messages: ``"planner"``.
        group: Plural, for entry points: ``"planners"``.
        builtin: The entries that this package brings.
        beside: What people may say instead of a registered name, for messages; may be empty.
    """

    def __init__(self, kind: str, group: str, builtin: tuple[Entry, ...], *, beside: str = "") -> None:
        self.kind = kind
        self._beside = beside
        self._group = f"reasoned_explorer.{group}"
        self._entries = {entry.name: entry for entry in builtin}
        self._searched = False

    def entries(self) -> tuple[Entry, ...]:
        """Return all entries, those of other packages included, sorted by name."""
        self._search()
        return tuple(self._entries[name] for name in sorted(self._entries))

    def names(self) -> tuple[str, ...]:
        """Return all names, sorted."""
        return tuple(entry.name for entry in self.entries())

    def load(self, name: str) -> Callable[..., Any]:
        """Return the factory that is registered under a name.

        Raises:
            UnknownNameError: If there is none; it names the near misses.
            InputError: If another package's entry cannot be imported.
        """
        if name not in self._entries:
            self._search()
        if name not in self._entries:
            raise UnknownNameError(self.kind, name, self.names(), beside=self._beside)
        entry = self._entries[name]
        module_name, _, attribute = entry.target.partition(":")
        try:
            factory = getattr(import_module(module_name), attribute)
        except (ImportError, AttributeError) as error:
            what = f"{name!r} from {entry.provider} cannot be loaded: {error}"
            raise InputError(self.kind, [Fault(what, f"{entry.target} to be importable")]) from error
        if not callable(factory):
            raise InputError(self.kind, [Fault(f"{entry.target} is {type(factory).__name__}", "a callable")])
        return factory  # type: ignore[no-any-return]

    def _search(self) -> None:
        if self._searched:
            return
        self._searched = True
        for point in entry_points(group=self._group):
            provider = point.dist.name if point.dist is not None else "unknown"
            # Built-in names cannot be taken over: a table's row must mean the same thing everywhere.
            self._entries.setdefault(point.name, Entry(point.name, point.value, f"from {provider}", provider))
