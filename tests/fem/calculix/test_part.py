"""A part against CalculiX on the same mesh: rigid and averaged interfaces, compliance and modes.

The first interface is held, six unit wrenches act on each of the others. A rigid face is a body
with a translation and a rotation of its own; an averaged one is loaded through its nodes by the
transpose of its mean, and its mean is taken of the displacements that are printed.
"""

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import STEEL

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.calculix.deck import Deck, ElementSet, rigid_face
from fem.calculix.run import CalculixMissing, calculix_program, run_calculix
from fem.couplings.grips import area_weights
from lumped.mechanism.part import ByCylinder, ByPlane, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh


@pytest.fixture(scope="session")
def bar_step(tmp_path_factory):
    """A bar of 170 × 40 × 30 mm with bores of radius 8 and 6 along z, the first at the origin."""
    path = tmp_path_factory.mktemp("bar") / "bar.step"
    with gmsh_model("bar") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        occ = gmsh.model.occ
        bar = occ.addBox(-20, -20, -15, 170, 40, 30)
        bores = [(3, occ.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((0, 8), (130, 6))]
        occ.cut([(3, bar)], bores)
        occ.synchronize()
        gmsh.write(str(path))
    return path


@pytest.fixture(scope="module")
def bar(bar_step):
    """A coarse mesh of the bar, and its interfaces: both bores and its flat end."""
    try:
        calculix_program()
    except CalculixMissing as reason:
        pytest.skip(str(reason))
    part = read_part(bar_step)
    wanted = {
        "A": PartInterface(ByCylinder(0.008), "rigid"),
        "B": PartInterface(ByCylinder(0.006), "rigid"),
        "C": PartInterface(ByPlane((1.0, 0.0, 0.0), (0.15, 0.0, 0.0)), "average"),
    }
    found = find_interfaces(part, wanted)
    return volume_mesh(part, found, Grading(0.04)), found


def mean_motion(grip, nodes):
    """(RᵀWR)⁻¹RᵀW (6×3n) of an averaged interface, dense."""
    weights = np.kron(area_weights(nodes, grip.facets).toarray(), np.eye(3))
    motions = grip.motions(nodes)
    return np.linalg.solve(motions.T @ weights @ motions, motions.T @ weights)


def by_calculix(mesh, grips, modes=0):
    """Compliance (6(m−1)×6(m−1), SI), first interface held, and frequencies, others free."""
    nodes, equations, cases, watched = [mesh.nodes], [], [], []
    for grip in grips[1:]:
        if grip.kind == "rigid":
            bodies = [sum(map(len, nodes)) + k for k in range(2)]
            twist = [(body, i) for body in bodies for i in range(3)]
            nodes.append(np.tile(grip.point, (2, 1)))
            equations += rigid_face(grip.nodes, mesh.nodes[grip.nodes], grip.point, twist)
            cases += [((freedom, 1.0),) for freedom in twist]
            watched += bodies
        else:
            for row in mean_motion(grip, mesh.nodes).reshape(6, -1, 3):
                forces = zip(grip.nodes.tolist(), row.tolist(), strict=True)
                cases.append(
                    tuple(
                        ((node, i), force)
                        for node, own in forces
                        for i, force in enumerate(own)
                        if force
                    )
                )
            watched += grip.nodes.tolist()
    deck = Deck(
        title="part",
        nodes=np.vstack(nodes),
        parts=(ElementSet(mesh.cells, mesh.element, STEEL),),
        equations=tuple(equations),
        held=tuple((node, i) for node in grips[0].nodes.tolist() for i in range(3)),
        load_cases=tuple(cases),
        watched=tuple(watched),
        modes=modes,
    )
    results = run_calculix(deck)
    columns, start = [], 0
    for grip in grips[1:]:
        count = 2 if grip.kind == "rigid" else len(grip.nodes)
        moved = results.displacements[:, start : start + count].reshape(-1, 3 * count)
        columns.append(moved if grip.kind == "rigid" else moved @ mean_motion(grip, mesh.nodes).T)
        start += count
    return np.hstack(columns).T, results.frequencies


def test_compliance_of_rigid_and_averaged_interfaces(bar):
    mesh, interfaces = bar
    grips = grips_of(mesh, interfaces)
    body = held_part(meshed_part(mesh, STEEL), grips, "bar")
    theirs, _ = by_calculix(mesh, grips)
    # CalculiX prints seven digits.
    assert scaled_difference(theirs, body.compliance) < 1e-6
