"""One prismatic leg as a solid: mesh → stiffness and mass → compliance, modes, leg matrices."""

from dataclasses import dataclass
from math import ceil
from typing import Literal, TypeAlias

import numpy as np
from scipy.sparse import csr_array, kron
from scipy.sparse.linalg import LinearOperator

from fem.couplings.end_coupling import FreeEnds, RigidEnds, free_ends, rigid_ends, rigid_motions
from fem.elements.elasticity import on_three_components, stiffness_and_mass
from fem.sections.saint_venant import section_quadrature
from fem.solvers.cholesky import analyse
from fem.solvers.factor import symmetric_product, upper_triangle
from fem.solvers.renewable_factor import RenewableFactor
from lumped.arrays import Array, SparseMatrix
from lumped.dense.balance import balanced_flexibility
from lumped.errors import InputError, naming
from lumped.legs import ConstantLeg
from lumped.mechanism.body_model import LegMatrices
from meshes.elements import ELEMENTS
from meshes.prism.extrude import extrude, stations
from meshes.section.section_blocks import Divisions
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import SolidMesh

Ends: TypeAlias = Literal["rigid", "free"]

# Length of a slice in elements of the section. Quadratic slices follow the cubic deflection of a
# tip load with a relative error of 0.08 (slice²/(b L))²: 1e-5 at four divisions and L = 5b.
_SLICE_ASPECT = 1.0


@dataclass(frozen=True, eq=False)
class SolidLeg:
    """A leg, its mesh, and the stiffness (csr 3N×3N, N/m) and mass (csr 3N×3N, kg) on it."""

    leg: ConstantLeg
    mesh: SolidMesh
    stiffness: SparseMatrix
    mass: SparseMatrix


def solid_mesh(
    leg: ConstantLeg, divisions: Divisions, section: Divisions | None = None
) -> SolidMesh:
    """Extruded mesh of a leg, `divisions` elements across the smaller side of its section.

    Slices are as long as these, also where the `section` has other divisions. Raises InputError
    where the leg or the divisions are impossible.
    """
    with naming(leg.name):
        require_leg(leg.section, leg.length, divisions)
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    size = min(leg.section.extent) / count
    slices = max(2, ceil(leg.length / (_SLICE_ASPECT * size)))
    face = section_mesh(leg.section, section or divisions, "quad9")
    return extrude(face, stations(leg.length, slices))


def solid_leg(leg: ConstantLeg, mesh: SolidMesh) -> SolidLeg:
    """Stiffness and mass of `leg` on `mesh`; raises ComputationError for folded elements."""
    with naming(leg.name):
        K, scalar_mass = stiffness_and_mass(mesh, leg.material)
    return SolidLeg(leg, mesh, K, on_three_components(scalar_mass))


@dataclass(frozen=True, eq=False)
class ClampedLeg:
    """A solid leg held at its root, factorised.

    Unknowns are those of `ends`: `mass` (n×n) is a sparse matrix or an operator, `factor` that of
    the stiffness (n×n), which is positive definite. `solid` is the leg before it was held; with
    rigid ends nothing needs it any more, and it is None.
    """

    mesh: SolidMesh
    ends: RigidEnds | FreeEnds
    mass: SparseMatrix | LinearOperator
    factor: RenewableFactor
    solid: SolidLeg | None


def clamped_leg(solid: SolidLeg, ends: Ends = "rigid") -> ClampedLeg:
    """The leg with its root held, `rigid` or `free` as in `fem.couplings.end_coupling`.

    Raises ComputationError where the stiffness cannot be factorised.
    """
    coupling = (
        rigid_ends(solid.mesh) if ends == "rigid" else free_ends(solid.mesh, solid.leg.material)
    )
    mesh, mass = solid.mesh, coupling.clamped_mass(solid.mass)
    stiffness = upper_triangle(coupling.clamped_stiffness(solid.stiffness))
    kept = solid if ends == "free" else None
    part = f"{solid.leg.name or 'leg'} as a solid, {ends} ends"
    # A caller that keeps no reference of its own has this memory for the factor.
    del solid
    symbolic = analyse(stiffness, coupling.leading_blocks)
    factor = RenewableFactor(symbolic, stiffness, part)
    # At once, so that a leg which cannot be held is refused here.
    _ = factor.numeric
    return ClampedLeg(mesh, coupling, mass, factor, kept)


