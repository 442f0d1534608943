"""Case on a CAD part with two interfaces: stepped and condensed models against the solid.

Input: a CAD part, its first interface clamped, its second loaded or free. Output: one verdict, and
values of the models without a verdict. Rule for the verdict: stiffness and mass condensed to the
interfaces (Guyan, AIAA J. 3 (1965) 380) restrain the part to static shapes, so by Rayleigh's
principle its k-th frequency cannot lie below the k-th frequency of the solid on the same mesh.

Ribs, lugs and fillets are in the solid and not in a stepped beam, and a condensed part has six
modes only. These differences are named but not bounded, so no small tolerance applies here. The
models of parts are judged in the matrix of verdicts, by the limits of [accept].
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from lumped.acceptance.requirement import AgreementLimits
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.mechanism.body import Body
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import clamped_modes, tip_compliance_of
from lumped.screws import turn, turn_matrix
from validation.case import Elsewhere, Measurement, Relation, Relative, UnjudgedValue
from validation.case_group import CaseGroup
from validation.comparisons.agreement_cases import MOTIONS
from validation.comparisons.discretisations import Discretisation
from validation.comparisons.element_convergence import MODES
from validation.context import Context
from validation.models.leg_models import leg_matrices
from validation.models.options import RefinedModel
from validation.models.reduced_parts import identified, is_leg, leg_axes
from validation.models.stepped_parts import PIECES, stepped
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.studies_and_figures import AGREEMENT

QUANTITIES = (*MOTIONS, *(f"f{number}" for number in range(1, MODES + 1)))
_STEPPED: tuple[RefinedModel, ...] = ("segments", "beam")
UNITS = (*(unit for _, unit in MOTIONS.values()), *MODES * ("Hz",))


@dataclass(frozen=True, eq=False)
class PartValues:
    """Values of a clamped part: diagonal tip compliances, then its first `MODES` frequencies.

    `values` are six compliances (SI, leg axes), then frequencies (Hz, ascending). `half_widths` are
    those due to the mesh of the part. They are NaN if the file of the part is itself a mesh, which
    cannot be refined.
    """

    values: Array
    half_widths: Array


def parts_as_legs(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the CAD parts with two interfaces."""
    return tuple(name for name, body in mechanism.parts.items() if is_leg(body))


def solid_values(body: Body) -> PartValues:
    """Values of a CAD part as a solid on its finest mesh, with the first interface clamped."""
    part, rotation = identified(body), leg_axes(body).rotation.T
    block = np.abs(turn(rotation))
    return PartValues(
        _values(turn_matrix(part.compliance, rotation), part.frequencies),
        # The half-width of a sum is at most the sum of half-widths.
        _values(block @ part.compliance_refinement @ block.T, part.frequency_refinement),
    )


def condensed_values(body: Body) -> Array:
    """Six tip compliances (SI), then `MODES` frequencies (Hz), of a condensed, clamped CAD part."""
    part, tip = identified(body), np.s_[6:, 6:]
    squared = eigh(part.stiffness[tip], part.mass[tip], eigvals_only=True)
    compliance = np.linalg.inv(part.stiffness[tip]).astype(float)
    frequencies = np.sqrt(squared) / (2.0 * np.pi)
    return _values(turn_matrix(compliance, leg_axes(body).rotation.T), frequencies)


def stepped_values(body: Body, discretisation: Discretisation) -> Array:
    """Six tip compliances (SI), then `MODES` frequencies (Hz), of a CAD part as prismatic pieces.

    The part is clamped at its first interface. Raises InputError if it cannot be divided into
    prismatic pieces.
    """
    matrices = leg_matrices(discretisation.model, stepped(body), discretisation.options)
    return _values(tip_compliance_of(matrices), clamped_modes(matrices, MODES).frequencies)


def _values(compliance: Array, frequencies: Array) -> Array:
    return np.concatenate([np.diag(compliance), frequencies[:MODES]])


cases = CaseGroup(
    over={"body": lambda parts: parts},
    reference_kind="independent-solver",
    section=AGREEMENT,
    subject="leg",
    group=SHARED_SOLIDS,
)


@cases.case(
    "{body}.bound[condensed-solid]",
    "{body}: no frequency of the condensed part is below that of its solid",
    quantity="f1 to f4 by number, first interface clamped",
    unit="Hz",
    label="bound",
    model="condensed",
    citation="Rayleigh's principle; same mesh of the part, all modes",
    relation=Relation.AT_LEAST,
    tolerance=Relative(1e-6),
    tolerance_reason="same mesh: round-off of two eigenvalue solvers, 1e-9 and less",
)
def _bound(context: Context, body: str, limits: AgreementLimits) -> Measurement:
    part = context.robot_file.mechanism.parts[body]
    solid, condensed = solid_values(part), condensed_values(part)
    first = len(MOTIONS)
    pairs = zip(QUANTITIES[first:], condensed[first:], solid.values[first:], strict=True)
    (_, value, reference), *other_pairs = pairs
    notes = []
    # Both models have the same mesh, whose half-widths do not affect the difference.
    unjudged_values = [
        *_unjudged_values("condensed", 0, condensed, replace(solid, half_widths=0.0 * solid.values))
    ]
    try:
        unjudged_values = [*_stepped(part, limits, solid), *unjudged_values]
    except InputError as error:
        notes.append(f"no stepped form of the part: {error}")
    return Measurement(
        float(value),
        float(reference),
        exact=True,
        elsewhere=tuple(Elsewhere(name, float(a), float(b)) for name, a, b in other_pairs),
        notes=tuple(notes),
        shown=tuple(unjudged_values),
    )


def _stepped(body: Body, limits: AgreementLimits, solid: PartValues) -> Iterator[UnjudgedValue]:
    """Values of a CAD part as prismatic pieces.

    The element count of [agree] is rounded to whole elements per piece.
    """
    elements = PIECES * max(1, round(limits.elements / PIECES))
    for model in _STEPPED:
        values = stepped_values(body, Discretisation(model, elements=elements))
        yield from _unjudged_values(f"{model}-stepped", elements, values, solid)


def _unjudged_values(
    model: str, elements: int, values: Array, solid: PartValues
) -> Iterator[UnjudgedValue]:
    columns = zip(QUANTITIES, UNITS, values, solid.values, solid.half_widths, strict=True)
    for label, unit, value, reference, width in columns:
        half_width = float(width) if np.isfinite(width) else None
        yield UnjudgedValue(
            model, label, unit, float(value), float(reference), half_width, elements
        )
