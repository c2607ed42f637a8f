"""Where positions come from, as a person writes it: ``gpsd://HOST``, ``serial:/dev/ttyUSB1:38400``, ``ntrip://…``."""

import re
from dataclasses import dataclass
from urllib.parse import SplitResult, urlsplit

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.positioning.gpsd import PORT as GPSD_PORT

SERIAL_BAUD = 38400
NTRIP_PORT = 2101
#: What serial lines of receivers are set to.
BAUDS = (4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600)
_FORMS = "gpsd://HOST[:2947] or serial:DEVICE[:BAUD], e.g. serial:/dev/ttyUSB1:38400"
_NTRIP_FORM = "ntrip://HOST[:2101]/MOUNTPOINT"
_BAUD = re.compile(r"(?P<device>.*):(?P<baud>[^:/\\]*)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class GpsdSource:
    """A gpsd.

    Attributes:
        host: Where it runs.
        port: Its port.
    """

    host: str
    port: int = GPSD_PORT


@dataclass(frozen=True, slots=True)
class SerialSource:
    """A receiver on a serial line that speaks NMEA.

    Attributes:
        device: A device, or a URL that pyserial knows.
        baud: Bits a second.
    """

    device: str
    baud: int = SERIAL_BAUD


@dataclass(frozen=True, slots=True)
class NtripSource:
    """A stream of corrections.

    Attributes:
        host: The caster.
        mountpoint: Which of its streams.
        port: Its port.
    """

    host: str
    mountpoint: str
    port: int = NTRIP_PORT


def parse_source(text: str) -> GpsdSource | SerialSource:
    """Return where positions come from.

    >>> parse_source("gpsd://rover.local")
    GpsdSource(host='rover.local', port=2947)
    >>> parse_source("serial:/dev/ttyUSB1:115200")
    SerialSource(device='/dev/ttyUSB1', baud=115200)

    Raises:
        SettingsError: If it is written wrongly, with all faults.
    """
    scheme, _, rest = text.partition(":")
    if scheme == "gpsd":
        host, port = _address(text, GPSD_PORT, "gpsd://HOST[:2947]", path="")
        return GpsdSource(host, port)
    if scheme == "serial":
        return _serial(text, rest)
    raise SettingsError("source of positions", [Fault(f"{text!r}", _FORMS)])


def parse_ntrip(text: str) -> NtripSource:
    """Return where corrections come from.

    >>> parse_ntrip("ntrip://caster.example/NEAREST")
    NtripSource(host='caster.example', mountpoint='NEAREST', port=2101)

    Raises:
        SettingsError: If it is written wrongly, with all faults.
    """
    host, port = _address(text, NTRIP_PORT, _NTRIP_FORM, path="MOUNTPOINT")
    return NtripSource(host, _split(text).path.strip("/"), port)


def _serial(text: str, rest: str) -> SerialSource:
    faults = []
    match = _BAUD.fullmatch(rest)
    device, baud = rest, SERIAL_BAUD
    if match is not None and match["device"] and not rest.startswith(("socket:", "rfc2217:")):
        device = match["device"]
        if match["baud"].isascii() and match["baud"].isdigit() and int(match["baud"]) in BAUDS:
            baud = int(match["baud"])
        else:
            faults.append(Fault(f"{match['baud']!r} bits a second", f"one of {', '.join(map(str, BAUDS))}"))
    if not device.strip() or any(letter.isspace() or not letter.isprintable() for letter in device):
        faults.append(Fault(f"the device is {device!r}", "a device such as /dev/ttyUSB1, without spaces"))
    if faults:
        raise SettingsError(f"source of positions {text!r}", faults)
    return SerialSource(device, baud)


def _address(text: str, port: int, form: str, *, path: str) -> tuple[str, int]:
    """Return host and port of an address that is nothing else, or say all that is wrong with it."""
    faults = []
    scheme = form.partition(":")[0]
    parts = _split(text)
    shown = text if "@" not in text else f"{scheme}://…@{text.rpartition('@')[2]}"
    if parts.scheme != scheme or not text.startswith(f"{scheme}://"):
        faults.append(Fault(f"{shown!r}", form))
    if "@" in text:
        fault = "it holds a user's name or password"
        faults.append(Fault(fault, form, "put them into the environment: NTRIP_USER and NTRIP_PASSWORD"))
    host = parts.hostname or ""
    if not host or any(letter.isspace() or not letter.isprintable() for letter in host):
        faults.append(Fault(f"the host is {host!r}", "a name or an address"))
    try:
        port = parts.port if parts.port is not None else port
        if port == 0:
            raise ValueError
    except ValueError:
        faults.append(Fault(f"the port of {shown!r}", "a number from 1 to 65535"))
    given = parts.path.strip("/")
    if path and (not given or "/" in given or any(letter.isspace() for letter in given)):
        faults.append(Fault(f"the mountpoint is {given!r}", "one name, as the caster's table has it"))
    if (not path and given) or parts.query or parts.fragment:
        faults.append(Fault(f"{shown!r} goes on after the {'mountpoint' if path else 'port'}", form))
    if faults:
        raise SettingsError(f"address {shown!r}", faults)
    return host, port


def _split(text: str) -> SplitResult:
    try:
        return urlsplit(text)
    except ValueError as error:  # brackets of an IPv6 address that do not match
        raise SettingsError(f"address {text!r}", [Fault(str(error), "an address")]) from error
