"""The errors of every room.

Bad input is answered once, with all its faults: `InputError` carries one `Fault` for each. What a part (a model, a
link, a sensor, a disk) does wrong while a mission runs is a `PartError`. The command line ends with exit code 2 for the
first and 3 for the second.
"""

import difflib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with an input.

    Attributes:
        what: What was wrong, with the value that was given.
        expected: What would have been right.
        remedy: What the person can do about it; may be empty.
    """

    what: str
    expected: str = ""
    remedy: str = ""

    def __str__(self) -> str:
        parts = [self.what]
        if self.expected:
            parts.append(f"expected {self.expected}")
        if self.remedy:
            parts.append(self.remedy)
        return "; ".join(parts)


class ReasonedExplorerError(Exception):
    """The base of every error that this package raises on purpose."""


class InputError(ReasonedExplorerError):
    """Input that cannot be used, with all its faults.

    Args:
        subject: What the faults are of, e.g. ``"mission settings"``.
        faults: At least one fault.
    """

    def __init__(self, subject: str, faults: Iterable[Fault]) -> None:
        self.subject = subject
        self.faults = tuple(faults)
        super().__init__(subject, self.faults)

    def __reduce__(self) -> tuple[object, ...]:
        # An error comes out of a worker process as it went in, whatever its own constructor asks for.
        return _rebuilt, (type(self), self.subject, self.faults, self.__dict__)

    def __str__(self) -> str:
        if len(self.faults) == 1:
            return f"{self.subject}: {self.faults[0]}"
        listed = "\n".join(f"  - {fault}" for fault in self.faults)
        return f"{self.subject}: {len(self.faults)} faults\n{listed}"


def _rebuilt(kind: type[InputError], subject: str, faults: tuple[Fault, ...], state: dict[str, object]) -> InputError:
    error = kind.__new__(kind)
    InputError.__init__(error, subject, faults)
    error.__dict__.update(state)
    return error


class GoalError(InputError):
    """A goal sentence that cannot be understood or that asks for nothing findable."""


class StartError(InputError):
    """A start pose where no mission can begin."""


class WorldError(InputError):
    """A world, or a file of one, that cannot be used."""


class SettingsError(InputError):
    """Settings out of their range or at odds with each other."""


class RecordError(InputError):
    """A record of a mission that cannot be read or written."""


class RecordWriteError(ReasonedExplorerError):
    """A record that could not be written on while its mission ran: the disk is full, say. What was written stays."""


class UnknownNameError(InputError):
    """A name that nothing is registered under, with the near misses.

    Args:
        kind: What was looked for, e.g. ``"planner"``.
        name: The name as it was given.
        known: The names that there are.
        beside: What may be given instead of a name, or where else the name may be used; may be empty.
    """

    def __init__(self, kind: str, name: str, known: Sequence[str], *, beside: str = "") -> None:
        self.kind, self.name, self.known = kind, name, tuple(sorted(known))
        near = difflib.get_close_matches(name, self.known, n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else ""
        expected = f"one of {', '.join(self.known)}" + (f", or {beside}" if beside else "")
        super().__init__(f"unknown {kind}", [Fault(f"{name!r}", expected, hint)])


class MissingDependencyError(ReasonedExplorerError):
    """An optional package that is not installed, with the command that installs it."""

    def __init__(self, feature: str, package: str, command: str) -> None:
        self.feature, self.package, self.command = feature, package, command
        super().__init__(f"{feature} needs the package {package}, which is not installed; install it with: {command}")


class PartError(ReasonedExplorerError):
    """A part that failed while a mission ran.

    Args:
        part: Which part, e.g. ``"captioner"``.
        reason: What happened, for people.
    """

    def __init__(self, part: str, reason: str) -> None:
        self.part, self.reason = part, reason
        super().__init__(f"{part}: {reason}")


class Gathering:
    """Goes on with what is sound of an input while it keeps what is wrong with the rest, to tell it all at once.

    Attributes:
        errors: What went wrong so far, in order; what was said already is not said again.
    """

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def take(self, make: Callable[[], T], instead: T) -> T:
        """Return what a call returns, or something else, its error kept, where it refuses its input."""
        try:
            return make()
        except InputError as error:
            self.add(error)
            return instead

    def check(self, call: Callable[[], object]) -> None:
        """Keep the error of a call that refuses its input."""
        self.take(call, None)

    def add(self, *errors: InputError) -> None:
        """Keep errors."""
        for error in errors:
            if str(error) not in map(str, self.errors):
                self.errors.append(error)

    @property
    def faults(self) -> list[Fault]:
        """All that is wrong, each with what it is wrong with, and each once."""
        told = [
            replace(fault, what=f"{error.subject}: {fault.what}") for error in self.errors for fault in error.faults
        ]
        return list(dict.fromkeys(told))

    def finish(self, subject: str) -> None:
        """Raise what was kept: a single error as it is, several as one of the type that they share.

        Raises:
            InputError: If anything was kept; an error of its own type where there is only one.
        """
        if len(self.errors) == 1:
            raise self.errors[0]
        if self.errors:
            kinds = {type(error) for error in self.errors} - {UnknownNameError}
            shared = len(kinds) == 1 and all(type(error) in kinds for error in self.errors)
            raise (kinds.pop() if shared else InputError)(subject, self.faults)
