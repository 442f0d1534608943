"""Waves in an infinitely long prism by 3-D elasticity, on the mesh of its section.

Standing waves u_x = a(y,z) cos kx, (u_y, u_z) = b(y,z) sin kx lead to a real symmetric eigenvalue
problem on the section (semi-analytical finite elements; Gavrić, J. Sound Vib. 185 (1995) 531). For
k → 0 the lowest torsional wave is Saint-Venant's, ω = k√(GJ/ρI_p). The excess at finite k is due to
stiffness and inertia of warping, of relative order (k · side)².
"""

import numpy as np
from scipy.linalg import eigh

from fem.sections.saint_venant import SectionQuadrature, section_quadrature
from lumped.arrays import Array
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh


def torsion_wave(mesh: SectionMesh, material: Material, wave_number: float) -> float:
    """Angular frequency (rad/s) of the torsional wave with `wave_number` k (rad/m).

    Among the lowest waves, it is the one whose motion is closest to a rotation of the section.
    """
    quad = section_quadrature(mesh)
    motion = _rotation(mesh, quad)
    stiffness, mass = stiffness_matrix(quad, material, wave_number), mass_matrix(quad, material.rho)
    # Two waves of bending, tension and torsion are the four lowest. Two more are computed because
    # higher waves may have lower frequencies at some k.
    values, shapes = eigh(stiffness, mass, subset_by_index=[0, 5])
    share = np.square(shapes.T @ mass @ motion) / (motion @ mass @ motion)
    return float(np.sqrt(values[np.argmax(share)]))


def _rotation(mesh: SectionMesh, quad: SectionQuadrature) -> Array:
    y, z = (mesh.nodes - quad.centroid).T
    return np.column_stack([np.zeros_like(y), -z, y]).ravel()


def stiffness_matrix(quad: SectionQuadrature, material: Material, k: float) -> Array:
    """Stiffness matrix (3N×3N) of a standing wave with the wave number k (rad/m), per length.

    It gives twice the strain energy, averaged along the prism. The unknowns of each node are (a,
    b_y, b_z).
    """
    field = strains(quad, k)
    moduli = elasticity(material)
    local = np.einsum("mqsi,st,mqtj,mq->mij", field, moduli, field, quad.weights, optimize=True)
    return assembled(quad, local)


def strains(quad: SectionQuadrature, k: float) -> Array:
    """Amplitudes (M×Q×6×3n) of the strains for unit unknowns of a cell, at the quadrature points.

    The strains are (εxx, εyy, εzz, γyz, γxz, γxy). The 3n unknowns are (a, b_y, b_z) of the n nodes
    of a cell. `k` (rad/m) is the wave number.
    """
    cells, points = quad.weights.shape
    count = len(quad.shapes)
    along_y, along_z = (quad.gradients[:, :, i].transpose(0, 2, 1) for i in (0, 1))
    shape = np.broadcast_to(quad.shapes.T, (cells, points, count))
    amplitudes = np.zeros((cells, points, 6, count, 3))
    amplitudes[:, :, 0, :, 0] = -k * shape
    amplitudes[:, :, 1, :, 1] = along_y
    amplitudes[:, :, 2, :, 2] = along_z
    amplitudes[:, :, 3, :, 1], amplitudes[:, :, 3, :, 2] = along_z, along_y
    amplitudes[:, :, 4, :, 0], amplitudes[:, :, 4, :, 2] = along_z, k * shape
    amplitudes[:, :, 5, :, 0], amplitudes[:, :, 5, :, 1] = along_y, k * shape
    return amplitudes.reshape(cells, points, 6, 3 * count)


def cell_matrices(quad: SectionQuadrature, moduli: Array) -> tuple[Array, Array, Array]:
    """Matrices E₀, E₁, E₂ (M×3n×3n) of each cell, ∫ ε·σ dA = u′E₀u′ + 2u′E₁u + uE₂u.

    `moduli` is one elasticity matrix (6×6), or one at each quadrature point (M×Q×6×6).
    """
    in_section = strains(quad, 0.0)
    along = strains(quad, 1.0) - in_section
    # The sign is reversed because axial strain is −k a in `strains` (standing wave), but u_x′ here.
    along[:, :, 0] *= -1.0
    product = "mqsi,st,mqtj,mq->mij" if moduli.ndim == 2 else "mqsi,mqst,mqtj,mq->mij"
    e0, e1, e2 = (
        np.einsum(product, left, moduli, right, quad.weights, optimize=True)
        for left, right in ((along, along), (along, in_section), (in_section, in_section))
    )
    return e0, e1, e2


def elasticity(material: Material) -> Array:
    """Elasticity matrix (6×6, in Pa) of a material with cubic symmetry."""
    E, nu = material.E, material.nu
    lame = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = lame + E / (1.0 + nu) * np.eye(3)
    matrix[3:, 3:] = material.G * np.eye(3)
    return matrix


def mass_matrix(quad: SectionQuadrature, rho: float | Array) -> Array:
    """Mass matrix per length (3N×3N, kg/m) for displacements that are constant along the leg.

    `rho` (kg/m³) is the density of all cells, or an array (M) with the density of each.
    """
    weights = np.reshape(rho, (-1, 1)) * quad.weights
    scalar = np.einsum("iq,jq,mq->mij", quad.shapes, quad.shapes, weights)
    cells, count, _ = scalar.shape
    blocks = np.einsum("mij,ab->miajb", scalar, np.eye(3))
    return assembled(quad, blocks.reshape(cells, 3 * count, 3 * count))


def assembled(quad: SectionQuadrature, local: Array) -> Array:
    """Matrix (3N×3N) that is the sum of the matrices `local` (M×3n×3n) of all M cells."""
    unknowns = (3 * quad.mesh.cells[:, :, None] + np.arange(3)).reshape(len(local), -1)
    matrix = np.zeros((3 * len(quad.mesh.nodes),) * 2)
    np.add.at(matrix, (unknowns[:, :, None], unknowns[:, None, :]), local)
    return matrix
