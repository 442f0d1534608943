"""Guards of single legs and of the simplified model, against what the robot file says."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np

from fem.beams.beam_theory import (
    Plane,
    bending_frequencies,
    tension_frequencies,
    torsion_frequencies,
)
from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.dense.modes import dense
from lumped.legs import ConstantLeg, GivenLeg, Leg, Theory
from lumped.models import vjm
from validation.agreement.differences import farthest_off, farthest_refined
from validation.case import Absolute, Measurement
from validation.case_group import CaseGroup
from validation.cases.program.guards.robot import ELEMENTS, SECTION, guarded_posture
from validation.context import Context
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.legs import constant_leg_of, kind_frequencies, leg_matrices
from validation.models.options import BEAM_ORDER, ModelName, ModelOptions

_ROOTS = 3
_BARS = {"tension": tension_frequencies, "torsion": torsion_frequencies}

cases = CaseGroup(section=SECTION, group="guard.legs", unit="1", reference_kind="closed-form")
_STIFF = "virtual joints with legs a million times stiffer than the drives, feet along y"


def drive_compliance_by_joints(robot: Biglide) -> Array:
    """2×2 compliance (m/N) at B by virtual joints: drives yield, all else a millionth of that."""
    drive = 1.0 / robot.actuator_stiffness
    stiff = 1e-6 * drive * np.diag([1.0, 1.0, 1.0, *[1.0 / robot.a**2] * 3])
    foot = stiff.copy()
    foot[1, 1] = drive
    plain = replace(robot, foot_compliance=foot, tool_compliance=None, tool_offset=np.zeros(3))
    return vjm.compliance(plain, guarded_posture(robot), (stiff, stiff))[:2, :2]


@cases.case(
    "guard.simplified.compliance",
    "The simplified model is the robot whose feet yield along y alone",
    quantity="largest difference of the 2×2 in units of its largest entry",
    reference_kind="independent-solver",
    citation=_STIFF,
    tolerance=Absolute(1e-4),
    tolerance_reason="the legs' own compliance, a millionth, by the square of lever arms",
    model="simplified",
    group="guard.simplified",
)
def _simplified_compliance(context: Context) -> Measurement:
    robot = context.robot
    reference = context.get(drive_compliance_by_joints, robot)
    found = robot_compliance("simplified", robot, guarded_posture(robot))
    return farthest_off((found - reference) / np.abs(reference).max())


@cases.case(
    "guard.simplified.frequency",
    "The simplified frequencies are those of the mass on that compliance",
    quantity="largest relative difference of both frequencies",
    citation=f"ω² = 1/(m c) for both principal compliances c; {_STIFF}",
    tolerance=Absolute(1e-4),
    tolerance_reason="as for the compliance",
    model="simplified",
    group="guard.simplified",
)
def _simplified_frequencies(context: Context) -> Measurement:
    robot = context.robot
    principal = np.linalg.eigvalsh(context.get(drive_compliance_by_joints, robot))
    reference = 1.0 / (2.0 * pi * np.sqrt(robot.platform_mass * principal[::-1]))
    found = robot_frequencies("simplified", robot, guarded_posture(robot), 2)
    return farthest_off(found / reference - 1.0)


@cases.case(
    "guard.simplified.mirrored",
    "Half way between slides with legs alike, the mass swings on two springs side by side",
    quantity="largest relative difference of both frequencies",
    citation="ẏ₁,₂ = ẏ ± ẋ a/2s: 2K along y and 2K (a/2s)² along x, s² = L² − (a/2)²",
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding",
    model="simplified",
    group="guard.simplified",
)
def _mirrored(context: Context) -> Measurement:
    # Two of the shorter one need not meet.
    longer = max(context.robot.leg1, context.robot.leg2, key=lambda leg: leg.length)
    robot = replace(context.robot, leg1=longer, leg2=longer)
    half = robot.a / 2.0
    slope = half / sqrt((longer.length - half) * (longer.length + half))
    upright = sqrt(2.0 * robot.actuator_stiffness / robot.platform_mass) / (2.0 * pi)
    found = robot_frequencies("simplified", robot, half, 2)
    return farthest_off(found / np.sort([upright, upright * slope]) - 1.0)


@cases.case(
    "guard.leg{number}.mass[{model}]",
    "Leg {number} by {model} weighs what the robot file says, about its middle",
    over={"number": (1, 2), "model": ("segments", "beam")},
    quantity="largest difference of mass, m L/2 and m L²/3 + ρI L in units of m, m L, m L²",
    citation="kinetic energy of a prism in its rigid motions, from mass, length, section",
    tolerance=Absolute(1e-9),
    tolerance_reason="consistent masses and rigid elements carry rigid motions exactly",
    model="",
)
def _mass(context: Context, number: int, model: ModelName) -> Measurement:
    robot = context.robot
    given: Leg = robot.leg1 if number == 1 else robot.leg2
    leg = constant_leg_of(context, f"leg{number}")
    matrices = leg_matrices(model, leg, ModelOptions(elements=ELEMENTS))
    length = given.length
    mass = given.mass
    rigid = _rigid_motions(dense(matrices.stiffness), length)
    found = rigid.T @ dense(matrices.mass) @ rigid
    # The equivalent leg of a given matrix is a solid rectangle.
    gyration = (
        leg.section.extent[1] ** 2 / 12.0
        if isinstance(given, GivenLeg)
        else given.section.second_moment_y / given.section.area
    )
    wanted = {
        (0, 0): mass,
        (2, 4): -mass * length / 2.0,
        (1, 5): mass * length / 2.0,
        (4, 4): mass * (length**2 / 3.0 + gyration),
    }
    return farthest_off(
        [
            (found[i, j] - value) / (mass * length ** ((i > 2) + (j > 2)))
            for (i, j), value in wanted.items()
        ]
    )


@cases.case(
    "guard.leg{number}.consistent-mass",
    "One slender beam element of leg {number} has the consistent mass of its cubic in both planes",
    over={"number": (1, 2)},
    quantity="largest difference of m/420 (156, 22 L, 54, −13 L, 4 L², −3 L²) in units of m, m L …",
    reference_kind="published",
    citation="Archer, J. Struct. Div. ASCE 89 (1963) 161; Przemieniecki 1968, ch. 11",
    tolerance=Absolute(1e-12),
    tolerance_reason="products of cubics, integrated exactly: rounding",
    model="beam",
)
def _consistent(context: Context, number: int) -> Measurement:
    leg = constant_leg_of(context, f"leg{number}")
    options = ModelOptions(elements=1, theory="euler-bernoulli")
    mass = dense(leg_matrices("beam", leg, options).mass) / leg.mass
    published = np.array(
        [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
    )
    off = []
    # Deflection and rotation at root and tip; a leg that goes up along z turns against y.
    for places, turned in (((1, 5, 7, 11), 1.0), ((2, 4, 8, 10), -1.0)):
        unit = np.array([1.0, turned / leg.length] * 2)
        found = mass[np.ix_(places, places)] * np.outer(unit, unit)
        off.append(found - published / 420.0)
    return farthest_off(np.ravel(off))


def _rigid_motions(stiffness: Array, length: float) -> Array:
    """Unknowns (n×6) of a free leg that moves rigidly with the twist of its root.

    The ends are prescribed, the inside follows without load.
    """
    motions = np.zeros((len(stiffness), 6))
    motions[:6] = np.eye(6)
    motions[6:12] = np.eye(6)
    motions[7, 5], motions[8, 4] = length, -length
    motions[12:] = -np.linalg.solve(stiffness[12:, 12:], stiffness[12:, :12] @ motions[:12])
    return motions


@cases.case(
    "guard.leg{number}.equivalent",
    "The equivalent leg {number} has the first four stiffnesses of the given one",
    over={"number": (1, 2)},
    quantity="largest relative difference of K11, K22, K33, K44 with the root clamped",
    citation="paper §2.3: the same first four diagonal terms of the stiffness matrix; one "
    "Euler–Bernoulli element",
    tolerance=Absolute(1e-9),
    tolerance_reason="rounding",
)
def _equivalent(context: Context, number: int) -> Measurement:
    robot = context.robot
    given: Leg = robot.leg1 if number == 1 else robot.leg2
    leg = constant_leg_of(context, f"leg{number}")
    if isinstance(given, GivenLeg):
        wanted = np.diag(np.linalg.inv(given.compliance))[:4]
    else:
        E, G, s, l = given.material.E, given.material.G, given.section, given.length
        bending = 12.0 * E / l**3
        wanted = np.array(
            [
                E * s.area / l,
                bending * s.second_moment_z,
                bending * s.second_moment_y,
                G * s.torsion_constant / l,
            ]
        )
    options = ModelOptions(elements=1, theory="euler-bernoulli")
    matrices = leg_matrices("beam", leg, options)
    stiffness = dense(matrices.stiffness)
    condensed = stiffness[6:12, 6:12] - stiffness[6:12, 12:] @ np.linalg.solve(
        stiffness[12:, 12:], stiffness[12:, 6:12]
    )
    return farthest_off(np.diag(condensed)[:4] / wanted - 1.0)


@cases.case(
    "guard.leg{number}.euler-bernoulli[{plane}]",
    "Leg {number} without shear: bending {plane} of Hermite beams is the closed form's",
    over={"number": (1, 2), "plane": ("y", "z")},
    quantity=f"largest relative difference of the first {_ROOTS} frequencies",
    citation="(βL)² √(EI/μ)/L² with the roots of cos βL cosh βL = −1",
    tolerance=Absolute(1e-4),
    tolerance_reason="fourth order in 1/n: 2e-5 for the third frequency with 20 elements",
)
def _slender(context: Context, number: int, plane: Plane) -> Measurement:
    leg = constant_leg_of(context, f"leg{number}")
    exact = bending_frequencies(leg.properties("euler-bernoulli"), leg.length, plane, _ROOTS)
    return _by_beams(leg, f"bending {plane}", exact, "euler-bernoulli")


def _by_beams(leg: ConstantLeg, kind: str, exact: Array, theory: Theory) -> Measurement:
    coarse, fine = (
        kind_frequencies(leg, "beam", kind, _ROOTS, ModelOptions(theory=theory, elements=elements))
        for elements in (10, 20)
    )
    return farthest_refined(coarse / exact - 1.0, fine / exact - 1.0, order=BEAM_ORDER)


@cases.case(
    "guard.leg{number}.quarter-waves[{kind}]",
    "Leg {number} in {kind}: quarter waves of beam elements are the closed form's",
    over={"number": (1, 2), "kind": tuple(_BARS)},
    quantity=f"largest relative difference of the first {_ROOTS} frequencies",
    citation="(2i − 1)/4L times the speed of a wave in a bar, clamped-free",
    tolerance=Absolute(1e-4),
    tolerance_reason="fourth order in 1/n: 2e-5 for the third frequency with 20 elements",
)
def _bars(context: Context, number: int, kind: str) -> Measurement:
    leg = constant_leg_of(context, f"leg{number}")
    exact = _BARS[kind](leg.timoshenko, leg.length, _ROOTS)
    return _by_beams(leg, kind, exact, "timoshenko")
