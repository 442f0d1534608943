"""A CAD part on one mesh: stiffness, mass, coupling to its interfaces, clamping and pressures.

The virtual work −p ∫ δu · n dA of a pressure p that pushes into the body gives the consistent nodal
forces f_a = −p ∫ N_a n dA. With facets x(ξ, η), n dA = ∂x/∂ξ × ∂x/∂η dξ dη is a polynomial, which
the quadrature integrates exactly on curved facets, too. The resultants are those of the facets: on
all faces of a closed body they vanish to round-off. The pressure keeps its direction when the body
deforms.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, eye_array

from fem.bodies.rooted import RootedBody, rooted_body
from fem.couplings.coupled_solid import CoupledSolid, coupled_solid
from fem.couplings.grips import Grip, Kind, rigid_motions, unknowns
from fem.elasticity import on_three_components, stiffness_and_mass
from fem.machine import available_memory
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.part.boundary import Facets, PartMesh
from meshes.part.interfaces import Interface
from meshes.shape_functions import gradients, quadrature, values

# Peak memory (bytes) of the factorisation for 150 000 unknowns, and the exponent with which it
# grows. Measured on parts meshed with tetrahedra.
_BYTES, _UNKNOWNS, _POWER = 1.6e9, 150e3, 1.4
# Degree of N_a n: at most 4 on triangles of second order, 5 in each coordinate on quadrilaterals.
_DEGREE = 5


@dataclass(frozen=True)
class MassProperties:
    """Mass (kg), mass centre (3, in m), and inertia about the mass centre (3×3, in kg m²).

    The axes are those of the mesh.
    """

    mass: float
    centre: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class MeshedPart:
    """A part on a mesh: `stiffness` (csr 3N×3N, in N/m) and `scalar_mass` (csr N×N, in kg).

    The axes are those of the part's file. The scalar mass applies to each component of
    displacement. `name` is used in messages.
    """

    name: str
    mesh: PartMesh
    material: Material
    stiffness: SparseMatrix
    scalar_mass: SparseMatrix

    def properties(self) -> MassProperties:
        """Mass, mass centre and inertia of the mesh, including its curved edges."""
        nodes, M = self.mesh.nodes, self.scalar_mass
        shares = M.sum(axis=0)
        mass = float(shares.sum())
        centre = shares @ nodes / mass
        moments = (nodes - centre).T @ (M @ (nodes - centre))
        return MassProperties(mass, centre, np.trace(moments) * np.eye(3) - moments)


def meshed_part(name: str, mesh: PartMesh, material: Material) -> MeshedPart:
    """Stiffness and mass matrices of a part on a mesh.

    Raises ComputationError for folded elements.
    """
    K, M = stiffness_and_mass(mesh, material)
    return MeshedPart(name, mesh, material, K, M)


def require_memory(unknowns: float, part: str) -> None:
    """Raise ComputationError if a mesh needs more than the available memory.

    `unknowns` is the mesh's number of displacement unknowns, `part` the name in the message.
    """
    needed = _BYTES * (unknowns / _UNKNOWNS) ** _POWER
    available = available_memory()
    if available is not None and needed > available:
        raise ComputationError(
            f"{unknowns:.0f} unknowns need about {needed / 1e9:.1f} GB and "
            f"{available / 1e9:.1f} GB are available; choose fewer unknowns",
            part=part,
        )


def grips_of(
    mesh: PartMesh, interfaces: Sequence[Interface], coupling: Kind | None = None
) -> tuple[Grip, ...]:
    """Faces of the mesh and kind of coupling for each interface of a part, in the same order.

    If `coupling` is not None, it replaces the coupling of each interface.
    """
    return tuple(
        Grip(
            coupling or interface.coupling,
            Facets(
                np.vstack([mesh.faces[number].cells for number in interface.faces]),
                mesh.faces[interface.faces[0]].element,
            ),
            interface.point,
            interface.axis,
            interface.on_axis,
        )
        for interface in interfaces
    )


def free_part(part: MeshedPart) -> RootedBody:
    """Part without interfaces. Its mean motion is fixed, and its stiffness is factorised.

    The mean motion of displacements u is weighted with the mass M: Bᵀu = (RᵀMR)⁻¹ RᵀMu, with the
    rigid motions R. It takes the place of the twist of a first interface. Raises errors as
    `rooted_body` does.
    """
    nodes, mass = part.mesh.nodes, on_three_components(part.scalar_mass)
    centre = part.properties().centre
    motions = rigid_motions(nodes, centre)
    momenta = np.asarray(mass @ motions)
    solid = CoupledSolid(
        stiffness=part.stiffness,
        mass=mass,
        transformation=csr_array(eye_array(3 * len(nodes), format="csr")),
        twists=np.linalg.solve(motions.T @ momenta, momenta.T).T,
        motions=motions,
        points=centre[None],
        places=nodes,
    )
    return rooted_body(solid, part.name)


def held_part(part: MeshedPart, grips: Sequence[Grip]) -> RootedBody:
    """Part clamped at its first interface, with factorised stiffness.

    `grips` are the faces and couplings of all interfaces. Raises errors as `rooted_body` does.
    """
    solid = coupled_solid(
        part.stiffness, on_three_components(part.scalar_mass), part.mesh.nodes, grips
    )
    return rooted_body(solid, part.name)


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
