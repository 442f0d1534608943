"""Ritz's method, EXUDYN and CalculiX, compared with closed forms and with the models."""

import shutil
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh, solve
from support.oracles.compliance_difference import scaled_difference
from support.oracles.shifted_references import assert_agrees_and_can_disagree
from support.robots.hook import HOOK_LEG, HOOK_POINTS
from support.robots.paper_legs import STEEL
from support.robots.robot_from_text import described, robot_of
from support.robots.single_arm import ONE_ARM

from fem import multibody
from fem.calculix import run as calculix_run
from fem.calculix.leg import with_bars
from lumped.beam_properties import tip_compliance
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Frame
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle, Tube
from lumped.system.response import damped_modes
from validation.case import Skip
from validation.cases import other_solvers, ritz
from validation.cases.other_solvers import beams_and_exudyn, farthest_entry
from validation.cases.polynomials import farthest_posture
from validation.cases.ritz_legs import ritz_beam
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.models.options import ModelOptions
from validation.models.robot_models import answers, mechanism_modes
from validation.run.outcome import judge
from validation.selftest.benchmarks import hexapod_stiffness

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
ROCKER, TAPERED_ARM = (EXAMPLES / name / "robot.toml" for name in ("rocker", "tapered-arm"))
# Beside the stiffness along such a leg rounding took 2e-4 of its torsion, 3e-5 without shear.
FOIL = ConstantLeg(90.0, Tube(2e-4, 1e-6), Material(2.1e11, 1.05e9, -0.9, 7850.0))


def first_pose(name):
    described = load_robot(name).mechanism
    return postures_of(described, described.poses[:1])[0]


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("prism", [ConstantLeg(0.85, Rectangle(0.1, 0.16), STEEL), FOIL])
def test_ritz_leg_equals_textbook(prism, theory):
    """Tip compliance of a stout bar and of a foil, with and without shear."""
    beam = prism.properties(theory)
    stiffness_and_mass = ritz_beam(beam, prism.length, ritz.STATIC_DEGREE)
    free = ritz.free_basis(stiffness_and_mass.stiffness, stiffness_and_mass.root)
    loaded = stiffness_and_mass.tip @ free
    compliance = loaded @ solve(
        free.T @ stiffness_and_mass.stiffness @ free, loaded.T, assume_a="pos"
    )
    assert scaled_difference(compliance, tip_compliance(beam, prism.length)) < 3e-6


def test_ritz_hexapod_has_stiffness_of_bars():
    """K = Σ k j jᵀ over the six legs, with k = 1/(L/EA + 1/k_drive)."""
    posture = first_pose("hexapod")
    stiffness = hexapod_stiffness(posture.mechanism, posture.pose)
    np.testing.assert_allclose(ritz.compliance(posture) @ stiffness, np.eye(6), atol=1e-8)


@pytest.mark.parametrize("softer", [1e-12, 1e6])
def test_ritz_frequencies_scale_with_stiffness(softer):
    """A factor `softer` on all stiffnesses changes frequencies by its root, despite idle spins."""
    posture = first_pose("delta")

    def scaled(record, *names):
        return replace(record, **{name: softer * getattr(record, name) for name in names})

    bodies = {
        name: replace(
            body, shape=replace(body.shape, material=scaled(body.shape.material, "E", "G"))
        )
        for name, body in posture.mechanism.bodies.items()
        if isinstance(body.shape, ConstantLeg)
    }
    joints = [
        replace(joint, drive=scaled(joint.drive, "stiffness")) if joint.drive else joint
        for joint in posture.mechanism.joints
    ]
    changed = replace(
        posture.mechanism, bodies={**posture.mechanism.bodies, **bodies}, joints=joints
    )
    frequencies = ritz.frequencies(replace(posture, mechanism=changed), 4)
    np.testing.assert_allclose(
        frequencies, np.sqrt(softer) * ritz.frequencies(posture, 4), rtol=1e-6
    )


def test_ritz_omits_idle_rod_spin():
    """The spin of a Delta's six rods is no mode. In a symmetric pose, modes 1 and 2 are a pair."""
    pair = ritz.frequencies(reference_posture(load_robot("delta").mechanism), 2)
    assert pair[0] > 10.0
    assert pair[1] == pytest.approx(pair[0], rel=1e-7)


def test_simplified_model_of_parts_equals_ritz():
    """Rocker of the examples as a rigid body: compliance and first frequency."""
    posture = first_pose(ROCKER)
    computed = answers("simplified", [posture], 1)
    compliance, frequencies = ritz.simplified_response(posture, 1)
    atol = 1e-10 * np.abs(compliance).max()
    np.testing.assert_allclose(computed.compliances[0], compliance, rtol=1e-9, atol=atol)
    np.testing.assert_allclose(computed.frequencies[0], frequencies, rtol=1e-10)


