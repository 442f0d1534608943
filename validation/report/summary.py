"""Lines on the result of a run, for the terminal, and sentences on design decisions.

Input: `Results`. Output: lines on comparisons, models, decisions, missing figures and changes. Rule
for a decision: a model chooses the parameter value that is best by its own results. The reference
model evaluates this choice: its loss is the relative amount by which the objective is worse than at
the best value. Models with an acceptable loss are listed together. Every other model is listed with
its choice and loss.
"""

from collections.abc import Sequence

from validation.drawing.text import percent
from validation.report.agreement import agreement_sentence, convergence_sentence
from validation.report.listing import outcome_line
from validation.report.words import capital, conditions, listed, sentence
from validation.run import compare
from validation.run.outcome import Outcome
from validation.run.results import Results


def verdicts(gathered: Results) -> list[str]:
    """Lines on comparisons that do not agree, and the verdict on the run."""
    outcomes = gathered.outcomes
    worst = [o for o in outcomes if o.verdict in {"disagree", "undecided", "failed"}]
    standing = gathered.standing
    # A run without comparisons has none to summarise.
    models_alone = not outcomes and gathered.matrices and not standing.failures
    sentences = [] if models_alone else [standing.sentence]
    return [*(outcome_line(*group) for group in _grouped_by_reason(worst)), *sentences]


def _grouped_by_reason(outcomes: Sequence[Outcome]) -> list[list[Outcome]]:
    """Outcomes grouped by verdict and reason.

    An outcome with a measurement is a group of its own.
    """
    groups: dict[tuple[str, ...], list[Outcome]] = {}
    for outcome in outcomes:
        unmeasured = outcome.measurement is None
        key = (outcome.verdict, outcome.message) if unmeasured else (outcome.case.id,)
        groups.setdefault(key, []).append(outcome)
    return list(groups.values())


def adequacy(gathered: Results) -> list[str]:
    """Lines on models that are relied on but not adequate, and the verdict sentence of the page."""
    refused, rely = ", ".join(gathered.standing.refused), gathered.rely
    lines = [f"relied on but not adequate: {refused}"] if refused else []
    lines += gathered.unjudged
    matrix, measured = gathered.matrix, gathered.measured
    lines += [f"{sentence(matrix, rely)} {conditions(matrix, rely)}".strip()] if matrix else []
    lines += [f"against measured values: {sentence(measured, rely)}"] if measured else []
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in lines]


def cross_validation(gathered: Results) -> list[str]:
    """Line on the agreement and the discretisation error of formulations. [] if there is none."""
    outcomes = gathered.outcomes
    parts = [agreement_sentence(outcomes), convergence_sentence(outcomes)]
    sentence = " ".join(part for part in parts if part)
    return [f"Cross-validation: {sentence}".replace("\N{NO-BREAK SPACE}", " ")] if sentence else []


def left_out(gathered: Results) -> list[str]:
    """Lines on figures that could not be drawn."""
    undrawn = gathered.missing_figures
    return [f"figure {planned.id} left out: {message}" for planned, message in undrawn]


def changes(gathered: Results) -> tuple[list[str], bool]:
    """Lines on changes since the baseline, and True if the run is worse than the baseline."""
    if gathered.baseline is None:
        return [], False
    lost = [
        (f"warning: comparison {name} agreed in the baseline and is skipped in this run: {why}")
        for name, why in gathered.no_longer_compared.items()
    ]
    comparison = gathered.compared_with(gathered.baseline)
    worse = [
        f"worse     {change.id}: {change.before} in the baseline, now {change.after}"
        for change in comparison.verdicts
        if change.worse and change.id not in gathered.no_longer_compared
    ]
    return [
        *lost,
        *worse,
        f"against the baseline: {compare.sentence(comparison)}",
    ], comparison.worsened


# Losses below this are displayed as 0 %.
_NO_LOSS = 5e-5


def decision_sentences(outcomes: Sequence[Outcome]) -> list[str]:
    """Sentences on the values that models choose for varied parameters. [] without --vary."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.case.kind == "decision":
            groups.setdefault(outcome.case.label, []).append(outcome)
    return [_decision_sentence(label, group) for label, group in groups.items()]


def _decision_sentence(label: str, outcomes: Sequence[Outcome]) -> str:
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
