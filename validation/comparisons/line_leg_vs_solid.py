"""Cases on single legs along a line, root clamped: beams, segments and links against solids.

Input: a straight leg whose section varies, or an arc. Output: a verdict for each model on tip
motions and frequencies. The solid is the same taper or arc in quadratic hexahedra, with the end
condition of the robot file. Two causes of a difference are computed separately: held end faces, by
the same solid with free ends, and the textbook's section constants along the line. The remainder is
the difference from the solid with free ends, whose numbers converge with the order of its elements.

Beam theory itself neglects the square of the slope of a taper's faces (torsion, tapers across the
plane of bending, sections without two axes of symmetry) and the square of half the height over the
radius of an arc. These are added to the tolerances of [agree].
"""

import numpy as np

from lumped.acceptance.requirement import AgreementLimits
from lumped.arrays import Array
from lumped.legs import Ends, LineLeg
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import clamped_modes, legs_of
from validation.case import Allowance, Measurement, Relative, Skip
from validation.comparisons.agreement_cases import (
    FORMULA,
    FORMULA_SOURCE,
    HELD_FACES,
    agreement_group,
    compliance_cases,
    frequency_cases,
    limited,
)
from validation.comparisons.element_convergence import MODES
from validation.comparisons.section_formulas import leg_formula_band
from validation.context import Context
from validation.models.leg_models import leg_compliance, leg_frequencies
from validation.models.options import ModelName, ModelOptions
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    computed_elements,
    computed_sections,
    line_divisions,
    slowest,
    solid_leg,
)
from validation.solids.leg_meshes import formal_order
from validation.solids.solid_legs import ELEMENTS, line_frequencies
from validation.solids.solid_size import too_large, why_shapeless
from validation.uncertainty.mesh_half_widths import MeshPolicy, mesh_half_widths

_HELD_SOURCE = "the same solid with ends free to warp and contract"
_NEGLECTED = (
    "and the squares of a taper's slope and of half the height over an arc's radius, which beam "
    "theory neglects"
)


def neglected(leg: LineLeg) -> float:
    """Allowed error of beam theory: (largest slope of a face)² + (half the height / radius)²."""
    slopes = [
        abs(last - first) / (2.0 * (span.end - span.start))
        for span in leg.spans
        for first, last in zip(span.first.extent, span.last.extent, strict=True)
    ]
    return float(max(slopes) ** 2 + (0.5 * leg.largest_extent / leg.line.smallest_radius) ** 2)


def _line_legs(mechanism: Mechanism) -> list[tuple[str, float]]:
    """Name of each leg along a line and the relative error of its beam theory."""
    legs = legs_of(mechanism).items()
    return [(name, neglected(leg)) for name, leg in legs if isinstance(leg, LineLeg)]


cases = agreement_group(
    over={"body, neglected": _line_legs}, subject="leg", group="{body}.line", effort=1.0
)
_CITATION = "the same leg along its line meshed with quadratic hexahedra"


def _leg(context: Context, body: str) -> LineLeg:
    leg = legs_of(context.robot_file.mechanism)[body]
    if not isinstance(leg, LineLeg):
        raise TypeError(f"{body}: no leg along a line")
    divisions = line_divisions(context.meshes, leg)
    if reason := why_shapeless([leg]) or too_large([leg], divisions[1:], context.meshes):
        raise Skip(reason)
    return leg


def _options(limits: AgreementLimits) -> ModelOptions:
    return ModelOptions(elements=limits.elements)


