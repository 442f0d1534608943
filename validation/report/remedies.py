"""Why models are off and what to do: entries with the same causes and remedy in one line."""

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

# How many causes a line names.
_FOREMOST = 2
_PERCENT = "\u00a0%"
# A share of an error that is not worth a word.
_NOTHING = 0.02
# An error of which less is along the load is off across it.
_ALONG = 0.8


@dataclass(frozen=True)
class RemedyLine:
    """Models and quantities that are off for the same reasons, and what helps.

    `without` and `with_remedy` are ranges of errors, as text.
    """

    models: str
    quantities: str
    without: str
    causes: tuple[str, ...]
    remedy: str
    with_remedy: str


def remedies_of(matrix: Matrix, models: Collection[str]) -> tuple[RemedyLine, ...]:
    """A line for each reason why any of the models is inadequate, in the order of the matrix.

    Entries belong together where they name the same foremost causes and the same remedy.
    """
    groups: dict[tuple[tuple[str, ...], str, str, bool], list[Entry]] = {}
    for entry in matrix.entries:
        if entry.verdict == "inadequate" and entry.model in models:
            causes = tuple(sorted(cause.cause for cause in entry.causes[:_FOREMOST]))
            # Errors of frequencies have a sign, those of displacements none.
            key = causes, entry.remedy, "" if causes else entry.reason, entry.signed
            groups.setdefault(key, []).append(entry)
    return tuple(
        RemedyLine(
            models=capital(listed(list(dict.fromkeys(model_name(e.model) for e in entries)))),
            quantities=quantities_text(matrix, [entry.quantity for entry in entries]),
            without=_range([e.error for e in entries], error_text, signed=signed) + _sense(entries),
            causes=_causes(entries) or (reason,),
            remedy=remedy,
            with_remedy=_range([e.error_with_remedy for e in entries], error_text, signed=signed),
        )
        for (_, remedy, reason, signed), entries in groups.items()
    )


def _causes(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The foremost causes with the range of their shares: "shear: 80 to 96 %".

    Where one takes back what another does no share means anything: they interact, and are told by
    what each does to the error.
    """
    interact = any(cause.share < -_NOTHING for entry in entries for cause in entry.causes)
    told: dict[str, list[float]] = {}
    for entry in entries:
        for cause in entry.causes[:_FOREMOST]:
            if interact:
                told.setdefault(cause.cause, []).append(cause.share * (entry.error or 0.0))
            elif cause.share > _NOTHING:
                told.setdefault(cause.cause, []).append(min(cause.share, 1.0))
    size = (
        partial(_range, told=error_text, signed=True) if interact else partial(_range, told=percent)
    )
    left = [sum(cause.share for cause in e.causes[_FOREMOST:]) for e in entries if e.causes]
    if not interact and max(left, default=0.0) > _NOTHING:
        told["all others"] = left
    found = [f"{cause}: {size(values)}" for cause, values in told.items()]
    return (*found[:-1], f"{found[-1]} (they interact)") if interact else tuple(found)


def _range(
    values: Sequence[float | None], told: Callable[..., str], *, signed: bool = False
) -> str:
    """The smallest and the largest, as they are told, with one sign for both."""
    known = sorted((value for value in values if value is not None), key=abs)
    if not known:
        return ""
    first, last = (told(one, signed=signed) for one in (known[0], known[-1]))
    return last if first == last else f"{first.removesuffix(_PERCENT)} to {last}"


def _sense(entries: Sequence[Entry]) -> str:
    """Whether what is off is the motion along the load, too little or too much of it."""
    along = [e.along for e in entries if e.along and abs(e.along) >= _ALONG * abs(e.error or 0.0)]
    if len(along) < len(entries) or entries[0].signed or min(along) < 0.0 < max(along):
        return ""
    return " too stiff" if along[0] < 0.0 else " too soft"