def test_simplified_structure_is_rigid():
    """Simplified model of an arm on a fixed joint, without drives: no compliance and no modes."""
    motor = "axis = [0.0, 0.0, 1.0]\ndrive = { stiffness = 5.0e4 }\n"
    text = ONE_ARM.replace(motor, "").replace('"revolute"', '"fixed"').replace('["x"]', "[]")
    compliance, frequencies = ritz.simplified_response(reference_posture(described(text)), 2)
    assert not compliance.any()
    assert len(frequencies) == 0


def test_posture_with_open_joint_is_refused():
    """A rod displaced by 10 µm would couple its end at a wrong point."""
    posture = first_pose("five-bar")
    rod = posture.frames["rod2"]
    moved_frame = Frame(rod.position + np.array([1e-5, 0.0, 0.0]), rod.rotation)
    with pytest.raises(ComputationError, match="elbow2: the two sides of the joint are"):
        ritz.compliance(replace(posture, frames={**posture.frames, "rod2": moved_frame}))


needs_exudyn = pytest.mark.skipif(
    find_spec("exudyn") is None, reason="EXUDYN (extra exudyn) is not installed"
)
FIVE_BAR = Context(load_robot("five-bar"), "standard")


def listed(mechanism, program):
    cases = other_solvers.cases(mechanism=mechanism)
    return [case for case in cases if case.group == f"mechanism.{program}"]


_PROPPED = """
schema = 2
name = "propped"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.1, 0.05], C = [0.3, 0.1, 0.25] }
materials.steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
tool = { body = "arm", point = "C", moves = [], mass = 1.0 }
[bodies.base]
from = "A"
to = "B"
section = { shape = "circle", diameter = 0.03 }
material = "steel"
[bodies.arm]
from = "B"
to = "C"
section = { shape = "i-section", width = 0.03, height = 0.04, flange = 0.004, web = 0.004 }
material = "steel"
[joints]
foot = { type = "fixed", between = ["ground", "base"], at = "A" }
elbow = { type = "fixed", between = ["base", "arm"], at = "B" }
table = { type = "planar", between = ["ground", "arm"], at = "C", axis = [0.0, 1.0, 1.0] }
"""


@pytest.fixture
def propped(tmp_path):
    """Frame on a plane: planar and fixed joints, unequal bending stiffnesses, a single posture."""
    return robot_of(_PROPPED, tmp_path).mechanism


@needs_exudyn
def test_frame_on_plane_joint_equals_exudyn(propped):
    """Frequencies within 5e-4 and within the uncertainty stated for EXUDYN's elements."""
    assert len(listed(propped, "exudyn")) == 1
    computed, theirs, uncertain = beams_and_exudyn(reference_posture(propped))
    np.testing.assert_allclose(computed, theirs, rtol=5e-4)
    assert (np.abs(computed - theirs) < uncertain).all()


HOOK = (
    HOOK_POINTS
    + """
tool = { body = "hook", point = "P", moves = [], mass = 2.0 }
joints.foot = { type = "fixed", between = ["ground", "hook"], at = "A" }
"""
    + HOOK_LEG
)


# Two straight pieces whose section has constants alone: rigid in shear.
CONSTANTS = """{ shape = "properties", A = 3.5e-3, Iy = 7.0e-7, Iz = 1.4e-6, J = 1.7e-6 }"""
RIGID_IN_SHEAR = (
    HOOK[: HOOK.index("sections")].replace(', { arc = "M" }, "Q"', "") + f"section = {CONSTANTS}\n"
).replace("points.M = [0.5, 0.2, 0.15]\npoints.Q = [0.55, 0.3, 0.3]\n", "")


@needs_exudyn
@pytest.mark.parametrize(
    "text",
    [TAPERED_ARM.read_text("utf-8"), HOOK, RIGID_IN_SHEAR],
    ids=["tapered-arm", "hook", "rigid in shear"],
)
def test_legs_along_line_equal_exudyn(text, tmp_path):
    """Chains of rigid bodies and springs: corners, steps, tapers and arcs out of a plane.

    Frequencies within 2e-4, and within the sum of the uncertainties stated for all modes.
    """
    posture = reference_posture(robot_of(text, tmp_path).mechanism)
    computed, theirs, uncertain = beams_and_exudyn(posture)
    np.testing.assert_allclose(computed, theirs, rtol=2e-4)
    assert np.abs(computed - theirs).sum() < uncertain.sum()
    # Stiffer sections by 1 % are noticed.
    assert uncertain[0] < 1e-3 * theirs[0]


class _WithLoad(multibody._ExudynModel):
    """EXUDYN model that stores the last node, at which the tool's load acts, as `last`."""

    def _node(self, position, rotation):
        self.last = super()._node(position, rotation)
        return self.last


