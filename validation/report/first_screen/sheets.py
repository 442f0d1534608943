"""The sheet behind a number of the matrix: reference, uncertainty, causes, functions."""

from typing import TypeAlias

from lumped.acceptance.measured import leg_entry
from lumped.acceptance.requirement import (
    ANY_FORCE,
    FREQUENCIES,
    LOAD,
    RESPONSE,
    ROTATIONS,
    is_static,
)
from validation.adequacy.matrix import Entry, Matrix, ModelNote
from validation.drawing.text import number, percent
from validation.report.first_screen.words import SIGNS, error_text, force_text

# A word, and what is to be said under it.
Line: TypeAlias = tuple[str, str]


_OF_RESPONSES = {
    "": "height of the peak",
    "frequency": "frequency of the peak",
    "at": "size at one frequency",
}


def sheet_of(matrix: Matrix, note: ModelNote, entry: Entry) -> tuple[str, tuple[Line, ...]]:
    """What the quantity of an entry means, and the entry in full."""
    lines = (("Model", note.title), *_numbers(matrix, entry), *_reasons(entry))
    return _meaning(entry.quantity), lines


def pose_text(matrix: Matrix, pose: tuple[float, ...]) -> str:
    """A pose by its coordinates: "x = 0.4975 m"."""
    if not pose:
        return "the root clamped"
    return ", ".join(
        f"{one.name} = {number(value, 4)} {one.unit}"
        for one, value in zip(matrix.coordinates, pose, strict=True)
    )


def _numbers(matrix: Matrix, entry: Entry) -> list[Line]:
    unit = entry.unit or _unit(entry.quantity)
    along = "" if entry.signed else ", along the load"
    lines = [("Worst at", pose_text(matrix, entry.pose))]
    if entry.force:
        lines.append(("Worst force", f"along {force_text(entry)}"))
    if entry.value is not None:
        lines.append(("Value", f"{number(entry.value, 6)} {unit}{along}"))
    if entry.expected is not None:
        lines.append(("Reference", f"{number(entry.expected, 6)} {unit}{along}"))
    lines.append(("Source", entry.reference))
    if entry.error is not None:
        whole = "" if entry.signed else " of the whole displacement"
        accepted = f"{'± ' * entry.signed}{percent(entry.limit, signed=False)}"
        error = error_text(entry.error, signed=entry.signed)
        lines.append(("Error", f"{error}{whole}, accepted {accepted}"))
    if entry.along is not None:
        lines.append(("Along the load", error_text(entry.along)))
    if entry.probability is not None:
        chance = percent(entry.probability, signed=False)
        lines.append(("Within the limit", f"with a probability of {chance}"))
        shares = [f"{key} {percent(one, signed=False)}" for key, one in entry.input_shares.items()]
        lines += [("Shares of the inputs", ", ".join(shares))] if shares else []
    if entry.uncertainty is not None:
        parts = [
            f"{name} {percent(size, signed=False)}" for name, size in entry.uncertainties.items()
        ]
        detail = f" ({', '.join(parts)})" if parts else ""
        lines.append(("Uncertainty", f"± {percent(entry.uncertainty, signed=False)}{detail}"))
    return lines


def _reasons(entry: Entry) -> list[Line]:
    lines = [("Reason", entry.reason)] if entry.reason else []
    for cause in entry.causes:
        share = percent(cause.share, signed=False)
        source = f" (from {cause.source})" if cause.source else ""
        lines.append(("Cause", f"{cause.cause}: {share} of the error{source}"))
    if entry.remedy:
        error = entry.error_with_remedy
        left = "" if error is None else f": {error_text(error, signed=entry.signed)} left"
        lines.append(("Remedy", f"{entry.remedy}{left}"))
    if entry.computed_by:
        lines.append(("Computed by", ", ".join(entry.computed_by)))
    return lines


def _meaning(quantity: str) -> str:
    if quantity in ROTATIONS:
        return f"rotation under a moment about {ROTATIONS[quantity]}"
    if is_static(quantity):
        what = "any force" if quantity == ANY_FORCE else f"a force along {quantity}"
        if quantity.startswith(LOAD):
            what = f"the load {quantity.removeprefix(LOAD)}"
        return f"displacement under {what}"
    if quantity in FREQUENCIES:
        return f"natural frequency {FREQUENCIES[quantity]}"
    if quantity.startswith(RESPONSE):
        name, _, what = quantity.removeprefix(RESPONSE).partition(".")
        return f"{_OF_RESPONSES[what]} of the response {name}"
    if (entry := leg_entry(quantity)) is not None:
        leg, row, column = entry
        return f"c{row + 1}{column + 1} of the 6×6 of {leg}"
    return SIGNS.get(quantity, quantity)


def _unit(quantity: str) -> str:
    if quantity.startswith(RESPONSE) and not quantity.endswith(".frequency"):
        return "m/N"
    if not is_static(quantity):
        return "Hz"
    if quantity.startswith(LOAD):
        return "m"
    return "rad/(N m)" if quantity in ROTATIONS else "m/N"
