"""Saint-Venant's tractions by their definition, and ends with them against a bordered system."""

from functools import partial

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import STEEL
from scipy.sparse import bmat
from scipy.sparse.linalg import spsolve

from fem.bodies.solid import clamped_leg, solid_leg
from fem.couplings.grips import rigid_motions, saint_venant_loads
from lumped.legs import ConstantLeg, Material
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism.hexahedra import extrude, stations
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh

CUBIC = Material(E=2.1e11, G=1.3e11, nu=0.25, rho=7850.0)
SECTIONS = [Rectangle(0.10, 0.16), Tube(0.12, 0.01), ISection(0.10, 0.16, 0.012, 0.008)]
LENGTH = 0.5


def small_leg(section=SECTIONS[0], divisions=1, slices=3):
    return extrude(section_mesh(section, divisions), stations(LENGTH, slices))


def tetrahedral_leg():
    return tetrahedra(Rectangle(0.10, 0.16), LENGTH, 1)


@pytest.mark.parametrize(
    "mesh",
    [
        *(partial(small_leg, section=one, divisions=3, slices=2) for one in SECTIONS),
        tetrahedral_leg,
    ],
)
def test_saint_venant_loads_are_unit_wrenches(mesh):
    """BᵀR = I: resultants and moments about (L, 0, 0) are those of unit wrenches."""
    mesh = mesh()
    points = mesh.nodes[mesh.tip.nodes]
    reference = np.array([LENGTH, 0.0, 0.0])
    loads = saint_venant_loads(mesh.tip, points, reference, CUBIC)
    np.testing.assert_allclose(loads.T @ rigid_motions(points, reference), np.eye(6), atol=1e-12)


@pytest.mark.parametrize("mesh", [small_leg, tetrahedral_leg])
def test_free_ends_equal_the_bordered_system(mesh):
    """K u + B_root λ = f, B_rootᵀu = 0 solved as it stands, without springs."""
    solid = solid_leg(ConstantLeg(LENGTH, SECTIONS[0], STEEL), mesh())
    clamped = clamped_leg(solid, "free")
    K, root, tip = solid.stiffness, clamped.root, clamped.loads
    # In units of E, so that the stiffness and the constraint are of one size.
    system = bmat([[K / STEEL.E, root], [root.T, None]], format="csc")
    right = np.vstack([tip / STEEL.E, np.zeros((6, 6))])
    u = spsolve(system, right)[:-6]
    size = np.abs(u).max(axis=0)
    # Rounding times the condition of a small mesh, about 1e5.
    np.testing.assert_allclose(clamped.response / size, u / size, rtol=0, atol=1e-10)
    assert scaled_difference(clamped.compliance, tip.T @ u) < 1e-10
