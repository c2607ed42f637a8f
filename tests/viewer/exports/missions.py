"""Missions that exports are tested on: one that was run, and one by hand that has everything a record can hold."""

from dataclasses import replace
from io import BytesIO
from pathlib import Path

from PIL import Image

from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import LegOutcome, TrackPoint
from reasoned_explorer.model.record import (
    CallRecord,
    ChoiceRecord,
    EpisodeRecord,
    FrontierRecord,
    InterventionRecord,
    LegRecord,
    MissionEnd,
    MissionHeader,
    MissionSummary,
    NodeRecord,
    StepRecord,
    ViewRecord,
)
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.world import World

#: In Monaco.
ORIGIN_DEG = (43.735, 7.42)

HEADER = MissionHeader(
    goal="Find me a bench, <b>now</b> & quietly",
    level=1,
    world="monaco",
    world_digest="0" * 64,
    attribution="© OpenStreetMap contributors, ODbL 1.0",
    start=(0.0, 0.0, 1.5, 0.0),
    planner="llm-rrt [scripted]",
    minds="scripted",
    captioner="perfect",
    vehicle="drone",
    clock="virtual",
    ct_label="modelled (gpt-2023)",
    settings={},
    seed=7,
    versions={"reasoned-explorer": "0.1.0"},
    goal_objects=((3, "bench", 30.0, 40.0, 2),),
    reference_length_m=50.0,
    reference_way=((0.0, 0.0), (30.0, 40.0)),
    origin_deg=ORIGIN_DEG,
)


def _leg(*points: tuple[float, float, float], outcome: LegOutcome, detail: str = "") -> LegRecord:
    track = tuple(TrackPoint(t_s, x_m, y_m, 1.5, 0.0) for t_s, x_m, y_m in points)
    return LegRecord(points[-1][1:], outcome, points[-1][0] - points[0][0], 10.0, detail, 0.1, 0.02, track)


STEPS = (
    StepRecord(
        step=0,
        started_s=0.0,
        ended_s=20.0,
        pose=(0.1, 0.0, 1.5, 0.0),
        point=0,
        views=(
            ViewRecord((0, 0, 0), 0.0, "A path leads on.", q=3.25, frontier=0),
            ViewRecord((0, 0, 1), 1.0, "", caption_fault="no answer", frontier=1),
        ),
        tree=(
            NodeRecord((0, 0, 0, 0), 1, "A bench under trees.", 4.0),
            NodeRecord((0, 0, 0, 0, 0), 2, "A square.", 2.5),
        ),
        choice=ChoiceRecord(0, 3.25, 10.0, 0.05, 3.2),
        legs=(
            _leg((8.0, 0.0, 0.0), (12.0, 0.0, 5.0), (15.0, 0.0, 10.0), outcome=LegOutcome.ARRIVED),
            _leg((15.0, 0.0, 10.0), (20.0, 3.0, 12.0), outcome=LegOutcome.COLLISION, detail="bench"),
        ),
        frontiers=(
            FrontierRecord(0, 0, 0.0, 10.0, 0.0, 3.25, False, "visited"),
            FrontierRecord(1, 0, 8.0, 5.0, 1.0, None, True, "open"),
        ),
        calls=(
            CallRecord("caption", "perfect", (0, 0, 0, 0), 1.0, 2.0),
            CallRecord("caption", "perfect", (0, 0, 0, 1), 1.0, 3.5),
        ),
        ct_s=8.0,
        tt_s=12.0,
        notes=("frontier 0 reached",),
        interventions=(InterventionRecord(13.0, "too close", "wall 0.4 m ahead", "stopped"),),
    ),
    StepRecord(
        step=1,
        started_s=20.0,
        ended_s=30.0,
        pose=(3.0, 12.0, 1.5, 0.5),
        point=1,
        views=(ViewRecord((1, 0, 0), 0.5, "A bench.", q=5.0, found=True, confidence=0.9, evidence="a bench, close"),),
        calls=(
            CallRecord("caption", "perfect", (1, 0, 0, 0), 21.0, 1.0),
            CallRecord("checker", "scripted", (1, 0, 0), 22.0, 4.0),
        ),
        ct_s=18.0,
        tt_s=12.0,
    ),
)
SUMMARY = MissionSummary(
    end=MissionEnd.FOUND,
    reason="a bench",
    declared=True,
    success=False,
    oracle_success=False,
    compliant=None,
    spl=0.0,
    casr=0.0,
    path_length_m=14.0,
    reference_length_m=50.0,
    distance_to_goal_m=39.0,
    ct_s=18.0,
    tt_s=12.0,
    plan_s=5.0,
    steps=2,
    judge="the nearest is 39 m away",
    collisions=("bench",),
)
RECORD = EpisodeRecord(HEADER, STEPS, SUMMARY)
CUT_OFF = EpisodeRecord(HEADER, STEPS[:1])
NOWHERE = replace(
    RECORD,
    header=replace(
        HEADER,
        world="none",
        world_digest="",
        origin_deg=None,
        goal_objects=(),
        reference_way=(),
        reference_length_m=None,
        attribution="",
    ),
    summary=replace(SUMMARY, success=None, oracle_success=None, spl=None, casr=None),
)


def png(colour: str) -> bytes:
    file = BytesIO()
    Image.new("RGB", (8, 8), colour).save(file, "PNG")
    return file.getvalue()


def keep(folder: Path, record: EpisodeRecord, *, world: World | None = None, pictures: bool = False) -> Path:
    """Put a mission into a folder, as ``rex run`` leaves it."""
    folder.mkdir(parents=True)
    (folder / "record.jsonl").write_bytes(record_bytes(record))
    if world is not None:
        save_world(world, folder / "world.rexworld")
    if pictures:
        (folder / "pictures").mkdir()
        for number, colour in enumerate(("red", "green")):
            (folder / "pictures" / f"0000-0000-{number:04d}.png").write_bytes(png(colour))
    return folder


def run_a_mission(folder: Path) -> Path:
    """Run a mission of half a minute in a generated place."""
    world = open_world("plaza:3@200")
    settings = MissionSettings(explorer=ExplorerSettings(t_max_s=40.0), planner="nearest-frontier")
    return keep(folder, Mission("Find me a bench", world, settings).run().record, world=world)
