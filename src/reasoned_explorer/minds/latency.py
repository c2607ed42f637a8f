"""How long a modelled call takes.

A profile gives every role a lognormal: answers of hosted models have a long right tail, and one median and one spread
is all that published figures allow to fit. Draws are keyed by the mission's seed, the role and the scene, so that the
same call takes the same time whatever else is asked.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from reasoned_explorer.model.draws import key_of, normal, normals
from reasoned_explorer.model.errors import Fault, SettingsError, UnknownNameError

_SECONDS = re.compile(r"\d{1,4}(?:\.\d{1,6})?s", re.ASCII)
#: The roles that a call can have.
ROLES = ("caption", "visionary", "evaluator", "checker")


@dataclass(frozen=True, slots=True)
class RoleLatency:
    """Seconds of one role's calls: lognormal with this median and this sigma (of the logarithm).

    Attributes:
        median_s: Seconds, 0 or more; at 0 every call takes no time.
        sigma: Standard deviation of the natural logarithm, in [0, 2].
    """

    median_s: float = 0.0
    sigma: float = 0.0


@dataclass(frozen=True, slots=True)
class LatencyProfile:
    """How long the calls of each role take.

    Attributes:
        name: As looked up.
        label: What people are shown, with the source of the figures or the word "assumed".
        caption: Of a captioner's calls.
        visionary: Of a visionary's.
        evaluator: Of an evaluator's.
        checker: Of a goal checker's.

    Raises:
        SettingsError: If a median or a sigma is out of its range, with all faults.
    """

    name: str
    label: str
    caption: RoleLatency = RoleLatency()
    visionary: RoleLatency = RoleLatency()
    evaluator: RoleLatency = RoleLatency()
    checker: RoleLatency = RoleLatency()

    def __post_init__(self) -> None:
        faults = []
        for role in ROLES:
            latency = self.role(role)
            if not (math.isfinite(latency.median_s) and latency.median_s >= 0.0):
                faults.append(Fault(f"{role}.median_s is {latency.median_s}", "seconds, finite and not negative"))
            if not 0.0 <= latency.sigma <= 2.0:  # NaN fails, too
                faults.append(Fault(f"{role}.sigma is {latency.sigma}", "a number from 0 to 2"))
        if faults:
            raise SettingsError(f"latency profile {self.name!r}", faults)

    def role(self, role: str) -> RoleLatency:
        """Return the latency of a role.

        Raises:
            UnknownNameError: If there is no such role.
        """
        if role not in ROLES:
            raise UnknownNameError("role", role, ROLES)
        latency: RoleLatency = getattr(self, role)
        return latency

    def duration_s(self, role: str, seed: int, *keys: int | str) -> float:
        """Return the seconds that one call takes, keyed by a seed and what it is about."""
        latency = self.role(role)
        if latency.median_s == 0.0:
            return 0.0
        return latency.median_s * math.exp(latency.sigma * normal(key_of(seed, "latency", role), *keys))

    def batch_s(self, role: str, seed: int, calls: Iterable[tuple[int | str, ...]]) -> tuple[float, ...]:
        """Return the seconds of each of several calls; started together, they end with the slowest."""
        latency = self.role(role)
        if latency.median_s == 0.0:
            return tuple(0.0 for _ in calls)
        base = key_of(seed, "latency", role)
        return tuple([latency.median_s * math.exp(latency.sigma * draw) for draw in normals(base, calls)])


_PROFILES = {
    profile.name: profile
    for profile in (
        LatencyProfile("instant", "answers take no time"),
        # Fitted to one published figure: the authors' log of N = 3, L = 1 shows 9 to 13.5 s of planning a step. Taken
        # as the 10-90 % band of the slowest of nine visionary calls plus the slowest of nine evaluator calls, one
        # sigma for both, it fixes the sum of the medians and sigma; how the sum is split (1 : 1.25) is assumed: GPT-4
        # answered more slowly than GPT-3.5, but with fewer words. A checker's question is like an evaluator's. The
        # captioner is not in that log; its time is assumed.
        LatencyProfile(
            "gpt-2023",
            "GPT-3.5 visionary and GPT-4 evaluator of 2023, fitted to the authors' log; captions (Kosmos-2 on a GPU) "
            "and"
            " the split between roles assumed",
            caption=RoleLatency(1.2, 0.15),
            visionary=RoleLatency(2.85, 0.36),
            evaluator=RoleLatency(3.55, 0.36),
            checker=RoleLatency(3.55, 0.36),
        ),
        LatencyProfile(
            "gpt-fast",
            "small hosted models of today, assumed",
            caption=RoleLatency(0.5, 0.2),
            visionary=RoleLatency(0.9, 0.3),
            evaluator=RoleLatency(0.5, 0.3),
            checker=RoleLatency(0.5, 0.3),
        ),
    )
}
#: Names of the profiles that there are, sorted.
LATENCY_PROFILES: tuple[str, ...] = tuple(sorted(_PROFILES))


def latency_profile(name: str) -> LatencyProfile:
    """Return a profile by its name, or the one of calls that all take the same time, e.g. ``"0.8s"``.

    Raises:
        UnknownNameError: If there is none; it names the near misses.
    """
    if _SECONDS.fullmatch(name):
        same = RoleLatency(float(name[:-1]))
        return LatencyProfile(name, f"every call takes {name[:-1]} s", same, same, same, same)
    if name not in _PROFILES:
        raise UnknownNameError("latency profile", name, (*LATENCY_PROFILES, "0.8s"))
    return _PROFILES[name]
