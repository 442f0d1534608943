"""The first screen put together from the matrix of adequacy."""

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
    listed,
    model_name,
    models_to_use,
    quantities_text,
    sentence,
    supposition,
)
from validation.studies_and_figures import Figure
from validation.verdicts import Entry, Matrix


@dataclass(frozen=True)
class FirstScreen:
    """What the reader sees first: the sentence and what it supposes, the table, errors over poses.

    Then `remedies`, and what decides the entries that are `undecided`, by entries; both of the
    models that are folded by themselves. The uncertain `inputs` with the errors that they leave
    most open; and `notes` on what was not said by the user. `parts` show the same of what stands
    beside the matrix, each by its `name` under `heading`.
    """

    sentence: str
    supposed: str
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
    """The first screen of a matrix; `plotted`: whether the figure is to be drawn.

    `measured`: whether the references are measured values, at poses of their own. `rely`: the
    models that the user relies on.
    """

    def errors() -> Figure | None:
        shown = measured_curves(matrix) if measured else error_curves(matrix)
        where = ("measured.values", "measured") if measured else ("adequacy.errors", "adequacy")
        return drawn_figure(shown, where[0], shown.title, where[1]) if shown else None

    table = table_of(matrix, [*rely] or [model for model, _ in models_to_use(matrix)])
    folded = [row.note.model for row in table.rows if row.folded]
    shown = [row.note.model for row in table.rows if not row.folded]
    return FirstScreen(
        sentence=sentence(matrix, rely),
        supposed=supposition(matrix, rely),
        table=table,
        csv=csv_of_matrix(matrix),
        errors=attempted(errors) if plotted else None,
        remedies=remedies_of(matrix, shown),
        other_remedies=remedies_of(matrix, folded),
        notes=matrix.notes,
        undecided=_undecided(matrix, shown),
        other_undecided=_undecided(matrix, folded),
        inputs=_inputs(matrix, shown),
        name=matrix.robot,
        parts=tuple(
            replace(first_screen(one, plotted=False), heading=_heading(matrix, one))
            for one in matrix.beside
        ),
    )


def _undecided(matrix: Matrix, models: Collection[str]) -> Mapping[str, str]:
    """What decides undecided entries of these models, with quantities and models that share it."""
    told: dict[str, list[Entry]] = {}
    for entry in matrix.entries:
        if entry.verdict == "undecided" and entry.reason and entry.model in models:
            told.setdefault(entry.reason, []).append(entry)
    return {
        reason: f"{quantities_text(matrix, [entry.quantity for entry in found])} by "
        f"{listed(list(dict.fromkeys(model_name(entry.model) for entry in found)))}"
        for reason, found in told.items()
    }


def _inputs(matrix: Matrix, models: Collection[str]) -> tuple[str, ...]:
    """Each uncertain input with the error of these models that it leaves most open (95 %)."""
    largest: dict[str, tuple[float, str]] = {}
    for entry in (one for one in matrix.entries if one.model in models):
        half = entry.uncertainties.get("inputs", 0.0)
        said = f"{quantities_text(matrix, [entry.quantity])} by {model_name(entry.model)}"
        for key, share in entry.input_shares.items():
            largest[key] = max(largest.get(key, (0.0, "")), (half * sqrt(share), said))
    ranked = sorted(((size, key, said) for key, (size, said) in largest.items()), reverse=True)
    return tuple(f"{key} ±{percent(size, signed=False)} ({said})" for size, key, said in ranked)


def _heading(matrix: Matrix, one: Matrix) -> str:
    if one is matrix.formulation:
        return "The robot with legs of constant section, against solids of the same legs"
    return f"{capital(one.robot)} alone, root clamped"
