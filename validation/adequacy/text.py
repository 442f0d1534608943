"""The matrix in words: a line for terminals, and notes on parts."""

from collections.abc import Sequence

from lumped.acceptance.requirement import ORDER, STATIC_QUANTITIES
from validation.adequacy.matrix import Adequacy, Matrix

_VERDICTS: tuple[Adequacy, ...] = ("adequate", "inadequate", "undecided")


def in_a_line(matrix: Matrix) -> str:
    """Which models are adequate for what; models of which the same is to be said share a clause."""
    alike: dict[str, list[str]] = {}
    for note in matrix.models:
        entries = matrix.of_model(note.model)
        parts = [
            f"{verdict} for {_names(matrix, names)}"
            for verdict in _VERDICTS
            if (names := [e.quantity for e in entries if e.verdict == verdict])
        ]
        said = ", ".join(parts) or f"not judged ({note.silent})"
        alike.setdefault(said, []).append(note.model)
    return "; ".join(f"{', '.join(models)}: {said}" for said, models in alike.items())


def notes_of_part(part: Matrix) -> list[str]:
    """What a part alone shows that is not adequate, by beams, in words."""
    notes = []
    for entry in part.of_model("beam"):
        if entry.verdict == "adequate" or entry.error is None or entry.uncertainty is None:
            continue
        said = f"{part.robot} alone, {entry.quantity} by beams: {100.0 * entry.error:+.3g} %"
        if entry.uncertainty > 1e-3:
            said += f" ± {100.0 * entry.uncertainty:.2g} %"
        if entry.causes:
            said += f", {100.0 * entry.causes[0].share:.0f} % of it {entry.causes[0].cause}"
        if entry.error_with_remedy is not None:
            said += f"; {entry.remedy}: {100.0 * entry.error_with_remedy:+.2g} %"
        notes.append(f"{said} ({entry.verdict})")
    return notes


def _names(matrix: Matrix, quantities: Sequence[str]) -> str:
    """Quantities in words where all of a kind are there."""
    frequencies = [name for name in matrix.quantities if name not in (*STATIC_QUANTITIES, ORDER)]
    kinds = (
        ("deflections and rotations", STATIC_QUANTITIES),
        ("frequencies", frequencies if len(frequencies) > 1 else ()),
    )
    said, left = [], list(quantities)
    for name, kind in kinds:
        if kind and all(one in left for one in kind):
            said.append(name)
            left = [one for one in left if one not in kind]
    return ", ".join([*said, *left])
