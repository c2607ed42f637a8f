"""Machines that look and move."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Leg, PartError, View
from reasoned_explorer.vehicles.profile import VehicleProfile


class Vehicle(ABC):
    """A machine that can look in given directions and go to a point.

    Used as an asynchronous context manager: `start` arms or takes off, `close` leaves it safe. Commands return what was
    really executed after the machine's limits. Time passes on the clock that the vehicle was made with.
    """

    profile: VehicleProfile

    async def connect(self) -> None:
        """Make ready to look without moving: nothing is armed, nothing takes off. For dry runs, instead of `start`.

        Raises:
            PartError: If the machine cannot: by default none can.
        """
        raise PartError("vehicle", f"{self.profile.name} cannot look without being started; no dry run with it")

    async def start(self) -> None:  # noqa: B027 - most machines need nothing
        """Make ready to look and move."""

    async def close(self) -> None:  # noqa: B027
        """Leave the machine safe: hover, land or stand still. Safe to call twice."""

    @property
    @abstractmethod
    def pose(self) -> Pose:
        """Where the machine believes it is (its filter's estimate, not the truth)."""

    @abstractmethod
    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Take one view in each heading (compass headings, [0, 2π)), in that order.

        Raises:
            PartError: If the camera or the link fails.
        """

    @abstractmethod
    async def go_to(self, target: Pose) -> Leg:
        """Go to a point in a straight leg and face the target's heading; stop and report what comes in between.

        Raises:
            PartError: If the link fails; what comes of the world (a collision, a stop) is an outcome of the leg.
        """

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
