"""Tables of the robot and of each leg by all formulations: values of the solid, and differences."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from validation.case import UnjudgedValue
from validation.drawing.text import number, percent
from validation.report.words import pose_text
from validation.run.outcome import Outcome, Verdict
from validation.verdicts import Coordinate

# Of verdicts on comparisons, wherever the page shows one.
MARKS: Mapping[Verdict, str] = {
    "agree": "✓",
    "disagree": "✗",
    "undecided": "?",
    "failed": "!",
    "skipped": "–",
}
# Shares of a value below this are not shown among the explained ones.
_NOTHING = 5e-5
_MODELS = {
    "vjm": "VJM",
    "links": "Links",
    "segments": "Segments",
    "beam": "Beam FE",
    "segments-stepped": "Segments, stepped",
    "beam-stepped": "Beam FE, stepped",
    "condensed": "Condensed",
}
# Factor and unit of what is shown of each unit of a case.
_SHOWN = {"m/N": (1e9, "µm"), "rad/(N m)": (1e8, "µrad"), "Hz": (1.0, "Hz")}


@dataclass(frozen=True)
class AgreementCell:
    """Difference of a formulation from the solid: `text`; under it what no cause explains.

    `case` is the id of the comparison. A skipped one has its reason as text. `verdict` is None and
    `mark` empty for a difference that is shown and not judged.
    """

    text: str
    under: str
    mark: str
    verdict: Verdict | None
    case: str


@dataclass(frozen=True)
class AgreementTable:
    """A leg or the robot: a row for each formulation with a cell per quantity, None without one.

    `subject` names the leg, or the robot and its pose. `solid` are the values of the solid with
    their units, "" if it has none. `explanations` name the differences that are allowed for, with
    their amounts, by quantity; `missing` name the comparisons that were skipped or failed, with the
    reason. `judged`: False if the differences are shown without verdicts, with `notes` below them.
    """

    subject: str
    quantities: tuple[str, ...]
    solid: tuple[str, ...]
    rows: tuple[tuple[str, tuple[AgreementCell | None, ...]], ...]
    explanations: tuple[str, ...]
    missing: tuple[str, ...]
    judged: bool = True
    notes: tuple[str, ...] = ()

    @property
    def compared(self) -> bool:
        """Whether any formulation was compared: otherwise only the reasons are shown."""
        return any(self.solid)


def agreement_tables(
    outcomes: Sequence[Outcome], coordinates: Sequence[Coordinate] = ()
) -> tuple[AgreementTable, ...]:
    """A table for the robot and for each leg that has agreement cases, then for each CAD part.

    `coordinates` of the poses name the robot's pose; without them its table is headed "robot".
    """
    found = [one for one in outcomes if one.case.kind == "agreement"]
    by_body = {
        body: [one for one in found if one.case.body == body]
        for body in dict.fromkeys(one.case.body for one in found)
    }
    judged = [_table(body or _robot(of, coordinates), of) for body, of in by_body.items()]
    return (*judged, *(_part_table(one) for one in outcomes if _shown(one)))


def agreement_sentence(outcomes: Sequence[Outcome]) -> str:
    """All comparisons of formulations in one sentence; "" if there are none.

    Comparisons that are undecided or failed are counted: all formulations agree only without them.
    """
    return " ".join(filter(None, (_judged_sentence(outcomes), _parts_sentence(outcomes))))


def _parts_sentence(outcomes: Sequence[Outcome]) -> str:
    """Largest differences of stepped CAD parts from their solids, or of condensed ones alone."""
    shown = [one for outcome in outcomes for one in _shown(outcome)]
    if not shown:
        return ""
    form = "as stepped beams" if any(one.elements for one in shown) else "condensed"
    compared = [one for one in shown if one.elements] or shown
    motions = max(abs(one.share) for one in compared if one.unit != "Hz")
    frequencies = max(abs(one.share) for one in compared if one.unit == "Hz")
    return (
        f"CAD parts {form} differ from their own solids by at most "
        f"{percent(motions, signed=False)} in tip motions and "
        f"{percent(frequencies, signed=False)} in f1 to f4 (judged by [accept] for the robot)."
    )


def _judged_sentence(outcomes: Sequence[Outcome]) -> str:
    found = [one for one in outcomes if one.case.kind == "agreement"]
    if not found:
        return ""
    counts = {
        verdict: sum(one.verdict == verdict for one in found)
        for verdict in ("agree", "disagree", "undecided", "failed")
    }
    unsettled = ", ".join(
        f"{counts[name]} {name}" for name in ("undecided", "failed") if counts[name]
    )
    if not counts["agree"] + counts["disagree"]:
        reason = f"; of the comparisons {unsettled}" if unsettled else ""
        if not unsettled and any(map(_shown, outcomes)):
            return ""
        return f"No formulation could be compared with solids of the same legs{reason}."
    rest = f"; of the other comparisons {unsettled}" if unsettled else ""
    agreeing = [one for one in found if one.verdict == "agree"]
    largest = max((_unexplained(one) for one in agreeing), default=0.0)
    within = percent(largest, signed=False) if largest else "rounding"
    named = "once held end faces, section constants and distortion are allowed for"
    if counts["disagree"]:
        decided = counts["agree"] + counts["disagree"]
        others = f"; the others agree within {within} {named}" if agreeing else ""
        return (
            f"On the same legs {counts['disagree']} of {decided} comparisons of the formulations "
            f"with the solid disagree{others}{rest}."
        )
    who = "the formulations" if rest else "all formulations"
    return f"On the same legs {who} agree within {within} {named}{rest}."


def convergence_sentence(outcomes: Sequence[Outcome]) -> str:
    """Largest error of segments and beams with the stated element count; "" if not computed."""
    stated = [one for one in outcomes if one.case.kind == "convergence" and one.case.elements]
    errors = [one.measurement.value for one in stated if one.measurement]
    if not errors:
        return ""
    return f"{stated[0].case.elements} elements: at most {percent(max(errors), signed=False)}."


def _unexplained(outcome: Outcome) -> float:
    measurement = outcome.measurement
    if measurement is None:
        return 0.0
    return abs(measurement.unexplained / measurement.reference)


def _robot(outcomes: Sequence[Outcome], coordinates: Sequence[Coordinate]) -> str:
    """The robot and the pose of its comparisons: "robot at x = 0.4975 m"."""
    poses = {one.measurement.pose for one in outcomes if one.measurement}
    pose = next(iter(poses), ())
    known = pose and len(pose) == len(coordinates)
    return f"robot at {pose_text(coordinates, pose)}" if known else "robot"


def _table(subject: str, outcomes: Sequence[Outcome]) -> AgreementTable:
    quantities = tuple(dict.fromkeys(one.case.label for one in outcomes))
    models = {one.case.model: _row_name(one.case.model, one.case.elements) for one in outcomes}
    by_place = {(one.case.model, one.case.label): one for one in outcomes}
    rows = []
    for model, name in models.items():
        cells = [by_place.get((model, quantity)) for quantity in quantities]
        rows.append((name, tuple(_cell(one) if one else None for one in cells)))
    solid = tuple(_solid(quantity, outcomes) for quantity in quantities)
    return AgreementTable(
        subject,
        quantities,
        solid,
        tuple(rows),
        _explanations(outcomes),
        _missing(outcomes),
    )


def _row_name(model: str, elements: int) -> str:
    """The model, and its elements per leg in brackets if it has any: "Beam FE (20)"."""
    return f"{_MODELS[model]} ({elements})" if elements else _MODELS[model]


def _shown(outcome: Outcome) -> tuple[UnjudgedValue, ...]:
    return outcome.measurement.shown if outcome.measurement else ()


def _part_table(outcome: Outcome) -> AgreementTable:
    """Stepped and condensed forms of a CAD part beside its solid, without verdicts."""
    shown = _shown(outcome)
    quantities = {one.label: _value(one.reference, one.unit) for one in shown}
    rows: dict[str, tuple[AgreementCell, ...]] = {}
    for one in shown:
        half_width = abs((one.half_width or 0.0) / one.reference)
        cell = AgreementCell(_percent(one.share), _spread(half_width), "", None, outcome.case.id)
        name = _row_name(one.model, one.elements)
        rows[name] = (*rows.get(name, ()), cell)
    return AgreementTable(
        outcome.case.body,
        tuple(quantities),
        tuple(quantities.values()),
        tuple(rows.items()),
        (),
        (),
        judged=False,
        notes=outcome.measurement.notes if outcome.measurement else (),
    )


def _solid(quantity: str, outcomes: Sequence[Outcome]) -> str:
    """Value of the solid: µm under 1000 N, µrad under 100 N m, or Hz."""
    for one in outcomes:
        if one.case.label == quantity and one.measurement is not None:
            return _value(one.measurement.reference, one.case.unit)
    return ""


def _value(reference: float, unit: str) -> str:
    scale, shown = _SHOWN[unit]
    return f"{number(scale * reference, 4)}\N{NO-BREAK SPACE}{shown}"


def _spread(half_width: float) -> str:
    """Relative half-width, "" if it would read as zero."""
    return f"± {_percent(half_width).lstrip('+')}" if half_width >= _NOTHING else ""


def _cell(outcome: Outcome) -> AgreementCell:
    measurement, mark = outcome.measurement, MARKS[outcome.verdict]
    if measurement is None:
        return AgreementCell(outcome.message, "", mark, outcome.verdict, outcome.case.id)
    scale = abs(measurement.reference)
    left = f"{_percent(measurement.unexplained / scale)} left" if _explained(outcome) else ""
    spread = _spread((measurement.numerical_uncertainty or 0.0) / scale)
    text = _percent(measurement.difference / scale)
    under = " ".join(filter(None, (left, spread)))
    return AgreementCell(text, under, mark, outcome.verdict, outcome.case.id)


def _explained(outcome: Outcome) -> str:
    """Amounts of the named differences that count: "held end faces +1.46 %"."""
    measurement = outcome.measurement
    if measurement is None:
        return ""
    scale = abs(measurement.reference)
    return ", ".join(
        f"{one.cause} {_percent(one.amount / scale)}"
        for one in measurement.allowances
        if abs(one.amount) >= _NOTHING * scale
    )


def _explanations(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """A line for each set of quantities that the same named differences explain."""
    return _by_text((_explained(one), one) for one in outcomes)


def _missing(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """A line for each reason why quantities are not compared."""
    return _by_text((one.message, one) for one in outcomes if one.measurement is None)


def _by_text(pairs: Iterable[tuple[str, Outcome]]) -> tuple[str, ...]:
    quantities: dict[str, dict[str, None]] = {}
    for text, one in pairs:
        if text:
            quantities.setdefault(text, {})[one.case.label] = None
    return tuple(f"{', '.join(names)}: {text}" for text, names in quantities.items())


def _percent(share: float) -> str:
    """A share in percent with two decimals: smaller differences are none here."""
    text = f"{100.0 * share:+.2f}".replace("-", "−")
    return f"{'0.00' if text[1:] == '0.00' else text}\N{NO-BREAK SPACE}%"
