"""Content of the first screen of the report, made from the matrix of verdicts.

Input: a matrix. Output: `FirstScreen`: the verdict in one sentence, the table of verdicts,
remedies, reasons of undecided entries, and a screen of each single leg. Inadequate entries with the
same causes and remedy share a line.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import sqrt

from validation.drawing.figures import attempted, drawn_figure
from validation.drawing.text import error_text, percent
from validation.report.figures.adequacy import error_curves, measured_curves
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

# Number of causes in a line.
_NAMED_CAUSES = 2
_PERCENT = "\u00a0%"
# Causes with a smaller share of an error are not listed.
_SMALLEST_SHARE = 0.02
# If at least this fraction of an error lies along the load, its line contains "too stiff" or "too
# soft". Otherwise the error is mainly across the load.
_ALONG_SHARE = 0.8


@dataclass(frozen=True)
class RemedyLine:
    """Models and quantities with the same causes of error, and their remedy.

    `without` and `with_remedy`: ranges of errors without and with the remedy, as text.
    """

    models: str
    quantities: str
    without: str
    causes: tuple[str, ...]
    remedy: str
    with_remedy: str


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


def remedies_of(matrix: Matrix, models: Collection[str]) -> tuple[RemedyLine, ...]:
    """Lines for groups of inadequate entries of the models, in the order of the matrix.

    A group has the same leading causes and the same remedy.
    """
    groups: dict[tuple[tuple[str, ...], str, str, bool], list[Entry]] = {}
    for entry in matrix.entries:
        if entry.verdict == "inadequate" and entry.model in models:
            causes = tuple(sorted(cause.cause for cause in entry.causes[:_NAMED_CAUSES]))
            # Errors of frequencies have a sign, those of displacement vectors have none.
            key = causes, entry.remedy, "" if causes else entry.reason, entry.signed
            groups.setdefault(key, []).append(entry)
    return tuple(
        RemedyLine(
            models=capital(listed(list(dict.fromkeys(model_name(e.model) for e in entries)))),
            quantities=quantities_text(matrix, [entry.quantity for entry in entries]),
            without=_range([e.error for e in entries], error_text, signed=signed)
            + _stiffness_sense(entries),
            causes=_causes(entries) or (reason,),
            remedy=remedy,
            with_remedy=_range([e.error_with_remedy for e in entries], error_text, signed=signed),
        )
        for (_, remedy, reason, signed), entries in groups.items()
    )


def _causes(entries: Sequence[Entry]) -> tuple[str, ...]:
    """Texts with the leading causes and the range of their shares: "shear: 80 to 96 %".

    If causes compensate each other, shares are meaningless. The texts then contain the amount by
    which each cause changes the error, and state that causes interact.
    """
    interact = any(cause.share < -_SMALLEST_SHARE for entry in entries for cause in entry.causes)
    sizes: dict[str, list[float]] = {}
    for entry in entries:
        for cause in entry.causes[:_NAMED_CAUSES]:
            if interact:
                sizes.setdefault(cause.cause, []).append(cause.share * (entry.error or 0.0))
            elif cause.share > _SMALLEST_SHARE:
                sizes.setdefault(cause.cause, []).append(min(cause.share, 1.0))
    size = (
        partial(_range, format_error=error_text, signed=True)
        if interact
        else partial(_range, format_error=percent)
    )
    remainders = [
        sum(cause.share for cause in e.causes[_NAMED_CAUSES:]) for e in entries if e.causes
    ]
    if not interact and max(remainders, default=0.0) > _SMALLEST_SHARE:
        sizes["all others"] = remainders
    texts = [f"{cause}: {size(values)}" for cause, values in sizes.items()]
    return (*texts[:-1], f"{texts[-1]} (they interact)") if interact else tuple(texts)


def _range(
    values: Sequence[float | None], format_error: Callable[..., str], *, signed: bool = False
) -> str:
    """Range of values as text, from smallest to largest magnitude: "2 to 5 %".

    `format_error` formats a value. "" if there are no values.
    """
    finite = sorted((value for value in values if value is not None), key=abs)
    if not finite:
        return ""
    first, last = (format_error(value, signed=signed) for value in (finite[0], finite[-1]))
    return last if first == last else f"{first.removesuffix(_PERCENT)} to {last}"


def _stiffness_sense(entries: Sequence[Entry]) -> str:
    """Text on the sign of all errors along the load: " too stiff" if negative, else " too soft".

    "" if the signs differ, or if an error is mainly across the load.
    """
    along = [
        e.along for e in entries if e.along and abs(e.along) >= _ALONG_SHARE * abs(e.error or 0.0)
    ]
    if len(along) < len(entries) or entries[0].signed or min(along) < 0.0 < max(along):
        return ""
    return " too stiff" if along[0] < 0.0 else " too soft"
