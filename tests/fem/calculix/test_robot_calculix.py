"""The whole robot with solid legs held against CalculiX on the same meshes."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from fem import robot_solid
from fem.bodies.solid import solid_leg, solid_leg_matrices
from fem.calculix import run as calculix_run
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.robot import compliance_and_frequencies, robot_deck
from lumped.biglide import with_equivalent_legs
from lumped.biglide_assembly import assemble
from lumped.errors import InputError
from lumped.robot_file import load_robot
from meshes.prism.tetrahedra import tetrahedra

needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)
BUILT_IN = with_equivalent_legs(load_robot("ifw").robot)
# With an offset in all directions, so that every lever of the platform counts.
ROBOT = replace(
    BUILT_IN,
    foot_compliance=None,
    tool_compliance=None,
    tool_offset=np.array([0.02, 0.03, 0.155]),
)
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
@pytest.mark.parametrize("x", [ROBOT.stroke[0], ROBOT.centre])
def test_statics_and_ten_frequencies(legs, x):
    compliance, frequencies = compliance_and_frequencies(ROBOT, x, legs, 10)
    whole = assemble(ROBOT, x, *(solid_leg_matrices(leg) for leg in legs))
    ours = robot_solid.factorised_robot(whole)
    expected = robot_solid.compliance(ours)
    scale = np.sqrt(np.diag(expected))
    assert np.abs((compliance - expected) / np.outer(scale, scale)).max() < PRINTED
    np.testing.assert_allclose(frequencies, robot_solid.modes(ours, 10).frequencies, rtol=PRINTED)


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


def test_elastic_feet_are_refused(legs):
    with pytest.raises(InputError, match="rigid feet"):
        robot_deck(BUILT_IN, BUILT_IN.centre, legs, 0)
