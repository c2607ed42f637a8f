"""Where an autopilot is reached, written as pymavlink's tools take it."""

import re
from dataclasses import dataclass
from enum import StrEnum

from reasoned_explorer.model import Fault, SettingsError

_BAUD = 115_200
_EXPECTED = "udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT or a serial device such as /dev/ttyACM0:115200"


class Wire(StrEnum):
    """How bytes travel."""

    UDP_IN = "udpin"
    UDP_OUT = "udpout"
    TCP = "tcp"
    SERIAL = "serial"


@dataclass(frozen=True, slots=True)
class Address:
    """Where an autopilot is reached.

    Attributes:
        wire: How bytes travel.
        host: To listen on or to reach, or the serial device.
        number: The port, or bits a second of a serial line.
    """

    wire: Wire
    host: str
    number: int

    def __str__(self) -> str:
        return f"{self.wire}:{self.host}:{self.number}"

    @classmethod
    def read(cls, text: str) -> "Address":
        """Return what is written: ``udpin:`` (or ``udp:``), ``udpout:``, ``tcp:``, or a serial device with its speed.

        Raises:
            SettingsError: If it is no such address.
        """
        found = re.fullmatch(r"(udpin|udpout|udp|tcp):(\[[0-9a-fA-F:.]+\]|[^:\s]+):([0-9]{1,5})", text)
        if found:
            kind, host, port = found[1], found[2].strip("[]"), int(found[3])
            if 0 < port < 65536:
                return cls(Wire.UDP_IN if kind == "udp" else Wire(kind), host, port)
        device = re.fullmatch(r"(?:serial:)?(/[^:,\s]+|COM[0-9]{1,3})(?:[:,]([0-9]{2,7}))?", text)
        if device:
            return cls(Wire.SERIAL, device[1], int(device[2] or _BAUD))
        raise SettingsError("MAVLink", [Fault(f"the address is {text!r:.80}", _EXPECTED)])
