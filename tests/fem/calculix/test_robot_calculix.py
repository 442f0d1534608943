"""The whole robot with solid legs held against CalculiX on the same meshes."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from fem import robot_solid
from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix import run as calculix_run
from fem.calculix.deck import full_spring
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.robot import compliance_and_frequencies, robot_deck
from lumped.biglide import with_equivalent_legs
from lumped.biglide_assembly import assemble
from lumped.robot_file import load_robot
from meshes.prism.tetrahedra import tetrahedra

needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
BUILT_IN = with_equivalent_legs(load_robot("ifw").robot)
OFFSET = np.array([0.02, 0.03, 0.155])
TOOL = np.diag([2e-9, 3e-9, 1e-9, 4e-7, 3e-7, 5e-7])
TOOL[[0, 1, 1, 5], [1, 0, 5, 1]] = 1e-9, 1e-9, 1e-8, 1e-8
# With an offset in all directions, so that every lever of the platform counts.
ROBOT = replace(BUILT_IN, foot_compliance=None, tool_compliance=None, tool_offset=OFFSET)
ROBOTS = {
    "rigid feet, offset": ROBOT,
    "elastic feet": BUILT_IN,
    "elastic feet, offset": replace(BUILT_IN, tool_offset=OFFSET),
    "elastic feet, tool spring": replace(BUILT_IN, tool_offset=OFFSET, tool_compliance=TOOL),
}
# Seven printed digits, as for one leg.
PRINTED = 1e-6


@pytest.fixture(scope="module")
def legs():
    solids = [
        solid_leg(leg, tetrahedra(leg.section, leg.length, 1)) for leg in (ROBOT.leg1, ROBOT.leg2)
    ]
    first, second = (
        replace(solid, mass=mass_at_stiffness_points(solid.mesh, solid.leg.material.rho))
        for solid in solids
    )
    return first, second


@needs_calculix
@pytest.mark.parametrize("name", ROBOTS)
def test_statics_and_ten_frequencies(legs, name):
    robot = ROBOTS[name]
    x = robot.stroke[0] if name == "elastic feet" else robot.centre
    compliance, frequencies = compliance_and_frequencies(robot, x, legs, 10)
    whole = assemble(robot, x, *(solid_leg_matrices(leg) for leg in legs))
    ours = robot_solid.factorised_robot(whole)
    expected = robot_solid.compliance(ours)
    scale = np.sqrt(np.diag(expected))
    assert np.abs((compliance - expected) / np.outer(scale, scale)).max() < PRINTED
    np.testing.assert_allclose(frequencies, robot_solid.modes(ours, 10).frequencies, rtol=PRINTED)


def test_a_full_spring_is_the_sum_of_its_parts():
    rng = np.random.default_rng(1)
    root = rng.standard_normal((6, 6)) * [1e4, 1e4, 1e4, 1e3, 1e3, 1e3]
    stiffness = root.T @ root
    motions = [(0, k) for k in range(6)]
    # Strains of a spring between two bodies: u_k − u_{k+6}.
    strain = [[(motion, 1.0), ((1, motion[1]), -1.0)] for motion in motions]
    equations, springs = full_spring(stiffness, strain, [(2, k) for k in range(6)])
    rows = np.zeros((6, 12))
    for row, equation in zip(rows, equations, strict=True):
        for (node, component), factor in equation.terms:
            row[6 * node + component] = factor
    found = rows.T @ np.diag([spring.stiffness for spring in springs]) @ rows
    apart = np.hstack([np.eye(6), -np.eye(6)])
    np.testing.assert_allclose(found, apart.T @ stiffness @ apart, rtol=1e-9, atol=1e-3)


def test_joints_leave_only_their_own_rotation_free(legs):
    deck = robot_deck(ROBOT, ROBOT.centre, legs, 0)
    start = len(legs[0].mesh.nodes) + len(legs[1].mesh.nodes)
    platform = {(start, k) for k in range(3)} | {(start + 1, k) for k in range(3)}
    ends = {}
    for leg, offset in zip(legs, (0, len(legs[0].mesh.nodes)), strict=True):
        for name, face in (("root", leg.mesh.root), ("tip", leg.mesh.tip)):
            nodes = set((face.nodes + offset).tolist())
            ends[name, offset] = {
                freedom
                for equation in deck.equations
                if equation.dependent[0] in nodes
                for freedom, _ in equation.terms
            }
    (root1, tip1), (root2, tip2) = [
        (ends["root", offset], ends["tip", offset]) for offset in (0, len(legs[0].mesh.nodes))
    ]
    assert tip1 == platform
    # Leg 2 shares all but the rotation about z with the platform, and has one of its own.
    assert platform - tip2 == {(start + 1, 2)}
    assert len(tip2 - platform) == 1
    held = set(deck.held)
    assert [len(root - held) for root in (root1, root2)] == [1, 1]
