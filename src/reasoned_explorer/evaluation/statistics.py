"""Intervals and tests for what missions score. They know numbers and groups, not missions.

Missions of one place are not independent: they share its map, its crowds of trees, its lack of benches. So a place is
drawn, kept or flipped as a whole:

- `bootstrap_sums`, `bootstrap_means`, `percentile_interval`: the cluster bootstrap (Field, Welsh, "Bootstrapping
  clustered data", 2007).
- `sign_flip_test`: a paired permutation test (Fisher, "The design of experiments", 1935).
- `holm`: correction for many comparisons (Holm, "A simple sequentially rejective multiple test procedure", 1979).
- `wilson_interval`: a share of independent trials (Wilson, "Probable inference", 1927).
- `kendall_tau_b`: how well two rankings agree (Kendall, "The treatment of ties in ranking problems", 1945).
- `missions_needed`: how many missions show a difference (Kish, "Survey sampling", 1965, for the design effect).

Everything is keyed by a seed, and the same numbers in the same order give the same answer to the last bit; callers sort
first. Draws come from PCG64's raw words, whose stream NumPy promises never to change.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.model.draws import key_of

#: Resamples of a bootstrap.
RESAMPLES = 2000
#: Random sign flips, where there are too many to try all.
FLIPS = 9999
#: Up to this many groups all flips are tried: 2¹⁴ of them.
EXACT_GROUPS = 14
# A bootstrap works on this many numbers at a time: 8 MB.
_BLOCK = 1_000_000
# Sums that differ by this share are the same: they were added up in another order.
_TIE = 1e-9

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def wilson_interval(successes: int, count: int, *, confidence: float = 0.95) -> tuple[float, float]:
    """Return Wilson's score interval for a share, inside [0, 1].

    Raises:
        InputError: If there is no trial, more successes than trials, or the confidence is not in (0, 1).
    """
    faults = _confidence_faults(confidence)
    if not (count >= 1 and 0 <= successes <= count):
        faults.append(Fault(f"{successes} successes of {count}", "0 ≤ successes ≤ count, count ≥ 1"))
    if faults:
        raise InputError("Wilson interval", faults)
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    share = successes / count
    middle = share + z * z / (2.0 * count)
    half = z * math.sqrt(share * (1.0 - share) / count + z * z / (4.0 * count * count))
    scale = 1.0 + z * z / count
    low = 0.0 if successes == 0 else max(0.0, (middle - half) / scale)
    high = 1.0 if successes == count else min(1.0, (middle + half) / scale)
    return low, high


def group_sums(values: ArrayLike, groups: Sequence[int] | Ints) -> Floats:
    """Return the sums of a table's rows by group, in the order of the groups.

    Args:
        values: Shape (n, columns).
        groups: Of each row, shape (n,), from 0.
    """
    table, labels = np.asarray(values, dtype=np.float64), np.asarray(groups, dtype=np.int64)
    return np.stack([np.bincount(labels, weights=column) for column in table.T], axis=1)


def bootstrap_sums(sums: Floats, *, seed: int) -> Floats:
    """Return the sums over each resample of groups, drawn with replacement, shape (RESAMPLES, columns).

    What is drawn depends on the seed and on the number of groups only, so that two calls with as many groups are
    paired. A mean is the ratio of two columns: what was summed, and how many; groups differ in size.

    Args:
        sums: Of each group, shape (groups, columns), at least one group.
        seed: Of the draws.
    """
    count, columns = sums.shape
    bulk = np.random.PCG64(key_of(seed, "bootstrap", count))
    rows = max(1, _BLOCK // count)
    drawn = np.empty((RESAMPLES, columns))
    for first in range(0, RESAMPLES, rows):
        block = min(rows, RESAMPLES - first)
        # The upper 53 bits of a word are a share in [0, 1).
        shares = (bulk.random_raw(block * count) >> np.uint64(11)) * (1.0 / (1 << 53))
        picked = (shares * count).astype(np.int64).reshape(block, count)
        for column in range(columns):
            drawn[first : first + block, column] = np.ascontiguousarray(sums[:, column]).take(picked).sum(axis=1)
    return drawn


def percentile_interval(resampled: Floats, *, confidence: float = 0.95) -> tuple[float, float]:
    """Return the percentile interval of a bootstrap; its ends are values that were drawn, the outer ones of two.

    A draw that has no value (NaN) could have any: it counts as low at the lower end and as high at the upper one.

    Raises:
        InputError: If there is no draw or the confidence is not in (0, 1).
    """
    faults = _confidence_faults(confidence)
    if not resampled.size:
        faults.append(Fault("there is no draw", "at least one"))
    if faults:
        raise InputError("percentile interval", faults)
    tail = (resampled.size - 1) * (1.0 - confidence) / 2.0
    place = math.floor(tail + 1e-9)
    low = np.sort(np.where(np.isnan(resampled), -np.inf, resampled))[place]
    high = np.sort(np.where(np.isnan(resampled), np.inf, resampled))[resampled.size - 1 - place]
    return float(low), float(high)


def sign_flip_test(differences: Sequence[float] | Floats, *, seed: int) -> float:
    """Return the two-sided p-value of a paired permutation test, in (0, 1].

    If two methods were the same, each group's difference could as well have had the other sign: p is the share of all
    sign flips whose sum is at least as far from 0 as the one that was seen. All flips are tried up to `EXACT_GROUPS`
    groups; beyond, `FLIPS` random ones, and p = (1 + hits) / (1 + FLIPS), which is never too small (Phipson, Smyth,
    "Permutation p-values should never be zero", 2010). Groups without a difference change nothing and are left out;
    with none left p is 1.

    Args:
        differences: The sum of each group's differences, finite.
        seed: Of the random flips.
    """
    values = np.asarray(differences, dtype=np.float64)
    values = values[values != 0.0]
    if not values.size:
        return 1.0
    scale = float(np.abs(values).sum())
    least = abs(float(values.sum())) - _TIE * scale
    count = int(values.size)
    if count <= EXACT_GROUPS:
        flips = (np.arange(1 << count)[:, None] >> np.arange(count)) & 1
        return float(np.mean(np.abs((values * (1 - 2 * flips)).sum(axis=1)) >= least))
    bulk = np.random.PCG64(key_of(seed, "flips", count))
    words = -(-count // 64)
    hits, rows = 0, max(1, _BLOCK // (64 * words))
    for first in range(0, FLIPS, rows):
        block = min(rows, FLIPS - first)
        raw = bulk.random_raw(block * words).astype("<u8").view(np.uint8).reshape(block, -1)
        flipped = np.unpackbits(raw, axis=1, bitorder="little")[:, :count].astype(np.bool_)
        sums = np.where(flipped, -values, values).sum(axis=1)
        hits += int(np.count_nonzero(np.abs(sums) >= least))
    return (1 + hits) / (1 + FLIPS)


def holm(p_values: Mapping[str, float]) -> dict[str, float]:
    """Return the p-values of a family of comparisons, adjusted: below a level α none is false but with a chance of α.

    The smallest of m is multiplied by m, the next by m − 1, …; none is below the one before it, none above 1.

    Args:
        p_values: By comparison.

    Raises:
        InputError: If one is not in [0, 1].
    """
    faults = [Fault(f"p of {name} is {p}", "in [0, 1]") for name, p in p_values.items() if not 0.0 <= p <= 1.0]
    if faults:
        raise InputError("Holm's correction", faults)
    adjusted, least = {}, 0.0
    for rank, name in enumerate(sorted(p_values, key=lambda key: (p_values[key], key))):
        least = max(least, min(1.0, (len(p_values) - rank) * p_values[name]))
        adjusted[name] = least
    return {name: adjusted[name] for name in p_values}


def kendall_tau_b(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Return how well two rankings of the same things agree, in [−1, 1]; None where one of them ranks nothing.

    τ_b = (concordant − discordant) / √((pairs − tied in the first) · (pairs − tied in the second)).

    Args:
        first: What each thing is ranked by in the first ranking.
        second: In the second, in the same order.

    Raises:
        InputError: If the lengths differ, or a number is NaN.
    """
    faults = []
    if len(first) != len(second):
        faults.append(Fault(f"{len(first)} things and {len(second)}", "the same things in both"))
    if any(math.isnan(value) for value in (*first, *second)):
        faults.append(Fault("a rank that is not a number", "numbers"))
    if faults:
        raise InputError("rankings", faults)
    pairs = [(i, j) for i in range(len(first)) for j in range(i)]
    signs = [(_sign(first[i], first[j]), _sign(second[i], second[j])) for i, j in pairs]
    ranked = sum(a != 0 for a, _ in signs) * sum(b != 0 for _, b in signs)
    return sum(a * b for a, b in signs) / math.sqrt(ranked) if ranked else None


