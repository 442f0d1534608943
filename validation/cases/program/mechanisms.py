"""Mechanisms of the program: postures and stiffness in closed form, a whole one by CalculiX.

What a run of a mechanism holds against each other shares the closing of loops and the assembler;
here both stand beside geometry, beside bars on ball joints, and beside another program.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.mechanism import compliance_and_frequencies
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.caches import lru_cache
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Prism
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile, load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, modes, solved
from meshes.prism.tetrahedra import tetrahedra
from validation.agreement.differences import farthest_off, scaled_difference
from validation.case import Absolute, Case, Measurement
from validation.case_group import CaseGroup
from validation.cases.mechanism import motion as mechanism_motion
from validation.cases.mechanism import path as mechanism_path
from validation.cases.program.calculix import PRINTED, PRINTED_ROOT
from validation.context import Context
from validation.models.mechanism import answers
from validation.models.options import ModelName, ModelOptions

SECTION = "Mechanisms of the program"
_GROUP = "program.mechanisms"

# Mechanisms whose moves are tried: closed loops of rigid bodies, rods that spin.
_MOVED = ("3-rrr", "delta")
_MODELS: tuple[ModelName, ...] = ("beam", "links", "vjm")
_MODES = 8
# Frequencies (Hz) of the five-bar of square bars end below the first; modes are kept to the second.
_HIGHEST, _CUTOFF = 1400.0, 5600.0
_SIDE = 0.06
# Mass (kg) at the tool; beside it the bars' own, 44 kg, is half a thousandth.
_HEAVY = 1e5
_CUBIC = Material(E=2.1e11, G=0.6e11, nu=0.2, rho=7850.0)


def cases() -> tuple[Case, ...]:
    """Hexapod and five-bar in closed form, moves of others, the five-bar by CalculiX."""
    return (
        *_in_closed_form(),
        *(_moved(case, robot) for robot in _MOVED for case in mechanism_motion.cases(moving=True)),
        *(_moved(case, "five-bar") for case in mechanism_path.of_links()),
        *_by_others(),
    )


# Several cases are about one robot.
@lru_cache(maxsize=8)
def _built_in(name: str) -> RobotFile:
    return load_robot(name)


_in_closed_form = CaseGroup(
    quantity="largest relative difference",
    unit="1",
    reference_kind="closed-form",
    section=SECTION,
    group=_GROUP,
    effort=0.3,
)
_by_others = CaseGroup(
    quantity="largest relative difference",
    unit="1",
    reference_kind="independent-solver",
    section=SECTION,
    group=_GROUP,
    effort=3.0,
)


def _moved(case: Case, robot: str) -> Case:
    return replace(
        case,
        id=f"program.{case.id}[{robot}]",
        title=f"{case.title} ({robot})",
        compute=partial(_on, robot=robot, compute=case.compute),
        section=SECTION,
        group=_GROUP,
        subject="program",
        # Those that are drawn are of the run's robot.
        figure="",
    )


def _on(context: Context, robot: str, compute: Callable[[Context], Measurement]) -> Measurement:
    return compute(replace(context, robot_file=_built_in(robot)))


def _largest(found: Array, expected: Array) -> Measurement:
    return farthest_off(scaled_difference(found, expected))


def _hexapod(place: int = 0) -> tuple[Mechanism, Array, list[tuple[Array, Array]]]:
    """Mechanism, a pose, and the ends of each leg in it by the pose's own numbers."""
    mechanism = _built_in("hexapod").mechanism
    pose = mechanism.poses[place]
    centre = mechanism.reference_pose[:3]
    turn = Rotation.from_rotvec(pose[3:]).as_matrix()
    ends = [
        (base, pose[:3] + turn @ (platform - centre)) for base, platform in _leg_points(mechanism)
    ]
    return mechanism, pose, ends


def _leg_points(mechanism: Mechanism) -> list[tuple[Array, Array]]:
    points = [
        (mechanism.reference[f"strut{i}"].position, mechanism.reference[f"rod{i}"])
        for i in range(1, 7)
    ]
    tips = [mechanism.bodies[f"rod{i}"].interfaces[f"Q{i}"] for i in range(1, 7)]
    return [(base, (rod @ tip).position) for (base, rod), tip in zip(points, tips, strict=True)]


