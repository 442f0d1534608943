"""The table of a matrix: a row for each model and quantity."""

from validation.report.words import pose_text
from validation.tables import Cell, ResultTable
from validation.verdicts import Entry, Matrix

_HEADINGS = (
    *("model", "quantity", "verdict", "error (%)", "half-width (%)", "low (%)", "high (%)"),
    *("limit (%)", "pose", "cause", "remedy"),
)


def matrix_table(matrix: Matrix) -> ResultTable:
    """A row for each model and quantity, errors and limits in per cent."""
    return ResultTable(_HEADINGS, tuple(_row(matrix, entry) for entry in matrix.entries))


def _row(matrix: Matrix, entry: Entry) -> tuple[Cell, ...]:
    errors = entry.error, entry.uncertainty, entry.low, entry.high
    return (
        entry.model,
        str(entry.quantity),
        entry.verdict,
        *(None if share is None else 100.0 * share for share in errors),
        100.0 * entry.limit,
        pose_text(matrix.coordinates, entry.pose) if entry.pose else None,
        entry.causes[0].cause if entry.causes else None,
        entry.remedy or None,
    )