@dataclass(frozen=True, slots=True)
class MissionsNeeded:
    """How many missions show a paired difference.

    Attributes:
        missions: In all, spread over places as they were.
        places: With as many missions each as there were; None where they are not known or there was only one.
        deviation: Standard deviation of the differences of single missions.
        design_effect: By how much the missions of a place say less than as many independent ones, at least 1.
    """

    missions: int
    places: int | None
    deviation: float
    design_effect: float


def missions_needed(
    differences: Mapping[str, float],
    *,
    places: Mapping[str, str] | None = None,
    effect: float = 0.02,
    power: float = 0.8,
    confidence: float = 0.95,
) -> MissionsNeeded | None:
    """Return how many missions a two-sided paired test needs to find a difference; None where these cannot tell.

    n = ((z(confidence) + z(power)) · deviation / effect)², times the design effect: the variance of the mean with
    places drawn as a whole over the one with missions drawn one by one. Below 1 it counts as 1: that was chance.
    Differences that are all the same, or a single one, cannot tell.

    Args:
        differences: Of a trial run, by mission id.
        places: Of each mission; None where missions are independent.
        effect: The difference to find, above 0.
        power: Chance to find it, in (0, 1).
        confidence: 1 − the level of the test, in (0, 1).

    Raises:
        InputError: If an option is out of range, there is no difference, one is not finite, or a mission has no place.
    """
    faults = _confidence_faults(confidence)
    if not (math.isfinite(effect) and effect > 0.0):
        faults.append(Fault(f"effect is {effect}", "a number above 0"))
    if not 0.0 < power < 1.0:
        faults.append(Fault(f"power is {power}", "a number in (0, 1)"))
    if not differences:
        faults.append(Fault("there is no difference", "at least one"))
    faults += [Fault(f"{name}: {v}", "a finite number") for name, v in differences.items() if not math.isfinite(v)][:10]
    if faults:
        raise InputError("missions needed", faults)
    ids = sorted(differences)
    values = np.asarray([differences[name] for name in ids])
    groups = groups_of(ids, places)
    count, spread = len(ids), values - values.mean()
    variance = float((spread**2).sum()) / (count - 1) if count > 1 else 0.0
    if variance <= (_TIE * float(np.abs(values).max())) ** 2:
        return None
    place_count = int(groups.max()) + 1
    design_effect = 1.0
    if places is not None and place_count > 1:
        sums = group_sums(spread[:, None], groups)
        clustered = place_count / (place_count - 1) * float((sums**2).sum()) / count**2
        design_effect = max(1.0, clustered / (variance / count))
    normal = NormalDist()
    z = normal.inv_cdf(0.5 + confidence / 2.0) + normal.inv_cdf(power)
    missions = z * z * variance / effect**2 * design_effect
    return MissionsNeeded(
        missions=math.ceil(missions),
        places=math.ceil(missions * place_count / count) if places is not None and place_count > 1 else None,
        deviation=math.sqrt(variance),
        design_effect=design_effect,
    )


