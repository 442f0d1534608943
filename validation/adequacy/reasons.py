"""Reasons for verdicts as text: missing numbers, unknown shapes, misplaced modes, ambiguous files.

Input: `Errors` of a quantity, the reference and the deciding pose. Output: text for the field
`reason` of an entry, and the half-widths by source from which it follows.
"""

from itertools import compress
from typing import TypeAlias

from lumped.acceptance.quantities import ORDER, Quantity, QuantityKind
from lumped.arrays import Array
from validation.adequacy.errors import Errors, verdicts_of
from validation.references.reference import NOT_FINER, Reference, Source
from validation.references.responses import Model
from validation.verdicts import Adequacy

_UNDECIDED_SHAPES = "several modes of the reference have the shape of one mode"
# If the largest source of uncertainty has no remedy, the remedy of another source is given if that
# source is at least this fraction as large.
_NEAR_SHARE = 0.5
# Index of the interpretation, and of the pose, to which the numbers of an entry belong.
Position: TypeAlias = tuple[int, int]


def reason_of(
    errors: Errors,
    model: Model,
    quantity: Quantity,
    verdict: Adequacy,
    reference: Reference,
    position: Position,
    limits: Array,
) -> str:
    """Reason why a `verdict` is not "adequate", or the information that would decide it.

    "" if there is nothing to add to the number. `position`: index of the interpretation and of the
    pose. `limits` (P): accepted error in each of P poses.
    """
    if verdict == "adequate":
        return ""
    pose = position[1]
    unknown, harmonic = errors.unknown[:, pose], quantity.harmonic
    if errors.missing[:, pose].all() and not unknown.any():
        return f"{model.name} {_reason_without_number(errors, quantity, pose)}"
    if unknown.any() and quantity.kind is QuantityKind.LOAD:
        return "the tool cannot move as the load requires in any pose, so that nothing is compared"
    if verdict == "inadequate":
        rigid = errors.displacement is not None and not errors.value[:, pose].any()
        return model.rigid if rigid else ""
    texts = _misplaced_modes(errors, reference, pose)
    if errors.pairing is not None and errors.pairing.undecided[:, pose].any():
        texts.append(f"{_UNDECIDED_SHAPES} of {model.name}")
        unknown = unknown & ~errors.pairing.undecided[:, pose]
    if unknown.any():
        without = [
            interpretation.name for interpretation in compress(reference.interpretations, unknown)
        ]
        lacking = (
            "the response is undamped"
            if harmonic
            else "the robot has fewer modes than are compared"
        )
        texts.append(f"with {', '.join(without)} {lacking}")
    decides = _deciding_information(errors, reference, pose, limits)
    if texts or errors.missing[:, pose].any():
        return "; ".join(filter(None, (*texts, decides or reference.finer)))
    parts = half_width_parts(errors, reference, position)
    remedy_by_source: dict[str, str] = {
        **{source: source.remedy for source in Source},
        reference.open: decides,
        Source.MESHES: reference.finer,
        Source.INTERIOR: reference.interior,
        Source.MASSES: reference.masses or reference.decides,
    }
    widest = max(parts.values())
    ranked = sorted(parts, key=lambda name: -parts[name])
    # If the largest source has no remedy, the remedy of a nearly as large source is given.
    remedies = [
        remedy_by_source[name]
        for name in ranked
        if parts[name] >= _NEAR_SHARE * widest and remedy_by_source[name]
    ]
    return next((remedy for remedy in remedies if remedy != NOT_FINER), reference.finer)


def _reason_without_number(errors: Errors, quantity: Quantity, pose: int) -> str:
    """Reason why the model has no value in a `pose`: a phrase that follows the model's name."""
    if quantity.static:
        return "is elastic in a direction in which the reference is rigid"
    if quantity.harmonic:
        return "has no peak in this frequency range, or an undamped peak without bound"
    if quantity == ORDER or errors.pairing is None:
        return "has too few modes"
    pairing = errors.pairing
    share, mac = (float(values[:, pose].max()) for values in (pairing.rigid_share, pairing.mac))
    lacking = f"energy-weighted MAC of at most {mac:.2f} with each of its modes"
    if pairing.local[:, pose].all():
        return (
            "lacks this mode, which is local to the section of a leg: rigid motion of "
            f"cross-sections and bodies has {100.0 * share:.2g} % of its kinetic energy; "
            f"{lacking}"
        )
    return f"has no mode of this shape: {lacking}"


def _deciding_information(errors: Errors, reference: Reference, pose: int, limits: Array) -> str:
    """Instruction to add to the robot file the information on which the verdict depends.

    `limits` (P): accepted error in each of P poses. The information is the stiffness inside the
    legs if the verdict remains undecided with any choice for everything else that the robot file
    leaves open.
    """
    if not reference.interior:
        return reference.decides
    verdicts = [verdicts_of(errors.rows(rows), limits)[pose] for rows in reference.by_interior]
    return reference.interior if set(verdicts) == {"undecided"} else reference.decides


def _misplaced_modes(errors: Errors, reference: Reference, pose: int) -> list[str]:
    """Texts on modes whose numbers differ from the reference, one for each interpretation.

    `pose` is the index of the pose. [] if all interpretations agree.
    """
    if errors.numbers is None:
        return []
    names_by_text: dict[str, list[str]] = {}
    for interpretation, numbers in zip(
        reference.interpretations, errors.numbers[:, pose], strict=True
    ):
        misplaced = [
            f"f{k + 1} is " + (f"f{number + 1} of the model" if number >= 0 else "missing")
            for k, number in enumerate(numbers)
            if number != k
        ]
        names_by_text.setdefault(", ".join(misplaced), []).append(interpretation.name)
    if len(names_by_text) == 1:
        return []
    texts = [
        f"{misplaced} with {' or '.join(names)}"
        for misplaced, names in names_by_text.items()
        if misplaced
    ]
    return (
        [*texts, "with the other assumptions all modes are in the same order"]
        if "" in names_by_text
        else texts
    )


def half_width_parts(errors: Errors, reference: Reference, position: Position) -> dict[str, float]:
    """Half-width of the error by name of the source, for one interpretation and pose (`position`).

    The sources of the reference's budget are completed by the pairing of modes, the stiffness
    inside the legs, and whatever else the robot file leaves open. The half-width of a choice that
    the robot file leaves open is half the distance between the errors under its alternatives.
    """
    parts: dict[str, float] = {
        source: float(half_widths[position])
        for source, half_widths in errors.budget.items()
        if source is Source.MESHES or half_widths.any()
    }
    if errors.pairing is not None:
        mixed = 0.5 * float(errors.pairing.below[position] + errors.pairing.above[position])
        parts |= {Source.PAIRING: mixed} if mixed else {}
    if reference.open and errors.numbers is None:
        low = high = errors.error[:, position[1]]
        if errors.pairing is not None:
            low = low - errors.pairing.exchange_below[:, position[1]]
            high = high + errors.pairing.exchange_above[:, position[1]]
        interior = 0.0
        if reference.interior:
            groups = reference.by_interior
            interior = max(0.5 * float(high[rows].max() - low[rows].min()) for rows in groups)
            parts[Source.INTERIOR] = interior
        parts[reference.open] = 0.5 * float(high.max() - low.min()) - interior
    return {str(name): half_width for name, half_width in parts.items()}
