"""MAVLink's messages, as pymavlink has them; loaded when they are first needed."""

import struct
from typing import Any

from reasoned_explorer.model.errors import MissingDependencyError

#: What parsing raises on bytes that are no MAVLink, beside pymavlink's own error.
_MALFORMED = (struct.error, ValueError, TypeError, LookupError, ArithmeticError, AttributeError)
#: Text that is longer is no autopilot's.
LONGEST_TEXT = 50


def dialect() -> Any:
    """Return the module of messages: MAVLink 2, the common ones and ArduPilot's.

    Raises:
        MissingDependencyError: If the library is not installed.
    """
    try:
        from pymavlink.dialects.v20 import ardupilotmega
    except ModuleNotFoundError as error:
        raise MissingDependencyError("MAVLink", "pymavlink", "pip install 'reasoned-explorer[vehicles]'") from error
    return ardupilotmega


class Packer:
    """Packs messages, numbered one after the other.

    Args:
        system: Who sends, 1 to 255.
        component: Which part of it.
    """

    def __init__(self, system: int, component: int) -> None:
        self._mav = dialect().MAVLink(None, srcSystem=system, srcComponent=component)

    def pack(self, message: Any) -> bytes:
        """Return a message as it travels."""
        packed: bytes = bytes(message.pack(self._mav))
        self._mav.seq = (self._mav.seq + 1) % 256
        return packed


class Parser:
    """Finds messages in bytes. What is none is counted and never raised.

    Args:
        datagrams: Whether chunks hold whole messages: then what is left of one does not spoil the next.
    """

    def __init__(self, *, datagrams: bool) -> None:
        self._datagrams = datagrams
        self._dialect = dialect()
        self._mav = self._new()
        #: How often something was found that is no message.
        self.malformed = 0

    def feed(self, data: bytes) -> list[Any]:
        """Return the messages that some bytes complete, of types that are known."""
        try:
            found = self._mav.parse_buffer(data) or []
        except (self._dialect.MAVError, *_MALFORMED):
            self.malformed += 1
            self._mav = self._new()
            return []
        sound = []
        for message in found:
            kind = message.get_type()
            if kind == "BAD_DATA":
                self.malformed += 1
            elif not kind.startswith("UNKNOWN"):
                sound.append(message)
        if self._datagrams and self._mav.buf_len() > 0:
            self.malformed += 1
            self._mav = self._new()
        return sound

    def _new(self) -> Any:
        made = self._dialect.MAVLink(None)
        made.robust_parsing = True
        return made


def text_of(value: object) -> str:
    """Return a text of the wire, without what is unprintable."""
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    return "".join(one for one in str(value)[:LONGEST_TEXT] if one.isprintable())
