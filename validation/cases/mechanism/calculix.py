"""A whole robot with solid legs, unreduced by CalculiX.

Its legs are bars of their outer size on coarse meshes, here reduced to their ends.
"""

from fem.bodies.solid import solid_leg_matrices
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import calculix_program
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.adequacy.mechanism.path import known_legs, path_postures
from validation.case import Absolute, Measurement, Relative, Sides, Skip
from validation.case_group import CaseGroup
from validation.cases.mechanism.quantities import ASSEMBLER, by_another_program, farthest_entry
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled
from validation.models.mechanism import highest_frequency
from validation.solids.bars import bar_solids, with_bars

MODES = 10
# Relative rounding of seven printed digits; frequencies are roots of the printed eigenvalues.
_PRINTED, _PRINTED_ROOT = 5e-7, 2.5e-7
# Modes of the bodies are kept up to four times the highest frequency of the mechanism: what is
# left out is below the printed digits.
_CUTOFF = 4.0
_CALCULIX = "CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations"
_ENTRY = "entry of the 6×6 that differs most, in units of √(c_ii c_jj)"
_FIRST = "first natural frequency, the others beside it"
_SAME = "the same equations: ten times what seven printed digits leave"

cases = CaseGroup(
    reference_kind="independent-solver",
    citation=f"{_CALCULIX}, drives as springs; the same meshes, not reduced",
    presets=("standard", "fine"),
    model="solid",
    section=PATH,
    group="mechanism.calculix",
    effort=4.0,
    sides=Sides(
        (solid_leg_matrices, craig_bampton, *ASSEMBLER),
        (compliance_and_frequencies,),
    ),
)


def by_reduced(at: Posture) -> tuple[Array, Array]:
    """Compliance (6×6, SI, base axes) at the loaded point, and first frequencies (Hz).

    Of a mechanism with legs as bars of their outer size, coarse meshes, reduced to their ends; mass
    is summed over the points that CalculiX sums it over.
    """
    bars = with_bars(at)
    highest = highest_frequency([bars], MODES)
    solids = bar_solids(bars.mechanism)
    cutoff = _CUTOFF * highest
    reduced = {
        leg: filled(craig_bampton(held_leg(solid_leg_matrices(solid)), highest, cutoff).matrices)
        for leg, solid in {solid.leg: solid for solid in solids.values()}.items()
    }
    bodies = {name: reduced[solid.leg] for name, solid in solids.items()}
    solution = solved(assembly(bars.mechanism, bodies).at(bars))
    return compliance(solution), modes(solution, MODES).frequencies


def by_calculix(at: Posture) -> tuple[Array, Array]:
    """The same of a mechanism of bars on the same meshes, not reduced."""
    calculix_program()
    bars = with_bars(at)
    return compliance_and_frequencies(bars, bar_solids(bars.mechanism), MODES)


def _found(context: Context) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """By this program and by CalculiX, which is asked first: it may not be there."""
    at = path_postures(context)[0]
    legs = known_legs(at.mechanism).values()
    if parts := at.mechanism.parts:
        raise Skip(f"{', '.join(parts)}: CalculiX solves mechanisms of prisms and rigid bodies")
    if not legs or not all(isinstance(leg, ConstantLeg) for leg in legs):
        raise Skip("legs known by a 6×6 have no section that could be meshed")
    theirs = context.get(by_calculix, at)
    return context.get(by_reduced, at), theirs


@cases.case(
    "mechanism.calculix.statics",
    "CalculiX gives the mechanism's 6×6 compliance, legs as solid bars",
    quantity=f"{_ENTRY}, first pose",
    unit="1",
    tolerance=Absolute(5e-6),
    tolerance_reason=_SAME,
    figure="mechanism.deflections",
)
def _statics(context: Context) -> Measurement:
    (own, _), (theirs, _) = _found(context)
    value, reference, _ = farthest_entry(own, theirs)
    return Measurement(value, reference, reference_uncertainty=_PRINTED)


@cases.case(
    "mechanism.calculix.frequencies",
    f"CalculiX gives the mechanism's first {MODES} frequencies, legs as solid bars",
    quantity=f"{_FIRST}, first pose of the path",
    unit="Hz",
    tolerance=Relative(5e-6),
    tolerance_reason="the printed digits, and what bodies reduced with modes up to four times the "
    "highest frequency leave: 3e-7 and less of built-in robots",
    figure="mechanism.frequencies",
)
def _frequency(context: Context) -> Measurement:
    (_, own), (_, theirs) = _found(context)
    headings = "CalculiX (Hz)", "reduced bodies (Hz)"
    return by_another_program(own, theirs, _PRINTED_ROOT * theirs, headings)