def tip_compliance(clamped: ClampedLeg) -> Array:
    """6×6 compliance (SI, leg axes) at (L, 0, 0): six unit wrenches solved for together.

    C = Fᵀ K⁻¹ F is the twist that does work on the wrenches, symmetric by construction. Raises
    ComputationError where rounding leaves too little of it.
    """
    loads = clamped.ends.tip_loads()
    displacements = clamped.factor.solve(loads)
    forces = symmetric_product(clamped.factor.triangle, displacements)
    return balanced_flexibility(loads, displacements, forces, clamped.factor.part)


def solid_leg_matrices(solid: SolidLeg) -> LegMatrices:
    """The leg with rigid end faces as free leg matrices: (root 6, tip 6, interior nodes 3 each)."""
    ends = rigid_ends(solid.mesh)

    def centreline(at: Array) -> SparseMatrix:
        return csr_array(section_twists(solid.mesh, at) @ ends.transformation)

    return LegMatrices(
        model="solid",
        length=solid.leg.length,
        stiffness=ends.reduced(solid.stiffness),
        mass=ends.reduced(solid.mass),
        centreline=centreline,
    )


def section_twists(mesh: SolidMesh, at: Array) -> SparseMatrix:
    """Twists of the sections at stations `at` (m values, m) from u: csr 6m × 3N.

    Translations are means over the section, rotations come from first moments: φy and φz from
    those of u_x, φx from that of the displacement about the axis. In between planes of nodes the
    elements' own interpolation. Raises InputError for stations outside the leg and for a mesh that
    is not extruded.
    """
    if mesh.slices is None:
        raise InputError("section twists need an extruded mesh: tetrahedra have no planes of nodes")
    stations_at = np.asarray(at, dtype=float)
    if not np.all((stations_at >= 0.0) & (stations_at <= mesh.length)):
        raise InputError(f"stations must lie between 0 m and {mesh.length:g} m")
    order = ELEMENTS[mesh.element].order
    planes = mesh.nodes[:: len(mesh.root.nodes), 0]
    count = len(stations_at)
    first = order * np.clip(
        np.searchsorted(planes[::order], stations_at, side="right") - 1, 0, mesh.slices - 1
    )
    used = first[:, None] + np.arange(order + 1)
    weights = np.empty(used.shape)
    for local in range(order + 1):
        others = planes[np.delete(used, local, axis=1)]
        weights[:, local] = np.prod(
            (stations_at[:, None] - others) / (planes[used[:, [local]]] - others), axis=1
        )
    station = np.repeat(np.arange(count), order + 1)
    interpolation = csr_array(
        (weights.ravel(), (station, used.ravel())), shape=(count, len(planes))
    )
    return csr_array(kron(interpolation, csr_array(_section_twist(mesh.root.mesh)), format="csr"))


def _section_twist(mesh: SectionMesh) -> Array:
    """Twist about x (y = z = 0) of a section from the displacements of its nodes: 6 × 3n."""
    quad = section_quadrature(mesh)
    y, z = quad.points
    mean = quad.load(np.ones_like(y))
    first_y, first_z = quad.load(y), quad.load(z)
    twist = np.zeros((6, len(mesh.nodes), 3))
    for component in range(3):
        twist[component, :, component] = mean
    twist[3, :, 1], twist[3, :, 2] = -first_z, first_y
    twist[4, :, 0], twist[5, :, 0] = first_z, -first_y
    rows = twist.reshape(6, -1)
    # The moments of the six rigid motions are area and moments of area: dividing by them makes
    # the twist of a rigid motion that motion itself.
    points = np.column_stack([np.zeros(len(mesh.nodes)), mesh.nodes])
    return np.asarray(np.linalg.solve(rows @ rigid_motions(points, np.zeros(3)), rows))
