"""How much worse a receiver is than its kind, learnt from what its fixes do.

Innovation-based adaptive estimation: the scatter of the fixes about where the filter expects them, less what the filter
itself is uncertain by, is the receiver's noise (Mehra, "Approaches to adaptive filtering", IEEE Transactions on
Automatic Control 17, 1972; over a window, for satellites and inertial sensors: Mohamed and Schwarz, "Adaptive Kalman
filtering for INS/GPS", Journal of Geodesy 73, 1999, doi:10.1007/s001900050236). Here the scatter is a median: jumps and
outliers, which fewer than half of the fixes are, do not make a receiver pass for a noisy one.

Only the quick part of the noise shows within seconds. The slow part, which shows in minutes if at all, is taken to be
as much larger: the shares of both are kept, as where a receiver tells its standard deviation.
"""

import math
from collections import deque

import numpy as np

from reasoned_explorer.vehicles.control.localization import PoseFilter
from reasoned_explorer.vehicles.positioning import wander
from reasoned_explorer.vehicles.positioning.fix import Fix
from reasoned_explorer.vehicles.positioning.receivers import ReceiverModel

#: Over so many fixes the scatter is taken; its scale then errs by 7 % (one sigma of the median of a chi-square).
WINDOW = 100
#: What is learnt counts where it differs from what was taken for true by this factor: three sigmas and more.
_TELLING = 1.25
#: Of the sums of the squares of two normal numbers half lie below twice this.
_HALF = math.log(2.0)


class Scatter:
    """Learns by what factor a receiver's noise is larger than its model, from 1 on.

    Args:
        worst: No factor is larger; 1 where nothing is to be learnt.
    """

    def __init__(self, worst: float) -> None:
        self._worst = worst
        self._seen: deque[tuple[float, float]] = deque(maxlen=WINDOW)
        #: What is taken for true.
        self.factor = 1.0
        #: Whether no other fixes came before, and nothing could be learnt yet: all that is known is known from them.
        self.is_first = True

    def copy(self) -> "Scatter":
        """Return one of its own that goes on from here."""
        other = Scatter(self._worst)
        other._seen, other.factor, other.is_first = self._seen.copy(), self.factor, self.is_first
        return other

    def forget(self) -> None:
        """Begin anew: fixes are of another quality from now on."""
        self._seen.clear()
        self.factor, self.is_first = 1.0, False

    def note(self, filter_: PoseFilter, fix: Fix, model: ReceiverModel) -> bool:
        """Take in a fix that the filter has not been given yet, and the model that it would have by itself.

        Returns:
            Whether it turns out that fixes have been worse ever since there were any.
        """
        if self._worst <= 1.0:
            return False
        unit = 1.0 / model.white_m**2
        cov = filter_.covariance
        known = [
            float(cov[place, place] + 2.0 * cov[place, slow] + cov[slow, slow])
            for place, slow in zip(wander.PLACES, wander.WANDERS, strict=True)
        ]
        off_m = wander.off_m(filter_, fix)
        self._seen.append((0.5 * off_m * off_m * unit, 0.5 * sum(known) * unit))
        if len(self._seen) < WINDOW:
            return False
        scatter, expected = np.median(np.array(self._seen), axis=0)
        factor = math.sqrt(max(1.0, float(scatter) / _HALF - float(expected)))
        factor = min(factor, self._worst)
        was_first, self.is_first = self.is_first, False
        if self.factor / _TELLING <= factor <= self.factor * _TELLING:
            return False
        self.factor = factor
        self._seen.clear()
        return was_first

    def applied_to(self, model: ReceiverModel) -> ReceiverModel:
        """Return a model with the noise that was learnt."""
        if self.factor == 1.0:
            return model
        return ReceiverModel(
            model.white_m * self.factor, model.wander_m * self.factor, model.wander_tau_s, model.velocity_mps
        )
