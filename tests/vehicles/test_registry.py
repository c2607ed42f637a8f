import sys
from types import ModuleType

import pytest

from reasoned_explorer.model import InputError, UnknownNameError
from reasoned_explorer.registry import Entry, Registry
from reasoned_explorer.vehicles import registry
from reasoned_explorer.vehicles.profile import PROFILES
from reasoned_explorer.vehicles.registry import VEHICLES, vehicle_profile


def test_every_profile_is_registered_by_its_name():
    assert set(PROFILES) <= set(VEHICLES.names())
    for name, profile in PROFILES.items():
        assert vehicle_profile(name) is profile


def test_a_misspelt_name_answers_with_the_near_misses():
    with pytest.raises(UnknownNameError, match="did you mean drone"):
        vehicle_profile("dron")


def test_another_packages_vehicle_must_be_a_profile(monkeypatch):
    module = ModuleType("somebodys_rover")
    module.make, module.wrong = lambda: PROFILES["go1"], lambda: "a rover"
    monkeypatch.setitem(sys.modules, "somebodys_rover", module)
    entries = (Entry("rover", "somebodys_rover:make"), Entry("bad-rover", "somebodys_rover:wrong"))
    monkeypatch.setattr(registry, "VEHICLES", Registry("vehicle", "vehicles", entries))
    assert vehicle_profile("rover") is PROFILES["go1"]
    with pytest.raises(InputError, match="VehicleProfile"):
        vehicle_profile("bad-rover")
