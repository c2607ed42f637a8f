"""What people say of a run's missions, beside what the judge says: a section where there are ratings.

Raters stand here without their names: who wants those asks the run's database.
"""

from collections.abc import Sequence

from reasoned_explorer.evaluation.human_success import (
    FIGURES,
    Judged,
    RatedMission,
    agreement_words,
    figures_of,
    said_of,
)
from reasoned_explorer.evaluation.ratings import QUESTION_TEXT
from reasoned_explorer.evaluation.report.links import link
from reasoned_explorer.evaluation.report.page import Section
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.tables import (
    METRIC_HEAD,
    Cell,
    Group,
    Line,
    Table,
    Value,
    metric_cell,
    metric_record,
)
from reasoned_explorer.evaluation.wording import level_name, share, signed

#: With more missions than this the table of those that are disputed is cut on the page, not in its file.
MOST_DISPUTED = 200
_WRITE = {"human − automatic": signed, "how well, 1–5": lambda value: share(value, 1)}


def people_section(study: Study, judged: Judged) -> Section | None:
    """Return the section; None where nobody rated."""
    if not judged.missions:
        return None
    by_method = _by_method(study, judged)
    raters, missions = len(judged.raters), len(judged.missions)
    asked = (
        f"{raters} {'people' if raters > 1 else 'person'} answered “{QUESTION_TEXT}” for {missions:,} missions, blind "
        "to the method and to what the judge says. A mission is a success as people see it where the robot said in "
        "time that it had found it and they say yes; where several rated it, their share counts."
    )
    texts = [asked, *(f"Agreement on {name}: {agreement_words(one)}." for name, one in judged.agreements().items())]
    disputed = judged.disputed
    texts.append(
        f"Disputed, since at least half of the raters say something else than the judge: {len(disputed):,} of "
        f"{missions:,} missions."
        if disputed
        else f"In none of the {missions:,} missions do half of the raters say something else than the judge."
    )
    if judged.lost:
        texts.append(f"{judged.lost:,} ratings are of missions that are not in this report; they do not count.")
    tables = [_people_table(study, by_method)]
    if disputed:
        tables.append(_disputed_table(study, disputed))
    folded = (_levels_table(study, by_method, judged.levels),) if len(judged.levels) > 1 else ()
    return Section("people", "What people say", texts=tuple(texts), tables=tuple(tables), folded=folded)


def _by_method(study: Study, judged: Judged) -> dict[str, list[RatedMission]]:
    """Return rated missions by method as the report names it."""
    found: dict[str, list[RatedMission]] = {method: [] for method in study.methods}
    for mission in judged.missions:
        found[_shown(study, mission)].append(mission)
    return {method: missions for method, missions in found.items() if missions}


def _shown(study: Study, mission: RatedMission) -> str:
    """Return what the report calls a mission's method."""
    mine = (mission.row.method, mission.row.score.vehicle)
    return next(name for name in study.methods if (study.stored[name], study.vehicle[name]) == mine)


def _people_table(study: Study, by_method: dict[str, list[RatedMission]]) -> Table:
    lines, records = [], []
    for method, missions in by_method.items():
        lines.append(_line(study, method, missions))
        records += _records(study, [method, level_name(None)], missions)
    return Table(
        key="people",
        caption="Success as people see it beside that of the judge, over the same missions, with 95 % intervals",
        columns=("method", "missions", "ratings", *FIGURES),
        groups=(Group("", tuple(lines)),),
        note=_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=tuple(records),
    )


def _levels_table(study: Study, by_method: dict[str, list[RatedMission]], levels: Sequence[int]) -> Table:
    groups, records = [], []
    for level in levels:
        lines = []
        for method, missions in by_method.items():
            mine = [mission for mission in missions if mission.row.level == level]
            if mine:
                lines.append(_line(study, method, mine))
                records += _records(study, [method, level_name(level)], mine)
        groups.append(Group(f"Level {level}", tuple(lines)))
    return Table(
        key="people-levels",
        caption="Success as people see it at each level",
        columns=("method", "missions", "ratings", *FIGURES),
        groups=tuple(groups),
        note=_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=tuple(records),
    )


def _disputed_table(study: Study, disputed: Sequence[RatedMission]) -> Table:
    lines, records = [], []
    for mission in disputed:
        row, method = mission.row, _shown(study, mission)
        verdict = "success" if row.score.success else "failure"
        comments = " / ".join(said.comment.replace("\n", " ") for said in mission.ratings if said.comment)
        cells = (
            Cell(row.mission_id, "", link(method=method, mission=row.mission_id), f"this mission of {method}"),
            Cell(level_name(row.level)),
            Cell(row.goal),
            Cell(f"{verdict}: {row.judge}" if row.judge else verdict),
            Cell(said_of(mission)),
            Cell(comments),
        )
        lines.append(Line(method, cells, method))
        for said in mission.ratings:
            known: tuple[Value, ...] = (method, row.mission_id, row.level, row.goal, int(row.score.success), row.judge)
            records.append((*known, said.answer.value, said.how_well, said.comment))
    left = len(lines) - MOST_DISPUTED
    cut = f" {left:,} more stand in its file." if left > 0 else ""
    return Table(
        key="disputed",
        caption="Missions of which at least half of the raters say something else than the judge",
        columns=("method", "mission", "level", "goal", "the judge", "people: answer, how well", "comments"),
        groups=(Group("", tuple(lines[:MOST_DISPUTED])),),
        note="The judge measures: in place, in sight, in time, the goal’s conditions kept, by what the world’s data "
        f"say. People look at pictures. Either may be wrong.{cut}",
        head=("method", "mission_id", "level", "goal", "success", "judge", "answer", "how_well", "comment"),
        records=tuple(records),
        words=True,
    )


def _line(study: Study, method: str, missions: Sequence[RatedMission]) -> Line:
    found = figures_of(missions, places=study.place_of, seed=study.about.seed)
    ratings = sum(len(mission.ratings) for mission in missions)
    cells = [metric_cell(found[name], _WRITE.get(name, share)) for name in FIGURES]
    return Line(method, (Cell(f"{len(missions):,}"), Cell(f"{ratings:,}"), *cells), method)


def _records(study: Study, first: Sequence[Value], missions: Sequence[RatedMission]) -> list[tuple[Value, ...]]:
    found = figures_of(missions, places=study.place_of, seed=study.about.seed)
    return [record for name in FIGURES for record in metric_record(first, found[name])]


_NOTE = (
    "Over the missions that people rated, not all. Human success: said in time that it had found it, and people say "
    "yes; with several raters, their share. Automatic: what the judge says of the same missions. The intervals are of "
    "missions and places; other raters may judge otherwise."
)