def groups_of(ids: Sequence[str], places: Mapping[str, str] | None) -> Ints:
    """Return the group of each mission, from 0, in the order of the places' names; each its own without places.

    Raises:
        InputError: If a mission has no place.
    """
    if places is None:
        return np.arange(len(ids), dtype=np.int64)
    lost = sorted({name for name in ids if name not in places})
    if lost:
        raise InputError(
            "places", [Fault(f"mission {name!r} has none", "a place for each mission") for name in lost[:10]]
        )
    rank = {place: k for k, place in enumerate(sorted({places[name] for name in ids}))}
    return np.asarray([rank[places[name]] for name in ids], dtype=np.int64)


def drawn_groups(ids: Sequence[str], places: Mapping[str, str] | None) -> tuple[Ints, str]:
    """Return what is drawn as a whole, and the name of such an interval; with one place only, missions are drawn.

    Raises:
        InputError: If a mission has no place.
    """
    groups = groups_of(ids, places)
    if places is None or int(groups.max()) == 0:
        return groups_of(ids, None), "bootstrap"
    return groups, "clustered bootstrap"


def bootstrap_means(values: Floats, groups: Ints, *, seed: int) -> tuple[Floats, Floats]:
    """Return the columns' means, shape (columns,), and those of each resample, shape (RESAMPLES, columns).

    Args:
        values: Of each mission, shape (missions, columns).
        groups: Of each mission, shape (missions,); drawn as a whole.
        seed: Of the draws.
    """
    sums = group_sums(np.concatenate((values, np.ones((len(values), 1))), axis=1), groups)
    drawn = bootstrap_sums(sums, seed=seed)
    return np.mean(values, axis=0), drawn[:, :-1] / drawn[:, -1:]


def _sign(a: float, b: float) -> int:
    return (a > b) - (a < b)


def _confidence_faults(confidence: float) -> list[Fault]:
    return [] if 0.0 < confidence < 1.0 else [Fault(f"confidence is {confidence}", "a number in (0, 1)")]
