"""Making splits: from places to episodes that are balanced over levels, distances and places.

A split is made for all vehicles: starts are on ground that a walker can stand on and go from, and lengths are a
walker's. A place deals its episodes by itself, from a seed of its own, so that places can be dealt side by side.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import (
    Fault,
    Gathering,
    SettingsError,
    StartError,
    UnknownNameError,
    WorldError,
)
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.task.sampling import EpisodeDealer, SamplingSettings
from reasoned_explorer.task.split import BANDS_M, LEVELS, Place, Split, SplitEpisode
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.generator import DISTRICTS
from reasoned_explorer.world.geodesic import Traveller
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.world import Bounds

#: Who the shortest ways of a split are for: a quadruped, the wider of the bodies that this package brings.
WALKER = Traveller(flies=False, radius_m=0.35, collides=True)
CAMERA_HEIGHT_M = 1.0
#: The edge of a generated place, metres; real places are cut into neighbourhoods of about a square kilometre.
GENERATED_SIZE_M = 500.0
NEIGHBOURHOOD_M = 1000.0
#: Level and band, and how many episodes of them.
Cells = Mapping[tuple[int, str], int]


@dataclass(frozen=True, slots=True)
class Share:
    """What each place of a split is asked for.

    Attributes:
        per_cell: Episodes of each level and distance, 1 or more.
        distances: At how many of the distances of `BANDS_M` each level is posed in a place, 1 to 3; which of them goes
            round from level to level and from place to place, so that all come equally often.
    """

    per_cell: int = 1
    distances: int = len(BANDS_M)

    def cells(self, place: int) -> Cells:
        """Return what the place of that number is asked for."""
        return {
            (level, band): self.per_cell
            for row, level in enumerate(LEVELS)
            for col, band in enumerate(BANDS_M)
            if (place + row + col) % len(BANDS_M) < self.distances
        }


@dataclass(frozen=True, slots=True)
class BuiltIn:
    """A split that this package brings.

    Attributes:
        worlds: How many of each district.
        share: What each is asked for.
        seed: Of all of it; nothing was developed on the worlds that come out.
    """

    worlds: int
    share: Share
    seed: int

    @property
    def places(self) -> tuple[Place, ...]:
        """The generated worlds."""
        names = [
            (district, f"{district}:{key_of(self.seed, 'world', district, number) % 1_000_000}@{GENERATED_SIZE_M:g}")
            for number in range(self.worlds)
            for district in DISTRICTS
        ]
        return tuple(Place(name, name, district=district) for district, name in names)


_SPLITS = {"mini": BuiltIn(1, Share(distances=2), 20_261), "full": BuiltIn(5, Share(), 20_262)}
SPLIT_NAMES = tuple(_SPLITS)


@dataclass(frozen=True, slots=True)
class Dealt:
    """What a place deals.

    Attributes:
        place: The place.
        world_digest: Fingerprint of its world; empty where there is nothing.
        attribution: Whom to thank; may be empty.
        episodes: Of each cell as many as were asked for, or fewer.
    """

    place: Place
    world_digest: str
    attribution: str
    episodes: tuple[SplitEpisode, ...]


def built_in_split(name: str) -> BuiltIn:
    """Return how a built-in split is made.

    Raises:
        UnknownNameError: If there is no such split.
    """
    if name not in _SPLITS:
        raise UnknownNameError("split", name, SPLIT_NAMES)
    return _SPLITS[name]


def places_of_worlds(
    worlds: Sequence[str], *, bbox: tuple[float, float, float, float] | None = None
) -> tuple[Place, ...]:
    """Return the places of worlds that a person names: generated ones as they are, real ones cut into neighbourhoods.

    Args:
        worlds: What `open_world` takes.
        bbox: Crops files, degrees.

    Raises:
        InputError: If worlds cannot be opened, with all of these, or a name stands twice.
    """
    # A run is gone on with from wherever one stands.
    sources = [_absolute(world) for world in worlds]
    if len(set(sources)) < len(sources):
        raise SettingsError("worlds", [Fault(f"{', '.join(worlds)}", "each world once")])
    places: list[Place] = []
    found = Gathering()
    cities: Counter[str] = Counter()
    for source in sources:
        world = found.take(partial(open_world, source, bbox=bbox), None)
        if world is None:
            continue
        plain, _, permuted = source.partition("~")
        stem = Path(plain).name.split(".")[0] if "/" in plain else plain.partition(":")[0].partition("@")[0]
        if "/" not in plain:
            places.append(Place(source, source, district=stem))
            continue
        # Maps are often all called map.osm: the second of a name is another city.
        cities[stem] += 1
        city = stem if cities[stem] == 1 else f"{stem}-{cities[stem]}"
        city += f"~{permuted}" if permuted else ""
        if world.origin is None:
            places.append(Place(city, source, city=city))
            continue
        places += [
            Place(f"{city}#{number}", source, tile, city)
            for number, tile in enumerate(_neighbourhoods_deg(world.bounds, world.origin))
        ]
    found.finish("worlds")
    return tuple(places)


def _absolute(world: str) -> str:
    """Return a world's name, a file's with its whole path."""
    plain, tilde, permuted = world.partition("~")
    return f"{Path(plain).resolve()}{tilde}{permuted}" if Path(plain).is_file() else world


def _neighbourhoods_deg(bounds: Bounds, origin: GeoOrigin) -> list[tuple[float, float, float, float]]:
    """Cut a world's bounds into equal parts of about a square kilometre, degrees, rows from the south."""
    cols = max(1, round(bounds.width_m / NEIGHBOURHOOD_M))
    rows = max(1, round(bounds.height_m / NEIGHBOURHOOD_M))
    tiles = []
    for row in range(rows):
        for col in range(cols):
            west_m = bounds.min_x_m + bounds.width_m * col / cols
            south_m = bounds.min_y_m + bounds.height_m * row / rows
            south_deg, west_deg = origin.geodetic_from_enu_deg(west_m, south_m)
            north_deg, east_deg = origin.geodetic_from_enu_deg(
                west_m + bounds.width_m / cols, south_m + bounds.height_m / rows
            )
            west, south, east, north = (round(float(side), 6) for side in (west_deg, south_deg, east_deg, north_deg))
            tiles.append((west, south, east, north))
    return tiles


