"""Solid elements in plates and membranes: NAFEMS benchmarks, Rayleigh–Lamb waves, Navier.

Robots have no symmetry planes and no supports along edges: unknowns of the meshes are fixed here.
Stiffness and mass are those of parts and legs. Eigenvalues are computed by scipy.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh, spsolve

from fem.bodies.part import pressure_forces
from fem.elasticity import on_three_components, stiffness_and_mass
from lumped.legs import Material
from meshes.elements import ELEMENTS
from meshes.part.boundary import area_vectors, boundary
from meshes.solid_mesh import VolumeMesh

# Material of the NAFEMS tests.
STEEL = Material.isotropic(2.0e11, 0.3, 8000.0)
# Side and thickness (m) of the thick plates.
SIDE, THICKNESS = 10.0, 1.0


def block(element, counts):
    """Cells of a block of `counts` elements along x, y, z, and node coordinates from 0 to 1."""
    kind, sizes = ELEMENTS[element], 2 * np.array(counts) + 1
    corners = 2 * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), -1)
    places = corners.reshape(-1, 1, 3) + np.rint(2 * kind.nodes).astype(int)
    numbers = np.ravel_multi_index(tuple(np.moveaxis(places, -1, 0)), sizes)
    used, cells = np.unique(numbers, return_inverse=True)
    shares = np.stack(np.unravel_index(used, sizes), axis=1) / (sizes - 1)
    return cells.reshape(numbers.shape), shares


def frequencies(mesh, fixed_components, count):
    """Lowest frequencies (Hz) with the `fixed_components` (N×3, true or false) fixed."""
    stiffness, mass = stiffness_and_mass(mesh, STEEL)
    free = ~fixed_components.ravel()
    K, M = (
        csr_array(matrix)[free][:, free].tocsc()
        for matrix in (stiffness, on_three_components(mass))
    )
    # A shift below zero leaves rigid motions in the plane regular.
    squares = eigsh(K, count, M, sigma=-1e3, return_eigenvectors=False, v0=np.ones(K.shape[0]))
    return np.sqrt(np.abs(np.sort(squares))) / (2.0 * np.pi)


def quarter(element, counts):
    """Quarter plate: simply supported sides x = 0 and y = 0, fixed along themselves and along z."""
    cells, shares = block(element, counts)
    fixed_components = np.zeros_like(shares, dtype=bool)
    x, y, _ = shares.T
    fixed_components[(x == 0.0) | (y == 0.0), 2] = True
    fixed_components[(x == 0.0) | (y == 1.0), 1] = True
    fixed_components[(y == 0.0) | (x == 1.0), 0] = True
    nodes = shares * [SIDE / 2.0, SIDE / 2.0, THICKNESS]
    return VolumeMesh(nodes, cells, element), fixed_components


def test_tapered_membrane_has_frequencies_of_fv32():
    """NAFEMS, Selected Benchmarks for Natural Frequency Analysis (1987), Test FV32.

    A membrane 10 m long, 5 m wide where it is clamped, 1 m at its end. Held in its middle plane
    and free to become thinner, the solid is in plane stress. The values are those of the test.
    """
    cells, shares = block("hex27", (12, 6, 1))
    x = 10.0 * shares[:, 0]
    y, z = (5.0 - 0.4 * x) * (shares[:, 1] - 0.5), 0.05 * (shares[:, 2] - 0.5)
    fixed_components = np.zeros_like(shares, dtype=bool)
    fixed_components[x == 0.0, :2] = True
    fixed_components[z == 0.0, 2] = True
    computed = frequencies(
        VolumeMesh(np.column_stack([x, y, z]), cells, "hex27"), fixed_components, 6
    )
    # 0.02 % in f4 and 0.07 % in f5 on this mesh; the limits of finer ones are 0.01 to 0.05 % below.
    assert computed == pytest.approx([44.623, 130.03, 162.70, 246.05, 379.90, 391.44], rel=1e-3)


def test_solid_plate_has_frequencies_of_fv52():
    """NAFEMS Test FV52: a thick square plate, 4 × 4 × 1 elements, supported at its lower edges.

    The targets of the test are those of plates. A line support of a solid becomes softer without
    limit on finer meshes: the first bending frequency is 2.4 % below its target here, and 5 % on
    12 × 12 × 2 elements. Other programs with the same elements are the reference: OptiStruct's
    verification, OS-V 0455, gives 0.9760, 1.0101, 1.0017 and 1.0022 of the targets 45.897, 109.44,
    193.59 and 206.19 Hz for 20 nodes.
    """
    cells, shares = block("hex20", (4, 4, 1))
    fixed_components = np.zeros_like(shares, dtype=bool)
    x, y, z = shares.T
    fixed_components[(z == 0.0) & ((x % 1.0 == 0.0) | (y % 1.0 == 0.0)), 2] = True
    mesh = VolumeMesh(shares * [SIDE, SIDE, THICKNESS], cells, "hex20")
    computed = frequencies(mesh, fixed_components, 10)
    assert np.abs(computed[:3]).max() < 0.01
    targets = computed[[3, 4, 5, 7, 8, 9]] / [45.897, 109.44, 109.44, 193.59, 206.19, 206.19]
    # Four digits are printed.
    assert targets == pytest.approx([0.9760, 1.0101, 1.0101, 1.0017, 1.0022, 1.0022], abs=1e-4)


def test_thick_plate_bends_as_a_rayleigh_lamb_wave():
    """Exact elasticity of simply supported sides: the antisymmetric wave of k² = 2(π/a)².

    Its sides move along their normals alone, where the normal stress is zero: the first bending
    mode is a standing Rayleigh–Lamb wave, (q² − k²)² tan ph/p = −4k²q tan qh (Graff, Wave Motion in
    Elastic Solids, §8.1) with half the thickness h, p² = ω²/c_L² − k² and q² = ω²/c_T² − k².
    """
    rho, nu = STEEL.rho, STEEL.nu
    longitudinal = STEEL.E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / rho
    k2, h = 2.0 * (np.pi / SIDE) ** 2, THICKNESS / 2.0

    def excess(frequency):
        squared = (2.0 * np.pi * frequency) ** 2
        p = np.emath.sqrt(squared / longitudinal - k2)
        q = np.emath.sqrt(squared * rho / STEEL.G - k2)
        bending = (q**2 - k2) ** 2 * np.sin(p * h) * np.cos(q * h) / p
        return np.real(bending + 4.0 * k2 * q * np.sin(q * h) * np.cos(p * h))

    exact = brentq(excess, 20.0, 80.0)
    coarse, fine = (
        frequencies(*quarter("hex27", counts), 1)[0] for counts in ((2, 2, 1), (4, 4, 2))
    )
    # 0.76 % and 0.053 %: the fourth order, and the limit that it gives.
    assert np.log2((coarse - exact) / (fine - exact)) == pytest.approx(4.0, abs=0.3)
    assert fine - (coarse - fine) / 15.0 == pytest.approx(exact, rel=1e-4)


def test_plate_under_pressure_bends_as_by_reissner():
    """Navier's series of D∇⁴w = p − (2 − ν)t²/(10(1 − ν)) ∇²p in the middle of the plate.

    E. Reissner, J. Appl. Mech. 12 (1945): w is the mean over the thickness with the weight of the
    shear stress, 1 − 4z²/t².
    """
    pressure = 1.0e6
    mesh, fixed_components = quarter("hex27", (4, 4, 2))
    facets = boundary(mesh)
    up = area_vectors(mesh.nodes, facets)
    top = facets.at(np.flatnonzero(up[:, 2] > 0.5 * np.linalg.norm(up, axis=1)))
    forces = np.zeros_like(mesh.nodes)
    forces[top.nodes] = pressure * pressure_forces(mesh.nodes, top)
    free = ~fixed_components.ravel()
    stiffness = csr_array(stiffness_and_mass(mesh, STEEL)[0])[free][:, free].tocsc()
    displacements = np.zeros(mesh.nodes.size)
    displacements[free] = spsolve(stiffness, forces.ravel()[free])
    across = np.flatnonzero((mesh.nodes[:, :2] == SIDE / 2.0).all(axis=1))
    across = across[np.argsort(mesh.nodes[across, 2])]
    # Simpson's rule over the five nodes, with the weights 0, ¾, 1, ¾, 0.
    mean = np.array([0.0, 3.0, 2.0, 3.0, 0.0]) / 8.0 @ displacements.reshape(-1, 3)[across, 2]

    odd = np.arange(1.0, 40.0, 2.0)
    k2 = (np.pi / SIDE) ** 2 * np.add.outer(odd**2, odd**2)
    signs = np.multiply.outer(*[(-1.0) ** ((odd - 1) / 2) / odd] * 2)
    nu = STEEL.nu
    bending = STEEL.E * THICKNESS**3 / (12.0 * (1.0 - nu**2))
    shear = (2.0 - nu) * THICKNESS**2 / (10.0 * (1.0 - nu))
    series = 16.0 * pressure / np.pi**2 * (signs * (1.0 / k2 + shear) / (bending * k2)).sum()
    # Of the mesh, as its lowest frequency squared.
    assert -mean == pytest.approx(series, rel=2e-3)
