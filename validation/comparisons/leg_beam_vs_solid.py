"""Cases on one leg: VJM, links, segments and beam elements against the solid of the same leg.

Input: a leg of constant section with its root clamped. Output: a verdict for each model on six tip
motions and four frequencies. Rule: the difference between model and solid, less the allowances
below, must be within the tolerance of [agree]. The end condition of the solid is that of [agree],
otherwise `ends` of the leg, otherwise rigid faces.

Allowances are made for three named causes. Each is computed without the judged model:
- the restraint by rigid end faces, from fields that decay from the faces of a prism;
- section constants by formula, up to the error of a correct formula
  (`validation.comparisons.section_formulas`);
- distortion of the section in vibration, from waves of 3-D elasticity in a prism.
"""

from dataclasses import replace

import numpy as np

from fem.beams.beam_theory import CantileverFrequency, Kind
from lumped.acceptance.requirement import AgreementLimits
from lumped.arrays import Array
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg
from lumped.model_choices import Ends
from lumped.sections import Rectangle
from meshes.section.section_blocks import WALL_ASPECT
from validation.case import Allowance, Measurement, Skip
from validation.cases.leg_theory import (
    DISTORTION_SOURCE,
    STATICS,
    WAVE_DIVISIONS,
    beam_mode_count,
    compliances,
    computed_compliances,
    computed_frequencies,
    distortion,
    distortion_half_width,
    exact_modes,
    face_restraints,
    frequencies,
    frequencies_by_kind,
    why_no_beam,
)
from validation.comparisons.agreement_cases import (
    DISTORTION,
    HELD_FACES,
    agreement_group,
    compliance_cases,
    formula_allowance,
    frequency_cases,
    limited,
)
from validation.comparisons.section_formulas import leg_formula_band
from validation.context import Context
from validation.models.leg_models import constant_leg_of, leg_compliance, leg_frequencies
from validation.models.options import ModelName, ModelOptions
from validation.references.reference_legs import SECTION_DIVISIONS, most_unknowns
from validation.solids.leg_meshes import formal_order, has_meshes, mesh_pair, static_divisions
from validation.solids.prism_legs import has_waves, prism_frequency
from validation.solids.solid_legs import Refinement, doubled_tips
from validation.solids.solid_size import why_shapeless

HELD_SOURCE = (
    "solids with free and with held end faces, at most twice the effect of fields that decay from "
    "held faces (fem.couplings.end_effects) and the distortion that held faces prevent; without "
    "two axes of symmetry at most the effect in modes of the section (fem.couplings.section_modes)"
)
# First table: entry of the tip compliance that belongs to the deformation of a kind of mode. Second
# table: exponent k. For order n the share of strain energy at the ends is up to (2n − 1)ᵏ times
# that for order 1, since waves become shorter.
_STRAINED = {"tension": (0, 0), "torsion": (3, 3), "bending y": (2, 2), "bending z": (1, 1)}
_GROWTH = {"tension": 1, "torsion": 1, "bending y": 2, "bending z": 2}
# Static models use the equivalent prism of a 6×6, as the solid does.
_OPTIONS = ModelOptions(legs="equivalent")

# Largest ratio of a prism's frequency to that of its beam without warping. The tolerance is
# relative to the former, the error of a beam to the latter: E too large by 5 % must exceed 1 %.
_LARGEST_RATIO = 1.8
_FREE_AND_RIGID: tuple[Ends, Ends] = ("free", "rigid")
# Fraction of the length over which a strip bends as a plate near its ends.
_SHORT = 0.1
# Index of torsion in the tip compliance.
_TORSION = 3

cases = agreement_group(over={"body": lambda legs: legs}, subject="leg", effort=0.05)
_CITATION = "the same leg meshed with quadratic hexahedra"


