"""A clamped leg solved by CalculiX, as an independent check of the solid model.

The deck is the leg with rigid end faces (`fem.couplings.grips`): clamped root, and the tip as a
rigid body under six unit wrenches. Both programs solve the same equations except for one integral.
CalculiX computes the mass of its element C3D10 with the four quadrature points of the stiffness,
which are too few for the products N_a N_b of shape functions. `mass_at_stiffness_points` computes
the mass in the same way. The difference from the exact mass vanishes with decreasing element size.

For the comparison of whole mechanisms with CalculiX and other programs, the legs are represented by
solid bars of their outer dimensions, which have coarse meshes.
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
from lumped.errors import InputError
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import Rectangle
from meshes.prism import tetrahedra
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import SolidMesh, VolumeMesh

# Polynomial degree for which the four stiffness points of C3D10 are exact.
_STIFFNESS_POINTS_DEGREE = 2


def leg_deck(mesh: SolidMesh, material: Material, modes: int = 20) -> Deck:
    """Deck of a leg with rigid end faces and clamped root: statics and `modes` modes.

    The load cases are six unit wrenches at (L, 0, 0). The last two nodes represent translation and
    rotation of the tip. Their displacements are printed.
    """
    point = np.array([mesh.length, 0.0, 0.0])
    translation, rotation = len(mesh.nodes), len(mesh.nodes) + 1
    twist: list[Freedom] = [(node, i) for node in (translation, rotation) for i in range(3)]
    tip = mesh.tip.nodes
    # Each node of the tip has the displacement u = u_ref + φ × r.
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
    """Tip compliance (6×6, SI, leg axes, at (L, 0, 0)) and natural frequencies (Hz) by CalculiX.

    Column j of the compliance is the twist under unit wrench j. Its values are those that CalculiX
    prints, with seven digits. They are not made symmetric. Raises errors as `run_calculix` does.
    """
    results = run_calculix(leg_deck(mesh, material, modes))
    return results.displacements.reshape(6, 6).T, results.frequencies


def mass_at_stiffness_points(mesh: VolumeMesh, rho: float) -> SparseMatrix:
    """Mass matrix (csr 3N×3N, in kg) of tet10 summed at its stiffness points, as in CalculiX.

    M = Nᵀ diag(ρ w det J) N, with the shape functions N (points × nodes) at all points and the
    quadrature weights w. It is too inaccurate for models of legs, but needed to compare frequencies
    with CalculiX to the last digit. `rho` is the density (kg/m³).
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
    """Posture in which each prismatic leg is a solid bar of its outer dimensions."""
    bodies = {
        name: replace(body, shape=replace(shape, section=Rectangle(*shape.section.extent)))
        if isinstance(shape := body.shape, ConstantLeg)
        else body
        for name, body in posture.mechanism.bodies.items()
    }
    return replace(posture, mechanism=replace(posture.mechanism, bodies=bodies))


def bar_solids(mechanism: Mechanism) -> dict[str, SolidLeg]:
    """Solid model of each leg of a mechanism, by name of the leg, on a coarse mesh.

    The mesh consists of second-order tetrahedra, one across the section. A leg given by its 6×6
    compliance is replaced by its equivalent prism (`lumped.equivalent_leg`). Equal legs share one
    model. The mass is summed over the points that CalculiX uses. Raises InputError for a tapered,
    stepped or curved leg.
    """
    solid_of_leg: dict[ConstantLeg, SolidLeg] = {}
    solids = {}
    for name, described in legs_of(mechanism).items():
        if isinstance(described, LineLeg):
            raise InputError(
                "meshes of tetrahedra are available only for straight legs of constant section",
                part=name,
            )
        leg = equivalent_leg(described)
        if leg not in solid_of_leg:
            solid = solid_leg(leg, tetrahedra(leg.section, leg.length, 1))
            mass = mass_at_stiffness_points(solid.mesh, leg.material.rho)
            solid_of_leg[leg] = replace(solid, mass=mass)
        solids[name] = solid_of_leg[leg]
    return solids
