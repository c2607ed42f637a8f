from dataclasses import replace

import numpy as np
import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.verdict import Grade, PositionVerdict
from reasoned_explorer.vehicles.safety import (
    CheckVerdict,
    Circle,
    OperatorStop,
    Polygon,
    SafetyLimits,
    Telemetry,
    preflight,
)
from tests.exploration.fakes import FakeVehicle

FENCED = SafetyLimits(fence=Circle(0.0, 0.0, 50.0))
GOOD = {"link_age_s": 0.1, "position": PositionVerdict(Grade.GOOD), "battery": 0.9, "range_ahead_m": 12.3}


class Machine(FakeVehicle):
    def __init__(self, clock, image, told):
        super().__init__(clock)
        self.image, self.told = image, told

    def telemetry(self):
        return Telemetry(**{"pose": self._pose, **self.told})

    async def look(self, headings_rad):
        return [replace(view, image=self.image) for view in await super().look(headings_rad)]


def picture(width=224, height=224):
    return np.random.default_rng(1).integers(0, 255, (height, width, 3), np.uint8)


def listed(*, image=None, told=None, limits=FENCED, broken=(), pressed=False, reachable=True, **more):
    clock, stop = VirtualClock(), OperatorStop()
    stop.is_reachable = reachable
    if pressed:
        stop.press()
    machine = Machine(clock, picture() if image is None else image, {**GOOD, **(told or {})})
    machine.broken = set(broken)
    return {item.name: item for item in clock.run(preflight(machine, limits, stop=stop, **more))}


def test_a_machine_that_is_fit_passes_all():
    items = listed()
    assert list(items) == ["link", "position", "camera", "geofence", "obstacles", "battery", "limits", "stop switch"]
    assert {item.verdict for item in items.values()} == {CheckVerdict.OK}
    assert items["camera"].seen == "224 × 224 pixels"
    assert not any(item.remedy for item in items.values())


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("link", {"told": {"link_age_s": 5.0}}),
        ("position", {"told": {"position": PositionVerdict(Grade.STALE, "no fix for 9 s")}}),
        ("position", {"told": {"position_age_s": 9.0}}),
        ("position", {"told": {"pose": Pose(float("nan"), 0.0)}}),
        ("camera", {"broken": ("camera",)}),
        ("camera", {"image": picture(16, 16)}),
        ("camera", {"image": picture(640, 64)}),
        ("camera", {"image": np.zeros((224, 224, 3), np.uint8)}),
        ("camera", {"image": np.full((224, 224, 3), 90, np.uint8)}),
        ("camera", {"image": np.full((224, 224), 90, np.uint8)}),
        ("camera", {"pictures_vary": True}),
        ("geofence", {"limits": SafetyLimits(fence=Polygon(((5, 5), (9, 5), (9, 9))))}),
        ("geofence", {"keep_out_at": lambda x, y: True}),
        ("battery", {"told": {"battery": 0.1}}),
        ("limits", {"limits": replace(FENCED, speed_mps=0.5)}),
        ("limits", {"limits": replace(FENCED, lowest_m=10.0)}),
        ("limits", {"limits": replace(FENCED, braking_mps2=0.1)}),
        ("stop switch", {"reachable": False}),
        ("stop switch", {"pressed": True}),
    ],
)
def test_what_is_wrong_is_said_with_what_to_do(name, wrong):
    item = listed(**wrong)[name]
    assert item.verdict is CheckVerdict.FAULT
    assert item.seen
    assert item.remedy


@pytest.mark.parametrize("name", ["position", "battery", "link", "obstacles"])
def test_what_is_not_told_is_unknown(name):
    silent = {"link_age_s": None, "position": None, "battery": None, "range_ahead_m": None}
    item = listed(told=silent)[name]
    assert (item.verdict, bool(item.remedy)) == (CheckVerdict.UNKNOWN, True)
    assert listed(limits=SafetyLimits())["geofence"].verdict is CheckVerdict.UNKNOWN


def test_what_looks_ahead_is_told_and_that_nothing_does():
    assert listed()["obstacles"].seen == "something 12.3 m ahead"
    assert listed(told={"range_ahead_m": float("inf")})["obstacles"].seen == "nothing in sight ahead"
    blind = listed(told={"range_ahead_m": None})["obstacles"]
    assert blind.seen == "no range ahead: obstacles are not seen"
    by_the_world = listed(told={"range_ahead_m": None}, range_ahead_m=lambda pose: 4.0)["obstacles"]
    assert (by_the_world.verdict, by_the_world.seen) == (CheckVerdict.OK, "something 4.0 m ahead")


def test_without_a_link_the_rest_is_not_asked():
    class Lost(Machine):
        async def refresh(self):
            raise PartError("link", "nobody there")

    clock = VirtualClock()
    items = clock.run(preflight(Lost(clock, None, {}), FENCED, stop=OperatorStop()))
    assert items[0].seen == "link: nobody there"
    assert {item.verdict for item in items[1:5]} == {CheckVerdict.UNKNOWN}
