"""What the paper reports: its Tables I to IV as data, to stand beside a run's figures and never among them.

Source: "Reasoning about the Unseen for Efficient Outdoor Object Navigation", Xie et al., 2023, arXiv 2309.10103,
section V. Its figures are of another simulator, other minds, other goals, starts and judges, and have no intervals.
"""

from dataclasses import dataclass

from reasoned_explorer.evaluation.wording import NONE, share

#: What must stand over these tables wherever they are shown.
PAPER_NOTE = (
    "The paper’s figures, not this run’s, and not to be compared with it number by number: another simulator (AirSim, "
    "Downtown West), other minds (GPT-3.5 and GPT-4 on captions of Kosmos-2), goals, starts and judges of its own, "
    "about 17 missions a level, no intervals."
)

PAPER_SOURCE = "Xie et al., Reasoning about the Unseen for Efficient Outdoor Object Navigation, 2023, arXiv:2309.10103"


@dataclass(frozen=True, slots=True)
class PaperTable:
    """One table of the paper.

    Attributes:
        number: As the paper numbers it, e.g. ``"I"``.
        title: What it is of.
        columns: Heads; the first is of the row names.
        rows: Name of the row, then a value for each further column; None where the paper has none.
        digits: After the point, for each further column, as the paper prints them.
    """

    number: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[float | None, ...]], ...]
    digits: tuple[int, ...]

    def written(self, name: str) -> tuple[str, ...]:
        """Return the cells of a row with as many digits as the paper gives; a dash where it has none."""
        values = dict(self.rows)[name]
        pairs = zip(values, self.digits, strict=True)
        return tuple(NONE if value is None else share(value, digits) for value, digits in pairs)


_LEVELS = ("L1", "L2", "L3", "L4", "avg")

PAPER_TABLES = (
    PaperTable(
        "I",
        "Baselines by level of the task, simulation (AirSim)",
        ("method", *(f"{metric} {level}" for metric in ("SR", "OSR", "SPL", "CASR") for level in _LEVELS)),
        (
            (
                "LLM-as-Eval",
                (
                    *(0.17, 0.09, 0.0, 0.0, 0.06, 0.17, 0.27, 0.0, 0.0, 0.06),
                    *(0.13, 0.04, 0.0, 0.0, 0.04, 0.10, 0.06, 0.0, 0.0, 0.04),
                ),
            ),
            (
                "LLM-MCTS (10 iterations)",
                (
                    *(0.54, 0.43, 0.59, 0.33, 0.47, 0.88, 0.76, 0.63, 0.69, 0.74),
                    *(0.37, 0.31, 0.38, 0.23, 0.32, 0.11, 0.09, 0.11, 0.07, 0.10),
                ),
            ),
            (
                "Reasoned Explorer (LLM-RRT)",
                (
                    *(0.59, 0.49, 0.63, 0.32, 0.51, 0.88, 0.82, 0.71, 0.88, 0.82),
                    *(0.44, 0.32, 0.43, 0.22, 0.35, 0.51, 0.42, 0.46, 0.28, 0.42),
                ),
            ),
        ),
        (2,) * 20,
    ),
    PaperTable(
        "II",
        "Simulation (drone) and the real world (quadruped)",
        ("method", "SR sim.", "OSR sim.", "CASR sim.", "SR real", "OSR real", "CASR real"),
        (
            ("LLM-as-Eval", (0.06, 0.06, 0.04, 0.10, 0.20, 0.04)),
            ("Reasoned Explorer (LLM-RRT)", (0.51, 0.82, 0.42, 0.60, 0.70, 0.24)),
        ),
        (2,) * 6,
    ),
    PaperTable(
        "III",
        "Choice of L, the depth of imagining: level 1, T_max 15 min, no caption error",
        ("depth", "CASR", "σ"),
        (
            ("L = 0", (0.141, 0.38)),
            ("L = 1", (0.516, 0.34)),
            ("L = 2", (0.732, 0.05)),
            ("L = 3", (0.644, 0.07)),
            ("L = 4", (0.520, 0.34)),
        ),
        (3, 2),
    ),
    PaperTable(
        "IV",
        "Choice of model: visionary + evaluator, as Table III",
        ("visionary + evaluator", "CASR"),
        (
            ("GPT-3.5 + GPT-3.5", (0.449,)),
            ("GPT-3.5 + GPT-4", (0.732,)),
            ("GPT-4 + GPT-4", (None,)),
        ),
        (3,),
    ),
)
