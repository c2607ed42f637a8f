"""A PID controller: derivative on the measurement, anti-windup, limits."""

import math
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.kernels import Floats


@dataclass(frozen=True, slots=True)
class PidGains:
    """Gains and limits of a PID controller; units are those of output per error.

    Attributes:
        proportional: Output per error.
        integral: Output per error and second.
        derivative: Output per rate of change of the measurement.
        limit: The output's largest magnitude, > 0.
        integral_limit: The integral term's largest magnitude, ≥ 0.

    Raises:
        SettingsError: If a gain is negative or not finite, or a limit out of range.
    """

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    limit: float = math.inf
    integral_limit: float = math.inf

    def __post_init__(self) -> None:
        faults = [
            Fault(f"{name} = {value}", "a finite number ≥ 0")
            for name, value in (
                ("proportional", self.proportional),
                ("integral", self.integral),
                ("derivative", self.derivative),
            )
            if not (math.isfinite(value) and value >= 0.0)
        ]
        if not self.limit > 0.0:
            faults.append(Fault(f"limit = {self.limit}", "a number > 0"))
        if not self.integral_limit >= 0.0:
            faults.append(Fault(f"integral_limit = {self.integral_limit}", "a number ≥ 0"))
        if faults:
            raise SettingsError("PID gains", faults)

    def as_array(self) -> Floats:
        """Return the gains in the order that the kernels read, shape (5,)."""
        return np.array([self.proportional, self.integral, self.derivative, self.limit, self.integral_limit])


class Pid:
    """A PID controller with its memory.

    Args:
        gains: Gains and limits.
    """

    def __init__(self, gains: PidGains) -> None:
        self.gains = gains
        self._gains = gains.as_array()
        self._integral = 0.0

    @property
    def integral(self) -> float:
        """The integral term, in the output's unit."""
        return self._integral

    def reset(self) -> None:
        """Forget the integral."""
        self._integral = 0.0

    def step(self, error: float, *, rate: float, dt_s: float) -> float:
        """Return the output, within the limit.

        Args:
            error: Set point minus measurement.
            rate: The measurement's own rate of change, per second.
            dt_s: Seconds since the last step, > 0.
        """
        output, self._integral = kernels.pid_step(self._gains, self._integral, error, rate, dt_s)
        return float(output)
