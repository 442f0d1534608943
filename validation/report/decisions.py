"""Sentences on design decisions: the value that each model chooses, and the cost of this choice.

Input: outcomes of the comparisons of `--vary`. Output: a sentence for each varied parameter and
objective. Rule: the loss of a choice is computed by the reference. Models that lose at most 1 % are
listed together, each other model with its choice and loss.
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
    good = [one for one in outcomes if one.verdict == "agree" and one.measurement]
    skipped = [one.case.model for one in outcomes if one.measurement is None]
    costly = [one for one in outcomes if one not in good and one.measurement]
    parts = []
    if good:
        largest = max(one.measurement.value for one in good if one.measurement) / 100.0
        names = listed([one.case.model for one in good])
        verb = "chooses" if len(good) == 1 else "choose"
        loss = f"a value at most {percent(largest, signed=False)} worse than the best value"
        parts.append(f"{names} {verb} {loss if largest >= _NO_LOSS else 'the best value'}")
    for one in costly:
        if one.measurement:
            loss = percent(one.measurement.value / 100.0, signed=False)
            choice = one.measurement.notes[0].removesuffix(".")
            parts.append(f"{choice}: {loss} worse ({one.verdict})")
    if skipped:
        parts.append(f"not computed by {listed(skipped)}")
    return f"{capital(label)}: {'; '.join(parts)}."
