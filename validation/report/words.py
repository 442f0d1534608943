"""Models, quantities and errors in words, and the whole matrix in one sentence.

Of the models relied on, else which models to use; at most forty words, unless many are relied on.
"""

from collections.abc import Collection, Mapping, Sequence
from math import ceil

from lumped.acceptance.requirement import (
    ANY_FORCE,
    FREQUENCIES,
    OF_HAMMER,
    ORDER,
    RESPONSE,
    STATIC_QUANTITIES,
    is_static,
)
from validation.adequacy.matrix import VERDICTS, Entry, Matrix
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
    ORDER: "order of modes",
}
_NOTHING = 5e-5


def model_name(model: str) -> str:
    """The model as in a sentence."""
    return _MODELS.get(model, model)


def quantities_text(matrix: Matrix, quantities: Collection[str]) -> str:
    """Quantities as in a sentence, all of a kind together."""
    spoken = {entry.quantity for entry in matrix.entries}
    told: list[str] = []
    left = [name for name in matrix.quantities if name in quantities]
    for words, kind in (
        (("deflections", "rotations"), STATIC_QUANTITIES),
        (("frequencies",), FREQUENCIES),
        (("responses",), [name for name in spoken if name.startswith(RESPONSE)]),
    ):
        asked = spoken.intersection(kind)
        if len(asked) > 1 and asked <= set(left):
            told += words
            left = [name for name in left if name not in asked]
    return listed([*told, *(f"the {SIGNS[ORDER]}" if q == ORDER else heading(q) for q in left)])


def heading(quantity: str) -> str:
    """A quantity as the table heads it: "φx", "load cutting"."""
    if quantity.startswith(OF_HAMMER):
        at = quantity.removeprefix(OF_HAMMER)
        return f"response {f'at {at}' if at in FREQUENCIES else 'at low frequency'}"
    return SIGNS.get(quantity, quantity.replace(":", " "))


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


def sentence(matrix: Matrix, rely: Sequence[str] = ()) -> str:
    """Whether the models of `rely` are adequate; without any, which models are, for what."""
    relied = [model for model in rely if matrix.of_model(model)]
    said = _relied(matrix, relied) if relied else _to_use(matrix)
    decided = [e for e in matrix.entries if not is_static(e.quantity)]
    if matrix.supposed and any(entry.verdict != "undecided" for entry in decided):
        said += f". Frequencies are judged {matrix.supposed}"
    return f"{said}." if said else "No model could be judged."


def _relied(matrix: Matrix, models: Sequence[str]) -> str:
    """For each model: for what it is adequate, for what not, and by how much it may be off."""
    told = []
    for model in models:
        entries = matrix.of_model(model)
        parts = [
            f"{verdict} for {quantities_text(matrix, [e.quantity for e in found])}{_by(found)}"
            for verdict in VERDICTS
            if (found := [entry for entry in entries if entry.verdict == verdict])
        ]
        told.append(f"{model}: {', '.join(parts)}")
    return f"You rely on {'; '.join(told)}"


def _by(entries: Sequence[Entry]) -> str:
    """How far entries of one verdict are off, what is left open included where they hold."""
    adequate, limits = entries[0].verdict == "adequate", [entry.limit for entry in entries]
    sizes = [
        abs(entry.error) + (entry.uncertainty or 0.0) * adequate
        for entry in entries
        if entry.error is not None
    ]
    if not sizes or entries[0].verdict == "undecided":
        return ""
    how = "at most" if adequate else "up to"
    accepted = " to ".join(
        dict.fromkeys(_rounded_up(limit) for limit in (min(limits), max(limits)))
    )
    return f" (off by {how} {_rounded_up(max(sizes))}, you accept {accepted})"


def _to_use(matrix: Matrix) -> str:
    """The fewest models that are adequate for all that any is adequate for, the simplest first."""
    fitting = {
        note.model: {e.quantity for e in matrix.of_model(note.model) if e.verdict == "adequate"}
        for note in matrix.models
    }
    left = set().union(*fitting.values())
    chosen: list[tuple[str, set[str]]] = []
    while left:
        model = max(fitting, key=lambda name: len(fitting[name] & left))
        chosen.append((model, fitting[model] & left))
        left -= fitting[model]
    held = set().union(*fitting.values())
    undecided = {e.quantity for e in matrix.entries if e.verdict == "undecided"} - held
    refused = {entry.quantity for entry in matrix.entries} - held - undecided
    # Solids of legs known by a 6×6 alone are of other legs: no remedy.
    if refused and not (matrix.supposed or any(entry.measured for entry in matrix.entries)):
        chosen.append(("solid", refused))
        refused = set()
    said = [f"{model} ({quantities_text(matrix, found)})" for model, found in chosen]
    parts = [f"for your limits use {', '.join(said)}"] if said else []
    parts += [f"no model is adequate for {quantities_text(matrix, refused)}"] if refused else []
    parts += [f"undecided: {quantities_text(matrix, undecided)}"] if undecided else []
    told = "; ".join(parts)
    return f"{told[:1].upper()}{told[1:]}"


def _rounded_up(size: float) -> str:
    """A bound of relative sizes, rounded up to a tenth of a percent: "2.1 %"."""
    return f"{number(ceil(1000.0 * size - _NOTHING) / 10.0, 3)}\u00a0%"