@compliance_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="displacement of the tip, {motion}, under a unit load, root clamped",
    citation=_CITATION,
    tolerance=lambda limits, neglected: Relative(limits.compliance + neglected),
    tolerance_reason=f"[agree] compliance (default 0.1 %), {_NEGLECTED}",
)
def _motion(
    context: Context, body: str, model: ModelName, entry: int, limits: AgreementLimits
) -> Measurement:
    leg = _leg(context, body)
    ends = limits.ends_of(leg.ends)
    meshes = solid_leg(context, leg)
    diagonal = entry, entry
    fine, coarse = meshes.fine[ends][diagonal], meshes.coarse[ends][diagonal]
    restraint = meshes.restrained[diagonal] if ends == "rigid" else 0.0
    computed = context.get(_computed_tip, leg)[diagonal]
    theory = leg.sections("timoshenko").tip_compliance[diagonal]
    soft, stiff = (bound[diagonal] for bound in context.get(_formula_tips, leg))
    formula = limited(
        float(theory - computed), (float(stiff - computed), float(soft - computed)), 0.0
    )
    return Measurement(
        float(leg_compliance(model, leg, _options(limits))[diagonal]),
        float(fine),
        reference_uncertainty=float(
            mesh_half_widths([np.abs(np.array(fine - coarse))], slowest(meshes.ratio))
        ),
        judged_uncertainty=_free_half_width(
            leg, meshes.coarse["free"][diagonal], meshes.fine["free"][diagonal], meshes.ratio
        ),
        allowances=(
            Allowance(HELD_FACES, -float(restraint), _HELD_SOURCE),
            Allowance(FORMULA, formula, FORMULA_SOURCE),
        ),
    )


def _free_half_width(leg: LineLeg, coarse: float, fine: float, ratio: float) -> float:
    """Half-width of a number by the solid with free ends, from its values on two meshes.

    `ratio`: element size of the coarse mesh over that of the fine one.
    """
    policy = MeshPolicy.of_order(ratio, formal_order(leg, "free"))
    return float(mesh_half_widths([np.abs(np.array(fine - coarse))], policy))


def _computed_tip(leg: LineLeg) -> Array:
    """Tip compliance (6×6, SI) of the beam with section constants by finite elements."""
    return computed_sections(leg).tip_compliance


def _formula_tips(leg: LineLeg) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI) of the softest and stiffest beam by correct textbook formulas."""
    soft, stiff = (
        leg.sections_by(lambda prism: leg_formula_band(prism, SECTION_DIVISIONS)[side])  # noqa: B023
        for side in (0, 1)
    )
    return soft.tip_compliance, stiff.tip_compliance


@frequency_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="natural frequency {mode}, clamped-free, paired by shape",
    citation=_CITATION,
    tolerance=lambda limits, neglected: Relative(limits.frequency + neglected),
    tolerance_reason=f"[agree] frequency (default 1 %), {_NEGLECTED}",
)
def _frequency(
    context: Context, body: str, model: ModelName, index: int, limits: AgreementLimits
) -> Measurement:
    leg = _leg(context, body)
    ends = limits.ends_of(leg.ends)
    meshes = line_divisions(context.meshes, leg)
    (coarse, fine), (coarse_free, free) = (
        [context.get(_solid_frequencies, leg, number, held)[index] for number in meshes]
        for held in (ends, "free")
    )
    if np.isnan([coarse, fine, coarse_free, free]).any():
        raise Skip(f"no mode of the solid has the shape of mode {index + 1} of the beam")
    computed = context.get(_computed_frequencies, leg)[index]
    theory = leg_frequencies("beam", leg, index + 1, ModelOptions(elements=ELEMENTS))[index]
    value = leg_frequencies(model, leg, index + 1, _options(limits))[index]
    return Measurement(
        float(value),
        float(fine),
        reference_uncertainty=float(
            mesh_half_widths([np.abs(np.array(fine - coarse))], slowest(meshes[1] / meshes[0]))
        ),
        judged_uncertainty=_free_half_width(leg, coarse_free, free, meshes[1] / meshes[0]),
        allowances=(
            Allowance(HELD_FACES, float(free - fine), _HELD_SOURCE),
            Allowance(FORMULA, float(theory - computed), FORMULA_SOURCE),
        ),
    )


def _solid_frequencies(leg: LineLeg, divisions: int, ends: Ends) -> Array:
    beam = computed_elements(leg, None, ELEMENTS)
    return line_frequencies(leg, divisions, ends, beam, MODES)


def _computed_frequencies(leg: LineLeg) -> Array:
    """Frequencies (Hz) of beam elements with section constants by finite elements."""
    return clamped_modes(computed_elements(leg, None, ELEMENTS), MODES).frequencies
