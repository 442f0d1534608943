"""A clamped leg solved by CalculiX: the independent judge of the solid model.

The deck is the leg with rigid end faces as in `fem.couplings.grips`: root held, tip a rigid
body under six unit wrenches. Both programs then solve the same equations, but for one integral:
CalculiX sums the mass of C3D10 over the four points of the stiffness, which are
too few for N_a N_b. `mass_at_stiffness_points` is that mass; the difference to the exact one
vanishes with the element size. Legs of a mechanism are given to it, and to other programs, as
solid bars of their outer size, whose meshes are coarse.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, diags_array, eye_array, kron

from fem.bodies.solid import SolidLeg, solid_leg
from fem.calculix.deck import Deck, ElementSet, Equation, Freedom
from fem.calculix.run import run_calculix
from fem.couplings.grips import rigid_motions
from lumped.arrays import Array, SparseMatrix
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import Rectangle
from meshes.prism import tetrahedra
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import SolidMesh, VolumeMesh

# Degree for which the four stiffness points of C3D10 are exact.
_STIFFNESS_POINTS_DEGREE = 2


def leg_deck(mesh: SolidMesh, material: Material, modes: int = 20) -> Deck:
    """A leg with rigid end faces, root clamped, six unit wrenches at (L, 0, 0), then its modes.

    The last two nodes are the tip's translation and rotation; both are watched.
    """
    point = np.array([mesh.length, 0.0, 0.0])
    translation, rotation = len(mesh.nodes), len(mesh.nodes) + 1
    twist: list[Freedom] = [(node, i) for node in (translation, rotation) for i in range(3)]
    tip = mesh.tip.nodes
    # u = u_ref + φ × r of every node of the tip.
    motions = rigid_motions(mesh.nodes[tip], point).reshape(-1, 3, 6)
    equations = tuple(
        Equation((int(node), i), tuple((twist[k], float(row[k])) for k in np.flatnonzero(row)))
        for node, motion in zip(tip, motions, strict=True)
        for i, row in enumerate(motion)
    )
    return Deck(
        title="clamped leg",
        nodes=np.vstack([mesh.nodes, point, point]),
        parts=(ElementSet(mesh.cells, mesh.element, material),),
        equations=equations,
        held=tuple((int(node), i) for node in mesh.root.nodes for i in range(3)),
        load_cases=tuple(((freedom, 1.0),) for freedom in twist),
        watched=(translation, rotation),
        modes=modes,
    )


def compliance_and_frequencies(
    mesh: SolidMesh, material: Material, modes: int = 20
) -> tuple[Array, Array]:
    """CalculiX's 6×6 tip compliance (SI, leg axes, at (L, 0, 0)) and frequencies (Hz) of a leg.

    Column j is the twist under unit wrench j, as printed: seven digits, not symmetrised. Raises
    as `run_calculix` does.
    """
    results = run_calculix(leg_deck(mesh, material, modes))
    return results.displacements.reshape(6, 6).T, results.frequencies


def mass_at_stiffness_points(mesh: VolumeMesh, rho: float) -> SparseMatrix:
    """Mass matrix (csr 3N×3N, kg) of tet10 summed over the stiffness points, as CalculiX does.

    M = Nᵀ diag(ρ w det J) N, with N (points × nodes) the shape functions at all points. Too coarse:
    a comparison of frequencies to the last digit needs it, a model of a leg should not use it.
    """
    points, weights = quadrature(mesh.element, _STIFFNESS_POINTS_DEGREE)
    shapes, slopes = values(mesh.element, points), gradients(mesh.element, points)
    jacobian = np.einsum("eai,ajq->eqij", mesh.nodes[mesh.cells], slopes, optimize=True)
    volumes = np.linalg.det(jacobian) * weights
    cells, per_cell = mesh.cells.shape
    rows = cells * len(weights)
    interpolation = csr_array(
        (
            np.tile(shapes.T, (cells, 1)).ravel(),
            np.repeat(mesh.cells, len(weights), axis=0).ravel(),
            np.arange(0, rows * per_cell + 1, per_cell),
        ),
        shape=(rows, len(mesh.nodes)),
    )
    scalar = interpolation.T @ diags_array(rho * volumes.ravel()) @ interpolation
    return csr_array(kron(scalar, eye_array(3), format="csr"))


def with_bars(posture: Posture) -> Posture:
    """The posture with every prism as a solid bar of its outer size, its ends rigid."""
    bodies = {
        name: replace(body, shape=replace(shape, section=Rectangle(*shape.section.extent)))
        if isinstance(shape := body.shape, ConstantLeg)
        else body
        for name, body in posture.mechanism.bodies.items()
    }
    return replace(posture, mechanism=replace(posture.mechanism, bodies=bodies))


def bar_solids(mechanism: Mechanism) -> dict[str, SolidLeg]:
    """Every leg by name on second-order tetrahedra, one across; alike ones are one object.

    Legs known by a 6×6 as their equivalents; mass is summed over the points that CalculiX sums it
    over.
    """
    solid_of_leg: dict[ConstantLeg, SolidLeg] = {}
    solids = {}
    for name, described in legs_of(mechanism).items():
        leg = equivalent_leg(described)
        if leg not in solid_of_leg:
            solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
            mass = mass_at_stiffness_points(solid.mesh, leg.material.rho)
            solid_of_leg[leg] = replace(solid, mass=mass)
        solids[name] = solid_of_leg[leg]
    return solids
