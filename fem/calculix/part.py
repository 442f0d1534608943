"""A CAD part solved by CalculiX on the same mesh: rigid and averaged interfaces as equations.

The first interface is held, six unit wrenches act on each of the others. A rigid face is a body
with a translation and a rotation of its own; an averaged one is loaded through its nodes by the
transpose of its mean, and its mean is taken of the displacements that are printed.
"""

from collections.abc import Sequence

import numpy as np

from fem.calculix.deck import Deck, ElementSet, Equation, Freedom, NodalForce, rigid_face
from fem.calculix.run import run_calculix
from fem.couplings.grips import Grip, area_weights
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from meshes.part.part_mesh import PartMesh


def mean_motion(grip: Grip, nodes: Array) -> Array:
    """(RᵀWR)⁻¹RᵀW (6×3n) of an averaged interface, dense."""
    weights = np.kron(area_weights(nodes, grip.facets).toarray(), np.eye(3))
    motions = grip.motions(nodes)
    return np.asarray(np.linalg.solve(motions.T @ weights @ motions, motions.T @ weights))


def part_deck(
    mesh: PartMesh, material: Material, grips: Sequence[Grip], modes: int = 0, title: str = "part"
) -> Deck:
    """A part with its first interface held rigidly, six load cases on each of the others.

    Nodes after the mesh's carry the translation and the rotation of each rigid interface in turn;
    all interfaces' nodes are watched. Raises InputError for pins and for a first interface that
    is not rigid, which these equations do not have.
    """
    first, *others = grips
    if first.kind != "rigid" or any(grip.kind == "pin" for grip in others):
        raise InputError(f"{title}: the deck has rigid and averaged interfaces, the first rigid")
    nodes = [mesh.nodes]
    equations: list[Equation] = []
    cases: list[tuple[NodalForce, ...]] = []
    watched: list[int] = []
    number = len(mesh.nodes)
    for grip in others:
        if grip.kind == "rigid":
            twist: list[Freedom] = [(number + k, i) for k in range(2) for i in range(3)]
            nodes.append(np.tile(grip.point, (2, 1)))
            equations += rigid_face(grip.nodes, mesh.nodes[grip.nodes], grip.point, twist)
            cases += [(NodalForce(freedom, 1.0),) for freedom in twist]
            watched += [number, number + 1]
            number += 2
            continue
        for row in mean_motion(grip, mesh.nodes).reshape(6, -1, 3):
            cases.append(
                tuple(
                    NodalForce((int(node), i), float(force[i]))
                    for node, force in zip(grip.nodes, row, strict=True)
                    for i in range(3)
                    if force[i] != 0.0
                )
            )
        watched += [int(node) for node in grip.nodes]
    return Deck(
        title=title,
        nodes=np.vstack(nodes),
        parts=(ElementSet(mesh.cells, mesh.element, material),),
        equations=tuple(equations),
        held=tuple((int(node), i) for node in first.nodes for i in range(3)),
        load_cases=tuple(cases),
        watched=tuple(watched),
        modes=modes,
    )


def compliance_and_frequencies(
    mesh: PartMesh,
    material: Material,
    grips: Sequence[Grip],
    modes: int = 0,
    timeout: float = 600.0,
) -> tuple[Array, Array]:
    """CalculiX's 6(m−1)×6(m−1) compliance (SI, file axes), first interface held, and frequencies.

    As printed: seven digits, not symmetrised. The frequencies are those with the other interfaces
    free. Raises as `part_deck` and `run_calculix` do.
    """
    results = run_calculix(part_deck(mesh, material, grips, modes), 1, timeout)
    columns, start = [], 0
    for grip in grips[1:]:
        count = 2 if grip.kind == "rigid" else len(grip.nodes)
        moved = results.displacements[:, start : start + count].reshape(-1, 3 * count)
        columns.append(moved if grip.kind == "rigid" else moved @ mean_motion(grip, mesh.nodes).T)
        start += count
    return np.hstack(columns).T, results.frequencies
