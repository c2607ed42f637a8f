"""When things happened, and what is said of them."""

from reasoned_explorer.viewer.exports import moments, told
from reasoned_explorer.viewer.exports.mission import ExportedMission
from tests.viewer.exports.missions import CUT_OFF, NOWHERE, RECORD, STEPS


def test_a_vehicle_is_where_its_track_says_and_stands_at_the_start_before() -> None:
    track = moments.poses(RECORD)
    assert [point.t_s for point in track] == [0.0, 8.0, 12.0, 15.0, 20.0]
    assert (track[0].x_m, track[0].y_m) == (0.0, 0.0)
    assert (track[-1].x_m, track[-1].y_m) == (3.0, 12.0)


def test_views_are_seen_when_captions_are_asked_for_and_said_when_all_have_come() -> None:
    look = moments.looks(STEPS[0])[0]
    assert (look.seen_s, look.said_s, len(look.views)) == (1.0, 4.5, 2)
    look = moments.looks(STEPS[1])[0]
    assert moments.checked_s(STEPS[1], look, look.views[0]) == 26.0


def test_a_step_is_decided_when_the_vehicle_sets_out() -> None:
    assert moments.decided_s(STEPS[0]) == 8.0
    assert moments.decided_s(STEPS[1]) == 30.0


def test_new_frontiers_are_open_while_the_vehicle_travels() -> None:
    found = [(moment.t_s, [each.state for each in moment.frontiers]) for moment in moments.frontier_moments(RECORD)]
    assert found == [(8.0, ["open", "open"]), (20.0, ["visited", "open"])]
    chosen = list(moments.choice_moments(RECORD))
    assert [(each.t_s, each.until_s, each.there) for each in chosen] == [(8.0, 20.0, (0.0, 10.0))]


def test_the_log_tells_of_all_that_happened_in_the_order_of_time() -> None:
    lines = told.lines(RECORD)
    assert [line.t_s for line in lines] == sorted(line.t_s for line in lines)
    said = {(line.topic, line.t_s): line for line in lines}
    assert said["caption", 22.0].text == "step 1, heading 29°: A bench."
    assert said["checker", 26.0].text == "step 1, heading 29°: goal seen (confidence 0.90): a bench, close"
    assert said["choice", 8.0].text == "step 0: to frontier 0, 10.0 m away: Q 3.25 - penalty 0.05 = 3.20"
    assert said["leg", 20.0].text == "collision with bench"
    assert said["guard", 13.0].text == "too close: wall 0.4 m ahead; stopped"
    assert said["end", 30.0].text == "failure, declared “Found Goal”, the nearest is 39 m away"
    assert [line.topic for line in lines if line.warns] == ["caption", "guard", "leg"]


def test_the_imagined_tree_is_indented_by_its_depth() -> None:
    assert told.tree_of(STEPS[0]).splitlines() == [
        "step 0",
        "view 0, heading 0°, Q 3.25: A path leads on.",
        "  [4.00] A bench under trees.",
        "    [2.50] A square.",
        "view 1, heading 57°, Q -: no answer",
    ]


def test_a_record_that_was_cut_off_and_one_that_nobody_judged_say_so() -> None:
    assert told.about(ExportedMission(CUT_OFF, "x"))["outcome"].startswith("cut off")
    about = told.about(ExportedMission(NOWHERE, "x"))
    assert about["place"] == "no world is known"
    assert about["outcome"].startswith("nobody judged")
    assert "simulated seconds" in about["time"]
    assert "spl" not in about
