"""A part against CalculiX on the same mesh: rigid and averaged interfaces, compliance and modes."""

import pytest

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.bodies.rooted import rooted_body
from fem.calculix.leg import mass_at_stiffness_points
from fem.calculix.part import compliance_and_frequencies
from fem.calculix.run import CalculixMissing, calculix_program
from fem.couplings.coupled_solid import coupled_solid
from lumped.legs import Material
from lumped.mechanism.part import ByCylinder, ByPlane, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from meshes.part.volume import Grading, volume_mesh
from validation.agreement.differences import scaled_difference

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """A bar with two bores and a flat end, coarse, with its interfaces."""
    try:
        calculix_program()
    except CalculixMissing as reason:
        pytest.skip(str(reason))
    path = tmp_path_factory.mktemp("bar") / "bar.step"
    with gmsh_model("bar") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        occ = gmsh.model.occ
        bar = occ.addBox(0, -20, -15, 200, 40, 30)
        bores = [(3, occ.addCylinder(x, 0, -30, 0, 0, 60, r)) for x, r in ((20, 8), (150, 6))]
        occ.cut([(3, bar)], bores)
        occ.synchronize()
        gmsh.write(str(path))
    part = read_part(path)
    wanted = {
        "A": PartInterface(ByCylinder(0.008), "rigid"),
        "B": PartInterface(ByCylinder(0.006), "rigid"),
        "C": PartInterface(ByPlane((1.0, 0.0, 0.0), (0.2, 0.0, 0.0)), "average"),
    }
    found = find_interfaces(part, wanted)
    return volume_mesh(part, found, Grading(0.04)), found


def test_compliance_of_rigid_and_averaged_interfaces(bar):
    mesh, interfaces = bar
    grips = grips_of(mesh, interfaces)
    body = held_part(meshed_part(mesh, STEEL), grips, "bar")
    theirs, _ = compliance_and_frequencies(mesh, STEEL, grips)
    # CalculiX prints seven digits.
    assert scaled_difference(theirs, body.compliance) < 1e-6


@pytest.mark.exhaustive
def test_twenty_frequencies_with_its_own_mass(bar):
    mesh, interfaces = bar
    grips = grips_of(mesh, interfaces[:2])
    part = meshed_part(mesh, STEEL)
    M = mass_at_stiffness_points(mesh, STEEL.rho)
    body = rooted_body(coupled_solid(part.stiffness, M, mesh.nodes, grips), "bar")
    _, theirs = compliance_and_frequencies(mesh, STEEL, grips, 20)
    assert body.modes(20).frequencies == pytest.approx(theirs, rel=1e-6)
