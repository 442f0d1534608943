"""Stresses of a solid at its nodes, from the displacements of its nodes.

The stress at a node is the mean of the stresses there in all elements that contain the node. For
elements of second order, the error is of second order in the element size. Stresses grow without
bound towards a sharp re-entrant edge and towards the edge of a rigid face. Values within a given
distance of such an edge are therefore not results (`away_from`).
"""

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from lumped.legs import Material
from meshes.elements import ELEMENTS
from meshes.shape_functions import gradients
from meshes.solid_mesh import VolumeMesh

# Components of a stress.
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
_PAIRS = ((0, 1), (1, 2), (0, 2))


def nodal_stresses(mesh: VolumeMesh, material: Material, displacements: Array) -> Array:
    """Stresses (N×6, Pa; xx, yy, zz, xy, yz, xz) from nodal displacements (N×3, in m), body axes.

    The material is cubic along these axes.
    """
    cells, nodes = mesh.cells, mesh.nodes
    local = gradients(mesh.element, ELEMENTS[mesh.element].nodes.T)
    total, counts = np.zeros((len(nodes), 6)), np.bincount(cells.ravel(), minlength=len(nodes))
    corners, cell_displacements = nodes[cells], displacements[cells]
    for corner in range(cells.shape[1]):
        slopes = local[:, :, corner]
        jacobian = np.einsum("mki,kj->mij", corners, slopes, optimize=True)
        by_reference = np.einsum("mki,kj->mij", cell_displacements, slopes, optimize=True)
        # ∂u/∂x = ∂u/∂ξ (∂x/∂ξ)⁻¹.
        gradient = by_reference @ np.linalg.inv(jacobian)
        stress = _stress(gradient, material)
        for component in range(6):
            total[:, component] += np.bincount(
                cells[:, corner], stress[:, component], minlength=len(nodes)
            )
    return np.asarray(total / counts[:, None])


def _stress(gradient: Array, material: Material) -> Array:
    """Stresses (M×6, Pa; xx, yy, zz, xy, yz, xz) from displacement gradients (M×3×3)."""
    E, G, nu = material.E, material.G, material.nu
    direct = np.einsum("mii->mi", gradient)
    volume = direct.sum(axis=1, keepdims=True)
    normal = E / (1.0 + nu) * (direct + nu / (1.0 - 2.0 * nu) * volume)
    shear = [G * (gradient[:, i, j] + gradient[:, j, i]) for i, j in _PAIRS]
    return np.column_stack([normal, *shear])


def von_mises(stresses: Array) -> Array:
    """Von Mises stress (N values, Pa) of stresses (N×6, in Pa)."""
    xx, yy, zz, *shear = stresses.T
    differences = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * differences + 3.0 * sum(component**2 for component in shear)))


def away_from(nodes: Array, singular: IntArray, distance: float) -> Array:
    """Flags of `nodes` (N×3, in m): True if farther than `distance` (m) from all `singular` ones.

    `singular` contains the indices of nodes on edges where stresses have no bound.
    """
    if not len(singular):
        return np.ones(len(nodes), dtype=bool)
    return np.asarray(scipy.spatial.cKDTree(nodes[singular]).query(nodes)[0] > distance)
