"""Sentences on design decisions: the value that each model chooses, and the cost of this choice.

Input: outcomes of the comparisons of `--vary`. Output: a sentence for each varied parameter and
objective. Rule: a model chooses the parameter value that is best by its own results. The reference
model evaluates this choice: its loss is the relative amount by which the objective is worse than at
the best value. Models with an acceptable loss are listed together. Every other model is listed with
its choice and loss.
"""

from collections.abc import Sequence

from validation.drawing.text import percent
from validation.report.words import capital, listed
from validation.run.outcome import Outcome

# Losses below this are displayed as 0 %.
_NO_LOSS = 5e-5


def decision_sentences(outcomes: Sequence[Outcome]) -> list[str]:
    """Sentences on the choices of all models, in the order of the variations."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.case.kind == "decision":
            groups.setdefault(outcome.case.label, []).append(outcome)
    return [_sentence(label, group) for label, group in groups.items()]


def _sentence(label: str, outcomes: Sequence[Outcome]) -> str:
    good = [outcome for outcome in outcomes if outcome.verdict == "agree" and outcome.measurement]
    skipped = [outcome.case.model for outcome in outcomes if outcome.measurement is None]
    costly = [outcome for outcome in outcomes if outcome not in good and outcome.measurement]
    parts = []
    if good:
        largest = max(outcome.measurement.value for outcome in good if outcome.measurement) / 100.0
        names = listed([outcome.case.model for outcome in good])
        verb = "chooses" if len(good) == 1 else "choose"
        loss = f"a value at most {percent(largest, signed=False)} worse than the best value"
        parts.append(f"{names} {verb} {loss if largest >= _NO_LOSS else 'the best value'}")
    for outcome in costly:
        if outcome.measurement:
            loss = percent(outcome.measurement.value / 100.0, signed=False)
            choice = outcome.measurement.notes[0].removesuffix(".")
            parts.append(f"{choice}: {loss} worse ({outcome.verdict})")
    if skipped:
        parts.append(f"not computed by {listed(skipped)}")
    return f"{capital(label)}: {'; '.join(parts)}."
