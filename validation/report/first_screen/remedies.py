"""Why models are off and what to do: entries with the same causes and remedy in one line."""

from collections.abc import Sequence
from dataclasses import dataclass

from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.text import percent
from validation.report.first_screen.words import SIGNS, capital, error_text, listed, model_name

# How many causes a line names.
_FOREMOST = 2
_PERCENT = "\u00a0%"
# An error of which less is along the load is off across it.
_ALONG = 0.8


@dataclass(frozen=True)
class Remedy:
    """Models and quantities that are off for the same reasons, and what helps.

    `without` and `with_remedy` are ranges of errors, as text.
    """

    models: str
    quantities: str
    without: str
    causes: tuple[str, ...]
    remedy: str
    with_remedy: str


def remedies_of(matrix: Matrix) -> tuple[Remedy, ...]:
    """A line for each reason of inadequacy, in the order of the matrix.

    Entries belong together where they name the same foremost causes and the same remedy.
    """
    groups: dict[tuple[tuple[str, ...], str, str, bool], list[Entry]] = {}
    for entry in matrix.entries:
        if entry.verdict == "inadequate":
            causes = tuple(sorted(cause.cause for cause in entry.causes[:_FOREMOST]))
            reason = "" if entry.causes else entry.reason
            # Errors of frequencies have a sign, those of displacements none.
            key = causes, entry.remedy, reason, entry.signed
            groups.setdefault(key, []).append(entry)
    return tuple(
        Remedy(
            models=capital(
                listed([model_name(model) for model in dict.fromkeys(e.model for e in entries)])
            ),
            quantities=_quantities(entries, matrix.quantities),
            without=_range([entry.error for entry in entries], signed=entries[0].signed)
            + _sense(entries),
            causes=_causes(entries) or (reason,),
            remedy=remedy,
            with_remedy=_range(
                [entry.error_with_remedy for entry in entries], signed=entries[0].signed
            ),
        )
        for (_, remedy, reason, _), entries in groups.items()
    )


def _quantities(entries: Sequence[Entry], order: Sequence[str]) -> str:
    off = sorted({entry.quantity for entry in entries}, key=order.index)
    return ", ".join(SIGNS.get(quantity, quantity) for quantity in off)


def _causes(entries: Sequence[Entry]) -> tuple[str, ...]:
    """The foremost causes with the range of their shares: "shear: 80 to 96 %"."""
    shares: dict[str, list[float]] = {}
    for entry in entries:
        for cause in entry.causes[:_FOREMOST]:
            shares.setdefault(cause.cause, []).append(cause.share)
    return tuple(f"{cause}: {_shares(found)}" for cause, found in shares.items())


def _shares(values: Sequence[float]) -> str:
    return _span([percent(one, signed=False) for one in sorted(values, key=abs)])


def _range(values: Sequence[float | None], *, signed: bool) -> str:
    known = sorted((value for value in values if value is not None), key=abs)
    return _span([error_text(one, signed=signed) for one in known])


def _sense(entries: Sequence[Entry]) -> str:
    """Whether what is off is the motion along the load, too little or too much of it."""
    along = [e.along for e in entries if e.along and abs(e.along) >= _ALONG * abs(e.error or 0.0)]
    if len(along) < len(entries) or entries[0].signed or min(along) < 0.0 < max(along):
        return ""
    return " too stiff" if along[0] < 0.0 else " too soft"


def _span(shown: Sequence[str]) -> str:
    if not shown:
        return ""
    first, last = shown[0], shown[-1]
    return last if first == last else f"{first.removesuffix(_PERCENT)} to {last}"
