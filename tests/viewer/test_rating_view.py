"""What a rater is shown of a mission, and that nothing tells more."""

import math
from dataclasses import replace

import pytest

from reasoned_explorer.model import Camera
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.rating_view import blind_map, blind_view, end_of, last_captions, outlooks, way_of
from reasoned_explorer.world.opening import open_world


def test_the_way_leads_from_the_start_to_where_it_really_ended(record: EpisodeRecord) -> None:
    way, end = way_of(record), end_of(record)
    assert way[0] == pytest.approx(record.header.start[:2], abs=0.06)
    assert way[-1] == pytest.approx((end.x_m, end.y_m), abs=0.06)
    told = sum(len(leg.track) for step in record.steps for leg in step.legs)
    assert len(way) < told, "points that tell of pace are left out"


def test_a_mission_that_never_moved_ends_where_it_began(record: EpisodeRecord) -> None:
    still = EpisodeRecord(record.header, (), None)
    assert way_of(still) == [tuple(round(value, 1) for value in record.header.start[:2])]
    assert blind_view(still)["end"]["x"] == round(record.header.start[0], 1)
    assert last_captions(still) == []


@pytest.mark.parametrize("fov_deg", [60, 90, 120, 179])
def test_pictures_leave_no_direction_out(record: EpisodeRecord, fov_deg: float) -> None:
    camera = Camera(horizontal_fov_rad=math.radians(fov_deg))
    looks = outlooks(record, camera)
    headings = sorted(look.pose.heading_rad % math.tau for look in looks)
    gaps = [b - a for a, b in zip(headings, [*headings[1:], headings[0] + math.tau], strict=True)]
    assert max(gaps) < camera.horizontal_fov_rad
    assert [look.label for look in looks].count("ahead") == 1
    (ahead,) = [look for look in looks if look.label == "ahead"]
    assert math.remainder(ahead.pose.heading_rad - end_of(record).heading_rad, math.tau) == pytest.approx(0.0)


def test_neither_the_view_nor_the_map_hang_on_what_the_judge_and_the_planner_know(record: EpisodeRecord) -> None:
    """Whatever they knew, a rater sees the same: so nothing of it can be read from what is shown."""
    world = open_world("plaza:3@200")
    header = replace(
        record.header,
        planner="another",
        minds="others",
        goal_objects=((7, "bench", 80.0, 80.0, 1),),
        reference_way=((-99.0, -99.0), (99.0, 99.0)),
        reference_length_m=1.0,
        success_radius_m=99.0,
        understood=("somewhere else",),
        notes=("a note",),
    )
    steps = tuple(
        replace(
            step,
            frontiers=(),
            tree=(),
            choice=None,
            ct_s=1e6,
            tt_s=1e6,
            started_s=0.0,
            ended_s=0.0,
            notes=("a note",),
            legs=tuple(replace(leg, duration_s=0.0, detail="x", target=(99.0, 99.0)) for leg in step.legs),
        )
        for step in record.steps
    )
    other = EpisodeRecord(header, steps, None)
    assert blind_view(other) == blind_view(record)
    assert blind_map(other, world) == blind_map(record, world)


def test_captions_are_those_of_the_last_look(record: EpisodeRecord) -> None:
    last = next(step for step in reversed(record.steps) if step.views)
    found = last_captions(record)
    assert found
    assert set(found) <= {view.caption for view in last.views}
