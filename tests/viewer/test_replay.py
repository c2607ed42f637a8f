"""A replay is the record itself, and what follows from it agrees with it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.exploration.penalty import distance_penalty
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.replay import replay_json
from reasoned_explorer.viewer.runs import MissionFiles
from reasoned_explorer.viewer.worths import explorer_settings, penalty_curve, worths_of


def _replay(record: EpisodeRecord, *, rest: bytes = b"") -> dict[str, object]:
    files = MissionFiles("a", "A", record_bytes(record) + rest, pair_key="k")
    read: dict[str, object] = json.loads(replay_json(files, record))
    return read


def test_header_steps_and_summary_are_the_records_own(record: EpisodeRecord) -> None:
    replay = _replay(record)
    lines = [json.loads(line) for line in record_bytes(record).splitlines()]
    assert replay["header"] == lines[0]["header"]
    assert replay["steps"] == [line["step"] for line in lines[1:-1]]
    assert replay["summary"] == lines[-1]["summary"]
    assert replay["complete"] is True


def test_a_record_that_was_cut_off_is_shown_as_far_as_it_goes(record: EpisodeRecord) -> None:
    cut = replace(record, summary=None)
    replay = _replay(cut, rest=b'{"step":{"step":')
    assert replay["summary"] is None
    assert replay["complete"] is False
    assert len(replay["steps"]) == len(record.steps)  # type: ignore[arg-type]


def test_the_curve_is_the_missions_own_penalty() -> None:
    settings = ExplorerSettings(sharpness_per_m=0.1, half_distance_m=30.0)
    curve = penalty_curve(settings)
    assert len(curve) == 100
    assert curve[0][0] == 0.0
    assert curve[-1][0] >= 60.0
    for distance_m, sigma in curve:
        assert sigma == pytest.approx(distance_penalty(distance_m, sharpness_per_m=0.1, half_distance_m=30.0), abs=1e-3)


def test_settings_that_a_header_does_not_hold_are_the_usual_ones(record: EpisodeRecord) -> None:
    assert explorer_settings(record.header).t_max_s == 90.0
    for strange in ({}, {"explorer": None}, {"explorer": {"views": -3}}, {"explorer": "x"}, {"explorer": {"new": 1}}):
        assert explorer_settings(replace(record.header, settings=strange)) == ExplorerSettings()


def test_what_frontiers_were_worth_explains_each_choice(bench: Path, record: EpisodeRecord) -> None:
    """The one that was chosen is the best of those that there were, by the record's own figures."""
    with RunStore.read(bench) as store:
        records = [record, *(found for row in store.rows() if (found := store.record(row)))]
    chosen = compared = 0
    for one in records:
        for step, worths in zip(one.steps, worths_of(one), strict=True):
            if step.choice is None:
                continue
            chosen += 1
            mine = next(worth for worth in worths if worth[0] == step.choice.frontier)
            assert mine[1:] == (step.choice.q, step.choice.distance_m, step.choice.penalty, step.choice.value)
            values = [worth[4] for worth in worths]
            assert None not in values, "the graph could not be made again"
            assert max(values) == step.choice.value  # type: ignore[type-var]
            compared += len(worths) > 1
    assert chosen > 20
    assert compared > 15


def test_where_the_graph_cannot_be_made_again_nothing_is_said(record: EpisodeRecord) -> None:
    steps = tuple(
        step
        if step.choice is None
        else replace(step, choice=replace(step.choice, distance_m=step.choice.distance_m + 5.0))
        for step in record.steps
    )
    worths = worths_of(replace(record, steps=steps))
    strayed = next(place for place, step in enumerate(steps) if step.choice is not None)
    choice = steps[strayed].choice
    assert choice is not None
    for frontier, _, distance_m, sigma, value in worths[strayed]:
        if frontier == choice.frontier:
            assert (distance_m, sigma, value) == (choice.distance_m, choice.penalty, choice.value)
        else:
            assert (distance_m, sigma, value) == (None, None, None)
    # Numbers that fit nothing are no harm.
    broken = replace(
        record.steps[0], point=99, frontiers=tuple(replace(each, id=each.id + 50) for each in record.steps[0].frontiers)
    )
    assert len(worths_of(replace(record, steps=(broken, *record.steps[1:])))) == len(record.steps)
    assert worths_of(replace(record, steps=())) == []