@compliance_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="displacement of the tip, {motion}, under a unit load, root clamped",
    citation=_CITATION,
    group="{body}.solid",
)
def _motion(
    context: Context, body: str, model: ModelName, entry: int, limits: AgreementLimits
) -> Measurement:
    leg = constant_leg_of(context, body)
    ends = limits.ends_of(leg.ends)
    smaller, larger = sorted(leg.section.extent)
    if entry == _TORSION and isinstance(leg.section, Rectangle) and larger > WALL_ASPECT * smaller:
        raise Skip(
            "thin strip: the section mesh is too coarse at the short sides, whose share of the "
            "torsion constant is 0.6 times thickness over width"
        )
    solid, sections = _solid_statics(context, body, ends)
    computed = context.get(computed_compliances, leg, sections)
    restraint = context.get(face_restraints, leg, sections) if ends == "rigid" else 0.0 * computed
    residuals = Refinement(
        solid.divisions, computed + restraint - solid.values, formal_order(leg, ends)
    )
    diagonal = entry, entry
    theory = tip_compliance(leg.timoshenko, leg.length)[diagonal]
    # The number of slices along the leg does not affect section constants, so their uncertainty
    # needs two section meshes.
    meshes = sections if sections[0] != sections[-1] else (sections[-1], SECTION_DIVISIONS)
    by_section = context.get(computed_compliances, leg, meshes)
    section_refinement = Refinement(meshes, by_section, formal_order(leg, "free"))
    stiff, soft = (bound[diagonal] for bound in context.get(compliance_band, leg, sections[-1]))
    half_width = section_refinement.uncertainty(*diagonal)
    return Measurement(
        float(leg_compliance(model, leg, _options(limits))[diagonal]),
        float(solid.values[-1][diagonal]),
        reference_uncertainty=solid.uncertainty(*diagonal),
        judged_uncertainty=residuals.uncertainty(*diagonal),
        allowances=(
            Allowance(HELD_FACES, -float(restraint[-1][diagonal]), "fem.couplings.end_effects"),
            formula_allowance(theory, computed[-1][diagonal], (stiff, soft), half_width),
        ),
    )


@frequency_cases(
    cases,
    "{body}",
    "{body}",
    "that of the solid leg",
    quantity="natural frequency {mode}, clamped-free, paired by shape",
    citation=_CITATION,
    group="{body}.modes",
)
def _frequency(
    context: Context, body: str, model: ModelName, index: int, limits: AgreementLimits
) -> Measurement:
    leg = constant_leg_of(context, body)
    count = beam_mode_count(context, leg)
    modes = exact_modes(leg)
    if reason := context.get(why_no_beam, leg, modes[index]):
        raise Skip(f"{modes[index].kind} mode {modes[index].order}: {reason}")
    ends = limits.ends_of(leg.ends)
    if reason := context.get(why_too_different, leg, ends, modes[index]):
        raise Skip(f"{modes[index].kind} mode {modes[index].order}: {reason}")
    specified_ends = frequencies(context, body, ends, count)
    free_ends = frequencies(context, body, "free", count)
    divisions = free_ends.frequencies.divisions
    kinds = tuple((mode.kind, mode.order) for mode in modes)
    beam_frequencies = context.get(computed_frequencies, leg, divisions, kinds)[:, index]
    change = beam_frequencies * context.get(distortion, leg, divisions, modes[index])
    free_frequencies = free_ends.frequencies.values[:, index]
    residuals = Refinement(divisions, beam_frequencies + change - free_frequencies)
    reference = float(specified_ends.frequencies.values[-1, index])
    value = float(leg_frequencies(model, leg, index + 1, _options(limits))[index])
    band = context.get(frequency_band, leg, divisions[-1], kinds)[:, index]
    half_width = Refinement(divisions, beam_frequencies).uncertainty()
    raised = context.get(most_raised, leg, divisions[-1], modes[index]) * reference
    # Held faces cannot distort. At most they remove the distortion that lowers the frequency.
    prevented = max(0.0, -float(change[-1]))
    faces = limited(
        float(free_frequencies[-1]) - reference,
        (-raised - prevented, 0.0),
        specified_ends.frequencies.uncertainty(index) + free_ends.frequencies.uncertainty(index),
    )
    return Measurement(
        value,
        reference,
        reference_uncertainty=specified_ends.frequencies.uncertainty(index),
        judged_uncertainty=residuals.uncertainty()
        + reference * context.get(distortion_half_width, leg, modes[index]),
        allowances=(
            Allowance(HELD_FACES, faces, HELD_SOURCE),
            Allowance(DISTORTION, -float(change[-1]), DISTORTION_SOURCE),
            formula_allowance(modes[index].frequency, beam_frequencies[-1], band, half_width),
        ),
    )


