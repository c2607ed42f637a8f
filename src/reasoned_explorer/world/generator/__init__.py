"""Generated worlds: districts and towns drawn from a seed, furnished as real places are.

`generate_world` is all that is needed; what it uses is loaded when it is first called.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from reasoned_explorer.model.checks import is_within, seed_faults
from reasoned_explorer.model.errors import Fault, SettingsError, UnknownNameError

if TYPE_CHECKING:
    from reasoned_explorer.world.world import World

__all__ = ["DISTRICTS", "SIZE_RANGE_M", "check_request", "generate_world"]

#: What can be generated, with one line for people.
DISTRICTS: Mapping[str, str] = MappingProxyType(
    {
        "downtown": "dense blocks on an irregular grid, often cut by a diagonal avenue; offices, shops, small squares",
        "plaza": "an old town around a great square with arcades, a fountain and cafes",
        "park": "a park with winding paths, lawns, ponds, woods, a playground and a cafe, streets around it",
        "campus": "academic buildings around green quads, winding paths, car parks, a ring road",
        "residential": "houses in gardens along curved streets and dead ends, a few flats and pocket parks",
        "waterfront": "a promenade along a bending shore with piers and a beach, blocks behind a quay road",
        "town": "several districts in one: an old town, parks, a campus, houses, a shore",
    }
)
#: Shortest and longest side of a world, metres.
SIZE_RANGE_M: tuple[float, float] = (100.0, 1000.0)


def generate_world(district: str, *, seed: int = 0, size_m: float = 400.0) -> "World":
    """Return a world that is the same for the same arguments, on every machine.

    Args:
        district: A name of `DISTRICTS`.
        seed: Not negative; another seed gives another place.
        size_m: Length of the sides of the square world, 100 to 1000 metres.

    Returns:
        A world named ``"park:7@400"``, its origin in the middle, all of its ground known.

    Raises:
        UnknownNameError: If only the district is wrong; it names the near misses.
        SettingsError: If the seed or the size is wrong, with all faults at once.
    """
    check_request(district, seed=seed, size_m=size_m)
    from reasoned_explorer.knowledge.cooccurrence import load_cooccurrence
    from reasoned_explorer.world.generator.generate import build_world

    return build_world(district, seed=seed, size_m=float(size_m), statistics=load_cooccurrence())


def check_request(district: str, *, seed: int, size_m: float) -> None:
    """Check that `generate_world` could make a world; it is not made.

    Raises:
        UnknownNameError: As `generate_world`.
        SettingsError: Likewise.
    """
    faults: list[Fault] = []
    faults += seed_faults(seed)
    low, high = SIZE_RANGE_M
    if not is_within(size_m, low, high):
        faults.append(Fault(f"size {size_m!r}", f"a length from {low:g} to {high:g} metres"))
    if not isinstance(district, str) or district not in DISTRICTS:
        unknown = UnknownNameError("district", str(district), tuple(DISTRICTS))
        if not faults:
            raise unknown
        faults = [*unknown.faults, *faults]
    if faults:
        raise SettingsError("generated world", faults)
