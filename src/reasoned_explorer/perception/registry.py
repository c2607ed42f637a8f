"""The captioners that a person can pick by name. A factory takes a `CaptionerContext` and returns a `Captioner`."""

from reasoned_explorer.calls.chat import MODEL_FORMS
from reasoned_explorer.registry import Entry, Registry

CAPTIONERS = Registry(
    "captioner",
    "captioners",
    (
        Entry(
            "perfect",
            "reasoned_explorer.simulation.captioner:perfect",
            "simulated: names everything that can be made out, where it is",
        ),
        Entry(
            "noisy",
            "reasoned_explorer.simulation.captioner:noisy",
            "simulated: misses, imagines, misplaces and confuses at assumed rates",
        ),
        Entry("noisier", "reasoned_explorer.simulation.captioner:noisier", "simulated: 1.5 times the errors of noisy"),
        Entry("noisiest", "reasoned_explorer.simulation.captioner:noisiest", "simulated: twice the errors of noisy"),
    ),
    beside=MODEL_FORMS,
)
