"""Consistent nodal loads of a uniform pressure on faces of a solid.

The virtual work −p ∫ δu · n dA of a pressure p that pushes into the body gives the nodal forces
f_a = −p ∫ N_a n dA. With facets x(ξ, η), n dA = ∂x/∂ξ × ∂x/∂η dξ dη is a polynomial, which the
quadrature integrates exactly on curved facets, too. The resultants are those of the facets: on all
faces of a closed body they vanish to round-off. The pressure keeps its direction when the body
deforms.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from fem.couplings.grips import unknowns
from lumped.arrays import Array
from meshes.part.boundary import Facets, PartMesh
from meshes.shape_functions import gradients, quadrature, values

# Degree of N_a n: at most 4 on triangles of second order, 5 in each coordinate on quadrilaterals.
_DEGREE = 5


def pressure_forces(nodes: Array, facets: Facets) -> Array:
    """Nodal forces (n×3, in N) of a pressure of 1 Pa on `facets`.

    They act on the n nodes of the facets, in ascending order. `nodes` (N×3, in m) are those of the
    whole mesh.
    """
    points, weights = quadrature(facets.element, _DEGREE)
    shapes, slopes = values(facets.element, points), gradients(facets.element, points)
    tangents = np.einsum("fki,kjq->fqij", nodes[facets.cells], slopes)
    normals = np.cross(tangents[..., 0], tangents[..., 1])
    forces = -np.einsum("q,aq,fqi->fai", weights, shapes, normals, optimize=True)
    total = np.zeros((len(facets.nodes), 3))
    np.add.at(total, np.searchsorted(facets.nodes, facets.cells), forces)
    return total


def forces_on_faces(mesh: PartMesh, pressures: Mapping[int, float]) -> Array:
    """Nodal forces (3N, in N) of `pressures` (Pa, by face number) on a part with this `mesh`."""
    forces = np.zeros((len(mesh.nodes), 3))
    for number, pressure in pressures.items():
        facets = mesh.faces[number]
        forces[facets.nodes] += pressure * pressure_forces(mesh.nodes, facets)
    return forces.ravel()


def wrenches_of_faces(mesh: PartMesh, shapes: Array) -> dict[int, Array]:
    """Wrenches (6m) on the m interfaces that are equivalent to a pressure of 1 Pa on a face.

    The result contains them for each face, by face number. `shapes` Ψ (3N×6m) are the displacements
    of the nodes for unit twists of the interfaces. The wrenches Ψᵀf do the same work on these
    twists as the nodal forces f of the pressure, so that the displacements of the interfaces are
    exact.
    """
    return {
        number: pressure_forces(mesh.nodes, facets).ravel() @ shapes[unknowns(facets.nodes)]
        for number, facets in mesh.faces.items()
    }


def as_columns(wrenches: Mapping[int, Array]) -> tuple[Array, Array]:
    """Face numbers (F) and wrenches (F×6m) as two arrays, from `wrenches` by face number."""
    return np.array(list(wrenches)), np.array(list(wrenches.values()))


def from_columns(numbers: Array, wrenches: Sequence[Array] | Array) -> dict[int, Array]:
    """Wrenches by face number, from the two arrays that `as_columns` returns."""
    return dict(zip(numbers.tolist(), wrenches, strict=True))
