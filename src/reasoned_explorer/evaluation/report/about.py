"""What a report is of, and where it gets records from."""

from dataclasses import dataclass
from typing import Protocol

from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.world.world import World


@dataclass(frozen=True, slots=True)
class ReportAbout:
    """What a report is of, in words: what rows cannot say themselves. All of it is data, never markup.

    Attributes:
        title: Headline.
        split: Name of the split, e.g. ``"mini"``.
        split_version: Its version.
        split_hash: Its hash.
        command: The command line that makes the run again.
        version: Of this package.
        attributions: Whom to thank for data, beside those that rows name.
        minds: Lines on who thinks, e.g. how embedded minds agree with GPT-4's scores.
        honesty: What a reader must know first, e.g. ``"No language model took part."``; stands under every table too.
        posed: Lines on what the split poses, e.g. its levels and distances.
        ceilings: Of the split: what, and the figure, e.g. ``("CASR of the oracle", ".80")``.
        methods: The order of the methods, the one that others are compared with first; empty for the order of the rows.
            Methods that are not named follow in the order of the rows.
        bounds: Methods that know the truth (the oracle, foresight, perfect halts): drawn in ink and left out where a
            relation between methods is asked for.
        side_by_side: The two methods of the trajectories; None for llm-as-eval and llm-rrt where both are there, else
            the first two.
        seed: Of the bootstrap.
    """

    title: str
    split: str
    split_version: str
    split_hash: str
    command: str
    version: str
    attributions: tuple[str, ...] = ()
    minds: tuple[str, ...] = ()
    honesty: tuple[str, ...] = ()
    posed: tuple[str, ...] = ()
    ceilings: tuple[tuple[str, str], ...] = ()
    methods: tuple[str, ...] = ()
    bounds: tuple[str, ...] = ()
    side_by_side: tuple[str, str] | None = None
    seed: int = 0


class TraceSource(Protocol):
    """Gives the records of missions, where they were kept."""

    def record(self, row: MissionRow) -> EpisodeRecord | None:
        """Return the record of a row's mission; None where it was not kept."""
        ...

    def world(self, row: MissionRow) -> World | None:
        """Return the world of a row's mission; None where it cannot be had any more."""
        ...
