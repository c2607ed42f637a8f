"""How far the fixes of each quality are taken to be off: quickly (each fix by itself) and slowly (for minutes).

Sources of the figures, which are of open sky; what is between trees and walls is worse, and is told by the receiver
itself where it sends GST:

- RTK fixed and float, size: standard deviations per axis of real receivers are 0.009 to 0.019 m fixed, and 0.08 to
  0.12 m float in quiet times, 0.10 to 0.32 m in disturbed ones ("Enhanced wide-area multi-GNSS RTK and rapid static
  positioning in the presence of ionospheric disturbances", Earth, Planets and Space 72, 2020, table 3,
  doi:10.1186/s40623-020-01238-7).
- RTK, how long an error lasts: carrier phases over baselines up to 10 km stay correlated for 115 s on average (Miller,
  O'Keefe and Gao, "Time correlation in GNSS positioning over short baselines", Journal of Surveying Engineering 138,
  2012), positions of network RTK for 13 to 17 min ("Temporal correlation for network RTK positioning", GPS Solutions
  16, 2012, doi:10.1007/s10291-011-0213-0); both by first-order Gauss-Markov functions.
- Without corrections: a first-order Gauss-Markov process of 4.7 m and 1,100 s and white noise of 0.4 m (Beard and
  McLain, "Small Unmanned Aircraft", 2012, table 7.2, after Rankin 1994). Today's receivers of two bands are better,
  1.5 m CEP by the data sheet of u-blox' ZED-F9P; the model here stands in between.
- The share of the quick part is assumed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.positioning.fix import FixQuality


@dataclass(frozen=True, slots=True)
class ReceiverModel:
    """What fixes of a quality are worth.

    Attributes:
        white_m: Standard deviation per axis of what is new in each fix, metres.
        wander_m: Likewise of what lasts, a first-order Gauss-Markov process.
        wander_tau_s: Its correlation time, seconds.
        velocity_mps: Standard deviation per axis of the velocity that comes with it.

    Raises:
        SettingsError: If a figure is no finite number > 0.
    """

    white_m: float
    wander_m: float
    wander_tau_s: float
    velocity_mps: float = 0.05

    def __post_init__(self) -> None:
        faults = [
            Fault(f"{item.name} = {getattr(self, item.name)}", "a finite number from 1e-4 on")
            for item in fields(self)
            if not is_within(getattr(self, item.name), 1e-4)
        ]
        if faults:
            raise SettingsError("model of a receiver", faults)

    @property
    def sigma_m(self) -> float:
        """Standard deviation per axis of all of it."""
        return float((self.white_m**2 + self.wander_m**2) ** 0.5)

    def scaled_to(self, sigma_m: float | None) -> "ReceiverModel":
        """Return the model for a fix whose receiver tells its standard deviation; the shares of both parts are kept.

        A receiver that claims to be much better than its kind is believed only by half: many do.
        """
        if sigma_m is None:
            return self
        scale = max(0.5, min(100.0, sigma_m / self.sigma_m))
        return ReceiverModel(self.white_m * scale, self.wander_m * scale, self.wander_tau_s, self.velocity_mps)


#: What is taken for true of each quality.
RECEIVERS: Mapping[FixQuality, ReceiverModel] = MappingProxyType(
    {
        FixQuality.FIXED: ReceiverModel(0.008, 0.012, 120.0),
        FixQuality.FLOAT: ReceiverModel(0.04, 0.15, 150.0),
        FixQuality.DGPS: ReceiverModel(0.2, 0.6, 300.0, 0.1),
        FixQuality.SINGLE: ReceiverModel(0.4, 2.5, 600.0, 0.1),
    }
)