def open_place(place: Place) -> Atlas:
    """Return the atlas of a place.

    Raises:
        InputError: If its world cannot be opened.
    """
    return Atlas(open_world(place.source, bbox=place.bbox))


@dataclass(frozen=True, slots=True)
class Dealing:
    """How places deal; can be sent to another process.

    Attributes:
        seed: Of every draw.
        time_limit_s: T_max.
        radius_m: Success radius.
    """

    seed: int
    time_limit_s: float = 1800.0
    radius_m: float = 15.0

    def deal(self, place: Place, cells: Cells) -> Dealt:
        """Return the episodes that a place deals.

        Each cell is dealt from a deck of its own, so that it gives the same episodes whatever else is asked for. A cell
        that the place cannot fill (it has no goal of the level so far away) stays short; a neighbourhood in which the
        map has nothing at all deals nothing.

        Raises:
            InputError: If its world cannot be opened.
        """
        try:
            atlas = open_place(place)
        except WorldError:
            if place.bbox is None:
                raise
            return Dealt(place, "", "", ())
        first: EpisodeDealer | None = None
        episodes: list[SplitEpisode] = []
        for band, (low_m, high_m) in BANDS_M.items():
            settings = SamplingSettings(
                min_m=low_m,
                max_m=high_m,
                camera_height_m=CAMERA_HEIGHT_M,
                success_radius_m=self.radius_m,
                time_limit_s=self.time_limit_s,
            )
            seed = key_of(self.seed, "split", place.name, band)
            dealer = EpisodeDealer(
                atlas, WALKER, seed=seed, settings=settings, name=f"{place.name}/{band}", share=first
            )
            first = first or dealer
            for level in LEVELS:
                stop_if_asked()
                for _ in range(cells.get((level, band), 0)):
                    try:
                        episode = dealer.deal(level)
                    except StartError:
                        break
                    episodes.append(SplitEpisode(episode, place.name, band, round(dealer.blind_rate(episode), 4)))
        return Dealt(place, atlas.digest, atlas.world.attribution, tuple(episodes))


