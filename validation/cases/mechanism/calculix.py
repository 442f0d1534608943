"""A whole mechanism with solid legs, unreduced by CalculiX, against its legs reduced."""

from typing import TypeAlias

from fem.bodies.solid import SolidLeg, solid_leg_matrices
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import calculix_program
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, modes, solved
from validation.adequacy.mechanism.path import known_legs, path_postures
from validation.case import Absolute, Measurement, Relative, Skip
from validation.case_group import CaseGroup
from validation.cases.program.calculix import PRINTED, against_printed
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled
from validation.models.mechanism import highest_frequency
from validation.solids.bars import bar_meshes, bar_solids, with_bars
from validation.studies.quantities import farthest_entry

MODES = 10
_GROUP = "mechanism.calculix"
# Modes of the bodies are kept up to four times the highest frequency of the mechanism: what is
# left out is below the printed digits.
_CUTOFF = 4.0
_CITATION = (
    "CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations, drives as springs; the "
    "same meshes, not reduced"
)

cases = CaseGroup(
    reference_kind="independent-solver",
    citation=_CITATION,
    presets=("standard", "fine"),
    model="solid",
    section=PATH,
    group=_GROUP,
    effort=4.0,
)


Answers: TypeAlias = tuple[Array, Array]


def by_both(at: Posture) -> tuple[Answers, Answers]:
    """Compliance (6×6, SI, base axes) and frequencies (Hz) by this program and by CalculiX."""
    return by_reduced(at), by_calculix(at)


def by_reduced(at: Posture) -> Answers:
    """The mechanism with legs as bars of their outer size, coarse meshes, reduced to their ends.

    Mass is summed over the points that CalculiX sums it over.
    """
    bars = with_bars(at)
    highest = highest_frequency([bars], MODES)
    solids = bar_solids(bars.mechanism)
    reduced = {solid.leg: _reduced(solid, highest) for solid in solids.values()}
    bodies = {name: reduced[solid.leg] for name, solid in solids.items()}
    solution = solved(assembly(bars.mechanism, bodies).at(bars))
    return compliance(solution), modes(solution, MODES).frequencies


def by_calculix(at: Posture) -> Answers:
    """The same on the same meshes by CalculiX, not reduced. Raises CalculixMissing without it."""
    calculix_program()
    bars = with_bars(at)
    return compliance_and_frequencies(bars, bar_meshes(bars.mechanism), MODES)


def _reduced(solid: SolidLeg, highest: float) -> BodyModel:
    held = held_leg(solid_leg_matrices(solid))
    return filled(craig_bampton(held, highest, _CUTOFF * highest).matrices)


def _found(context: Context) -> tuple[Answers, Answers]:
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
    quantity="entry of the 6×6 that differs most, in units of √(c_ii c_jj), first pose",
    headlines=("robot.statics.solid",),
    unit="1",
    tolerance=Absolute(1e-5),
    tolerance_reason="the same equations: the seven printed digits, with a margin",
    figure="mechanism.deflections",
)
def _statics(context: Context) -> Measurement:
    (own, _), (theirs, _) = _found(context)
    value, reference = farthest_entry(own, theirs)
    return Measurement(value, reference, reference_uncertainty=PRINTED)


@cases.case(
    "mechanism.calculix.frequencies",
    f"CalculiX gives the mechanism's first {MODES} frequencies, legs as solid bars",
    quantity="first natural frequency, the others beside it, first pose of the path",
    headlines=("robot.frequencies.solid",),
    unit="Hz",
    tolerance=Relative(1e-5),
    tolerance_reason="the printed digits, and what bodies reduced with modes up to four times the "
    "highest frequency leave",
    figure="mechanism.frequencies",
)
def _frequency(context: Context) -> Measurement:
    (_, own), (_, theirs) = _found(context)
    return against_printed({"reduced bodies": own}, theirs, "mode 1")