@_in_closed_form.case(
    "program.mechanism.hexapod.stiffness[{model}, pose {number}]",
    "A hexapod on bars between ball joints has the stiffness of its bars ({model})",
    over={"model": _MODELS, "number, place": (("1", 0), ("last", -1))},
    citation="K = Σ k j jᵀ, j = (d, p × d), 1/k = L₁/EA₁ + L₂/EA₂ + 1/k_drive",
    tolerance=Absolute(1e-8),
    tolerance_reason="exact whatever the legs' bending: rounding, grown by their slenderness",
    model="",
)
def _bars(_context: Context, model: ModelName, place: int) -> Measurement:
    mechanism, pose, ends = _hexapod(place)
    drives = {joint.name: joint.drive for joint in mechanism.joints if joint.drive}
    stiffness = np.zeros((6, 6))
    for number, (base, platform) in enumerate(ends, start=1):
        give = 0.0
        for body in (f"strut{number}", f"rod{number}"):
            shape = mechanism.bodies[body].shape
            if isinstance(shape, Prism):
                give += shape.length / (shape.material.E * shape.section.area)
        drive = drives[f"drive{number}"]
        give += 1.0 / (drive.stiffness or np.inf) if drive else 0.0
        along = (platform - base) / np.linalg.norm(platform - base)
        screw = np.concatenate([along, np.cross(platform - pose[:3], along)])
        stiffness += np.outer(screw, screw) / give
    at = posture(mechanism, pose)
    (found,) = answers(model, [at], 0, ModelOptions(elements=1))
    return _largest(found.compliance, np.asarray(np.linalg.inv(stiffness), dtype=float))


@_in_closed_form.case(
    "program.mechanism.delta.rods",
    "As many motions of a Delta idle as it has rods between ball joints",
    citation="a rod between two ball joints spins: one idle motion each",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number",
)
def _rods(_context: Context) -> Measurement:
    mechanism = _built_in("delta").mechanism
    balls = [
        {joint.first.body, joint.second.body}
        for joint in mechanism.joints
        if joint.kind == "spherical"
    ]
    rods = [name for name in legs_of(mechanism) if sum(name in pair for pair in balls) == 2]
    found = mobility(posture(mechanism, mechanism.poses[0])).idle
    return Measurement(float(found), float(len(rods)), exact=True)


@_in_closed_form.case(
    "program.mechanism.hexapod.drives",
    "Its drives are as long as the distances of its joints",
    citation="|Q − B| less that of the reference, from the numbers of the pose",
    tolerance=Absolute(1e-10),
    tolerance_reason="loops are closed to 1e-12 of the size",
)
def _lengths(_context: Context) -> Measurement:
    mechanism, pose, ends = _hexapod()
    at = posture(mechanism, pose)
    # The slides' axes lead from the strut's end back to the rod's start: against the leg.
    off = [
        at.coordinates[f"drive{number}"][0]
        + (np.linalg.norm(end - base) - np.linalg.norm(before - base))
        for number, ((base, end), (_, before)) in enumerate(
            zip(ends, _leg_points(mechanism), strict=True), start=1
        )
    ]
    return farthest_off(np.array(off) / mechanism.size)


@_in_closed_form.case(
    "program.mechanism.five-bar.drives",
    "The cranks of a five-bar stand where two circles meet",
    citation="law of cosines in the triangles of base pivot, elbow and tool",
    tolerance=Absolute(1e-6),
    tolerance_reason="the rods' lengths and the drives follow from points of twelve digits",
)
def _cranks(_context: Context) -> Measurement:
    mechanism = _built_in("five-bar").mechanism
    crank, rod = (legs_of(mechanism)[name].length for name in ("crank1", "rod1"))
    off = []
    for pose in mechanism.poses:
        at = posture(mechanism, pose)
        for number, side in ((1, 1.0), (2, -1.0)):
            pivot = mechanism.reference[f"crank{number}"].position[:2]
            angles = [
                np.arctan2(*(tool - pivot)[::-1])
                + side
                * np.arccos(
                    (crank**2 + (d := np.linalg.norm(tool - pivot)) ** 2 - rod**2)
                    / (2.0 * crank * d)
                )
                for tool in (pose, mechanism.reference_pose)
            ]
            off.append(at.coordinates[f"motor{number}"][0] - (angles[0] - angles[1]))
    return farthest_off(off)


