"""Couplings of faces against the obvious way: Lagrange multipliers on the full, dense matrices.

The obvious way has the displacements of all nodes and the twists as unknowns, and an equation for
every tie. It shares the element matrices with the fast one, and nothing else.
"""

from dataclasses import replace

import numpy as np
import pytest
from drawn_parts import meshed, read_here
from prismatic_legs import STEEL
from scipy.sparse import block_array, block_diag, csc_array, csr_array
from scipy.sparse.linalg import splu

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.couplings.coupled_solid import coupled_solid
from fem.couplings.grips import area_weights, rigid_motions
from fem.elasticity import on_three_components
from lumped.mechanism.body import ByCylinder, ByPlane, PartInterface
from meshes.part.interfaces import find_interfaces

# The second bore is referred to a point beside its axis.
OFF = np.array([1e-3, 2e-3, 0.0])


@pytest.fixture(scope="module")
def lug(tmp_path_factory):
    """A coarse bar of 100 × 40 × 30 mm with bores of radius 8 and 5, and a flat end."""

    def draw(kernel):
        bar = kernel.addBox(0.0, -20.0, -15.0, 100.0, 40.0, 30.0)
        bores = [(3, kernel.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((20, 8), (80, 5))]
        kernel.cut([(3, bar)], bores)

    file = read_here(meshed(tmp_path_factory.mktemp("lug") / "lug.msh", draw, 40.0, 9.0), "mm")
    return file, meshed_part(file.mesh, STEEL)


def grips_on(file, *kinds):
    """Both bores, and the flat end where there are three kinds."""
    choices = ByCylinder(0.008), ByCylinder(0.005), ByPlane((1.0, 0.0, 0.0), (0.1, 0.0, 0.0))
    chosen = enumerate(zip(choices, kinds, strict=False))
    wanted = {f"I{k}": PartInterface(choice, kind) for k, (choice, kind) in chosen}
    first, second, *others = find_interfaces(file, wanted)
    second = replace(second, point=second.point + OFF)
    return grips_of(file.mesh, (first, second, *others))


def ties(grip, nodes):
    """Rows by which a face's displacements (3 a node) are those of its twist; pins are off."""
    weights = area_weights(nodes, grip.facets).toarray()
    if grip.kind == "rigid":
        return np.eye(3 * len(weights))
    if grip.kind == "average":
        return rigid_motions(nodes[grip.nodes], grip.point).T @ np.kron(weights, np.eye(3))
    # Along z.
    radial = (nodes[grip.nodes] - (grip.point - OFF)) * [1.0, 1.0, 0.0]
    radial /= np.linalg.norm(radial, axis=1)[:, None]
    away = np.eye(len(radial))[:, :, None] * radial
    turned, along = np.cross([0.0, 0.0, 1.0], radial), np.array([[0.0, 0.0, 1.0]])
    slides = [weights.sum(axis=0)[:, None] * one for one in (turned, along)]
    return np.vstack([one.reshape(-1, radial.size) for one in (away, *slides)])


def test_the_compliance_is_that_of_lagrange_multipliers(lug):
    file, part = lug
    grips = grips_on(file, "rigid", "pin", "average")
    nodes, size, m = part.mesh.nodes, part.stiffness.shape[0], len(grips)
    rows = []
    for k, grip in enumerate(grips):
        own = ties(grip, nodes)
        rows.append(np.zeros((len(own), size + 6 * m)))
        rows[-1][:, np.add.outer(3 * grip.nodes, range(3)).ravel()] = own
        motion = rigid_motions(nodes[grip.nodes], grip.point)
        rows[-1][:, size + 6 * k : size + 6 * k + 6] = -own @ motion
    # Unknowns: displacements, twists, multipliers; the first twist is held.
    tied = csr_array(np.delete(np.vstack(rows), range(size, size + 6), axis=1))
    energy = block_diag([part.stiffness, csr_array((6 * m - 6, 6 * m - 6))], format="csr")
    scale = float(np.abs(part.stiffness.diagonal()).mean())
    system = csc_array(block_array([[energy, scale * tied.T], [scale * tied, None]]))
    loads = np.zeros((system.shape[0], 6 * m - 6))
    loads[size : size + 6 * m - 6] = np.eye(6 * m - 6)
    expected = splu(system).solve(loads)[size : size + 6 * m - 6]
    body = held_part(part, grips, "lug")
    sizes = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # 1e-7: the indefinite system's rounding.
    assert body.compliance / sizes == pytest.approx(expected / sizes, abs=1e-7)
    assert body.stiffness.shape == (6 * m, 6 * m)


@pytest.mark.parametrize("kind", ["rigid", "average", "pin"])
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
    twists = solid.twists.T @ solid.motions
    assert twists[:6] == pytest.approx(np.eye(6), abs=1e-12)
    expected = rigid_motions(part.mesh.nodes, grips[0].point)
    assert T @ solid.motions == pytest.approx(expected, abs=1e-12)
    body = held_part(part, grips, "lug")
    rigid = twists.T @ body.condensed_mass @ twists
    mass = part.properties().mass * np.eye(3)
    assert rigid[:3, :3] == pytest.approx(mass, rel=1e-9, abs=1e-9)
    assert abs(body.stiffness @ twists).max() < 1e-9 * abs(body.stiffness).max()


def test_an_averaged_bore_moves_as_the_means_of_fields_by_hand(lug):
    """u_z = x² moves one by ∫x²/A = r²/2; u_x = z³ turns it about y by ∫z⁴/∫(x² + z²)."""
    file, part = lug
    (grip, _) = grips_on(file, "average", "average")
    mass, nodes = on_three_components(part.scalar_mass), part.mesh.nodes
    twists = coupled_solid(part.stiffness, mass, nodes, [grip]).twists
    x, _, z = (nodes - grip.point).T
    nothing = np.zeros_like(x)
    raised = twists.T @ np.column_stack([nothing, nothing, x**2]).ravel()
    bent = twists.T @ np.column_stack([z**3, nothing, nothing]).ravel()
    radius, top = 0.008, 0.015
    turned = top**4 / 5.0 / (top**2 / 3.0 + radius**2 / 2.0)
    # Circles of nine quadratic sides: off by 2e-5 and 2e-4.
    assert raised[:3] / radius**2 == pytest.approx([0.0, 0.0, 0.5], abs=2e-4)
    assert bent[3:] / turned == pytest.approx([0.0, 1.0, 0.0], abs=2e-3)