@needs_exudyn
def test_frame_response_equals_exudyn(propped):
    """Reference: superposition of all damped modes of EXUDYN's matrices, constraints eliminated.

    EXUDYN's elements converge with second order: frequencies and peaks are 0.1 % off.
    """
    ratio, options = 0.02, ModelOptions(elements=32)
    posture = reference_posture(replace(propped, damping=ratio))
    (solved_modes,) = mechanism_modes("beam", [posture], 3, options)
    frequencies = np.outer(solved_modes.modes.frequencies, [0.3, 0.95, 1.0, 1.05]).ravel()
    system = _WithLoad(posture, options.elements)
    system.mbs.Assemble()
    mass, stiffness, _, _, free = system.mbs.ComputeLinearizedSystem(
        projectIntoConstraintNullspace=True,
        singularValuesTolerance=1e-6,
        returnConstraintNullspace=True,
    )
    index = system.mbs.GetNodeODE2Index(system.last)
    squares, shapes = eigh(stiffness, mass)
    speeds = 2.0 * np.pi * frequencies[:, None]
    swing = squares - speeds**2 + 2j * ratio * speeds * np.sqrt(squares)
    for axis in np.eye(3):
        theirs = ((axis @ free[:, index : index + 3].T @ shapes) ** 2 / swing).sum(axis=1)
        response = damped_modes(solved_modes.solution, frequencies.max()).along(axis)
        errors = np.abs(response.receptance(frequencies) - theirs)
        assert errors.max() < 0.02 * np.abs(theirs).max()


@pytest.mark.parametrize(
    ("program", "message"),
    [("exudyn", r"\./flexproof extras exudyn"), ("calculix", "is not installed")],
)
def test_missing_program_is_named_in_skip(monkeypatch, program, message):
    """EXUDYN or CalculiX is missing: the reason of the skip contains how to install it."""
    monkeypatch.setattr("fem.extras.find_spec", lambda _module: None)
    monkeypatch.setattr(calculix_run, "PROGRAMS", ("no-such-program",))
    cases = listed(FIVE_BAR.robot_file.mechanism, program)
    assert cases
    for case in cases:
        with pytest.raises(Skip, match=message):
            case.measure(FIVE_BAR)


def test_exudyn_refusal_names_bodies():
    """A leg known by its 6×6, a body without mass and an elastic joint each give one line."""
    with pytest.raises(InputError) as raised:
        multibody.require_beams(load_robot("ifw").mechanism)
    message = "\n".join(raised.value.faults)
    assert "leg1: the EXUDYN comparison needs a section; leg1 is a leg specified by" in message
    assert "body without mass" in message
    assert "does not support joints with a compliance" in message


@pytest.mark.exhaustive
@pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
@pytest.mark.parametrize("robot", ["five-bar", TAPERED_ARM], ids=["five-bar", "tapered-arm"])
def test_rotated_robot_equals_calculix(robot):
    """All cases agree, and with a shifted reference they disagree."""
    context = Context(load_robot(robot), "standard")
    cases = listed(context.robot_file.mechanism, "calculix")
    assert len(cases) == 2
    for case in cases:
        assert_agrees_and_can_disagree(judge(case, case.measure(context), 0.0))


def test_calculix_skip_names_leg_without_mesh(tmp_path):
    """A corner whose mitre does not match both outlines: the reason names the leg."""
    text = TAPERED_ARM.read_text("utf-8").replace(
        '["K", { arc = "M" }]', '["K", "M"]\nup = [0.3, 0.5, 1.0]'
    )
    context = Context(robot_of(text, tmp_path), "standard")
    case, _ = listed(context.robot_file.mechanism, "calculix")
    with pytest.raises(Skip, match=r"as a solid bar, arm: .* do not meet at the corner"):
        case.measure(context)


def test_solid_bars_have_outer_size_of_legs():
    """Hollow legs become full bars, which CalculiX meshes with few elements."""
    posture = reference_posture(load_robot("delta").mechanism)
    for name, body in with_bars(posture).mechanism.bodies.items():
        shape = posture.mechanism.bodies[name].shape
        if hasattr(shape, "section"):
            assert body.shape.section.extent == shape.section.extent
            assert body.shape.section.area > shape.section.area


@pytest.mark.parametrize("error", [0.01, -0.01, np.nan])
@pytest.mark.parametrize("pose", range(4))
def test_pose_with_largest_error_is_reported(error, pose):
    """Four poses. NaN counts as the largest error, and differences by rounding are ignored."""
    even, anywhere = np.array([2.0, 4.0, 8.0, 16.0]), np.ones(4, dtype=bool)
    values = even * (1.0 + np.where(np.arange(4) == pose, error, 0.005))
    assert farthest_posture(values, even, anywhere) == pose
    # Of those that are looked at; of those off by rounding alone the largest number.
    assert farthest_posture(values, even, np.arange(4) == 3 - pose) == 3 - pose
    assert farthest_posture(even * (1.0 + 1e-12 * np.arange(4)[::-1]), even, anywhere) == 3


def test_largest_entry_is_scaled_by_diagonal():
    """The largest difference relative to the diagonal, 4.08 for 4, is returned as 1.02 for 1."""
    reference = np.diag([1.0, 4.0, 16.0])
    value = reference + np.diag([0.01, 0.08, 0.17])
    assert farthest_entry(value, reference) == pytest.approx((1.02, 1.0))
