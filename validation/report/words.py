"""Names of models and quantities in sentences, and the sentence on a matrix of verdicts.

Input: a `Matrix` and the models relied on. Output: sentences. Rule: the sentence has the verdicts
on the models relied on; if no models are relied on, it recommends models. It has at most forty
words, unless many models are relied on. Assumptions are a separate sentence.
"""

from collections.abc import Collection, Mapping, Sequence

from lumped.acceptance.quantities import AXIS_LABELS, ORDER, Quantity, QuantityGroup
from validation.adequacy.judged_models import JUDGED
from validation.drawing.text import bound, error_text, number, percent
from validation.verdicts import VERDICTS, Adequacy, Coordinate, Entry, Matrix

_WORDS: Mapping[str, str] = {name: model.words for name, model in JUDGED.items()}


def model_name(model: str) -> str:
    """Name of a model inside a sentence."""
    return _WORDS.get(model) or model


def quantities_text(matrix: Matrix, quantities: Collection[Quantity]) -> str:
    """Names of quantities inside a sentence.

    If all judged quantities of a group are listed, the name of the group, such as "frequencies",
    replaces them.
    """
    judged = {entry.quantity for entry in matrix.entries}
    words: list[str] = []
    remaining = [quantity for quantity in matrix.quantities if quantity in quantities]
    for group in QuantityGroup:
        members = {quantity for quantity in judged if quantity.group is group}
        if group.value and len(members) > 1 and members <= set(remaining):
            words += group.value
            remaining = [quantity for quantity in remaining if quantity not in members]
    singles = (
        f"the {quantity.label}" if quantity == ORDER else quantity.label for quantity in remaining
    )
    return listed([*words, *singles])


def capital(text: str) -> str:
    """Text with a capital first letter, otherwise unchanged."""
    return f"{text[:1].upper()}{text[1:]}"


