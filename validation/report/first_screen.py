"""Content of the first screen of the report, made from the matrix of verdicts.

Input: a matrix. Output: `FirstScreen`: the verdict in one sentence, the table of verdicts,
remedies, reasons of undecided entries, and a screen of each single leg.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import sqrt

from validation.drawing.figures import attempted, drawn_figure
from validation.drawing.text import percent
from validation.report.figures.adequacy import error_curves, measured_curves
from validation.report.remedies import RemedyLine, remedies_of
from validation.report.table import Table, csv_of_matrix, table_of
from validation.report.words import (
    capital,
    conditions,
    listed,
    model_name,
    models_to_use,
    quantities_text,
    sentence,
)
from validation.studies_and_figures import Figure
from validation.verdicts import Entry, Matrix


@dataclass(frozen=True)
class FirstScreen:
    """Top of the page: verdict with its assumptions, table of verdicts, figure of the errors.

    `remedies` and `undecided` (entries by reason) belong to unfolded rows of the table, `other_…`
    to folded ones. `inputs`: each uncertain input with the error on which it has the largest
    effect. `notes`: assumptions for values missing in the robot file. `parts`: screens of further
    matrices (legs alone, formulations), each with a `name` under a `heading`.
    """

    sentence: str
    conditions: str
    table: Table
    csv: str
    errors: Figure | None
    remedies: tuple[RemedyLine, ...]
    other_remedies: tuple[RemedyLine, ...]
    notes: tuple[str, ...]
    undecided: Mapping[str, str]
    other_undecided: Mapping[str, str] = field(default_factory=dict)
    inputs: tuple[str, ...] = ()
    name: str = ""
    heading: str = ""
    parts: "tuple[FirstScreen, ...]" = ()


def first_screen(
    matrix: Matrix, *, plotted: bool, measured: bool = False, rely: Sequence[str] = ()
) -> FirstScreen:
    """First screen of a matrix.

    `plotted`: True to draw the errors. `measured`: True if the references are measured values, each
    in its own pose. `rely`: models on which the user relies.
    """

    def errors() -> Figure | None:
        chart = measured_curves(matrix) if measured else error_curves(matrix)
        identity = ("measured.values", "measured") if measured else ("adequacy.errors", "adequacy")
        return drawn_figure(chart, identity[0], chart.title, identity[1]) if chart else None

    table = table_of(matrix, [*rely] or [model for model, _ in models_to_use(matrix)])
    folded = [row.note.model for row in table.rows if row.folded]
    unfolded = [row.note.model for row in table.rows if not row.folded]
    return FirstScreen(
        sentence=sentence(matrix, rely),
        conditions=conditions(matrix, rely),
        table=table,
        csv=csv_of_matrix(matrix),
        errors=attempted(errors) if plotted else None,
        remedies=remedies_of(matrix, unfolded),
        other_remedies=remedies_of(matrix, folded),
        notes=matrix.notes,
        undecided=_undecided_reasons(matrix, unfolded),
        other_undecided=_undecided_reasons(matrix, folded),
        inputs=_input_texts(matrix, unfolded),
        name=matrix.robot,
        parts=tuple(
            replace(first_screen(part, plotted=False), heading=_heading(matrix, part))
            for part in matrix.attached
        ),
    )


def _undecided_reasons(matrix: Matrix, models: Collection[str]) -> Mapping[str, str]:
    """Text with the quantities and models of undecided entries, for each reason (key)."""
    entries_by_reason: dict[str, list[Entry]] = {}
    for entry in matrix.entries:
        if entry.verdict == "undecided" and entry.reason and entry.model in models:
            entries_by_reason.setdefault(entry.reason, []).append(entry)
    return {
        reason: f"{quantities_text(matrix, [entry.quantity for entry in entries])} by "
        f"{listed(list(dict.fromkeys(model_name(entry.model) for entry in entries)))}"
        for reason, entries in entries_by_reason.items()
    }


def _input_texts(matrix: Matrix, models: Collection[str]) -> tuple[str, ...]:
    """Texts with each uncertain input and its largest effect on an error of the `models`.

    The effect is a half-width at a confidence of 95 %.
    """
    largest: dict[str, tuple[float, str]] = {}
    for entry in (candidate for candidate in matrix.entries if candidate.model in models):
        half_width = entry.uncertainties.get("inputs", 0.0)
        subject = f"{quantities_text(matrix, [entry.quantity])} by {model_name(entry.model)}"
        for key, share in entry.input_shares.items():
            largest[key] = max(largest.get(key, (0.0, "")), (half_width * sqrt(share), subject))
    ranked = sorted(
        ((size, key, subject) for key, (size, subject) in largest.items()), reverse=True
    )
    return tuple(
        f"{key} ±{percent(size, signed=False)} ({subject})" for size, key, subject in ranked
    )


def _heading(matrix: Matrix, part: Matrix) -> str:
    if part is matrix.formulation:
        return "Robot with legs of constant section, compared with solids of the same legs"
    return f"{capital(part.robot)} alone, root clamped"
