"""End couplings against the naive TᵀKT, against a bordered system, and by their definition."""

from functools import partial

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.sparse import bmat
from scipy.sparse.linalg import spsolve

from fem.couplings.end_coupling import (
    free_ends,
    rigid_ends,
    rigid_motions,
    saint_venant_loads,
    unknowns,
)
from fem.elements.elasticity import on_three_components, stiffness, stiffness_and_mass
from lumped.legs import Material
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.prism.extrude import extrude, stations
from meshes.prism.tetrahedra import tetrahedra
from meshes.section.section_mesh import section_mesh

CUBIC = Material(E=2.1e11, G=1.3e11, nu=0.25, rho=7850.0)
SECTIONS = [
    Rectangle(0.10, 0.16),
    HollowRectangle(0.10, 0.16, 0.01),
    Circle(0.12),
    Tube(0.12, 0.01),
    ISection(0.10, 0.16, 0.012, 0.008),
]
LENGTH = 0.5


def small_leg(element="quad9", section=SECTIONS[0], divisions=1, slices=3):
    return extrude(section_mesh(section, divisions, element), stations(LENGTH, slices))


def tetrahedral_leg():
    return tetrahedra(Rectangle(0.10, 0.16), LENGTH, 1)


MESHES = {
    "hex27": small_leg,
    "hex8": lambda: small_leg("quad4", divisions=2),
    "tet10": tetrahedral_leg,
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_rigid_ends_equal_the_naive_product(mesh):
    mesh = mesh()
    ends = rigid_ends(mesh)
    T = ends.transformation
    K, M = stiffness_and_mass(mesh, CUBIC)
    for matrix in (K, on_three_components(M)):
        naive = (T.T @ matrix @ T).toarray()
        # The same sums in another order.
        tolerance = 1e-14 * np.abs(naive).max()
        np.testing.assert_allclose(ends.reduced(matrix).toarray(), naive, rtol=0, atol=tolerance)
        held = naive[6:, 6:]
        np.testing.assert_allclose(
            ends.clamped_stiffness(matrix).toarray(), held, rtol=0, atol=tolerance
        )
        assert abs(ends.reduced(matrix) - ends.reduced(matrix).T).max() == 0.0


def test_rigid_ends_move_as_rigid_bodies():
    """u = x + φ × r at every node of a face, r from (0, 0, 0) or (L, 0, 0)."""
    mesh = small_leg()
    ends = rigid_ends(mesh)
    q = np.zeros(ends.size)
    root, tip = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]), np.array([4.0, 5.0, 6.0, -0.3, 0.5, 0.7])
    q[:6], q[6:12] = root, tip
    u = (ends.transformation @ q).reshape(-1, 3)
    for face, twist, point in ((mesh.root, root, 0.0), (mesh.tip, tip, LENGTH)):
        r = mesh.nodes[face.nodes] - [point, 0.0, 0.0]
        expected = twist[:3] + np.cross(twist[3:], r)
        np.testing.assert_allclose(u[face.nodes], expected, atol=1e-15)
    assert np.all(u[ends.interior] == 0.0)


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
    forces = loads.reshape(-1, 3, 6)
    np.testing.assert_allclose(forces.sum(axis=0), np.eye(6)[:3], atol=1e-12)
    moments = np.cross(points - reference, forces.transpose(2, 0, 1)).sum(axis=1).T
    np.testing.assert_allclose(moments, np.eye(6)[3:], atol=1e-12)


def test_shear_traction_of_a_rectangle_is_parabolic():
    """ν = 0: τ = 3/2A (1 − (2y/b)²), whose mean work with y² is b²/20 (5/3 less than uniform)."""
    section = Rectangle(0.10, 0.16)
    mesh = small_leg(section=section, divisions=6, slices=2)
    points = mesh.nodes[mesh.root.nodes]
    material = Material(E=2.1e11, G=1e11, nu=0.0, rho=7850.0)
    loads = saint_venant_loads(mesh.root, points, np.zeros(3), material).reshape(-1, 3, 6)
    # Quadratic cells hold the cubic flexure function to h⁴: 1/6⁴ of the square's tenth.
    assert points[:, 1] ** 2 @ loads[:, 1, 1] == pytest.approx(0.10**2 / 20.0, rel=1e-3)
    assert points[:, 2] ** 2 @ loads[:, 2, 2] == pytest.approx(0.16**2 / 20.0, rel=1e-3)
    assert np.abs(loads[:, 0, 1]).max() == 0.0


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_free_ends_equal_the_bordered_system(mesh):
    """K u + B_root λ = f, B_rootᵀu = 0 solved as it stands, without springs."""
    mesh = mesh()
    ends = free_ends(mesh, STEEL)
    K = stiffness(mesh, STEEL)
    # In units of E, so that the stiffness and the constraint are of one size.
    system = bmat([[K / STEEL.E, ends.root_loads], [ends.root_loads.T, None]], format="csc")
    right = np.zeros((K.shape[0] + 6, 6))
    right[:-6] = ends.free_tip_loads / STEEL.E
    u = spsolve(system, right)[:-6]
    x = spsolve(ends.clamped_stiffness(K).tocsc(), ends.tip_loads())
    size = np.abs(u).max(axis=0)
    # Rounding times the condition of a small mesh, about 1e5.
    np.testing.assert_allclose(ends.expanded(x) / size, u / size, rtol=0, atol=1e-10)
    compliance = ends.tip_loads().T @ x
    scale = 1.0 / np.sqrt(np.diag(compliance))
    difference = (compliance - ends.free_tip_loads.T @ u) * scale[:, None] * scale
    assert np.abs(difference).max() < 1e-10


def test_unknowns_run_node_by_node():
    assert unknowns(np.array([4, 1])).tolist() == [12, 13, 14, 3, 4, 5]
