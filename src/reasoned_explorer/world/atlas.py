"""Fast answers to questions about a world: each part is built when it is first asked for, and then kept."""

from functools import cached_property

from reasoned_explorer.model.checks import kind_faults
from reasoned_explorer.model.errors import WorldError
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.geodesic import Geodesics
from reasoned_explorer.world.index import ObjectIndex
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.sight import SightLines
from reasoned_explorer.world.world import World


class Atlas:
    """A world with its indices.

    Args:
        world: The world; it is never changed. A world that is finer than files keep it is asked about as they do.

    Raises:
        WorldError: If it is no world.
    """

    def __init__(self, world: World) -> None:
        if faults := kind_faults("the world", world, World, "a World", "open_world makes one of a name or a file"):
            raise WorldError("atlas", faults)
        self.world = rounded(world)

    @cached_property
    def digest(self) -> str:
        """A fingerprint of what the world contains (`world_digest`)."""
        return world_digest(self.world)

    @cached_property
    def ground(self) -> GroundRaster:
        """What ground is where."""
        return GroundRaster.of(self.world)

    @cached_property
    def index(self) -> ObjectIndex:
        """Which objects are near."""
        return ObjectIndex.of(self.world)

    @cached_property
    def sight(self) -> SightLines:
        """What can be seen from where."""
        return SightLines.of(self.world)

    @cached_property
    def geodesics(self) -> Geodesics:
        """Shortest ways for walkers and flyers."""
        return Geodesics.of(self.world, self.ground)