def _solid_statics(context: Context, body: str, ends: Ends) -> tuple[Refinement, tuple[int, ...]]:
    """Tip compliances of the solid leg on several meshes, and the section divisions of each mesh.

    The meshes are those that the preset allows for the doubling method (`fem.bodies.doubling`). If
    there are fewer than two, the two meshes of the robot's solids are used; the two may have the
    same section mesh and different numbers of slices along the leg. Raises Skip if the preset
    allows none of these meshes.
    """
    leg = constant_leg_of(context, body)
    if shapeless := why_shapeless([leg]):
        raise Skip(shapeless)
    largest_unknowns = most_unknowns(context.meshes, leg)
    if context.get(static_divisions, leg, STATICS[context.preset]) or not has_meshes(
        leg, largest_unknowns
    ):
        solid = compliances(context, body, ends)
        return solid, solid.divisions
    pair = mesh_pair(leg, largest_unknowns)
    along = tuple(slices for _, slices in pair)
    tips = [context.get(doubled_tips, leg, *mesh) for mesh in pair]

    def on_both(kind: Ends) -> Array:
        return np.array([tip[kind] for tip in tips])

    solid = Refinement(along, on_both("free"), formal_order(leg, "free"))
    if ends == "rigid":
        solid = Refinement(along, on_both("rigid"), formal_order(leg, "rigid"), solid)
    return solid, tuple(divisions for divisions, _ in pair)


def is_strip(leg: ConstantLeg) -> bool:
    """True if the section of a leg is a flat strip, so that the leg bends like a plate.

    Its larger side exceeds `WALL_ASPECT` times its smaller side and a tenth of the leg's length.
    """
    smaller, larger = sorted(leg.section.extent)
    return larger > max(WALL_ASPECT * smaller, _SHORT * leg.length)


def why_too_different(leg: ConstantLeg, ends: Ends, mode: CantileverFrequency) -> str:
    """Reason why errors of a beam cannot be seen beside the warping of its section; "" if none."""
    if has_waves(leg):
        return ""
    ratio = prism_frequency(leg, WAVE_DIVISIONS, ends, mode) / mode.frequency
    if ratio <= _LARGEST_RATIO:
        return ""
    return (
        f"warping and end faces raise the frequency to {ratio:.2g} times that of a beam without "
        "warping; errors of the beam are not visible beside this"
    )


def most_raised(leg: ConstantLeg, divisions: int, mode: CantileverFrequency) -> float:
    """Bound of the relative increase of the frequency of a `mode` by rigid end faces.

    `divisions` are the elements across the section.
    """
    if has_waves(leg):
        share = rigid_end_share(leg, divisions, mode.kind)
        return share * float(2 * mode.order - 1) ** _GROWTH[mode.kind]
    free, rigid = (prism_frequency(leg, divisions, ends, mode) for ends in _FREE_AND_RIGID)
    return 1.0 - free / rigid


def rigid_end_share(leg: ConstantLeg, divisions: int, kind: str) -> float:
    """Relative increase of a leg's stiffness due to rigid end faces, under a load at its tip.

    A first frequency rises by about half of this ratio (Rayleigh). `kind` is the deformation, such
    as "torsion". `divisions` are the elements across the section.
    """
    entry = _STRAINED[kind]
    restraint = face_restraints(leg, (divisions,))[0][entry]
    return float(-restraint / (computed_compliances(leg, (divisions,))[0][entry] + restraint))


def compliance_band(leg: ConstantLeg, divisions: int) -> tuple[Array, Array]:
    """Tip compliances (6×6, SI) of the stiffest and softest beam by correct textbook formulas.

    `divisions` are the elements across the section for the exact section constants.
    """
    soft, stiff = leg_formula_band(leg, divisions)
    return tip_compliance(stiff, leg.length), tip_compliance(soft, leg.length)


def frequency_band(leg: ConstantLeg, divisions: int, kinds: tuple[tuple[Kind, int], ...]) -> Array:
    """Bounds (2×k, Hz) of the frequencies of k modes, by the softest and by the stiffest beam.

    Both beams have section constants by correct textbook formulas. `kinds` has the kind of
    deformation and the order of each mode. `divisions` are the elements across the section for the
    exact section constants.
    """
    return frequencies_by_kind(leg_formula_band(leg, divisions), leg.length, kinds)


def _options(limits: AgreementLimits) -> ModelOptions:
    return replace(_OPTIONS, elements=limits.elements)
