"""Human success: what people say, where the robot said so in time; beside what the judge says of the same missions."""

import random
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from reasoned_explorer.evaluation.human_success import FIGURES, Judged, figures_of, people_sheet
from reasoned_explorer.evaluation.ratings import Answer, Rating
from reasoned_explorer.evaluation.row import MissionRow
from tests.evaluation.report.rows import made_row

YES, PARTLY, NO = Answer.YES, Answer.PARTLY, Answer.NO
NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


def said(row: MissionRow, rater: str, answer: Answer, how_well: int = 3, comment: str = "", after_s: int = 0) -> Rating:
    key = (row.score.vehicle, row.method, row.mission_id)
    return Rating(rater, *key, answer, how_well, comment, NOON + timedelta(seconds=after_s), "0.1.0")


def judged(rows: Sequence[MissionRow], *ratings: Rating) -> Judged:
    return Judged.of(rows, ratings)


def test_a_mission_is_as_good_as_the_share_of_its_raters_who_say_yes() -> None:
    row = made_row(declared=True, in_place=True)
    one = judged([row], said(row, "Ann", YES), said(row, "Bob", NO), said(row, "Cyd", PARTLY), said(row, "Dan", YES))
    (mission,) = one.missions
    assert mission.human_success == 0.5
    assert mission.values["yes or partly"] == 0.75
    assert mission.values["automatic success"] == 1.0
    assert mission.values["human − automatic"] == -0.5
    assert mission.is_disputed, "half of them say something else than the judge"


@pytest.mark.parametrize("late", [False, True])
def test_who_did_not_say_in_time_that_it_was_found_has_no_success_whatever_people_say(late: bool) -> None:
    row = made_row(declared=late, in_place=True, ct_s=1500.0, tt_s=900.0) if late else made_row(declared=False)
    assert not late or row.score.over_time
    (mission,) = judged([row], said(row, "Ann", YES, 5)).missions
    assert mission.human_success == 0.0
    assert mission.values["yes or partly"] == 0.0
    assert mission.values["how well, 1–5"] == 5.0, "what they saw stays what they saw"
    assert not mission.is_disputed


def test_partly_is_no_success() -> None:
    row = made_row(declared=True)
    (mission,) = judged([row], said(row, "Ann", PARTLY)).missions
    assert mission.human_success == 0.0
    assert mission.is_disputed


def test_the_latest_of_each_rater_counts_and_the_others_are_counted() -> None:
    row = made_row()
    found = judged([row], said(row, "Ann", NO), said(row, "Bob", YES), said(row, "Ann", YES, after_s=9))
    assert found.missions[0].human_success == 1.0
    assert (found.count, found.earlier, found.raters) == (2, 1, ("Ann", "Bob"))


def test_ratings_of_missions_that_are_not_there_any_more_are_counted_and_left_out() -> None:
    row, other = made_row(number=0), made_row(number=1)
    found = judged([row], said(row, "Ann", YES), said(other, "Ann", YES))
    assert len(found.missions) == 1
    assert found.lost == 1


def test_intervals_draw_places_as_a_whole_and_never_claim_certainty() -> None:
    rows = [made_row(number=number, declared=True) for number in range(12)]
    places = {row.mission_id: row.place for row in rows}
    all_yes = figures_of(judged(rows, *(said(row, "Ann", YES) for row in rows)).missions, places=places)
    assert all_yes["human success"].value == 1.0
    assert all_yes["human success"].interval == "Wilson"
    assert all_yes["human success"].low < 0.8
    mixed = judged(rows, *(said(row, "Ann", YES if number % 3 else NO) for number, row in enumerate(rows)))
    found = figures_of(mixed.missions, places=places)
    assert found["human success"].interval == "clustered bootstrap"
    # Number 0, 3, 6 … are of one place: drawn as a whole, nothing to everything may come of it.
    assert found["human success"].low == 0.0
    assert found["human success"].high == 1.0
    one_place = figures_of(mixed.missions, places=dict.fromkeys(places, "park"))
    assert one_place["human success"].interval == "Wilson"
    assert one_place["human success"].low > 0.3
    assert figures_of([], places={}) == {}


def test_figures_do_not_hang_on_the_order_of_rows() -> None:
    rows = [made_row(number=number, declared=number % 2 == 0) for number in range(20)]
    ratings = [said(row, rater, luck) for row in rows for rater, luck in (("Ann", YES), ("Bob", PARTLY))]
    places = {row.mission_id: row.place for row in rows}
    turned = list(rows)
    random.Random(1).shuffle(turned)
    assert figures_of(judged(rows, *ratings).missions, places=places) == figures_of(
        judged(turned, *ratings).missions, places=places
    )


def test_the_text_table_has_levels_and_methods_and_says_how_well_raters_agree() -> None:
    rows = [made_row(method, number) for method in ("llm-rrt", "random") for number in range(4)]
    sheet = people_sheet(judged(rows, *(said(row, "Ann", YES, 4) for row in rows)), ("random", "llm-rrt"))
    assert sheet.title == "What people say (1 rater)"
    assert sheet.head == ("level", "planner", "missions", "ratings", *FIGURES)
    assert [line[:2] for line in sheet.lines[-2:]] == [("all", "random"), ("all", "llm-rrt")]
    assert len(sheet.lines) == 2 * 5
    assert sheet.notes[0] == "Agreement on yes, partly or no: not defined: one rater only."


def test_vehicles_are_never_pooled() -> None:
    row = made_row()
    other = replace(row, score=replace(row.score, vehicle="go1"))
    found = judged([row, other], said(row, "Ann", YES), said(other, "Ann", NO))
    sheet = people_sheet(found, ("llm-rrt",))
    assert [line[1] for line in sheet.lines if line[0] == "all"] == ["llm-rrt · drone", "llm-rrt · go1"]
