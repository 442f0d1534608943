"""Couplings of faces against the obvious way: Lagrange multipliers on the full, dense matrices.

The obvious way has the displacements of all nodes and the twists as unknowns, and an equation for
every tie. It shares the element matrices with the fast one, and nothing else.
"""

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.sparse import block_array, block_diag, csc_array, csr_array
from scipy.sparse.linalg import splu

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.couplings.coupled_solid import coupled_solid
from fem.couplings.grips import area_weights, rigid_motions
from fem.elements.elasticity import on_three_components
from meshes.gmsh_arrays import connectivity, numbered
from meshes.gmsh_session import gmsh_model
from meshes.part.boundary import PartMesh, boundary, smooth_faces
from meshes.part.faces import face_of
from meshes.part.interfaces import Interface
from meshes.part.straighten import straightened

# The second bore is referred to a point beside its axis.
OFF = np.array([1e-3, 2e-3, 0.0])
KINDS = ("rigid", "average", "pin")


@pytest.fixture(scope="module")
def lug():
    """A coarse bar of 200 × 40 × 30 mm with bores of radius 8 and 5, and a flat end."""
    with gmsh_model("lug") as gmsh:
        occ = gmsh.model.occ
        bar = occ.addBox(0.0, -0.02, -0.015, 0.2, 0.04, 0.03)
        bores = [
            (3, occ.addCylinder(x, 0.0, -0.03, 0.0, 0.0, 0.06, r))
            for x, r in ((0.02, 0.008), (0.18, 0.005))
        ]
        occ.cut([(3, bar)], bores)
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.04)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 9)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        tagged = connectivity(gmsh, "tet10")
        tags, nodes = numbered(gmsh, tagged)
    nodes, _ = straightened(nodes, np.searchsorted(tags, tagged))
    bare = PartMesh(nodes, np.searchsorted(tags, tagged), "tet10", {})
    facets = boundary(bare)
    faces = {
        number: facets.at(rows) for number, rows in enumerate(smooth_faces(nodes, facets), start=1)
    }
    mesh = PartMesh(nodes, bare.cells, "tet10", faces)
    found = {number: face_of(number, nodes, own) for number, own in faces.items()}
    return meshed_part(mesh, STEEL), found


def interfaces(found, kinds):
    bores = sorted((f for f in found.values() if f.kind == "bore"), key=lambda f: f.on_axis[0])
    flat = [f for f in found.values() if f.kind == "plane" and f.direction[0] > 0.9]
    chosen = [(bores[0], bores[0].on_axis), (bores[1], bores[1].on_axis + OFF)]
    if len(kinds) == 3:
        chosen.append((flat[0], flat[0].centre))
    return [
        Interface(f"I{k}", (f.number,), place, kind, "", f.direction, f.on_axis, f.area)
        for k, ((f, place), kind) in enumerate(zip(chosen, kinds, strict=True))
    ]


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
                # The axis, found anew: bores in these tests run along z.
                assert abs(axis[2]) == pytest.approx(1.0)
                centre = np.linalg.lstsq(
                    np.column_stack([2 * away[:, :2], np.ones(len(away))]),
                    (away[:, :2] ** 2).sum(axis=1),
                    rcond=None,
                )[0][:2]
                radial = away[:, :2] - centre
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


@pytest.mark.parametrize(
    "kinds",
    [
        ("pin", "rigid", "average"),
        *(pytest.param((kind, kind), marks=pytest.mark.exhaustive) for kind in KINDS),
    ],
)
def test_the_compliance_is_that_of_lagrange_multipliers(lug, kinds):
    part, found = lug
    grips = grips_of(part.mesh, interfaces(found, kinds))
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
    part, found = lug
    grips = grips_of(part.mesh, interfaces(found, (kind, kind)))
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


def test_an_averaged_bore_moves_as_the_means_of_a_field_by_hand(lug):
    """u_z = x² moves it by ∫x²/A = r²/2; u_x = z³ turns it about y by ∫z⁴/∫(x² + z²)."""
    part, found = lug
    grips = grips_of(part.mesh, interfaces(found, ("average", "average")))
    solid = coupled_solid(
        part.stiffness, on_three_components(part.scalar_mass), part.mesh.nodes, grips
    )
    away = part.mesh.nodes - grips[0].point
    fields = np.zeros((len(away), 3, 2))
    fields[:, 2, 0], fields[:, 0, 1] = away[:, 0] ** 2, away[:, 2] ** 3
    radius, top = 0.008, 0.015
    turned = top**4 / 5.0 / (top**2 / 3.0 + radius**2 / 2.0)
    means = solid.twists[:, :6].T @ fields.reshape(-1, 2)
    # Circles of nine quadratic sides: off by 2e-5 and 2e-4.
    assert means[:3, 0] / radius**2 == pytest.approx([0.0, 0.0, 0.5], abs=2e-4)
    assert means[3:, 1] / turned == pytest.approx([0.0, 1.0, 0.0], abs=2e-3)


def test_rigid_is_stiffer_than_a_pin_and_than_an_average(lug):
    part, found = lug
    rigid, *softer = (
        held_part(part, grips_of(part.mesh, interfaces(found, (k, k))), "lug").compliance
        for k in ("rigid", "average", "pin")
    )
    # Fewer ties, more energy under the same load: differences are positive semidefinite.
    for other in softer:
        scale = 1.0 / np.sqrt(np.diag(other))
        assert np.linalg.eigvalsh((other - rigid) * np.outer(scale, scale))[0] > -1e-9


def test_mass_properties_of_the_mesh_are_those_of_the_drawing(lug):
    part, _ = lug
    found = part.properties()
    volume = 0.2 * 0.04 * 0.03 - np.pi * 0.03 * (0.008**2 + 0.005**2)
    # 1e-4: circles of nine quadratic sides, some of them straightened.
    assert found.mass == pytest.approx(7850.0 * volume, rel=1e-4)
    away = np.pi * 0.03 * 0.08 * (0.008**2 - 0.005**2) / volume
    assert found.centre == pytest.approx([0.1 + away, 0.0, 0.0], abs=1e-6)
