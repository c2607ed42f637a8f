from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.planning.setting_pairs import parse_planner_settings


def test_settings_are_json_or_text() -> None:
    given_pairs = ["depth=1", "restart=true", "depth-weight=0.5", "name=x y"]
    assert parse_planner_settings(given_pairs) == {"depth": 1, "restart": True, "depth_weight": 0.5, "name": "x y"}


def test_settings_that_make_no_sense_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        parse_planner_settings(["depth", "=1", "restart=true", "restart=false"])
    assert len(raised.value.faults) == 3


@given(st.text(max_size=40))
def test_whatever_is_typed_is_understood_or_refused(text: str) -> None:
    with suppress(SettingsError):
        parse_planner_settings([text])
