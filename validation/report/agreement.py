"""Tables and sentences on the agreement of all formulations with solids, for robot and legs.

Input: outcomes of the comparisons. Output: a table for the robot, each leg and each CAD part, and
sentences with the largest differences, their causes and the skipped comparisons. A named cause is a
known difference between a formulation and the solid, such as end faces that stay plane. Its effect
is computed separately. The unexplained difference is the total difference without the effects of
named causes; verdicts judge the unexplained difference.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from validation.case import UnjudgedValue
from validation.comparisons.agreement_cases import STATIC_MODELS
from validation.comparisons.agreement_rows import AgreementRow, agreement_row
from validation.drawing.text import engineering, number, percent
from validation.models.options import MODELS
from validation.report.words import capital, listed, pose_text
from validation.run.outcome import Outcome, Verdict
from validation.verdicts import Coordinate

# Symbols of the verdicts on comparisons.
MARKS: Mapping[Verdict, str] = {
    "agree": "✓",
    "disagree": "✗",
    "undecided": "?",
    "failed": "!",
    "skipped": "–",
}
# Ratios below this are displayed as 0.00 % and are not listed as explained.
_SMALLEST_SHARE = 5e-5
_ROWS: Mapping[str, str] = {
    **{model: capital(MODELS[model].words) for model in STATIC_MODELS},
    "segments-stepped": "Segments, stepped",
    "beam-stepped": "Beam FE, stepped",
    "condensed": "Condensed",
}
# Names of formulations inside a sentence.
_IN_TEXT: Mapping[str, str] = {**_ROWS, **{model: MODELS[model].words for model in STATIC_MODELS}}


@dataclass(frozen=True)
class AgreementCell:
    """Texts of a table cell with the difference of a formulation from the solid.

    `text`: the difference that is judged (relative, without the effects of named causes), or the
    reason if the comparison was skipped or failed. `raw`: the total difference, "" if no named
    cause contributes to it. `spread`: the half-width of the difference's uncertainty, "" if it
    would be displayed as zero. `mark`: symbol of the `verdict`. A difference that is not judged has
    the mark "" and the verdict None. `case`: id of the comparison.
    """

    text: str
    raw: str
    spread: str
    mark: str
    verdict: Verdict | None
    case: str


@dataclass(frozen=True)
class AgreementTable:
    """Differences of formulations from the solid: rows of formulations, columns of quantities.

    `subject`: name of the compared leg, or the robot with its pose. `quantities`: headings of the
    columns; a quantity that was compared for no formulation has no column. `solid`: value of the
    solid with its unit, for each column. `rows`: name of a formulation, and a cell for each column;
    the cell is None if there is no comparison. `causes`: name of a named cause, and the difference
    due to it for each column as text, "" if the cause does not affect the quantity. `explanations`:
    lines with the same differences and the quantities that they concern. `missing`: lines with the
    comparisons that were skipped or failed, and the reason. `judged`: False if the differences have
    no verdicts. `notes`: lines displayed below the table.
    """

    subject: str
    quantities: tuple[str, ...]
    solid: tuple[str, ...]
    rows: tuple[tuple[str, tuple[AgreementCell | None, ...]], ...]
    causes: tuple[tuple[str, tuple[str, ...]], ...]
    explanations: tuple[str, ...]
    missing: tuple[str, ...]
    judged: bool = True
    notes: tuple[str, ...] = ()

    @property
    def compared(self) -> bool:
        """True if any formulation was compared. Otherwise only `missing` is displayed."""
        return bool(self.quantities)


def agreement_tables(
    outcomes: Sequence[Outcome], coordinates: Sequence[Coordinate] = ()
) -> tuple[AgreementTable, ...]:
    """Tables for the robot and each leg with comparisons, then for each CAD part.

    The heading of the robot's table gives the pose, with the names of `coordinates`. Without
    `coordinates` the heading is "robot".
    """
    comparisons = [outcome for outcome in outcomes if outcome.case.kind == "agreement"]
    by_body = {
        body: [outcome for outcome in comparisons if outcome.case.body == body]
        for body in dict.fromkeys(outcome.case.body for outcome in comparisons)
    }
    judged = [
        _table(body or _robot_at_pose(members, coordinates), members)
        for body, members in by_body.items()
    ]
    return (*judged, *(_part_table(outcome) for outcome in outcomes if _unjudged_values(outcome)))


def agreement_sentence(outcomes: Sequence[Outcome]) -> str:
    """Sentences on all comparisons of formulations. "" if there are no comparisons."""
    texts = agreement_statement(outcomes), agreement_reservations(outcomes)
    return " ".join(filter(None, texts))


def agreement_statement(outcomes: Sequence[Outcome]) -> str:
    """Sentences on the compared models and their largest differences from solids.

    They also give the numbers of undecided and failed comparisons. "" if there are no comparisons.
    """
    return " ".join(filter(None, (_judged_sentence(outcomes), _parts_sentence(outcomes))))


def agreement_reservations(outcomes: Sequence[Outcome]) -> str:
    """Sentences on the differences due to named causes, and on skipped comparisons.

    "" if there are neither. Also "" if no comparison has the verdict "agree" or "disagree".
    """
    comparisons = [outcome for outcome in outcomes if outcome.case.kind == "agreement"]
    if all(outcome.verdict not in {"agree", "disagree"} for outcome in comparisons):
        return ""
    agreeing = [outcome for outcome in comparisons if outcome.verdict == "agree"]
    return " ".join(filter(None, (_allowances_sentence(agreeing), _missing_sentence(comparisons))))


def _parts_sentence(outcomes: Sequence[Outcome]) -> str:
    """Sentence on the largest differences of simplified CAD parts from their solids.

    A CAD part is simplified to a stepped beam, or condensed to a stiffness between its interfaces.
    "" if no CAD part was compared.
    """
    values = [value for outcome in outcomes for value in _unjudged_values(outcome)]
    forms = {
        "stepped beams": [value for value in values if value.elements],
        "condensed parts": [value for value in values if not value.elements],
    }
    texts = [
        f"{form} up to {_largest(members, frequencies=False)} in compliances and "
        f"{_largest(members, frequencies=True)} in f1 to f4 with a free end"
        for form, members in forms.items()
        if members
    ]
    if not texts:
        return ""
    return (
        "Largest differences between simplified CAD parts and their solid FE: "
        f"{'; '.join(texts)}. The verdicts on the robot with these parts are in the table "
        '"Adequacy of the models".'
    )


def _largest(values: Iterable[UnjudgedValue], *, frequencies: bool) -> str:
    shares = [abs(value.share) for value in values if (value.unit == "Hz") is frequencies]
    return _unsigned(max(shares))


def _judged_sentence(outcomes: Sequence[Outcome]) -> str:
    comparisons = [outcome for outcome in outcomes if outcome.case.kind == "agreement"]
    if not comparisons:
        return ""
    counts = {
        verdict: sum(outcome.verdict == verdict for outcome in comparisons)
        for verdict in ("agree", "disagree", "undecided", "failed")
    }
    unsettled = ", ".join(
        f"{counts[name]} {name}" for name in ("undecided", "failed") if counts[name]
    )
    if not counts["agree"] + counts["disagree"]:
        reason = f"; comparisons without a verdict: {unsettled}" if unsettled else ""
        if not unsettled and any(map(_unjudged_values, outcomes)):
            return ""
        return f"No formulation could be compared with solid FE of the same legs{reason}."
    rest = f"; other comparisons: {unsettled}" if unsettled else ""
    agreeing = [outcome for outcome in comparisons if outcome.verdict == "agree"]
    decided = [outcome for outcome in comparisons if outcome.verdict in {"agree", "disagree"}]
    if counts["disagree"]:
        remaining = f"; the others agree {_bound_text(agreeing)}" if agreeing else ""
        return (
            f"{counts['disagree']} of {len(decided)} comparisons of {_models(decided)} with solid "
            f"FE of the same legs disagree{remaining}{rest}."
        )
    return f"{_agreement(agreeing)}{rest}."


def _agreement(agreeing: Sequence[Outcome]) -> str:
    """Text on the models that agree with solids, and on their largest differences.

    Differences of compliances and of frequencies are separate.
    """
    kinds = {
        "compliances": [outcome for outcome in agreeing if outcome.case.unit != "Hz"],
        "frequencies": [outcome for outcome in agreeing if outcome.case.unit == "Hz"],
    }
    (models, within), *further = [
        (_models(members), f"{_bound_text(members)} in {kind}")
        for kind, members in kinds.items()
        if members
    ]
    first = f"{capital(models)} agree with solid FE of the same legs {within}"
    return ", ".join([first, *(" ".join(other) for other in further)])


def _models(outcomes: Sequence[Outcome]) -> str:
    compared = {outcome.case.model for outcome in outcomes}
    return listed([name for model, name in _IN_TEXT.items() if model in compared])


def _bound_text(agreeing: Sequence[Outcome]) -> str:
    """Text with the bound of all differences: "within 0.36 % (f3 of leg1: 0.19 % ± 0.17 %)".

    The bound is the largest sum of an unexplained difference and its half-width. A half-width that
    would be displayed as 0.00 % is omitted. A bound that would be displayed as 0.00 % is given as
    0.01 %.
    """
    worst, parts = _largest_part(agreeing, lambda parts: abs(parts.unexplained) + parts.half_width)
    difference, bound = abs(parts.unexplained), abs(parts.unexplained) + parts.half_width
    if bound < _SMALLEST_SHARE:
        return f"within {_unsigned(2.0 * _SMALLEST_SHARE)}"
    spread = _spread(parts.half_width)
    split = f": {_unsigned(difference)} {spread}" if spread else ""
    return f"within {_unsigned(bound)} ({_quantity_text(worst)}{split})"


def _largest_part(
    outcomes: Iterable[Outcome], part: Callable[[AgreementRow], float]
) -> tuple[Outcome, AgreementRow]:
    """Comparison whose agreement row has the largest value of `part`, and this row.

    `part`: function that returns a number of the row, such as its unexplained difference.
    """
    compared = [(outcome, agreement_row(outcome)) for outcome in outcomes if outcome.measurement]
    return max(compared, key=lambda pair: part(pair[1]))


def _allowances_sentence(agreeing: Sequence[Outcome]) -> str:
    """Sentences on the largest total difference, and on each named cause with its largest effect.

    Example: "Total differences reach 21.27 % (φx of leg2). Named causes, computed separately: held
    end faces (up to 1.46 % in x of leg1)." Returns "" if there are no named causes.
    """
    amounts: dict[str, tuple[float, str]] = {}
    for outcome in agreeing:
        for cause, share in _shares(outcome).items():
            largest = amounts.get(cause, (0.0, ""))
            amounts[cause] = max(largest, (abs(share), _quantity_text(outcome)))
    if not amounts:
        return ""
    worst, parts = _largest_part(agreeing, lambda parts: abs(parts.difference))
    causes = sorted(amounts, key=lambda cause: -amounts[cause][0])
    texts = [
        f"{cause} (up to {_unsigned(amounts[cause][0])} in {amounts[cause][1]})" for cause in causes
    ]
    largest_difference = f"{_unsigned(abs(parts.difference))} ({_quantity_text(worst)})"
    return (
        f"Total differences reach {largest_difference}. Named causes, computed "
        f"separately: {listed(texts)}."
    )


def _missing_sentence(comparisons: Sequence[Outcome]) -> str:
    """Sentence on skipped comparisons, "Not compared: f1, f2 of arm1; VJM of the robot.".

    It lists first the quantities that were compared for no formulation, then the formulations that
    were not compared at all.
    """
    quantities: dict[tuple[str, ...], list[str]] = {}
    models: dict[tuple[str, ...], list[str]] = {}
    for body in dict.fromkeys(outcome.case.body for outcome in comparisons):
        members = [outcome for outcome in comparisons if outcome.case.body == body]
        compared = [outcome for outcome in members if outcome.verdict != "skipped"]
        labels = {outcome.case.label for outcome in compared}
        missing = dict.fromkeys(
            outcome.case.label for outcome in members if outcome.case.label not in labels
        )
        if missing:
            quantities.setdefault(tuple(missing), []).append(body or "the robot")
        present = {outcome.case.model for outcome in compared}
        absent = dict.fromkeys(
            _IN_TEXT[outcome.case.model] for outcome in members if outcome.case.model not in present
        )
        if absent and compared:
            models.setdefault(tuple(absent), []).append(body or "the robot")
    gaps = [
        f"{listed(names)} of {listed(subjects)}"
        for names, subjects in (*quantities.items(), *models.items())
    ]
    return f"Not compared: {'; '.join(gaps)}." if gaps else ""


def _quantity_text(outcome: Outcome) -> str:
    return f"{outcome.case.label} of {outcome.case.body or 'the robot'}"


def convergence_sentence(outcomes: Sequence[Outcome]) -> str:
    """Sentence on the largest discretisation error with the element count of table [agree].

    The table is in the robot file. "" if no error with this count was computed.
    """
    stated = [
        outcome
        for outcome in outcomes
        if outcome.case.kind == "convergence" and outcome.case.elements
    ]
    errors = [outcome.measurement.value for outcome in stated if outcome.measurement]
    if not errors:
        return ""
    return f"{stated[0].case.elements} elements: at most {percent(max(errors), signed=False)}."


def _robot_at_pose(outcomes: Sequence[Outcome], coordinates: Sequence[Coordinate]) -> str:
    """Text with the pose of the robot's comparisons: "robot at x = 0.4975 m".

    "robot" if the pose is unknown or the number of `coordinates` differs from that of the pose.
    """
    poses = {outcome.measurement.pose for outcome in outcomes if outcome.measurement}
    pose = next(iter(poses), ())
    complete = pose and len(pose) == len(coordinates)
    return f"robot at {pose_text(coordinates, pose)}" if complete else "robot"


def _table(subject: str, outcomes: Sequence[Outcome]) -> AgreementTable:
    solid: dict[str, str] = {}
    for outcome in outcomes:
        if outcome.measurement:
            value = _value(outcome.measurement.reference, outcome.case.unit)
            solid.setdefault(outcome.case.label, value)
    labels = dict.fromkeys(outcome.case.label for outcome in outcomes)
    quantities = tuple(label for label in labels if label in solid)
    models = {
        outcome.case.model: _row_name(outcome.case.model, outcome.case.elements)
        for outcome in outcomes
    }
    by_place = {(outcome.case.model, outcome.case.label): outcome for outcome in outcomes}
    rows = []
    for model, name in models.items():
        cells = [by_place.get((model, quantity)) for quantity in quantities]
        rows.append((name, tuple(_cell(outcome) if outcome else None for outcome in cells)))
    return AgreementTable(
        subject,
        quantities,
        tuple(solid[quantity] for quantity in quantities),
        tuple(rows),
        _cause_rows(outcomes, quantities),
        explanations=_quantities_by_text((_causes_text(outcome), outcome) for outcome in outcomes),
        missing=_quantities_by_text((o.message, o) for o in outcomes if o.measurement is None),
    )


def _row_name(model: str, elements: int) -> str:
    """Name of the model, with its elements per leg in brackets if it has any: "Beam FE (20)"."""
    return f"{_ROWS[model]} ({elements})" if elements else _ROWS[model]


def _unjudged_values(outcome: Outcome) -> tuple[UnjudgedValue, ...]:
    return outcome.measurement.shown if outcome.measurement else ()


def _part_table(outcome: Outcome) -> AgreementTable:
    """Table of the simplified models of a CAD part against its solid, without verdicts.

    The models are stepped beams, and the part condensed to its interfaces.
    """
    values = _unjudged_values(outcome)
    quantities = {value.label: _value(value.reference, value.unit) for value in values}
    rows: dict[str, tuple[AgreementCell, ...]] = {}
    for value in values:
        half_width = abs((value.half_width or 0.0) / value.reference)
        spread = _spread(half_width)
        cell = AgreementCell(_percent(value.share), "", spread, "", None, outcome.case.id)
        name = _row_name(value.model, value.elements)
        rows[name] = (*rows.get(name, ()), cell)
    return AgreementTable(
        outcome.case.body,
        tuple(quantities),
        tuple(quantities.values()),
        tuple(rows.items()),
        (),
        (),
        (),
        judged=False,
        notes=outcome.measurement.notes if outcome.measurement else (),
    )


def _value(reference: float, unit: str) -> str:
    if unit == "Hz":
        return f"{number(reference, 4)} Hz"
    scaled, prefix = engineering(reference)
    return f"{number(scaled, 4)} {prefix}{unit}".replace("N m", "N\N{NO-BREAK SPACE}m")


def _spread(half_width: float) -> str:
    """Relative half-width as text. "" if it would be displayed as zero."""
    return f"± {_unsigned(half_width)}" if half_width >= _SMALLEST_SHARE else ""


def _cell(outcome: Outcome) -> AgreementCell:
    parts, mark = agreement_row(outcome), MARKS[outcome.verdict]
    if outcome.measurement is None:
        return AgreementCell(outcome.message, "", "", mark, outcome.verdict, outcome.case.id)
    return AgreementCell(
        text=_percent(parts.unexplained),
        raw=_percent(parts.difference) if _shares(outcome) else "",
        spread=_spread(parts.half_width),
        mark=mark,
        verdict=outcome.verdict,
        case=outcome.case.id,
    )


def _shares(outcome: Outcome) -> dict[str, float]:
    """Relative differences due to named causes, by cause, without those displayed as zero."""
    causes = agreement_row(outcome).causes.items()
    return {cause: share for cause, share in causes if abs(share) >= _SMALLEST_SHARE}


def _causes_text(outcome: Outcome) -> str:
    """Text with the differences due to named causes: "held end faces +1.46 %"."""
    return ", ".join(f"{cause} {_percent(share)}" for cause, share in _shares(outcome).items())


def _cause_rows(
    outcomes: Sequence[Outcome], quantities: Sequence[str]
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Rows of the table: a named cause, and the difference due to it in each quantity, as text.

    If the difference varies between formulations, the text lists all values. "" if the cause does
    not affect the quantity.
    """
    amounts: dict[str, dict[str, dict[str, None]]] = {}
    for outcome in outcomes:
        for cause, share in _shares(outcome).items():
            of_quantity = amounts.setdefault(cause, {}).setdefault(outcome.case.label, {})
            of_quantity[_percent(share)] = None
    return tuple(
        (cause, tuple(", ".join(by_quantity.get(quantity, {})) for quantity in quantities))
        for cause, by_quantity in amounts.items()
    )


def _quantities_by_text(pairs: Iterable[tuple[str, Outcome]]) -> tuple[str, ...]:
    quantities: dict[str, dict[str, None]] = {}
    for text, outcome in pairs:
        if text:
            quantities.setdefault(text, {})[outcome.case.label] = None
    return tuple(f"{', '.join(names)}: {text}" for text, names in quantities.items())


def _percent(share: float) -> str:
    """Ratio as text in per cent, with its sign and two decimals. Zero has no sign."""
    text = f"{100.0 * share:+.2f}".replace("-", "−")
    return f"{'0.00' if text[1:] == '0.00' else text}\N{NO-BREAK SPACE}%"


def _unsigned(share: float) -> str:
    """Non-negative ratio as text in per cent, without a plus sign."""
    return _percent(share).lstrip("+")
