"""Nodal forces of pressures on faces of meshed parts: equilibrium, exact strains, CalculiX."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from support.robots.drawn_parts import meshed, read_here

from fem.bodies.part import forces_on_faces, meshed_part, wrenches_of_faces
from fem.calculix import run
from fem.calculix.deck import Deck, ElementSet, deck_text
from fem.calculix.run import calculix_version, run_calculix
from fem.couplings.grips import rigid_motions, unknowns
from lumped.legs import Material
from lumped.mechanism.body import ByCylinder, ByPlane
from meshes.elements import SIMPLEX_EDGES
from meshes.part.boundary import facets_of_cells
from meshes.part.interfaces import selected_faces

E, NU, PRESSURE = 2.1e11, 0.3, 4.0e6
STEEL = Material.isotropic(E, NU, 7850.0)
# Block with a through bore along z (m).
LENGTH, WIDTH, HEIGHT, RADIUS = 0.12, 0.05, 0.03, 0.012


def block(kernel):
    solid = kernel.addBox(0.0, -25.0, -15.0, 120.0, 50.0, 30.0)
    kernel.cut([(3, solid)], [(3, kernel.addCylinder(60, 0, -30, 0, 0, 60, 12))])


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return read_here(meshed(tmp_path_factory.mktemp("block") / "block.msh", block, 30.0, 8.0), "mm")


def resultants(mesh):
    """Forces and moments (6) of 1 Pa on each face about the origin, by face number."""
    return wrenches_of_faces(mesh, rigid_motions(mesh.nodes, np.zeros(3)))


def test_pressure_on_all_faces_is_in_equilibrium(file):
    """One pressure on all faces, bores included, has no resultant force and moment."""
    total = sum(resultants(file.mesh).values())
    # Round-off of sums over 200 facets; a single face has 1e-3 m² or more.
    assert np.abs(total).max() <= 1e-16


def test_pressure_on_plane_face_is_area_times_normal(file):
    """Pressure on an end of 50 × 30 mm: the resultant is inward, through the end's centre."""
    (end,) = selected_faces(file, ByPlane((1.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)))
    wrench = resultants(file.mesh)[end.number]
    assert wrench == pytest.approx([-WIDTH * HEIGHT, 0, 0, 0, 0, 0], abs=1e-15)


def test_pressure_in_bore_has_no_resultant(file):
    """Pressure in a bore between parallel faces: opposite strips of the wall are in balance."""
    bore = selected_faces(file, ByCylinder(RADIUS))
    wrenches = np.array([resultants(file.mesh)[face.number] for face in bore])
    # Chords of second order replace the circle, whose midpoints lie on it to 1e-9.
    assert np.abs(wrenches.sum(axis=0)).max() <= 1e-9 * 2.0 * RADIUS * HEIGHT
    forces = forces_on_faces(file.mesh, dict.fromkeys((face.number for face in bore), 1.0))
    outward = file.mesh.nodes - [0.06, 0.0, 0.0]
    virial = np.sum(forces.reshape(-1, 3)[:, :2] * outward[:, :2])
    # ∫ p r dA = p r · 2πrh pushes from the axis into the wall.
    assert virial == pytest.approx(2.0 * np.pi * RADIUS**2 * HEIGHT, rel=1e-3)


@pytest.fixture(scope="module")
def straight(file):
    """Return the same mesh with straight edges, whose elements contain uniform strains exactly."""
    mesh, nodes = file.mesh, file.mesh.nodes.copy()
    corners = mesh.cells[:, :4]
    for middle, ends in zip(mesh.cells[:, 4:].T, SIMPLEX_EDGES[4], strict=True):
        nodes[middle] = nodes[corners[:, ends]].mean(axis=1)
    return meshed_part("part", replace(mesh, nodes=nodes), STEEL)


def test_hydrostatic_pressure_strains_uniformly(straight):
    """u = −p(1 − 2ν)/E x balances p on all faces, holes included: K u = f."""
    mesh = straight.mesh
    forces = forces_on_faces(mesh, dict.fromkeys(mesh.faces, PRESSURE))
    shrunk = -PRESSURE * (1.0 - 2.0 * NU) / E * mesh.nodes.ravel()
    # Entries of K cancel to 1e-12 of themselves.
    np.testing.assert_allclose(straight.stiffness @ shrunk, forces, atol=1e-9 * forces.max())


def test_pressures_move_block_as_in_calculix(file, straight, monkeypatch):
    """*DLOAD on the same elements: pressures on an end, a side and the bore; other end clamped."""
    if calculix_version() is None:
        pytest.skip("CalculiX is not installed")
    mesh = straight.mesh
    pressures = {1.0: ByPlane((1.0, 0.0, 0.0), (LENGTH, 0.0, 0.0)), -3.0: ByCylinder(RADIUS)}
    pressures[2.0] = ByPlane((0.0, 1.0, 0.0), (0.0, WIDTH / 2.0, 0.0))
    on_faces = {
        face.number: PRESSURE * factor
        for factor, selection in pressures.items()
        for face in selected_faces(file, selection)
    }
    clamped = np.flatnonzero(np.abs(mesh.nodes[:, 0]) < 1e-9)
    free = np.setdiff1d(np.arange(3 * len(mesh.nodes)), unknowns(clamped))
    displacements = np.zeros(3 * len(mesh.nodes))
    forces = forces_on_faces(mesh, on_faces)
    displacements[free] = spsolve(straight.stiffness[free][:, free].tocsc(), forces[free])

    watched = np.flatnonzero(np.abs(mesh.nodes[:, 0] - LENGTH) < 1e-9)
    deck = Deck(
        "block",
        mesh.nodes,
        (ElementSet(mesh.cells, "tet10", STEEL),),
        held=tuple((int(node), i) for node in clamped for i in range(3)),
        load_cases=((),),
        watched=tuple(int(node) for node in watched),
    )
    loads = "\n".join(["*DLOAD", *dload_lines(mesh, on_faces)])
    text = deck_text(deck).replace("*CLOAD, OP=NEW", loads)
    monkeypatch.setattr(run, "deck_text", lambda _: text)
    (printed,) = run_calculix(deck).displacements
    # Seven printed digits.
    largest = np.abs(printed).max()
    assert np.abs(displacements.reshape(-1, 3)[watched] - printed).max() <= 1e-6 * largest


def dload_lines(mesh, pressures):
    """Lines of *DLOAD. Faces P1 to P4 of C3D10 are those of `facets_of_cells`, in its order."""
    facets, _ = facets_of_cells(mesh)
    sides = {tuple(sorted(side)): row for row, side in enumerate(facets.corners.tolist())}
    for number, pressure in pressures.items():
        for corners in mesh.faces[number].corners.tolist():
            element, side = divmod(sides[tuple(sorted(corners))], 4)
            yield f"{element + 1}, P{side + 1}, {pressure!r}"
