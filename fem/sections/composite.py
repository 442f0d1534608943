"""Saint-Venant's states of a prism of several materials, by finite elements on its section.

A prism obeys E₀u″ + Gu′ − E₂u = 0 with the 3N displacements u of a section (semi-analytical finite
elements, see `fem.couplings.section_fields`). Its polynomial solutions are tension, torsion, pure
bending in two planes and flexure by two transverse forces; parts of different Poisson's ratios
strain each other in them. Coefficients a_k of x^k/k! follow from the rigid motion of the highest
power downwards, E₂a_k = E₀a_{k+2} + Ga_{k+1} (V. Giavotto et al., Computers & Structures 16 (1983)
403, has the same six states for any anisotropic section). Unit wrenches on a section are sums of
the states. Their strain energies per length are the 6×6 compliance of the beam.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, coo_array, csc_array
from scipy.sparse.linalg import splu

from fem.sections.saint_venant import SectionQuadrature, section_quadrature
from fem.sections.waveguide import elasticity, strains
from lumped.arrays import Array, SparseMatrix
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Degree of the polynomial of each rigid motion that strains no section by itself: tension from a
# displacement along x, bending and flexure from one along y and along z, torsion from a rotation.
_DEGREES = ((0, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 1))


@dataclass(frozen=True, eq=False)
class WrenchStates:
    """States of unit wrenches (x y z φx φy φz) on a section about the origin of its mesh.

    `tractions` (3N×6): nodal forces. `compliance` (6×6, in 1/N, 1/(N m), 1/(N m²)): strains per
    length of a beam, conjugate to the wrenches.
    """

    tractions: Array
    compliance: Array


def wrench_states(mesh: SectionMesh, materials: Sequence[Material]) -> WrenchStates:
    """States of unit wrenches on a section `mesh` whose regions have the given `materials`."""
    quad = section_quadrature(mesh)
    E0, E1, E2 = _matrices(quad, materials)
    coupling = E1 - E1.T
    y, z = mesh.nodes.T
    motions = np.zeros((len(y), 3, 6))
    motions[:, :, :3] = np.eye(3)
    motions[:, 0, 4], motions[:, 0, 5] = z, -y
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    rigid = motions.reshape(-1, 6)
    null = rigid[:, :4]
    means = null.T @ E0
    bordered = splu(block_array([[E2, null], [means, np.zeros((4, 4))]], format="csc"))
    warpings, slopes = [], []
    for motion, degree in _DEGREES:
        terms = [null[:, motion], np.zeros(len(null))]
        for _ in range(degree):
            load = E0 @ terms[1] + coupling @ terms[0]
            terms.insert(0, bordered.solve(np.append(load, np.zeros(4)))[: len(null)])
        # At x = 0: the lowest term and its slope, the next one.
        warpings.append(terms[0])
        slopes.append(terms[1])
    warping, slope = np.column_stack(warpings), np.column_stack(slopes)
    forces = E0 @ slope + E1 @ warping
    to_wrenches = np.linalg.inv(rigid.T @ forces)
    energies = slope.T @ forces + warping.T @ (E1.T @ slope + E2 @ warping)
    compliance = to_wrenches.T @ energies @ to_wrenches
    return WrenchStates(forces @ to_wrenches, 0.5 * (compliance + compliance.T))


def composite_tractions(mesh: SectionMesh, materials: Sequence[Material]) -> Array:
    """Nodal forces (3N×6) of unit wrenches on a section of several materials."""
    return wrench_states(mesh, materials).tractions


def _matrices(
    quad: SectionQuadrature, materials: Sequence[Material]
) -> tuple[SparseMatrix, SparseMatrix, SparseMatrix]:
    """E₀, E₁, E₂ (csc 3N×3N): ∫ ε·σ = u′E₀u′ + 2u′E₁u + uE₂u."""
    in_section = strains(quad, 0.0)
    along = strains(quad, 1.0) - in_section
    # The standing wave's axial strain is −k a: here it is u_x′.
    along[:, :, 0] *= -1.0
    regions = quad.mesh.regions
    D = np.array([elasticity(material) for material in materials])
    moduli = D[np.zeros(len(quad.mesh.cells), dtype=int) if regions is None else regions]
    E0, E1, E2 = (
        _assembled(
            quad,
            np.einsum("mqsi,mst,mqtj,mq->mij", left, moduli, right, quad.weights, optimize=True),
        )
        for left, right in ((along, along), (along, in_section), (in_section, in_section))
    )
    return E0, E1, E2


def _assembled(quad: SectionQuadrature, local: Array) -> SparseMatrix:
    unknowns = (3 * quad.mesh.cells[:, :, None] + np.arange(3)).reshape(len(local), -1)
    rows, columns = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    size = 3 * len(quad.mesh.nodes)
    places = rows.ravel(), columns.ravel()
    return csc_array(coo_array((local.ravel(), places), shape=(size, size)))
