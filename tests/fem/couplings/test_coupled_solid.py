"""Couplings of faces against the obvious way: Lagrange multipliers on the full, dense matrices.

The obvious way has the displacements of all nodes and the twists as unknowns, and an equation for
every tie. It shares the element matrices with the fast one, and nothing else.
"""

from dataclasses import replace

import numpy as np
import pytest
from drawn_parts import meshed
from prismatic_legs import STEEL
from scipy.sparse import block_array, block_diag, csc_array, csr_array
from scipy.sparse.linalg import splu

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.couplings.coupled_solid import coupled_solid
from fem.couplings.grips import area_weights, rigid_motions
from fem.elements.elasticity import on_three_components
from lumped.mechanism.body import ByCylinder, ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part

# The second bore is referred to a point beside its axis.
OFF = np.array([1e-3, 2e-3, 0.0])
KINDS = ("rigid", "average", "pin")


@pytest.fixture(scope="module")
def lug(tmp_path_factory):
    """A coarse bar of 200 × 40 × 30 mm with bores of radius 8 and 5, and a flat end."""

    def draw(kernel):
        bar = kernel.addBox(0.0, -20.0, -15.0, 200.0, 40.0, 30.0)
        bores = [(3, kernel.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((20, 8), (180, 5))]
        kernel.cut([(3, bar)], bores)

    file = read_part(meshed(tmp_path_factory.mktemp("lug") / "lug.msh", draw, 40.0, 9.0), "mm")
    return file, meshed_part(file.mesh, STEEL)


def grips_on(file, *kinds):
    """Both bores, and the flat end where there are three kinds."""
    choices = ByCylinder(0.008), ByCylinder(0.005), ByPlane((1.0, 0.0, 0.0), (0.2, 0.0, 0.0))
    wanted = {
        f"I{k}": PartInterface(choice, kind)
        for k, (choice, kind) in enumerate(zip(choices, kinds, strict=False))
    }
    first, second, *others = find_interfaces(file, wanted)
    second = replace(second, point=second.point + OFF)
    return grips_of(file.mesh, (first, second, *others))


def tied(part, grips):
    """Rows G with G [u; q] = 0, dense."""
    nodes, m = part.mesh.nodes, len(grips)
    size = 3 * len(nodes)
    rows = []
    for k, grip in enumerate(grips):
        own = np.arange(size + 6 * k, size + 6 * k + 6)
        held = grip.nodes
        at = (3 * held[:, None] + np.arange(3)).ravel()
        R = rigid_motions(nodes[held], grip.point)
        if grip.kind == "rigid":
            G = np.zeros((len(at), size + 6 * m))
            G[:, at], G[:, own] = np.eye(len(at)), -R
        else:
            W = np.kron(area_weights(nodes, grip.facets).toarray(), np.eye(3))
            mean = np.linalg.solve(R.T @ W @ R, R.T @ W)
            G = np.zeros((6, size + 6 * m))
            G[:, at], G[:, own] = mean, -np.eye(6)
            if grip.kind == "pin":
                axis = grip.axis
                away = nodes[held] - grip.point
                # Bores in these tests run along z, the second off its reference point.
                assert abs(axis[2]) == pytest.approx(1.0)
                radial = away[:, :2] + (OFF[:2] if k else 0.0)
                radial = np.column_stack([radial, np.zeros(len(radial))])
                radial /= np.linalg.norm(radial, axis=1)[:, None]
                N = np.zeros((len(held), len(at)))
                for i, n in enumerate(radial):
                    N[i, 3 * i : 3 * i + 3] = n
                tangent = np.cross([0.0, 0.0, 1.0], radial)
                w = area_weights(nodes, grip.facets).toarray().sum(axis=0)
                slides = np.zeros((2, len(at)))
                slides[0, 2::3] = w
                slides[1] = (w[:, None] * tangent).ravel()
                G = np.zeros((len(held) + 2, size + 6 * m))
                ties = np.vstack([N, slides])
                G[:, at], G[:, own] = ties, -ties @ R
        rows.append(G)
    return np.vstack(rows)


def test_the_compliance_is_that_of_lagrange_multipliers(lug):
    file, part = lug
    grips = grips_on(file, "pin", "rigid", "average")
    body = held_part(part, grips, "lug")
    size, m = part.stiffness.shape[0], len(grips)
    # Unknowns: displacements, twists, multipliers; the first twist is held.
    ties = csr_array(tied(part, grips))
    kept = np.delete(np.arange(size + 6 * m), np.arange(size, size + 6))
    ties = ties[:, kept]
    energy = block_diag([part.stiffness, csr_array((6 * m - 6, 6 * m - 6))], format="csr")
    scale = float(np.abs(part.stiffness.diagonal()).mean())
    system = csc_array(block_array([[energy, scale * ties.T], [scale * ties, None]]))
    loads = np.zeros((system.shape[0], 6 * m - 6))
    loads[size : size + 6 * m - 6] = np.eye(6 * m - 6)
    compliance = splu(system).solve(loads)[size : size + 6 * m - 6]
    sizes = np.sqrt(np.diag(body.compliance))
    # 1e-7: the indefinite system's rounding.
    assert body.compliance / np.outer(sizes, sizes) == pytest.approx(
        compliance / np.outer(sizes, sizes), abs=1e-7
    )
    assert body.stiffness.shape == (6 * m, 6 * m)


@pytest.mark.parametrize("kind", KINDS)
def test_rigid_motions_are_exact_and_loads_have_exact_resultants(lug, kind):
    file, part = lug
    grips = grips_on(file, kind, kind)
    M = on_three_components(part.scalar_mass)
    solid = coupled_solid(part.stiffness, M, part.mesh.nodes, grips)
    T = solid.transformation
    if kind != "pin":
        # What a pin does not let free keeps a stiffness of its own.
        naive = T.T @ part.stiffness @ T
        assert abs(solid.stiffness - naive).max() < 1e-14 * abs(naive).max()
    assert abs(solid.mass - T.T @ M @ T).max() < 1e-14 * abs(solid.mass).max()
    forces = solid.stiffness @ solid.motions
    assert abs(forces).max() < 1e-12 * abs(solid.stiffness).max()
    first = solid.twists[:, :6].T @ solid.motions
    assert first == pytest.approx(np.eye(6), abs=1e-12)
    fields = T @ solid.motions
    expected = rigid_motions(part.mesh.nodes, grips[0].point)
    assert fields == pytest.approx(expected, abs=1e-12)
    body = held_part(part, grips, "lug")
    properties = part.properties()
    motions = np.vstack([np.eye(6), solid.twists[:, 6:].T @ solid.motions])
    rigid = motions.T @ body.condensed_mass @ motions
    assert rigid[:3, :3] == pytest.approx(properties.mass * np.eye(3), rel=1e-9, abs=1e-9)
    assert abs(body.stiffness @ motions).max() < 1e-9 * abs(body.stiffness).max()


def test_averaged_bores_move_as_the_means_of_fields_by_hand(lug):
    """u_z = x² moves one by ∫x²/A = r²/2; u_x = z³ turns it about y by ∫z⁴/∫(x² + z²).

    Two bores of one length weigh as their radii: u_x = x from the first axis moves both.
    """
    file, part = lug
    bores = {f"{r:g}": PartInterface(ByCylinder(r), "average") for r in (0.008, 0.005)}
    first, second = find_interfaces(file, bores)
    both = replace(first, faces=(*first.faces, *second.faces))
    away = part.mesh.nodes - first.point
    fields = np.zeros((len(away), 3, 3))
    fields[:, 2, 0], fields[:, 0, 1], fields[:, 0, 2] = away[:, 0] ** 2, away[:, 2] ** 3, away[:, 0]
    means = []
    for interface in (first, both):
        grips = grips_of(file.mesh, [interface])
        mass = on_three_components(part.scalar_mass)
        solid = coupled_solid(part.stiffness, mass, part.mesh.nodes, grips)
        means.append(solid.twists.T @ fields.reshape(-1, 3))
    radius, top = 0.008, 0.015
    turned = top**4 / 5.0 / (top**2 / 3.0 + radius**2 / 2.0)
    # Circles of nine quadratic sides: off by 2e-5 and 2e-4.
    assert means[0][:3, 0] / radius**2 == pytest.approx([0.0, 0.0, 0.5], abs=2e-4)
    assert means[0][3:, 1] / turned == pytest.approx([0.0, 1.0, 0.0], abs=2e-3)
    stretched = means[1][:, 2] / (0.16 * 5.0 / (8.0 + 5.0))
    assert stretched == pytest.approx([1.0, *[0.0] * 5], abs=2e-4)
