"""The robot with solid legs and rigid feet, unreduced, against CalculiX."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.bodies.solid import SolidLeg, solid_leg
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.robot import compliance_and_frequencies
from fem.calculix.run import CalculixMissing, calculix_program
from lumped.arrays import Array
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.legs import equivalent_leg
from meshes.prism.tetrahedra import tetrahedra
from validation.case import Absolute, Case, Measurement, Relative, Skip
from validation.cases.calculix import PRINTED, PRINTED_ROOT
from validation.cases.robot_solid import SECTION
from validation.context import Context, Preset
from validation.robot_solids import solved_robot

MODES = 10
DIVISIONS: dict[Preset, int] = {"quick": 1, "standard": 1, "fine": 2}
PLACES = {"left": 0.0, "centre": 0.5}
_CITATION = "CalculiX CrunchiX, C3D10, joints and rigid faces as linear equations"


def cases() -> tuple[Case, ...]:
    """Statics and frequencies at two postures, rigid feet."""
    return tuple(case for place in PLACES for case in _posture(place))


def _posture(place: str) -> tuple[Case, Case]:
    return (
        Case(
            id=f"robot.solid.calculix.statics[{place}]",
            title=f"CalculiX gives the robot's 6×6 compliance, rigid feet, {place} of the stroke",
            quantity="largest difference in units of √(c_ii c_jj)",
            unit="1",
            reference_kind="independent-solver",
            citation=_CITATION,
            tolerance=Absolute(1e-4),
            tolerance_reason="the same equations: the seven printed digits, with a margin",
            compute=partial(_statics, place=place),
            presets=("standard", "fine"),
            model="solid",
            section=SECTION,
            group="robot.solid.calculix",
            effort=3.0,
        ),
        Case(
            id=f"robot.solid.calculix.frequencies[{place}]",
            title=f"CalculiX gives the robot's first {MODES} frequencies, rigid feet, {place} of "
            "the stroke",
            quantity="natural frequency of the largest difference",
            unit="Hz",
            reference_kind="independent-solver",
            citation=_CITATION,
            tolerance=Relative(1e-4),
            tolerance_reason="the same equations once the mass is summed over the same points: "
            "the seven printed digits, with a margin",
            compute=partial(_frequency, place=place),
            presets=("standard", "fine"),
            model="solid",
            section=SECTION,
            group="robot.solid.calculix",
            effort=3.0,
        ),
    )


@dataclass(frozen=True)
class Posture:
    """One posture by CalculiX and by this project.

    `statics`: largest difference of the compliances in units of √(c_ii c_jj). Frequencies (Hz):
    `calculix`, `same_points` with the mass summed as CalculiX does, `exact` with the exact mass.
    """

    statics: float
    calculix: Array
    same_points: Array
    exact: Array


def posture(robot: Biglide, x: float, divisions: int) -> Posture:
    """Both programs with B at `x` (m) on second-order tetrahedra; feet and tool held rigid.

    Raises CalculixMissing where CalculiX is not installed.
    """
    calculix_program()
    rigid = replace(with_equivalent_legs(robot), foot_compliance=None, tool_compliance=None)
    leg1, leg2 = (_tetrahedral(rigid, number, divisions) for number in (1, 2))
    legs = leg1, leg2
    compliance, frequencies = compliance_and_frequencies(rigid, x, legs, MODES)
    exact = solved_robot(rigid, x, legs, MODES)
    same = solved_robot(rigid, x, (_same_points(leg1), _same_points(leg2)), MODES)
    scale = np.sqrt(np.diag(exact.compliance))
    return Posture(
        statics=float(np.abs((compliance - exact.compliance) / np.outer(scale, scale)).max()),
        calculix=frequencies,
        same_points=same.modes.frequencies,
        exact=exact.modes.frequencies,
    )


def _tetrahedral(robot: Biglide, number: int, divisions: int) -> SolidLeg:
    leg = equivalent_leg(robot.leg1 if number == 1 else robot.leg2)
    return solid_leg(leg, tetrahedra(leg.section, leg.length, divisions))


def _same_points(solid: SolidLeg) -> SolidLeg:
    return replace(solid, mass=mass_at_stiffness_points(solid.mesh, solid.leg.material.rho))


def _found(context: Context, place: str) -> Posture:
    first, last = context.robot.stroke
    x = first + PLACES[place] * (last - first)
    try:
        return context.get(posture, context.robot, x, DIVISIONS[context.preset])
    except CalculixMissing as missing:
        raise Skip(str(missing)) from None


def _statics(context: Context, place: str) -> Measurement:
    return Measurement(_found(context, place).statics, 0.0, reference_uncertainty=PRINTED)


def _frequency(context: Context, place: str) -> Measurement:
    found = _found(context, place)
    worst = int(np.argmax(np.abs(found.same_points / found.calculix - 1.0)))
    rule = 100.0 * np.abs(found.same_points / found.exact - 1.0).max()
    return Measurement(
        float(found.same_points[worst]),
        float(found.calculix[worst]),
        reference_uncertainty=PRINTED_ROOT * float(found.calculix[worst]),
        notes=(
            f"mode {worst + 1}; CalculiX's mass of C3D10, summed over four points, changes "
            f"frequencies by up to {rule:.2g} %",
        ),
        table={
            "mode": tuple(float(k) for k in range(1, MODES + 1)),
            "CalculiX (Hz)": tuple(found.calculix.tolist()),
            "same mass points (Hz)": tuple(found.same_points.tolist()),
            "exact mass (Hz)": tuple(found.exact.tolist()),
        },
    )