@_by_others.case(
    "program.mechanism.calculix.{name}",
    "A five-bar of solid bars with a joint that gives way by CalculiX: {name}",
    over={"name": ("statics", "frequencies")},
    citation="CalculiX CrunchiX, G. Dhondt, the same tetrahedra, joints by *EQUATION",
    tolerance=Absolute(1e-6),
    tolerance_reason="seven printed digits, and a reduction cut off at four times the frequencies",
)
def _by_calculix(context: Context, name: str) -> Measurement:
    own, theirs = context.get(_five_bar_twice)
    if name == "statics":
        return replace(_largest(theirs[0], own[0]), exact=False, reference_uncertainty=PRINTED)
    off = float(np.abs(theirs[1] / own[1] - 1.0).max())
    return Measurement(off, 0.0, reference_uncertainty=PRINTED_ROOT)


def _five_bar_twice() -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Compliance (6×6) and frequencies (Hz), reduced and assembled here, and by CalculiX."""
    at = _five_bar_of_squares()
    solids, reduced = {}, {}
    legs = legs_of(at.mechanism).items()
    for name, leg in ((name, leg) for name, leg in legs if isinstance(leg, ConstantLeg)):
        solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
        solid = replace(solid, mass=mass_at_stiffness_points(solid.mesh, leg.material.rho))
        solids[name] = solid
        reduced[name] = craig_bampton(
            held_leg(solid_leg_matrices(solid)), _HIGHEST, _CUTOFF
        ).matrices
    theirs = compliance_and_frequencies(at, solids, _MODES)
    solution = solved(assemble(at, reduced))
    return (compliance(solution), modes(solution, _MODES).frequencies), theirs


@_by_others.case(
    "program.mechanism.calculix.heavy",
    "CalculiX's five-bar with a heavy mass at its tool swings on its own compliance",
    reference_kind="closed-form",
    citation="ω² = eigenvalues of C⁻¹/m, C the translations' compliance in the same run; the "
    "bars' mass, half a thousandth, is left out",
    tolerance=Absolute(3e-4),
    tolerance_reason="the bars' own mass, by half of it at most in frequency",
)
def _heavy(context: Context) -> Measurement:
    compliance_there, frequencies = context.get(_heavy_five_bar)
    springs = np.linalg.eigvalsh(compliance_there[:3, :3])[::-1]
    expected = 1.0 / (2.0 * np.pi * np.sqrt(_HEAVY * springs))
    off = float(np.abs(frequencies / expected - 1.0).max())
    return Measurement(off, 0.0, reference_uncertainty=PRINTED_ROOT)


def _heavy_five_bar() -> tuple[Array, Array]:
    """Compliance (6×6, SI) and the first three frequencies (Hz) by CalculiX."""
    at = _five_bar_of_squares()
    tool = replace(at.mechanism.tool, mass=_HEAVY)
    legs = legs_of(at.mechanism).items()
    solids = {
        name: solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
        for name, leg in legs
        if isinstance(leg, ConstantLeg)
    }
    return compliance_and_frequencies(
        replace(at, mechanism=replace(at.mechanism, tool=tool)), solids, 3
    )


def _five_bar_of_squares() -> Posture:
    """Solid square bars, so that coarse meshes are good ones; the first joint gives way.

    Of a cubic material, whose axes turn with the bars.
    """
    mechanism = _built_in("five-bar").mechanism
    root = np.random.default_rng(1).normal(size=(6, 6))
    first, *others = mechanism.joints
    soft = replace(first, compliance=1e-8 * (root @ root.T + np.eye(6)))
    bodies = {
        name: replace(
            body, shape=replace(body.shape, section=Rectangle(_SIDE, _SIDE), material=_CUBIC)
        )
        if isinstance(body.shape, Prism)
        else body
        for name, body in mechanism.bodies.items()
    }
    changed = replace(mechanism, bodies=bodies, joints=(soft, *others))
    return posture(changed, changed.poses[0])
