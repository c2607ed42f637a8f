from reasoned_explorer.calls.ledger import lost_calls
from reasoned_explorer.minds import CallRecord, Ledger


def test_totals_add_up_by_role():
    ledger = Ledger()
    ledger.add(CallRecord("visionary", "m", (0, 0, 0, 0), 1.0, 2.0, tokens_in=10, tokens_out=5, usd=0.01))
    ledger.add_all(
        [
            CallRecord("visionary", "m", (0, 0, 0, 1), 1.0, 3.0, tokens_in=10, tokens_out=7, usd=0.02, retries=2),
            CallRecord("checker", "m", (0, 0, 0), 1.0, 0.5, cached=True, fault="no answer"),
        ]
    )
    totals = ledger.totals()
    assert list(totals) == ["checker", "visionary"]
    assert totals["visionary"].calls == 2
    assert totals["visionary"].latency_s == 5.0
    assert (totals["visionary"].tokens_in, totals["visionary"].tokens_out) == (20, 12)
    assert totals["visionary"].retries == 2
    assert totals["checker"].faults == totals["checker"].cached == 1


def test_calls_without_a_known_price_are_counted_and_not_taken_for_free():
    ledger = Ledger()
    for usd in (0.01, None, 0.0):
        ledger.add(CallRecord("checker", "m", (0,), 0.0, 0.1, usd=usd))
    total = ledger.totals()["checker"]
    assert (total.usd, total.unpriced) == (0.01, 1)


def test_calls_are_lost_where_a_real_model_has_no_answer():
    answered = CallRecord("checker", "openai:m", (0,), 0.0, 0.1)
    lost = CallRecord("caption", "hf:m", (1,), 0.0, 0.1, fault="empty: no text")
    # A mind of this package that cannot answer has not lost a call: nobody was called.
    modelled = CallRecord("evaluator", "embedded", (1,), 0.0, 0.1, fault="the scene has no description")
    assert lost_calls([answered, lost, modelled]) == [lost]


def test_what_a_step_added_can_be_had_alone():
    ledger = Ledger()
    ledger.add(CallRecord("checker", "m", (0, 0, 0), 0.0, 0.1))
    before = len(ledger)
    ledger.add(CallRecord("checker", "m", (1, 0, 0), 5.0, 0.1))
    assert [call.key for call in ledger.since(before)] == [(1, 0, 0)]
    assert len(ledger.calls) == 2


def test_an_empty_ledger_has_no_totals():
    assert Ledger().totals() == {}
