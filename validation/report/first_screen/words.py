"""Models, quantities and errors in words."""

from collections.abc import Collection, Mapping, Sequence

from lumped.acceptance.requirement import ANY_FORCE, FREQUENCIES, STATIC_QUANTITIES
from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.text import number, percent

_MODELS: Mapping[str, str] = {
    "simplified": "the simplified model",
    "vjm": "VJM with the legs as given",
    "vjm-equivalent": "VJM on equivalent legs",
    "beam": "beams",
    "segments-euler-bernoulli": "Euler–Bernoulli segments",
    "beam-euler-bernoulli": "Euler–Bernoulli beams",
    "segments-condensed": "condensed segments",
    "segments-stepped": "stepped segments",
}
SIGNS: Mapping[str, str] = {
    "phi_x": "φx",
    "phi_y": "φy",
    "phi_z": "φz",
    ANY_FORCE: "any force",
    "order": "order of modes",
}
_NOTHING = 5e-5


def model_name(model: str) -> str:
    """The model as in a sentence."""
    return _MODELS.get(model, model)


def quantities_text(matrix: Matrix, quantities: Collection[str]) -> str:
    """Quantities as the table heads them, all of a kind together."""
    spoken = {entry.quantity for entry in matrix.entries}
    told, left = [], [name for name in matrix.quantities if name in quantities]
    for words, kind in (
        ("deflections and rotations", STATIC_QUANTITIES),
        ("frequencies", FREQUENCIES),
    ):
        asked = spoken.intersection(kind)
        if len(asked) > 1 and asked <= set(left):
            told.append(words)
            left = [name for name in left if name not in asked]
    return ", ".join([*told, *(SIGNS.get(name, name) for name in left)])


def capital(text: str) -> str:
    """The text with a capital first letter, the rest as it is."""
    return f"{text[:1].upper()}{text[1:]}"


def listed(words: Sequence[str]) -> str:
    """Words with commas and a final "and"."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def error_text(error: float, *, signed: bool = True) -> str:
    """An error in percent, two digits; "0 %" below what could matter to anyone."""
    return percent(error, signed=signed) if abs(error) >= _NOTHING else "0\u00a0%"


def force_text(entry: Entry) -> str:
    """The worst direction of any force: "(0.71, −0.7, 0.02)"; "" of any other quantity."""
    return f"({', '.join(number(one, 2) for one in entry.force)})" if entry.force else ""
