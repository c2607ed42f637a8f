"""Holding and stepping a served autopilot's time, in messages of the kind TUNNEL that no real autopilot knows.

A program whose clock jumps cannot steer what moves in real time. So the embedded simulator, served as an autopilot,
can be held, let go for some seconds, and asked where it really is, with all digits. TUNNEL is MAVLink's envelope for
private contents; types from 32768 on are free.
"""

import math
import struct
from dataclasses import dataclass
from enum import IntEnum

from reasoned_explorer.geometry import Pose

#: The type of the envelope, of requests and of answers.
REQUEST_TYPE, ANSWER_TYPE = 0xB051, 0xB052
_REQUEST = struct.Struct("<BBIdB")
_ANSWER = struct.Struct("<BBIBH11d20s")
_VERSION = 1
_ROOM = 128
#: No step is longer, seconds.
LONGEST_STEP_S = 86_400.0
_BUSY, _LANDED = 1, 2


class Ask(IntEnum):
    """What is asked for."""

    STATE = 0
    HOLD = 1
    STEP = 2
    LOOK = 3
    RELEASE = 4


@dataclass(frozen=True, slots=True)
class Request:
    """A request.

    Attributes:
        ask: What for.
        number: The answer has the same; a number that comes again is answered as before.
        seconds: How long a step is.
        until_idle: Whether a step ends where a motion does.
    """

    ask: Ask
    number: int
    seconds: float = 0.0
    until_idle: bool = False

    def pack(self) -> list[int]:
        """Return it as an envelope's contents."""
        return _padded(_REQUEST.pack(_VERSION, self.ask, self.number, self.seconds, self.until_idle))

    @classmethod
    def read(cls, payload: object) -> "Request | None":
        """Return what an envelope holds; None where it is no request."""
        data = _bytes(payload, _REQUEST.size)
        if data is None:
            return None
        version, ask, number, seconds, until_idle = _REQUEST.unpack(data)
        known = version == _VERSION and ask in set(Ask) and until_idle in {0, 1}
        if not known or not 0.0 <= seconds <= LONGEST_STEP_S:
            return None
        return cls(Ask(ask), number, seconds, bool(until_idle))


@dataclass(frozen=True, slots=True)
class Report:
    """Where the machine is.

    Attributes:
        number: Of the request.
        t_s: The simulator's time, seconds.
        true: Where it is; the height is its own.
        believed: Where it takes itself to be.
        speed_mps: Of its body.
        yaw_rate_radps: Positive clockwise.
        is_busy: Whether it is moving to somewhere.
        is_landed: Whether it stands on the ground.
        hits: How often it has run into something, modulo 65536.
        hit: What it last ran into.
    """

    number: int
    t_s: float
    true: Pose
    believed: Pose
    speed_mps: float
    yaw_rate_radps: float
    is_busy: bool
    is_landed: bool
    hits: int
    hit: str

    def pack(self) -> list[int]:
        """Return it as an envelope's contents."""
        poses = [(one.x_m, one.y_m, one.z_m, one.heading_rad) for one in (self.true, self.believed)]
        flags = _BUSY * self.is_busy + _LANDED * self.is_landed
        numbers = self.t_s, *poses[0], *poses[1], self.speed_mps, self.yaw_rate_radps
        name = self.hit.encode()[:20]
        return _padded(_ANSWER.pack(_VERSION, 0, self.number, flags, self.hits % 65536, *numbers, name))

    @classmethod
    def read(cls, payload: object) -> "Report | None":
        """Return what an envelope holds; None where it is no report."""
        data = _bytes(payload, _ANSWER.size)
        if data is None:
            return None
        version, _, number, flags, hits, *numbers, name = _ANSWER.unpack(data)
        if version != _VERSION or not all(math.isfinite(one) for one in numbers):
            return None
        t_s, *both, speed, rate = numbers
        hit = name.rstrip(b"\0").decode("utf-8", "replace")
        true, believed = Pose(*both[:4]), Pose(*both[4:])
        return cls(number, t_s, true, believed, speed, rate, bool(flags & _BUSY), bool(flags & _LANDED), hits, hit)


def _padded(data: bytes) -> list[int]:
    return [*data, *bytes(_ROOM - len(data))]


def _bytes(payload: object, size: int) -> bytes | None:
    try:
        data = bytes(payload)[:size]  # type: ignore[call-overload]
    except (TypeError, ValueError):
        return None
    return data if len(data) == size else None
