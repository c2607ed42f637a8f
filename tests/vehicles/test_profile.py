import math

import pytest

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.profile import PROFILES, VehicleProfile


def test_the_authors_figures_stand_as_they_published_them():
    assert PROFILES["drone-authors"].speed_mps == 1.0
    assert PROFILES["drone-authors"].settle_s == 5.0
    assert not PROFILES["drone-authors"].collides
    assert PROFILES["go1-authors"].speed_mps == 0.2


def test_a_bad_profile_names_all_its_faults():
    with pytest.raises(SettingsError) as caught:
        VehicleProfile(
            name="broken",
            summary="",
            flies=True,
            speed_mps=0.0,
            acceleration_mps2=math.nan,
            turn_rate_radps=1.0,
            camera_height_m=1.0,
            radius_m=-0.3,
            settle_s=-1.0,
        )
    assert len(caught.value.faults) == 4
