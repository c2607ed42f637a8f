"""What a model will take is counted where no model is asked."""

import pytest

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.prices import OWN_MACHINE, Price
from reasoned_explorer.evaluation.forecast import TOKENS, ModelFacts, Sample, forecast
from reasoned_explorer.evaluation.mission_settings import MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

SHORT = ExplorerSettings(t_max_s=300.0)
DEAR = Price(1.0, 10.0, None, "made up")


@pytest.fixture(scope="module")
def samples() -> list[Sample]:
    atlas = Atlas(open_world("park:5@300"))
    return [Sample("Find me a bench", atlas), Sample("Find me a tree", atlas)]


def _model(latency_s: float = 1.0, parallel: float = 100.0, price: Price | None = DEAR) -> dict[str, ModelFacts]:
    return {"openai:m": ModelFacts(Abilities(latency_s=latency_s, parallel=parallel), price)}


def test_a_mission_takes_its_calls_in_money_and_its_rounds_in_time(samples: list[Sample]) -> None:
    settings = MissionSettings(minds="openai:m", clock="mixed", explorer=SHORT)
    one = forecast(samples, settings, _model())
    assert one.calls > 40
    assert one.usd is not None
    dearest = max(DEAR.usd(*TOKENS[role]) for role in ("visionary", "evaluator", "checker"))
    cheapest = min(DEAR.usd(*TOKENS[role]) for role in ("visionary", "evaluator", "checker"))
    assert one.calls * cheapest <= one.usd <= one.calls * dearest
    # Many calls share a second, and a mission has at most 300 of them.
    assert one.calls / 60.0 > one.minutes > 0.2


def test_calls_one_after_the_other_take_longer_and_a_mission_then_has_fewer(samples: list[Sample]) -> None:
    settings = MissionSettings(minds="openai:m", clock="mixed", explorer=SHORT)
    together, alone = (forecast(samples, settings, _model(parallel=at_once)) for at_once in (100.0, 1.0))
    assert alone.calls < together.calls
    assert alone.minutes > together.minutes


def test_only_roles_that_a_model_has_are_counted(samples: list[Sample]) -> None:
    settings = MissionSettings(evaluator="openai:m", clock="mixed", explorer=SHORT)
    whole = MissionSettings(minds="openai:m", captioner="openai:m", clock="mixed", explorer=SHORT)
    assert forecast(samples, settings, _model()).calls < forecast(samples, whole, _model()).calls


def test_a_price_that_is_not_known_stays_unknown(samples: list[Sample]) -> None:
    settings = MissionSettings(minds="openai:m", clock="mixed", explorer=SHORT)
    assert forecast(samples, settings, _model(price=None)).usd is None
    assert forecast(samples, settings, _model(price=OWN_MACHINE)).usd == 0.0
