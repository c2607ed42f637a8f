"""What stands in a report, in which order."""

from reasoned_explorer.evaluation.human_success import Judged
from reasoned_explorer.evaluation.report.about import TraceSource
from reasoned_explorer.evaluation.report.curves import (
    casr_curves,
    casr_table,
    observations,
    radius_curves,
    radius_table,
    relations,
    relations_table,
)
from reasoned_explorer.evaluation.report.figures import (
    causes_chart,
    collisions_chart,
    ct_casr_chart,
    curves_chart,
    differences_chart,
    levels_chart,
)
from reasoned_explorer.evaluation.report.looks import Look
from reasoned_explorer.evaluation.report.page import Section
from reasoned_explorer.evaluation.report.people import people_section
from reasoned_explorer.evaluation.report.results import (
    MOST_CITIES,
    causes_table,
    cities_table,
    collisions_table,
    differences_table,
    every_level_table,
    headroom_table,
    levels_table,
    overall_table,
    spent_table,
)
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.trajectories import pair_of, pictures


def sections_of(
    study: Study, looks: dict[str, Look], traces: TraceSource | None, judged: Judged | None = None
) -> tuple[Section, ...]:
    """Return all sections but the paper's tables and the missions, which the page has in any case."""
    people = people_section(study, judged) if judged else None
    return (
        Section(
            "results",
            "Results",
            tables=(overall_table(study), spent_table(study), levels_table(study)),
            folded=(every_level_table(study),),
        ),
        _differences(study, looks),
        *([people] if people else []),
        Section(
            "levels",
            "Arriving and noticing it",
            texts=(
                "Between SR and OSR lie missions that had been in place and did not end there, as the paper found.",
            ),
            charts=(levels_chart(study, looks),),
        ),
        *_over_time(study, looks),
        _radius(study, looks),
        Section(
            "causes",
            "Why missions failed",
            charts=(causes_chart(study),),
            tables=(causes_table(study),),
        ),
        Section(
            "collisions",
            "Collisions",
            charts=(collisions_chart(study, looks),),
            folded=(collisions_table(study),),
        ),
        _trajectories(study, traces),
        _cities(study),
    )


def _differences(study: Study, looks: dict[str, Look]) -> Section:
    table, chart = differences_table(study), differences_chart(study, looks)
    if table is None or chart is None:
        return Section("differences", "Differences", texts=("There is nothing to compare: the run has one method.",))
    headroom = headroom_table(study)
    tables = (table,) if headroom is None else (table, headroom)
    return Section("differences", "Differences", charts=(chart,), tables=tables)


def _over_time(study: Study, looks: dict[str, Look]) -> tuple[Section, Section]:
    curves = casr_curves(study)
    chart = curves_chart(
        study, looks, curves, key="casr-over-tmax", caption="CASR over T_max.", axis="T_max, min", what="CASR"
    )
    found = relations(study)
    return (
        Section("time", "The time that is allowed", charts=(chart,), folded=(casr_table(curves),)),
        Section(
            "computing",
            "Thinking and acting",
            texts=(
                "The paper names three things that CASR can show when CT varies. Each stands here as it claims it.",
            ),
            charts=(ct_casr_chart(study, looks),),
            observations=observations(found),
            folded=(relations_table(found),),
        ),
    )


def _radius(study: Study, looks: dict[str, Look]) -> Section:
    curves = radius_curves(study)
    table = radius_table(curves)
    if table is None:
        return Section("radius", "How near is near enough", texts=("Missions were judged at one radius only.",))
    chart = curves_chart(
        study, looks, curves, key="success-over-radius", caption="Success over R.", axis="R, m", what="SR"
    )
    return Section("radius", "How near is near enough", charts=(chart,), folded=(table,))


def _trajectories(study: Study, traces: TraceSource | None) -> Section:
    title = "Side by side"
    if pair_of(study) is None:
        return Section("trajectories", title, texts=("It takes two methods to show trajectories side by side.",))
    if traces is None:
        return Section("trajectories", title, texts=("The run kept no records, so that no trajectories can be shown.",))
    drawn = tuple(pictures(study, traces))
    if not drawn:
        return Section("trajectories", title, texts=("No mission has the records of both methods and its world.",))
    return Section("trajectories", title, pictures=drawn)


def _cities(study: Study) -> Section:
    table = cities_table(study)
    if table is not None:
        return Section("cities", "By city", tables=(table,))
    if len(study.cities) > MOST_CITIES:
        return Section("cities", "By city", texts=(f"{len(study.cities)} cities are too many for a table.",))
    return Section("cities", "By city", texts=(f"All missions are of one city: {study.cities[0] or 'no city'}.",))
