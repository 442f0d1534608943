"""Frames against closed forms: a turned cantilever, and Castigliano's theorem on a bent one."""

import numpy as np
import pytest
from compliances import scaled_difference

from fem.beams.frame import BeamFrame, Member, Support, assemble, displacements
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.screws import turn_matrix
from lumped.sections import Rectangle

LEG = ConstantLeg(2.0, Rectangle(0.12, 0.2), Material.isotropic(2.1e11, 0.3, 7850.0))
BEAM = LEG.timoshenko
UP = (0.0, 0.0, 1.0)


def last_compliance(nodes, members, support=Support(0)):  # noqa: B008  frozen
    frame = BeamFrame("test frame", np.array(nodes, dtype=float), tuple(members), (support,))
    wrenches = np.eye(6 * len(nodes))[:, -6:]
    return displacements(assemble(frame), wrenches)[-6:]


def test_a_member_in_any_direction_has_the_turned_cantilever_compliance():
    axes, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    axes *= np.sign(np.linalg.det(axes))
    # Any normal in the x–z plane will do, not only z itself.
    member = Member(0, 1, BEAM, tuple(axes[:, 2] + 0.7 * axes[:, 0]), 3)
    found = last_compliance([np.zeros(3), LEG.length * axes[:, 0]], [member])
    expected = turn_matrix(tip_compliance(BEAM, LEG.length), axes)
    # Exact in statics: what is left is rounding, grown by the conditioning of a few elements.
    assert scaled_difference(found, expected) < 1e-9


def test_a_bent_cantilever_under_a_load_out_of_its_plane_and_a_loose_one():
    first, second = 1.5, 0.8
    nodes = [[0, 0, 0], [first, 0, 0], [first, second, 0]]
    members = [Member(0, 1, BEAM, UP, 2), Member(1, 2, BEAM, UP, 1)]
    # Castigliano: bending and shear of both arms, the first arm twisted by the second.
    expected = (
        (first**3 + second**3) / (3.0 * BEAM.EIy)
        + (first + second) / BEAM.GAz
        + second**2 * first / BEAM.GJ
    )
    assert last_compliance(nodes, members)[2, 2] == pytest.approx(expected, rel=1e-9)
    with pytest.raises(ComputationError, match=r"test frame.*free to move"):
        last_compliance(nodes, members, Support(0, ("x", "y", "z")))
