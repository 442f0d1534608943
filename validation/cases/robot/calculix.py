"""The robot with solid legs, elastic feet and tool, unreduced, against CalculiX."""

from dataclasses import dataclass, replace

import numpy as np

from fem.bodies.solid import SolidLeg, solid_leg
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.mechanism import compliance_and_frequencies
from fem.calculix.run import calculix_program
from lumped.arrays import Array
from lumped.biglide import Biglide, postures, with_equivalent_legs
from lumped.legs import equivalent_leg
from meshes.prism.tetrahedra import tetrahedra
from validation.case import Absolute, Measurement, Relative
from validation.case_group import CaseGroup
from validation.cases.program.calculix import PRINTED, against_printed
from validation.context import Context, Preset
from validation.exhibits import SOLID_ROBOT
from validation.solids.bars import mesh_of
from validation.solids.robots import solved_robot
from validation.solids.size import skip_too_large
from validation.studies.quantities import farthest_entry

MODES = 10
DIVISIONS: dict[Preset, int] = {"quick": 1, "standard": 1, "fine": 2}
PLACES = {"left": 0.0, "centre": 0.5}
_CITATION = (
    "CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations, feet and tool as full "
    "6×6 springs"
)

cases = CaseGroup(
    over={"place": lambda places: places},
    reference_kind="independent-solver",
    citation=_CITATION,
    presets=("standard", "fine"),
    model="solid",
    section=SOLID_ROBOT,
    group="robot.solid.calculix",
    effort=3.0,
)


@dataclass(frozen=True)
class Sparse:
    """The unreduced robot by sparse Cholesky: compliance (6×6, SI, robot axes), frequencies (Hz).

    `same_points` with the mass summed as CalculiX does, `exact` with the exact mass.
    """

    compliance: Array
    same_points: Array
    exact: Array


def by_sparse(robot: Biglide, x: float, divisions: int) -> Sparse:
    """The robot with B at `x` (m) on second-order tetrahedra by this project."""
    whole = with_equivalent_legs(robot)
    leg1, leg2 = (_tetrahedral(whole, number, divisions) for number in (1, 2))
    exact = solved_robot(whole, x, (leg1, leg2), MODES)
    same = solved_robot(whole, x, (_same_points(leg1), _same_points(leg2)), MODES)
    return Sparse(exact.compliance, same.modes.frequencies, exact.modes.frequencies)


def by_calculix(robot: Biglide, x: float, divisions: int) -> tuple[Array, Array]:
    """The same by CalculiX: compliance and frequencies; raises CalculixMissing without it."""
    calculix_program()
    whole = with_equivalent_legs(robot)
    both = {"leg1": whole.leg1, "leg2": whole.leg2}
    legs = {name: mesh_of(equivalent_leg(leg), divisions) for name, leg in both.items()}
    (at,) = postures(whole, (x,))
    return compliance_and_frequencies(at, legs, MODES)


def _tetrahedral(robot: Biglide, number: int, divisions: int) -> SolidLeg:
    leg = equivalent_leg(robot.leg1 if number == 1 else robot.leg2)
    return solid_leg(leg, tetrahedra(leg.section, leg.length, divisions))


def _same_points(solid: SolidLeg) -> SolidLeg:
    return replace(solid, mass=mass_at_stiffness_points(solid.mesh, solid.leg.material.rho))


def _found(context: Context, place: str) -> tuple[Sparse, Array, Array]:
    """The solution by sparse Cholesky, CalculiX's compliance and frequencies."""
    robot, divisions = context.robot, DIVISIONS[context.preset]
    skip_too_large((robot.leg1, robot.leg2), (divisions, divisions), context.preset)
    first, last = robot.stroke
    question = robot, first + PLACES[place] * (last - first), divisions
    theirs = context.get(by_calculix, *question)
    return context.get(by_sparse, *question), *theirs


@cases.case(
    "robot.solid.calculix.statics[{place}]",
    "CalculiX gives the robot's 6×6 compliance, {place} of the stroke",
    quantity="entry of the 6×6 that differs most, in units of √(c_ii c_jj)",
    headlines=("robot.statics.solid",),
    unit="1",
    tolerance=Absolute(1e-4),
    tolerance_reason="the same equations: the seven printed digits, with a margin",
)
def _statics(context: Context, place: str) -> Measurement:
    ours, theirs, _ = _found(context, place)
    value, reference = farthest_entry(ours.compliance, theirs)
    return Measurement(value, reference, reference_uncertainty=PRINTED)


@cases.case(
    "robot.solid.calculix.frequencies[{place}]",
    f"CalculiX gives the robot's first {MODES} frequencies, {{place}} of the stroke",
    quantity="first natural frequency, the others beside it",
    headlines=("robot.frequencies.solid",),
    unit="Hz",
    tolerance=Relative(1e-4),
    tolerance_reason="the same equations once the mass is summed over the same points: the seven "
    "printed digits, with a margin",
)
def _frequency(context: Context, place: str) -> Measurement:
    ours, _, theirs = _found(context, place)
    rule = 100.0 * np.abs(ours.same_points / ours.exact - 1.0).max()
    return against_printed(
        {"same mass points": ours.same_points, "exact mass": ours.exact},
        theirs,
        f"mode 1; CalculiX's mass of C3D10, summed over four points, changes frequencies by up to "
        f"{rule:.2g} %",
    )
