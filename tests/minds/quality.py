"""How well the embedded minds rank and notice, on scenes and goals written by hand for this purpose."""

from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.minds.embedded.checker import verdict_on
from reasoned_explorer.minds.embedded.evaluator import assess
from reasoned_explorer.minds.embedded.relevance import Senses

DATA = Path(__file__).parent / "data"


@dataclass(frozen=True)
class LabelledGoal:
    name: str
    level: int
    text: str
    paraphrase: str


@dataclass(frozen=True)
class LabelledScene:
    text: str
    shows: frozenset[str]
    within_reach: frozenset[str]


def _rows(name: str) -> list[list[str]]:
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    return [line.split("|") for line in lines if line and not line.startswith("#")]


def labelled_goals() -> list[LabelledGoal]:
    return [LabelledGoal(name, int(level), text, other) for name, level, text, other in _rows("goals.txt")]


def labelled_scenes() -> list[LabelledScene]:
    return [LabelledScene(text, frozenset(a.split()), frozenset(b.split())) for text, a, b in _rows("scenes.txt")]


def area_under_curve(positive: list[float], negative: list[float]) -> float:
    """How often a positive scores higher than a negative; a tie counts half."""
    wins = sum((p > n) + 0.5 * (p == n) for p in positive for n in negative)
    return wins / (len(positive) * len(negative))


def goal_aucs(senses: Senses, *, paraphrased: bool = False) -> dict[str, float]:
    found = {}
    for goal in labelled_goals():
        text = goal.paraphrase if paraphrased else goal.text
        scores = [
            (assess(text, scene.text, senses).score or 0.0, goal.name in scene.shows) for scene in labelled_scenes()
        ]
        found[goal.name] = area_under_curve([s for s, yes in scores if yes], [s for s, yes in scores if not yes])
    return found


def pooled_auc(senses: Senses) -> float:
    """The same over all goals at once: high only where scores can be compared across goals."""
    scores = [
        (assess(goal.text, scene.text, senses).score or 0.0, goal.name in scene.shows)
        for goal in labelled_goals()
        for scene in labelled_scenes()
    ]
    return area_under_curve([s for s, yes in scores if yes], [s for s, yes in scores if not yes])


def hard_aucs(senses: Senses) -> dict[str, float]:
    """The same for goals in words that the lexicon was not written for."""
    found = {}
    for name, text in _rows("hard_goals.txt"):
        scores = [(assess(text, scene.text, senses).score or 0.0, name in scene.shows) for scene in labelled_scenes()]
        found[name] = area_under_curve([s for s, yes in scores if yes], [s for s, yes in scores if not yes])
    return found


def halting_f1(senses: Senses, *, paraphrased: bool = False) -> tuple[float, list[str]]:
    """F1 of "found" against "within reach", and what was got wrong."""
    hits = false_alarms = misses = 0
    wrong = []
    for goal in labelled_goals():
        text = goal.paraphrase if paraphrased else goal.text
        for scene in labelled_scenes():
            found, truth = verdict_on(text, scene.text, senses).found, goal.name in scene.within_reach
            hits += found and truth
            false_alarms += found and not truth
            misses += truth and not found
            if found != truth:
                wrong.append(f"{'false alarm' if found else 'miss'}: {text} | {scene.text}")
    return 2 * hits / (2 * hits + false_alarms + misses), wrong


def main() -> None:
    from reasoned_explorer.minds.embedded import default_senses
    from reasoned_explorer.minds.embedded.embedding import model_folder

    for with_embedder in (False, True) if model_folder() is not None else (False,):
        senses = default_senses(with_embedder=with_embedder)
        print("with MiniLM" if with_embedder else "words and lexicon only")
        for paraphrased in (False, True):
            aucs = goal_aucs(senses, paraphrased=paraphrased)
            f1, wrong = halting_f1(senses, paraphrased=paraphrased)
            mean = sum(aucs.values()) / len(aucs)
            print(f"  {'paraphrased' if paraphrased else 'original'}: AUC {mean:.3f}, halting F1 {f1:.3f}")
            print("   ", {name: round(value, 3) for name, value in aucs.items() if value < 0.97})
            for line in wrong:
                print("   ", line)
        hard = hard_aucs(senses)
        print(f"  pooled AUC {pooled_auc(senses):.3f}")
        print(f"  words outside of the lexicon: AUC {sum(hard.values()) / len(hard):.3f}")


if __name__ == "__main__":
    main()
