"""Matrix of verdicts as a table of the page, as CSV, as a Python table and as lines of text.

Input: a `Matrix`. Output: `Table` with cells and detail sheets, CSV, `ResultTable`, and one line
per entry.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from lumped.acceptance.quantities import (
    ORDER,
    Quantity,
    QuantityKind,
)
from validation.adequacy.judged_models import JUDGED
from validation.drawing.style import csv_of
from validation.drawing.text import (
    anchor,
    error_parts,
    error_text,
    error_with_spread,
    number,
    percent,
    spread_text,
)
from validation.record_fields import columns_of
from validation.report.words import (
    capital,
    force_text,
    model_name,
    pose_text,
)
from validation.tables import ResultTable
from validation.verdicts import (
    Adequacy,
    Cause,
    Entry,
    EntryRecord,
    Matrix,
    ModelNote,
)

# Line of a detail sheet: a term and its text.
Line: TypeAlias = tuple[str, str]
MARKS: Mapping[Adequacy, str] = {"adequate": "✓", "inadequate": "✗", "undecided": "?"}
# Loads (N, N m) for the robot's own deflections in the table.
FORCE, MOMENT = 1000.0, 100.0
# Verdicts with at least this probability are displayed without the probability.
_CERTAIN = 0.995
# A model without a motion has an error of −1 along the load. Errors beyond minus this value count
# as −1: round-off.
_WHOLE_MOTION = 1.0 - 1e-9
_EULER_BERNOULLI = frozenset(
    name for name, model in JUDGED.items() if model.options.theory == "euler-bernoulli"
)


@dataclass(frozen=True)
class Cell:
    """Displayed entry of the table.

    `text`: error. `spread`: half-width of its uncertainty. `mark`: symbol of the verdict. `hint`:
    line displayed beside the mouse pointer. `anchor`: target of the link to the detail `sheet` with
    its `title`. A line of the sheet is a pair of a term and its text.
    """

    entry: Entry
    text: str
    spread: str
    mark: str
    hint: str
    anchor: str
    title: str
    sheet: tuple[Line, ...]


@dataclass(frozen=True)
class Row:
    """A model with its cells. A cell is None if the model does not define the quantity.

    `folded` is true if the model has no entries, if it is adequate for no quantity and cannot
    represent some motions, or if it uses Euler–Bernoulli's beam theory.
    """

    note: ModelNote
    name: str
    cells: tuple[Cell | None, ...]
    folded: bool


@dataclass(frozen=True)
class Table:
    """Rows of models under `headings` of quantities, with values of the reference in `robot`.

    `robot`: value and half-width of each quantity as texts. A deflection is the largest one over
    the poses (µm, µrad) under `FORCE` or `MOMENT`. A frequency (Hz) is that of the pose in which
    the model with the smallest error has its largest error. Both texts are "" for an unknown value.
    """

    headings: tuple[str, ...]
    robot: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]

    @property
    def cells(self) -> tuple[Cell, ...]:
        """Cells of all rows that are not None."""
        return tuple(cell for row in self.rows for cell in row.cells if cell)


def table_of(matrix: Matrix, unfolded: Collection[str] = ()) -> Table:
    """Table of a matrix: models in the order of the matrix, quantities with at least one entry.

    `unfolded`: models whose rows are not folded, because the sentence above the table names them.
    """
    quantities = [q for q in matrix.quantities if any(e.quantity == q for e in matrix.entries)]
    rows = []
    for note in matrix.models:
        entries = [matrix.entry(note.model, quantity.name) for quantity in quantities]
        cells = tuple(_cell(matrix, note, entry) if entry else None for entry in entries)
        folded = note.model not in unfolded and _folded(matrix, note.model)
        rows.append(Row(note, capital(model_name(note.model)), cells, folded))
    headings = tuple(quantity.label for quantity in quantities)
    return Table(
        headings, tuple(_robot_number(matrix, quantity) for quantity in quantities), tuple(rows)
    )


def _cell(matrix: Matrix, note: ModelNote, entry: Entry) -> Cell:
    text, spread = _error_texts(entry)
    # If readings of the robot file differ in the order of modes, the error is that of one of them.
    if entry.quantity == ORDER and entry.verdict == "undecided" and entry.error is not None:
        spread = "at most"
    if entry.chance is not None and entry.chance < _CERTAIN:
        spread = f"{spread} {percent(entry.chance, signed=False)}\u00a0sure".strip()
    if entry.mac is not None:
        spread = f"{spread} MAC\u00a0{entry.mac:.2f}".strip()
    # Sheets of one model and quantity against different references need different anchors.
    kind, name = ".measured" if entry.measured else "", capital(model_name(entry.model))
    return Cell(
        entry=entry,
        text=text,
        spread=spread,
        mark=MARKS[entry.verdict],
        hint=entry_line(matrix, entry),
        anchor=anchor(f"{matrix.robot}.{entry.model}.{entry.quantity}{kind}"),
        title=f"{name}, {entry.quantity.meaning}: {error_with_spread(entry) or text}",
        sheet=(("Model", note.title), *_numbers(matrix, entry), *_reasons(entry)),
    )


def _folded(matrix: Matrix, model: str) -> bool:
    entries = matrix.of_model(model)
    if not entries:
        return True
    # A model that is adequate for the order of modes only has no adequate frequency.
    inadequate = all(entry.verdict != "adequate" for entry in entries if entry.quantity != ORDER)
    lacking = any(entry.along is not None and entry.along <= -_WHOLE_MOTION for entry in entries)
    return model in _EULER_BERNOULLI or (inadequate and lacking)


def _robot_number(matrix: Matrix, quantity: Quantity) -> tuple[str, str]:
    """Value of the reference and its half-width as texts, as described in `Table`.

    The best model of the quantity, which has the smallest error, provides the pose.
    """
    entries = [
        entry
        for entry in matrix.entries
        if entry.quantity == quantity and entry.error is not None and entry.expected is not None
    ]
    # No value for any force, whose worst direction differs between robots; the detail sheet has it.
    if not entries or quantity.any_direction or quantity == ORDER or entries[0].measured:
        return "", ""
    best = min(entries, key=lambda entry: abs(entry.error or 0.0))
    unit, scale, size = quantity.unit, 1.0, best.expected or 0.0
    if quantity.harmonic and quantity.kind is not QuantityKind.PEAK_FREQUENCY:
        unit, scale = "µm/N", 1e6
    if quantity.static:
        pairs = zip(best.values, best.alongs, strict=False)
        deflections = (
            v / (1.0 + error)
            for v, error in pairs
            if v is not None and error is not None and error > -_WHOLE_MOTION
        )
        size = max(deflections, default=size)
        unit, scale = ("µrad", 1e6 * MOMENT) if quantity.rotational else ("µm", 1e6 * FORCE)
        scale = 1e6 if quantity.kind is QuantityKind.LOAD else scale
    spread = 0.0
    if best.expected and len(best.expected_range) == 2:
        # All poses get the relative half-width of the pose where the model is worst.
        low, high = (end / best.expected for end in best.expected_range)
        size, spread = 0.5 * (low + high) * size, (high - low) / (low + high)
    return f"{number(scale * size, 3)}\u00a0{unit}", spread_text(spread)


def csv_of_matrix(matrix: Matrix) -> str:
    """CSV with a line for each entry: its fields, with the coordinates of its pose as columns."""
    columns: dict[str, Sequence[float | str | None]] = {}
    for name, column in columns_of(EntryRecord).items():
        values = [getattr(entry, name) for entry in matrix.entries]
        if name == "pose":
            for column_index, coordinate in enumerate(matrix.coordinates):
                columns[str(coordinate)] = [pose[column_index] if pose else "" for pose in values]
        else:
            columns[column.heading] = [_csv_cell(value) for value in values]
    return csv_of(columns)


def _csv_cell(value: Any) -> float | str | None:
    """CSV cell for the value of a field.

    Spaces separate the numbers of a tuple. Semicolons separate pairs of a name and a number.
    """
    match value:
        case Quantity():
            return value.name
        case Mapping():
            return "; ".join(f"{name} {number:.6g}" for name, number in value.items())
        case (Cause(), *_):
            return "; ".join(f"{cause.cause} {cause.share:.3g}" for cause in value)
        case tuple():
            return " ".join(f"{number:.6g}" for number in value)
    cell: float | str | None = value
    return cell


def _error_texts(entry: Entry) -> tuple[str, str]:
    """Texts of an entry's error and half-width.

    Without an error, the texts are "none" and "" for the verdict "inadequate", "open" and "" for
    any other verdict.
    """
    if entry.error is not None:
        return error_parts(entry, named=False)
    return "none" if entry.verdict == "inadequate" else "open", ""


def entry_line(matrix: Matrix, entry: Entry) -> str:
    """Line on an entry: verdict, error, pose, limit, leading cause, remedy and reason."""
    parts = [f"{entry.model}, {entry.quantity}: {entry.verdict}"]
    if entry.error is not None:
        parts.append(
            f"error {error_with_spread(entry)} at {pose_text(matrix.coordinates, entry.pose)}, "
            f"accepted {percent(entry.limit, signed=False)}"
        )
    if entry.along is not None:
        direction = f" (force along {force_text(entry)})" if entry.force else ""
        parts.append(f"component along the load{direction} {percent(entry.along)}")
    parts += [f"cause: {entry.causes[0].cause}"] if entry.causes else []
    if entry.remedy:
        remaining_error = entry.error_with_remedy
        suffix = (
            ""
            if remaining_error is None
            else f" (remaining error {percent(remaining_error, signed=entry.signed)})"
        )
        parts.append(f"remedy: {entry.remedy}{suffix}")
    parts += [entry.reason] if entry.reason else []
    return "; ".join(parts)


def _per_cent(name: str) -> Callable[[Matrix, Entry], float | None]:
    """Function that returns a field of an entry, which is a ratio, in per cent."""

    def value(_: Matrix, entry: Entry) -> float | None:
        share: float | None = getattr(entry, name)
        return None if share is None else 100.0 * share

    return value


# Columns of the `ResultTable` of a matrix: heading, and function that returns the cell of an entry.
_COLUMNS: Mapping[str, Callable[[Matrix, Entry], str | float | None]] = {
    "model": lambda _, entry: entry.model,
    "quantity": lambda _, entry: str(entry.quantity),
    "verdict": lambda _, entry: entry.verdict,
    "error (%)": _per_cent("error"),
    "half-width (%)": _per_cent("uncertainty"),
    "low (%)": _per_cent("low"),
    "high (%)": _per_cent("high"),
    "limit (%)": _per_cent("limit"),
    "pose": lambda matrix, entry: pose_text(matrix.coordinates, entry.pose) if entry.pose else None,
    "cause": lambda _, entry: entry.causes[0].cause if entry.causes else None,
    "remedy": lambda _, entry: entry.remedy or None,
}


def matrix_table(matrix: Matrix) -> ResultTable:
    """Table with a row for each model and quantity, errors and limits in per cent."""
    rows = tuple(
        tuple(cell(matrix, entry) for cell in _COLUMNS.values()) for entry in matrix.entries
    )
    return ResultTable(tuple(_COLUMNS), rows)


def _numbers(matrix: Matrix, entry: Entry) -> list[Line]:
    unit = entry.quantity.unit
    along = "" if entry.signed else ", along the load"
    lines = [("Pose with the largest error", pose_text(matrix.coordinates, entry.pose))]
    if entry.force:
        lines.append(("Force with the largest error", f"along {force_text(entry)}"))
    if entry.value is not None:
        lines.append(("Value", f"{number(entry.value, 6)} {unit}{along}"))
    if entry.expected is not None:
        lines.append(("Reference", f"{number(entry.expected, 6)} {unit}{along}"))
    lines.append(("Source", entry.reference))
    if entry.error is not None:
        suffix = "" if entry.signed else " of the displacement vector"
        accepted = f"{'± ' * entry.signed}{percent(entry.limit, signed=False)}"
        error = error_text(entry.error, signed=entry.signed)
        lines.append(("Error", f"{error}{suffix}, accepted {accepted}"))
        if len(entry.readings) > 1:
            lines.append(("Readings", _readings(entry)))
        if entry.low is not None and entry.high is not None:
            low, high = (error_text(end, signed=entry.signed) for end in (entry.low, entry.high))
            lines.append(("Range of the error", f"from {low} to {high}"))
    if entry.mac is not None:
        lines.append(("Shape correlation (MAC)", f"{entry.mac:.4f}"))
    if entry.along is not None:
        lines.append(("Error of the component along the load", error_text(entry.along)))
    if entry.probability is not None:
        chance = percent(entry.probability, signed=False)
        lines.append(("Probability that the error is within the limit", chance))
        shares = [
            f"{key} {percent(share, signed=False)}" for key, share in entry.input_shares.items()
        ]
        lines += (
            [("Shares of the uncertain inputs in the variance", ", ".join(shares))]
            if shares
            else []
        )
    if entry.uncertainty is not None:
        parts = [
            f"{name} {percent(size, signed=False)}" for name, size in entry.uncertainties.items()
        ]
        detail = f" ({', '.join(parts)})" if parts else ""
        lines.append(("Uncertainty", f"± {percent(entry.uncertainty, signed=False)}{detail}"))
    return lines


def _readings(entry: Entry) -> str:
    """Text with the error under each interpretation of the robot file.

    Example: "0 % with rigid pins, 33 % with averaged ones".
    """
    return ", ".join(
        f"{error_text(error, signed=entry.signed)} with {name}"
        for name, error in entry.readings.items()
    )


def _reasons(entry: Entry) -> list[Line]:
    lines = [("Reason", entry.reason)] if entry.reason else []
    for cause in entry.causes:
        share = percent(cause.share, signed=False)
        source = f" (from {cause.source})" if cause.source else ""
        lines.append(("Cause", f"{cause.cause}: {share} of the error{source}"))
    if entry.remedy:
        error = entry.error_with_remedy
        suffix = (
            "" if error is None else f": remaining error {error_text(error, signed=entry.signed)}"
        )
        lines.append(("Remedy", f"{entry.remedy}{suffix}"))
    if entry.computed_by:
        lines.append(("Computed by", ", ".join(entry.computed_by)))
    return lines
