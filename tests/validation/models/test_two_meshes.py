"""A leg on two similar meshes of solids, and the beams of the same section meshes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, HollowRectangle, ISection
from validation.solids.legs import two_meshes

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)


def leg(section, length=0.85):
    return ConstantLeg(length, section, STEEL)


@pytest.mark.parametrize("section", [Circle(0.1), ISection(0.12, 0.2, 0.01, 0.008)])
def test_two_meshes_of_any_shape_with_free_ends_are_the_beam_of_their_constants(section):
    found = two_meshes(leg(section), 900)
    assert found.ratio == 2.0
    assert_allclose(np.diag(found.fine.free), np.diag(found.fine.own), rtol=3e-4)
    # Held faces take from torsion and bending, never add.
    assert np.all(np.diag(found.fine.rigid) <= np.diag(found.fine.free) * (1.0 + 1e-9))


def test_one_mesh_of_walls_is_refined_along_the_leg():
    """A hollow rectangle of four divisions has 432 unknowns, of eight 1440."""
    hollow = leg(HollowRectangle(0.1, 0.16, 0.01))
    found = two_meshes(hollow, 900)
    assert_allclose(found.coarse.own, found.fine.own, rtol=1e-12)
    assert not np.array_equal(found.coarse.free, found.fine.free)
    with pytest.raises(InputError, match="432 unknowns, more than 400"):
        two_meshes(hollow, 400)
