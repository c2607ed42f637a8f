"""What an AirSim drone tells of itself beside its pose: what a guard looks after."""

from reasoned_explorer.clock import Clock
from reasoned_explorer.model.errors import PartError
from reasoned_explorer.vehicles.airsim.api import AirSimApi, Moment
from reasoned_explorer.vehicles.airsim.corridor import Corridor
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.safety.telemetry import Telemetry

#: What a small drone goes through.
CORRIDOR = Corridor()


class Senses:
    """The last news of a drone.

    Args:
        api: Of the simulator.
        settings: What is asked for.
        clock: The mission's.
    """

    def __init__(self, api: AirSimApi, settings: DriverSettings, clock: Clock) -> None:
        self._api, self._settings, self._clock = api, settings, clock
        self._reads_gps, self._reads_depth = settings.reads_gps, True
        self._fix_s: float | None = None
        self._range_m: float | None = None
        #: Whether news is asked for all the time, and when it last came, on the mission's clock.
        self.is_listening = False
        self._heard_s = 0.0

    async def read(self, *, ranges: bool = True) -> None:
        """Ask for the news.

        Args:
            ranges: Whether to ask what stands ahead, too: a depth picture takes some time.

        Raises:
            PartError: If the link fails, or there is no such distance sensor.
        """
        if self._reads_gps:
            try:
                self._fix_s = await self._api.fix_s()
            except PartError as fault:
                if "refused" not in fault.reason:
                    raise
                self._reads_gps, self._fix_s = False, None
        if ranges:
            self._range_m = await self._ahead_m()

    async def _ahead_m(self) -> float | None:
        """Return how far it is to what stands ahead; None where nothing tells."""
        sensor, camera = self._settings.range_sensor, self._settings.range_camera
        told_m = [] if sensor is None else [await self._api.range_m(sensor)]
        if camera is not None and self._reads_depth:
            try:
                told_m.append(await self._api.depth_ahead_m(camera, CORRIDOR))
            except PartError as fault:
                if "refused" not in fault.reason:
                    raise
                self._reads_depth = False  # the simulator has no such camera, or no depth
        return min(told_m, default=None)

    def hear(self, *, listening: bool) -> None:
        """Note that the drone was heard of, and whether it will be asked on."""
        self.is_listening, self._heard_s = listening, self._clock.now_s()

    def telemetry(self, moment: Moment) -> Telemetry:
        """Return all that is known."""
        return Telemetry(
            pose=moment.believed,
            t_s=moment.t_s,
            speed_mps=moment.speed_mps,
            yaw_rate_radps=moment.yaw_rate_radps,
            link_age_s=self._clock.now_s() - self._heard_s if self.is_listening else None,
            position_age_s=None if self._fix_s is None else max(0.0, moment.t_s - self._fix_s),
            range_ahead_m=self._range_m,
        )