def listed(words: Sequence[str]) -> str:
    """Words joined by commas and a final "and"."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def force_text(entry: Entry) -> str:
    """Direction of force with the largest error: "(0.71, −0.7, 0.02)". "" without a direction."""
    return (
        f"({', '.join(number(component, 2) for component in entry.force)})" if entry.force else ""
    )


def sentence(matrix: Matrix, rely: Sequence[str] = ()) -> str:
    """Sentence with the verdicts on the models of `rely`.

    If `rely` is empty, it names the adequate models.
    """
    relied = [model for model in rely if matrix.of_model(model)]
    text = _relied_text(matrix, relied) if relied else _recommendation(matrix)
    return f"{text}." if text else "No verdict on any model."


def conditions(matrix: Matrix, rely: Sequence[str] = ()) -> str:
    """Sentences on the conditions under which decided verdicts hold. "" if there are none.

    If the models of `rely` are judged, only the verdicts on them count, otherwise all verdicts. One
    condition is the assumed distribution of masses, on which verdicts on frequencies depend. The
    other is the number of compared poses, given if the verdict "adequate" is based on some poses of
    the path only.
    """
    entries = [e for model in rely for e in matrix.of_model(model)] or matrix.entries
    decided = [entry for entry in entries if entry.verdict != "undecided"]
    sentences = []
    if matrix.supposed and any(not entry.quantity.static for entry in decided):
        sentences.append(f"Verdicts on frequencies hold {matrix.supposed}.")
    partly_compared: dict[int, set[Quantity]] = {}
    for entry in decided:
        # One pose suffices for "inadequate". A measured value has one pose.
        if entry.verdict == "adequate" and None in entry.errors and not entry.measured:
            compared = len(entry.errors) - entry.errors.count(None)
            partly_compared.setdefault(compared, set()).add(entry.quantity)
    sentences += [
        f"Adequate for {quantities_text(matrix, quantities)} in {compared} of "
        f"{len(matrix.poses)} poses: there is no comparison in the others."
        for compared, quantities in sorted(partly_compared.items())
    ]
    return " ".join(sentences)


def _relied_text(matrix: Matrix, models: Sequence[str]) -> str:
    """Text with verdicts and largest errors of models.

    Models with the same verdicts share a text.
    """
    models_by_verdicts: dict[tuple[tuple[Quantity, Adequacy], ...], list[str]] = {}
    for model in models:
        verdicts = tuple((entry.quantity, entry.verdict) for entry in matrix.of_model(model))
        models_by_verdicts.setdefault(verdicts, []).append(model)
    texts = []
    for verdicts, names in models_by_verdicts.items():
        entries = [entry for name in names for entry in matrix.of_model(name)]
        parts = [
            f"{verdict} for "
            f"{_purpose_text(matrix, [q for q, own_verdict in verdicts if own_verdict == verdict])}"
            f"{_largest_error_text([entry for entry in entries if entry.verdict == verdict])}"
            for verdict in VERDICTS
            if any(own_verdict == verdict for _, own_verdict in verdicts)
        ]
        texts.append(f"{listed(names)}: {', '.join(parts)}")
    limits = sorted(entry.limit for model in models for entry in matrix.of_model(model))
    accepted = dict.fromkeys(percent(limit, signed=False) for limit in (limits[0], limits[-1]))
    return f"You rely on {'; '.join(texts)}. Accepted error: {' to '.join(accepted)}"


def _purpose_text(matrix: Matrix, quantities: Sequence[Quantity]) -> str:
    judged = {entry.quantity for entry in matrix.entries}
    everything = judged == {*quantities} and ORDER in judged
    return "all quantities" if everything else quantities_text(matrix, quantities)


def _largest_error_text(entries: Sequence[Entry]) -> str:
    """Text with the largest error of entries with one verdict. "" if they are undecided.

    For the verdict "adequate", it is the largest upper bound of the error. Errors of the quantity
    "order of modes" count only if there are no others, since they compare modes of different
    shapes.
    """
    adequate = entries[0].verdict == "adequate"
    with_error = [entry for entry in entries if entry.error is not None]
    with_error = [entry for entry in with_error if entry.quantity != ORDER] or with_error
    if not with_error or entries[0].verdict == "undecided":
        return ""
    largest = max(bound(entry) if adequate else abs(entry.error or 0.0) for entry in with_error)
    error = error_text(largest, signed=False)
    return f" (error {'at most' if adequate else 'up to'} {error})"


def models_to_use(matrix: Matrix) -> list[tuple[str, set[Quantity]]]:
    """Models that together are adequate for every quantity for which any model is adequate.

    Each model is listed with the quantities for which it was chosen. Each step chooses the model
    that is adequate for most of the remaining quantities. Of several such models, it chooses the
    first in the order of the matrix.
    """
    adequate = {
        note.model: {e.quantity for e in matrix.of_model(note.model) if e.verdict == "adequate"}
        for note in matrix.models
    }
    uncovered: set[Quantity] = set().union(*adequate.values())
    selection: list[tuple[str, set[Quantity]]] = []
    while uncovered:
        model = max(adequate, key=lambda name: len(adequate[name] & uncovered))
        selection.append((model, adequate[model] & uncovered))
        uncovered -= adequate[model]
    return selection


def _recommendation(matrix: Matrix) -> str:
    selection = models_to_use(matrix)
    covered = {quantity for _, quantities in selection for quantity in quantities}
    undecided = {e.quantity for e in matrix.entries if e.verdict == "undecided"} - covered
    refused = {entry.quantity for entry in matrix.entries} - covered - undecided
    # Solids are no remedy for legs known by a 6×6 alone, since they model equivalent prisms.
    if refused and not (matrix.supposed or any(entry.measured for entry in matrix.entries)):
        selection.append(("solid", refused))
        refused = set()
    texts = [f"{model} ({quantities_text(matrix, quantities)})" for model, quantities in selection]
    parts = [f"within the accepted errors, use {', '.join(texts)}"] if texts else []
    parts += [f"no model is adequate for {quantities_text(matrix, refused)}"] if refused else []
    parts += [f"undecided: {quantities_text(matrix, undecided)}"] if undecided else []
    return capital("; ".join(parts))


def pose_text(coordinates: Sequence[Coordinate], pose: Sequence[float]) -> str:
    """Coordinates of a pose as text with units: "x = 0.4975 m".

    "the root clamped" for an empty pose, which belongs to a single leg.
    """
    if not pose:
        return "the root clamped"
    return ", ".join(
        f"{AXIS_LABELS[coordinate.name]} = {number(value, 4)} {coordinate.unit}"
        for coordinate, value in zip(coordinates, pose, strict=True)
    )
