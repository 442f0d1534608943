"""Models, quantities and errors in words, and the whole matrix in one sentence.

Of the models relied on, else which models to use; at most forty words, unless many are relied on.
What verdicts suppose is a sentence of its own.
"""

from collections.abc import Collection, Mapping, Sequence

from lumped.acceptance.quantities import AXIS_LABELS, ORDER, Quantity, QuantityKind
from validation.drawing.text import bound, error_text, number, percent
from validation.verdicts import VERDICTS, Adequacy, Coordinate, Entry, Matrix

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
_KIND = QuantityKind
# Words for all quantities of some kinds together.
_GROUPS: tuple[tuple[tuple[str, ...], frozenset[QuantityKind]], ...] = (
    (
        ("deflections", "rotations"),
        frozenset(
            {_KIND.DEFLECTION, _KIND.ROTATION, _KIND.ANY_FORCE, _KIND.COMPONENT, _KIND.ANGLE}
        ),
    ),
    (("frequencies",), frozenset({_KIND.FREQUENCY})),
    (("loads",), frozenset({_KIND.LOAD})),
    (
        ("responses",),
        frozenset({_KIND.PEAK, _KIND.PEAK_FREQUENCY, _KIND.SIZE, _KIND.TEST_SIZE, _KIND.LOW_SIZE}),
    ),
)


def model_name(model: str) -> str:
    """The model as in a sentence."""
    return _MODELS.get(model, model)


def quantities_text(matrix: Matrix, quantities: Collection[Quantity]) -> str:
    """Quantities as in a sentence, all of a group together."""
    judged = {entry.quantity for entry in matrix.entries}
    words: list[str] = []
    remaining = [quantity for quantity in matrix.quantities if quantity in quantities]
    for group, kinds in _GROUPS:
        members = {quantity for quantity in judged if quantity.kind in kinds}
        if len(members) > 1 and members <= set(remaining):
            words += group
            remaining = [quantity for quantity in remaining if quantity not in members]
    singles = (f"the {one.label}" if one == ORDER else one.label for one in remaining)
    return listed([*words, *singles])


def capital(text: str) -> str:
    """The text with a capital first letter, the rest as it is."""
    return f"{text[:1].upper()}{text[1:]}"


def listed(words: Sequence[str]) -> str:
    """Words with commas and a final "and"."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def force_text(entry: Entry) -> str:
    """The worst direction of any force: "(0.71, −0.7, 0.02)"; "" of any other quantity."""
    return f"({', '.join(number(one, 2) for one in entry.force)})" if entry.force else ""


def sentence(matrix: Matrix, rely: Sequence[str] = ()) -> str:
    """Whether the models of `rely` are adequate; without any, which models are, for what."""
    relied = [model for model in rely if matrix.of_model(model)]
    said = _relied(matrix, relied) if relied else _to_use(matrix)
    return f"{said}." if said else "No model could be judged."


def supposition(matrix: Matrix, rely: Sequence[str] = ()) -> str:
    """What decided verdicts on frequencies suppose, of models of `rely` if any; "" without such."""
    entries = [e for model in rely for e in matrix.of_model(model)] or matrix.entries
    decided = any(e.verdict != "undecided" and not e.quantity.static for e in entries)
    return f"Frequencies are judged {matrix.supposed}." if matrix.supposed and decided else ""


def _relied(matrix: Matrix, models: Sequence[str]) -> str:
    """For models of the same verdicts: for what they are adequate or not, how far they are off."""
    alike: dict[tuple[tuple[Quantity, Adequacy], ...], list[str]] = {}
    for model in models:
        verdicts = tuple((entry.quantity, entry.verdict) for entry in matrix.of_model(model))
        alike.setdefault(verdicts, []).append(model)
    told = []
    for verdicts, names in alike.items():
        entries = [entry for name in names for entry in matrix.of_model(name)]
        parts = [
            f"{verdict} for {_for_what(matrix, [q for q, one in verdicts if one == verdict])}"
            f"{_by([entry for entry in entries if entry.verdict == verdict])}"
            for verdict in VERDICTS
            if any(one == verdict for _, one in verdicts)
        ]
        told.append(f"{listed(names)}: {', '.join(parts)}")
    limits = sorted(entry.limit for model in models for entry in matrix.of_model(model))
    accepted = dict.fromkeys(percent(limit, signed=False) for limit in (limits[0], limits[-1]))
    return f"You rely on {'; '.join(told)}. You accept {' to '.join(accepted)}"


def _for_what(matrix: Matrix, quantities: Sequence[Quantity]) -> str:
    spoken = {entry.quantity for entry in matrix.entries}
    everything = spoken == {*quantities} and ORDER in spoken
    return "everything judged" if everything else quantities_text(matrix, quantities)


def _by(entries: Sequence[Entry]) -> str:
    """The largest error of entries of one verdict; of adequate ones the largest that is left open.

    Of the order, which compares modes that have nothing in common, only where nothing else is.
    """
    adequate = entries[0].verdict == "adequate"
    found = [entry for entry in entries if entry.error is not None]
    found = [entry for entry in found if entry.quantity != ORDER] or found
    if not found or entries[0].verdict == "undecided":
        return ""
    largest = max(bound(one) if adequate else abs(one.error or 0.0) for one in found)
    off = error_text(largest, signed=False)
    return f" (off by {'at most' if adequate else 'up to'} {off})"


def models_to_use(matrix: Matrix) -> list[tuple[str, set[Quantity]]]:
    """Models that together are adequate for all that any is adequate for, with what each is for.

    In turn the model that is adequate for most of what is left, the simplest of equals.
    """
    fitting = {
        note.model: {e.quantity for e in matrix.of_model(note.model) if e.verdict == "adequate"}
        for note in matrix.models
    }
    left: set[Quantity] = set().union(*fitting.values())
    chosen: list[tuple[str, set[Quantity]]] = []
    while left:
        model = max(fitting, key=lambda name: len(fitting[name] & left))
        chosen.append((model, fitting[model] & left))
        left -= fitting[model]
    return chosen


def _to_use(matrix: Matrix) -> str:
    chosen = models_to_use(matrix)
    held = {quantity for _, found in chosen for quantity in found}
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
    return capital("; ".join(parts))


def pose_text(coordinates: Sequence[Coordinate], pose: Sequence[float]) -> str:
    """Coordinates of a pose with their units: "x = 0.4975 m"; "the root clamped" if it has none."""
    if not pose:
        return "the root clamped"
    return ", ".join(
        f"{AXIS_LABELS[coordinate.name]} = {number(value, 4)} {coordinate.unit}"
        for coordinate, value in zip(coordinates, pose, strict=True)
    )