#: Deals places side by side or one after the other, in the order given: what `map` does with two lists.
MapPlaces = Callable[[Callable[[Place, Cells], Dealt], Sequence[Place], Sequence[Cells]], Iterable[Dealt]]


def make_split(
    name: str,
    places: Sequence[Place],
    *,
    share: Share,
    dealing: Dealing,
    map_places: MapPlaces = map,
) -> Split:
    """Return a split of places, balanced over levels and distances as far as they allow.

    What one place lacks is filled by others, one episode from each in turn, so that each level and distance has as
    many episodes as were asked for wherever that can be.

    Args:
        name: Of the split.
        places: Where.
        share: What each is asked for.
        dealing: How.
        map_places: `map`, or the map of a pool.

    Raises:
        StartError: If no place can deal anything.
        SettingsError: If numbers are out of range.
        InputError: If a world cannot be opened.
    """
    if share.per_cell < 1 or not places or not 1 <= share.distances <= len(BANDS_M):
        what = f"{share.per_cell} episodes a cell at {share.distances} distances in {len(places)} places"
        raise SettingsError("split", [Fault(what, f"at least one of each, and at most {len(BANDS_M)} distances")])
    asked = [share.cells(number) for number in range(len(places))]
    dealt = list(map_places(dealing.deal, places, asked))
    counts = Counter(cell for found in dealt for cell in _cells(found))
    lack = Counter(cell for cells in asked for cell in cells for _ in range(share.per_cell))
    lack.subtract(counts)
    lack = +lack
    if lack:
        # The places deal once more what is lacking, and twice as much: the second half is new.
        more = list(map_places(dealing.deal, places, [dict.fromkeys(sorted(lack), 2 * share.per_cell)] * len(places)))
        spared = _spared(dealt, more, lack, share.per_cell)
        dealt = [_filled(found, again) for found, again in zip(dealt, spared, strict=True)]
    found_in = [found for found in dealt if found.episodes]
    if not found_in:
        what = f"no episode can be posed in {', '.join(place.name for place in places)}"
        raise StartError("split", [Fault(what, "places with goals 30 to 320 m away", "take larger worlds")])
    return Split(
        name=name,
        seed=dealing.seed,
        places=tuple(found.place for found in found_in),
        episodes=tuple(item for found in found_in for item in found.episodes),
        world_digests={found.place.name: found.world_digest for found in found_in},
        attributions=tuple(sorted({found.attribution for found in found_in} - {""})),
    )


def _cells(found: Dealt) -> list[tuple[int, str]]:
    return [(item.episode.spec.level, item.band) for item in found.episodes]


def _spared(
    dealt: Sequence[Dealt], more: Sequence[Dealt], lack: Counter[tuple[int, str]], per_cell: int
) -> list[list[SplitEpisode]]:
    """Return what each place has to spare of the cells that others lack, one from each in turn until nothing lacks."""
    had = [{item.episode.id for item in found.episodes} for found in dealt]
    spare = [
        [item for item in again.episodes if item.episode.id not in known]
        for again, known in zip(more, had, strict=True)
    ]
    given: list[list[SplitEpisode]] = [[] for _ in dealt]
    left = Counter(lack)
    for turn in range(per_cell):
        for index, items in enumerate(spare):
            by_cell: dict[tuple[int, str], list[SplitEpisode]] = {}
            for item in items:
                by_cell.setdefault((item.episode.spec.level, item.band), []).append(item)
            for cell, mine in by_cell.items():
                if turn < len(mine) and left[cell] > 0:
                    left[cell] -= 1
                    given[index].append(mine[turn])
    return given


def _filled(found: Dealt, more: Sequence[SplitEpisode]) -> Dealt:
    return replace(found, episodes=(*found.episodes, *more))


def ceiling_casr(split: Split, *, speed_mps: float) -> float:
    """Return the CASR of who knows the way: every episode succeeds, without thinking, at a vehicle's cruising speed.

    Both CASRs are the same there, since every mission succeeds.
    """
    shares = [
        max(0.0, 1.0 - item.episode.reference_length_m / speed_mps / item.episode.time_limit_s)
        for item in split.episodes
        if math.isfinite(item.episode.reference_length_m)
    ]
    return math.fsum(shares) / len(split.episodes)
