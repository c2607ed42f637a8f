"""What may be given to the served methods, checked before anything happens."""

import functools
from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, validate_call

from reasoned_explorer.serving.msgpack_rpc import Method, MethodError

_STRICT = ConfigDict(strict=True, arbitrary_types_allowed=True)
#: Nothing farther from home, slower or faster, or longer is flown: metres, metres a second, seconds.
_FARTHEST_M, _SLOWEST_MPS, _FASTEST_MPS, _LONGEST_S = 1e5, 0.05, 50.0, 600.0
#: No step of held time is longer, seconds.
_LONGEST_STEP_S = 86_400.0

Metres = Annotated[float, Field(ge=-_FARTHEST_M, le=_FARTHEST_M, allow_inf_nan=False)]
Speed = Annotated[float, Field(ge=_SLOWEST_MPS, le=_FASTEST_MPS, allow_inf_nan=False)]
Velocity = Annotated[float, Field(ge=-_FASTEST_MPS, le=_FASTEST_MPS, allow_inf_nan=False)]
Duration = Annotated[float, Field(ge=0.0, le=_LONGEST_S, allow_inf_nan=False)]
Step = Annotated[float, Field(ge=0.0, le=_LONGEST_STEP_S, allow_inf_nan=False)]
Degrees = Annotated[float, Field(ge=-36000.0, le=36000.0, allow_inf_nan=False)]
#: Time-outs, look-aheads: read, and not needed, since flights here come to an end.
Unused = Annotated[float, Field()]
Name = Annotated[str, Field(max_length=200)]
Drivetrain = Annotated[int, Field(ge=0, le=1)]


class _Map(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


class Vector(_Map):
    """Three finite numbers."""

    x_val: Metres
    y_val: Metres
    z_val: Metres


class LooseVector(_Map):
    """Three numbers; one that is none (NaN) leaves things as they are."""

    x_val: float
    y_val: float
    z_val: float


class LooseQuaternion(_Map):
    """An orientation; NaN leaves things as they are."""

    w_val: float
    x_val: float
    y_val: float
    z_val: float


class LoosePose(_Map):
    """A pose; NaN leaves things as they are."""

    position: LooseVector
    orientation: LooseQuaternion


class YawMode(_Map):
    """How to face: a rate in degrees a second, or an angle in degrees."""

    is_rate: bool = True
    yaw_or_rate: Degrees = 0.0


class ImageRequest(_Map):
    """A picture that is asked for."""

    camera_name: Name = "0"
    image_type: int = 0
    pixels_as_float: bool = False
    compress: bool = True


def checked(name: str, method: Callable[..., Any]) -> Method:
    """Return a method that refuses arguments that are not as its annotations say, with all that is wrong at once."""
    valid = validate_call(config=_STRICT)(method)

    @functools.wraps(method)
    def answered(*arguments: object) -> Any:
        try:
            return valid(*arguments)
        except ValidationError as error:
            told = "; ".join(
                f"{'.'.join(str(part) for part in one['loc'])}: {one['msg']}" for one in error.errors()[:8]
            )
            raise MethodError(f"{name} takes other arguments: {told}") from error

    return answered
