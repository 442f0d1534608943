"""What a section's mesh adds to bending because it cannot contract as Poisson's ratio asks.

A bent prism curves its sections: with εxx = s, s = y or z from the centroid,

    s = y   u = −ν (½(y² − z²), yz)        s = z   u = −ν (yz, ½(z² − y²))

and σxx = E s is its only stress. Second-order cells with straight sides hold these fields; curved
ones hold them to O(h²) of strain, and their prism is too stiff by O(h⁴) of EI, G/E times more where
shear is stiff. A solid's mesh has the same error whatever the length of its elements.
"""

import numpy as np

from fem.sections.saint_venant import SectionQuadrature, solved_with, summed
from fem.sections.waveguide import elasticity
from lumped.arrays import Array
from lumped.legs import Material

# Of the strain ν s that is asked for: rounding of interpolation, beneath any error of a mesh.
_ROUNDING = 1e-12


def held_contraction(quad: SectionQuadrature, nu: float, shear_to_young: float) -> Array:
    """Symmetric 2×2 (m⁴) that a prism of this mesh has in bending over Σ = ∫ s sᵀ dA, s = (y, z).

    With the strains δε by which the interpolated fields miss the contraction, and r = ∫ BᵀCδε, it
    is (∫ δεᵀCδε − rᵀK⁻¹r)/E: positive semidefinite, without cancellation against Σ.
    """
    y, z = (quad.mesh.nodes - quad.centroid).T
    fields = -nu * np.array([[0.5 * (y**2 - z**2), y * z], [y * z, 0.5 * (z**2 - y**2)]])
    missed = np.array([_strains(quad, field) for field in fields])
    missed[:, :2] += nu * quad.points[:, None]
    largest = abs(nu) * np.abs(quad.points).max()
    if np.abs(missed).max() <= _ROUNDING * largest:
        return np.zeros((2, 2))
    material = Material(E=1.0, G=shear_to_young, nu=nu, rho=1.0)
    moduli = elasticity(material)[1:4, 1:4]
    stresses = np.einsum("st,ctmq->csmq", moduli, missed)
    energy = np.einsum("asmq,bsmq,mq->ab", missed, stresses, quad.weights, optimize=True)
    residual = np.column_stack([_forces(quad, stress) for stress in stresses])
    relaxed = _stiffness_solution(quad, moduli, residual)
    found = energy - residual.T @ relaxed
    return np.asarray(0.5 * (found + found.T))


def _strains(quad: SectionQuadrature, field: Array) -> Array:
    """(εyy, εzz, γyz) (3×M×Q) of displacements (2×N) in the section's plane."""
    (yy, yz), (zy, zz) = (quad.gradient(component) for component in field)
    return np.array([yy, zz, yz + zy])


def _forces(quad: SectionQuadrature, stress: Array) -> Array:
    """∫ Bᵀσ dA (2N, node by node) of stresses (3×M×Q)."""
    yy, zz, yz = stress
    along = [quad.gradient_load(np.array(row)) for row in ((yy, yz), (yz, zz))]
    return np.column_stack(along).ravel()


def _stiffness_solution(quad: SectionQuadrature, moduli: Array, forces: Array) -> Array:
    """Displacements (2N×m) in the plane under `forces` (2N×m) in equilibrium, K from `moduli`."""
    cells, nodes = quad.mesh.cells, quad.mesh.nodes
    gradients = quad.gradients
    operator = np.zeros((*gradients.shape[:2], 2, 3, gradients.shape[-1]))
    operator[:, :, 0, 0] = operator[:, :, 1, 2] = gradients[:, :, 0]
    operator[:, :, 1, 1] = operator[:, :, 0, 2] = gradients[:, :, 1]
    size = 2 * cells.shape[1]
    operator = operator.reshape(len(cells), size, 3, -1)
    blocks = np.einsum(
        "misq,st,mjtq,mq->mij", operator, moduli, operator, quad.weights, optimize=True
    )
    unknowns = (2 * cells[:, :, None] + np.arange(2)).reshape(len(cells), size)
    # Two nodes far apart hold the three rigid motions, which balanced forces do not stir.
    far = int(np.argmax(np.abs(nodes - nodes[0]).max(axis=1)))
    across = 1 - int(np.argmax(np.abs(nodes[far] - nodes[0])))
    return solved_with(summed(blocks, unknowns, len(forces)), forces, held=[0, 1, 2 * far + across])
