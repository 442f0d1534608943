"""Frames against closed forms: Castigliano's theorem, moved compliances, exact frequencies."""

import numpy as np
import pytest
from compliances import scaled_difference

from fem.beams.frame import BeamFrame, Member, Support, assemble, displacements, modes
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.screws import turn_matrix
from lumped.sections import Rectangle

LEG = ConstantLeg(2.0, Rectangle(0.12, 0.2), Material.isotropic(2.1e11, 0.3, 7850.0))
BEAM = LEG.timoshenko
UP = (0.0, 0.0, 1.0)
CLAMPED = (Support(0),)
# Exact in statics: what is left is rounding, grown by the conditioning of a few elements.
EXACT = 1e-9


def direct(nodes, members, supports=CLAMPED, **more):
    return BeamFrame("test frame", np.array(nodes, dtype=float), tuple(members), supports, **more)


def node_compliance(frame, node):
    wrenches = np.zeros((6 * len(frame.nodes), 6))
    wrenches[6 * node : 6 * node + 6] = np.eye(6)
    return displacements(assemble(frame), wrenches)[6 * node : 6 * node + 6]


def random_rotation(seed):
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


@pytest.mark.parametrize("seed", range(2))
def test_a_member_in_any_direction_has_the_turned_cantilever_compliance(seed):
    axes = random_rotation(seed)
    frame = direct(
        [np.zeros(3), LEG.length * axes[:, 0]],
        # Any normal in the x–z plane will do, not only z itself.
        [Member(0, 1, BEAM, tuple(axes[:, 2] + 0.7 * axes[:, 0]), 3)],
    )
    expected = turn_matrix(tip_compliance(BEAM, LEG.length), axes)
    assert scaled_difference(node_compliance(frame, 1), expected) < EXACT


def test_a_bent_cantilever_under_a_load_out_of_its_plane():
    first, second = 1.5, 0.8
    frame = direct(
        [[0, 0, 0], [first, 0, 0], [first, second, 0]],
        [Member(0, 1, BEAM, UP, 2), Member(1, 2, BEAM, UP, 1)],
    )
    # Castigliano: bending and shear of both arms, the first arm twisted by the second.
    expected = (
        (first**3 + second**3) / (3.0 * BEAM.EIy)
        + (first + second) / BEAM.GAz
        + second**2 * first / BEAM.GJ
    )
    assert node_compliance(frame, 2)[2, 2] == pytest.approx(expected, rel=EXACT)


def test_a_member_without_a_kind_of_deformation_gives_no_stiffness_in_it():
    nodes = [[0, 0, 0], [LEG.length, 0, 0]]
    bending = assemble(direct(nodes, [Member(0, 1, BEAM, UP, 2, kinds=("bending z",))], ()))
    ends = bending.stiffness.toarray()[:12, :12]
    assert np.flatnonzero(np.diag(ends)).tolist() == [1, 5, 7, 11]


def test_a_loose_frame_is_named():
    frame = assemble(
        direct([[0, 0, 0], [1, 0, 0]], [Member(0, 1, BEAM, UP)], (Support(0, ("x", "y", "z")),))
    )
    with pytest.raises(ComputationError, match=r"test frame.*free to move"):
        displacements(frame, np.zeros((12, 1)))
    with pytest.raises(ComputationError, match="test frame"):
        modes(frame, 2)
