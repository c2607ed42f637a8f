"""What modelled calls are charged: seconds by the latency profile, and a line each in the ledger."""

from collections.abc import Sequence

from reasoned_explorer.calls.ledger import CallRecord
from reasoned_explorer.minds.context import MindContext


async def charge_calls(
    context: MindContext, role: str, model: str, keys: Sequence[tuple[int, ...]], faults: Sequence[str | None]
) -> None:
    """Write calls that start together down, then let the slowest one's seconds pass: a cancelled call was made, too.

    Args:
        context: Clock, latency profile, ledger and seed; draws are keyed by seed, role and scene.
        role: Of the calls: ``visionary``, ``evaluator`` or ``checker``.
        model: What answers.
        keys: Of the scenes, one a call.
        faults: Why an answer is missing, or None, one a call.
    """
    if not keys:
        return
    seconds = context.latency.batch_s(role, context.seed, keys)
    # As records keep them (`CallRecord.rounded`): thousands need not be made a second time.
    started_s = round(context.clock.now_s(), 6)
    context.ledger.add_all(
        [
            CallRecord(role, model, key, started_s, round(second, 6), fault=fault)
            for key, second, fault in zip(keys, seconds, faults, strict=True)
        ]
    )
    await context.clock.think(max(seconds))
