"""The matrix model × quantity as a table of the page, and as CSV."""

from collections.abc import Mapping
from dataclasses import dataclass

from validation.adequacy.matrix import Adequacy, Entry, Matrix, ModelNote
from validation.drawing.style import csv_of
from validation.drawing.text import anchor, number, percent
from validation.report.first_screen.words import (
    SIGNS,
    capital,
    error_text,
    force_text,
    model_name,
)

MARKS: Mapping[Adequacy, str] = {"adequate": "✓", "inadequate": "✗", "undecided": "?"}


@dataclass(frozen=True)
class Cell:
    """One entry as it is shown: its number, its verdict, what a pointer that rests on it is told.

    `anchor` leads to the entry's sheet.
    """

    entry: Entry
    text: str
    spread: str
    mark: str
    hint: str
    anchor: str


@dataclass(frozen=True)
class Row:
    """A model with its cells, None where it is silent of a quantity."""

    note: ModelNote
    name: str
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class Table:
    """Rows of models under `headings` of quantities."""

    headings: tuple[str, ...]
    rows: tuple[Row, ...]


def table_of(matrix: Matrix) -> Table:
    """The matrix as a table: models in its order, quantities of which any model says anything."""
    spoken = [q for q in matrix.quantities if any(e.quantity == q for e in matrix.entries)]
    rows = []
    for note in matrix.models:
        found = [matrix.entry(note.model, quantity) for quantity in spoken]
        cells = tuple(cell_of(matrix, entry) if entry else None for entry in found)
        rows.append(Row(note, capital(model_name(note.model)), cells))
    return Table(tuple(SIGNS.get(quantity, quantity) for quantity in spoken), tuple(rows))


def cell_of(matrix: Matrix, entry: Entry) -> Cell:
    """The entry as a cell."""
    spread = ""
    if entry.uncertainty is not None and entry.uncertainty >= _WORTH_SAYING:
        spread = f"±\u00a0{percent(entry.uncertainty, signed=False)}"
    return Cell(
        entry=entry,
        text=_text(entry),
        spread=spread,
        mark=MARKS[entry.verdict],
        hint=_hint(matrix, entry),
        anchor=anchor(f"{matrix.robot}.{entry.model}.{entry.quantity}{_kind(entry)}"),
    )


# Uncertainties below this share of the reference are not shown in a cell.
_WORTH_SAYING = 5e-4


def pose_text(matrix: Matrix, pose: tuple[float, ...]) -> str:
    """A pose by its coordinates: "x = 0.4975 m"."""
    if not pose:
        return "no pose of the robot"
    return ", ".join(
        f"{one.name} = {number(value, 4)} {one.unit}"
        for one, value in zip(matrix.coordinates, pose, strict=True)
    )


def csv_of_matrix(matrix: Matrix) -> str:
    """One line per entry with its verdict, numbers, pose, causes and remedy."""
    entries = matrix.entries
    poses = {
        str(coordinate): [entry.pose[place] if entry.pose else "" for entry in entries]
        for place, coordinate in enumerate(matrix.coordinates)
    }
    return csv_of(
        {
            "model": [entry.model for entry in entries],
            "quantity": [entry.quantity for entry in entries],
            "verdict": [entry.verdict for entry in entries],
            "error": [_or_empty(entry.error) for entry in entries],
            "uncertainty": [_or_empty(entry.uncertainty) for entry in entries],
            "limit": [entry.limit for entry in entries],
            "error along the load": [_or_empty(entry.along) for entry in entries],
            "worst force": [" ".join(f"{one:.6g}" for one in entry.force) for entry in entries],
            **poses,
            "value": [_or_empty(entry.value) for entry in entries],
            "reference value": [_or_empty(entry.expected) for entry in entries],
            "reference": [entry.reference for entry in entries],
            "causes": [
                "; ".join(f"{cause.cause} {cause.share:.3g}" for cause in entry.causes)
                for entry in entries
            ],
            "remedy": [entry.remedy for entry in entries],
            "error with remedy": [_or_empty(entry.error_with_remedy) for entry in entries],
            "reason": [entry.reason for entry in entries],
        }
    )


def _kind(entry: Entry) -> str:
    """Sheets of one model and quantity by different references are told apart."""
    return ".measured" if entry.measured else ""


def _text(entry: Entry) -> str:
    if entry.error is not None:
        return error_text(entry.error, signed=entry.signed)
    return "none" if entry.verdict == "inadequate" else "open"


def _hint(matrix: Matrix, entry: Entry) -> str:
    parts = [f"{entry.verdict} (limit {percent(entry.limit, signed=False)})"]
    worst = f" under a force along {force_text(entry)}" if entry.force else ""
    parts.append(f"worst at {pose_text(matrix, entry.pose)}{worst}")
    if entry.along is not None:
        parts.append(f"along the load {error_text(entry.along)}")
    if entry.causes:
        cause = entry.causes[0]
        parts.append(f"{cause.cause}: {percent(cause.share, signed=False)} of the error")
    parts += [entry.reason] if entry.reason else []
    return "; ".join(parts)


def _or_empty(value: float | None) -> float | str:
    return "" if value is None else value
