"""Lines on inadequate models. Entries with the same causes and remedy share a line.

Input: a matrix of verdicts. Output: `RemedyLine` records.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial

from validation.drawing.text import error_text, percent
from validation.report.words import (
    capital,
    listed,
    model_name,
    quantities_text,
)
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
