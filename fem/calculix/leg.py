"""A clamped leg solved by CalculiX, as an independent check of the solid model.

The deck is the leg with rigid end faces (`fem.couplings.grips`): clamped root, and the tip as a
rigid body under six unit wrenches. Both programs solve the same equations except for one integral.
CalculiX computes the mass of its elements C3D10 and C3D20 with the quadrature points of the
stiffness, which are too few for the products N_a N_b of shape functions. `mass_at_stiffness_points`
computes the mass in the same way. The difference from the exact mass vanishes with decreasing
element size.

For the comparison of whole mechanisms with CalculiX and other programs, the legs are represented by
solid bars of their outer dimensions, which have coarse meshes: tetrahedra for prisms, and bricks of
20 nodes for tapered, stepped and bent legs.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, diags_array, eye_array, kron

from fem.bodies.solid import SolidLeg, solid_leg, solid_mesh
from fem.calculix.deck import Deck, ElementSet, Equation, Freedom
from fem.calculix.run import run_calculix
from fem.couplings.grips import rigid_motions
from lumped.arrays import Array, SparseMatrix
from lumped.equivalent_leg import sectioned_leg
from lumped.legs import ConstantLeg, LineLeg, Material, SectionedLeg
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import legs_of
from lumped.sections import Circle, Rectangle, Section
from meshes.loft import why_no_loft
from meshes.prism import tetrahedra
from meshes.section.section_mesh import SectionMesh
from meshes.shape_functions import gradients, quadrature, values
from meshes.solid_mesh import EndFace, SolidMesh, VolumeMesh
from meshes.stepped import is_round

# Polynomial degree for which the stiffness points are exact: four of C3D10, 27 of C3D20.
_STIFFNESS_POINTS_DEGREE = {"tet10": 2, "hex20": 5}
# Nodes of the brick of 20 nodes among those of 27: corners, edges of both faces, edges along x.
_TWENTY = (0, 1, 2, 3, 18, 19, 20, 21, 4, 5, 6, 7, 22, 23, 24, 25, 9, 10, 11, 12)
# Nodes of the plane element of 8 nodes among those of 9.
_EIGHT = slice(0, 8)


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
    """Mass matrix (csr 3N×3N, in kg) of tet10 or hex20 at its stiffness points, as in CalculiX.

    M = Nᵀ diag(ρ w det J) N, with the shape functions N (points × nodes) at all points and the
    quadrature weights w. It is too inaccurate for models of legs, but needed to compare frequencies
    with CalculiX to the last digit. `rho` is the density (kg/m³).
    """
    points, weights = quadrature(mesh.element, _STIFFNESS_POINTS_DEGREE[mesh.element])
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


def of_twenty_nodes(mesh: SolidMesh) -> SolidMesh:
    """Mesh with bricks of 20 nodes, an element of CalculiX, in place of bricks of 27 nodes."""
    used, cells = np.unique(mesh.cells[:, _TWENTY], return_inverse=True)

    def end_face(face: EndFace) -> EndFace:
        kept, section_cells = np.unique(face.mesh.cells[:, _EIGHT], return_inverse=True)
        section = SectionMesh(
            face.mesh.nodes[kept], section_cells.reshape(len(face.mesh.cells), -1), "quad8"
        )
        return EndFace(np.searchsorted(used, face.nodes[kept]), section, face.axes)

    ends = end_face(mesh.root), end_face(mesh.tip)
    cells = cells.reshape(len(mesh.cells), -1)
    return SolidMesh(mesh.nodes[used], cells, "hex20", *ends, slices=None)


def with_bars(posture: Posture) -> Posture:
    """Posture in which each leg with sections is a solid bar of its outer dimensions."""
    bodies = {
        name: replace(body, shape=_bar(body.shape))
        if isinstance(body.shape, ConstantLeg | LineLeg)
        else body
        for name, body in posture.mechanism.bodies.items()
    }
    return replace(posture, mechanism=replace(posture.mechanism, bodies=bodies))


def _bar(leg: SectionedLeg) -> SectionedLeg:
    """Solid bar with the outer dimensions of a leg. Round sections of a line leg remain round."""
    if isinstance(leg, ConstantLeg):
        return replace(leg, section=Rectangle(*leg.section.extent))

    def filled(section: Section) -> Section:
        width, height = section.extent
        return Circle(width) if is_round(section) else Rectangle(width, height)

    stations = tuple((position, filled(section)) for position, section in leg.stations)
    return replace(leg, stations=stations)


def why_no_bars(bars: Mechanism) -> list[str]:
    """Reasons why legs of a mechanism of bars (`with_bars`) have no mesh. [] if all have one."""
    legs = legs_of(bars).values()
    reasons = [why_no_loft(leg) for leg in legs if isinstance(leg, LineLeg)]
    return [f"as a solid bar, {reason}" for reason in reasons if reason]


def bar_solids(mechanism: Mechanism) -> dict[str, SolidLeg]:
    """Solid model of each leg of a mechanism, by name of the leg, on a coarse mesh.

    Prisms consist of second-order tetrahedra, one across the section, other legs of bricks of 20
    nodes. A leg given by its 6×6 compliance is replaced by its equivalent prism
    (`lumped.equivalent_leg`). Equal legs share one model. The mass is summed over the points that
    CalculiX uses. Raises InputError for a leg along a line that has no solid mesh.
    """
    solid_of_leg: dict[SectionedLeg, SolidLeg] = {}
    solids = {}
    for name, described in legs_of(mechanism).items():
        leg = sectioned_leg(described)
        if leg not in solid_of_leg:
            solid = solid_leg(leg, _coarse_mesh(leg))
            mass = mass_at_stiffness_points(solid.mesh, leg.material.rho)
            solid_of_leg[leg] = replace(solid, mass=mass)
        solids[name] = solid_of_leg[leg]
    return solids


def _coarse_mesh(leg: SectionedLeg) -> SolidMesh:
    if isinstance(leg, LineLeg):
        return of_twenty_nodes(solid_mesh(leg, 1))
    return tetrahedra(leg.section, leg.length, 1)
