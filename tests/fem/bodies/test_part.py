"""Parts against closed forms, and one mesh in three formats."""

import meshio
import numpy as np
import pytest

from fem.bodies.part import grips_of, held_part, meshed_part, require_memory
from lumped.errors import ComputationError
from lumped.legs import Material
from lumped.mechanism.part import ByPlane, PartInterface
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.read import read_part
from meshes.part.volume import Grading, volume_mesh

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
LENGTH, ROOT, TIP = 0.5, 0.03, 0.02


@pytest.fixture(scope="module")
def cone(tmp_path_factory):
    """A cone of 500 mm, radii 30 and 20 mm, along x, and its two averaged ends."""
    path = tmp_path_factory.mktemp("cone") / "cone.step"
    with gmsh_model("cone") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.model.occ.addCone(0, 0, 0, 1e3 * LENGTH, 0, 0, 1e3 * ROOT, 1e3 * TIP)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    part = read_part(path)
    ends = {
        name: PartInterface(ByPlane((way, 0.0, 0.0), (x, 0.0, 0.0)), "average")
        for name, way, x in (("A", -1.0, 0.0), ("B", 1.0, LENGTH))
    }
    found = find_interfaces(part, ends)
    return part, ends, volume_mesh(part, found, Grading(0.015)), found


def test_a_cone_stretches_twists_and_bends_as_its_closed_form(cone):
    _, _, mesh, found = cone
    part = meshed_part(mesh, STEEL)
    compliance = np.diag(held_part(part, grips_of(mesh, found), "cone").compliance)
    # ∫dx/r² = L/(r₀r₁) and ∫dx/r⁴ = L(r₀² + r₀r₁ + r₁²)/3r₀³r₁³, with A = πr², I = πr⁴/4, J = 2I.
    squares = LENGTH / (ROOT * TIP)
    fourth = LENGTH * (ROOT**2 + ROOT * TIP + TIP**2) / (3.0 * (ROOT * TIP) ** 3)
    E, G = STEEL.E, STEEL.G
    expected = {
        0: squares / (np.pi * E),
        3: 2.0 * fourth / (np.pi * G),
        4: 4.0 * fourth / (np.pi * E),
        5: 4.0 * fourth / (np.pi * E),
    }
    # 1e-3: the square of the cone's slope, 4e-4, is what rod theory leaves out.
    for row, value in expected.items():
        assert compliance[row] == pytest.approx(value, rel=1e-3)
    # A truncated cone: V = πL(r₀² + r₀r₁ + r₁²)/3; circles of twelve quadratic sides leave 5e-5.
    volume = np.pi * LENGTH * (ROOT**2 + ROOT * TIP + TIP**2) / 3.0
    assert part.properties().mass == pytest.approx(STEEL.rho * volume, rel=1e-4)


def test_one_mesh_in_three_formats_gives_the_same_numbers(cone, tmp_path):
    _, ends, mesh, _ = cone
    # The file's order is VTK's, which for ten nodes is ours.
    plain = meshio.Mesh(mesh.nodes, [("tetra10", mesh.cells)])
    found = []
    for name in ("cone.msh", "cone.inp", "cone.vtu"):
        options = {"float_fmt": ".17e"} if name.endswith(".inp") else {}
        form = {"msh": "gmsh", "inp": "abaqus", "vtu": "vtu"}[name[-3:]]
        meshio.write(tmp_path / name, plain, file_format=form, **options)
        part = read_part(tmp_path / name)
        grips = grips_of(part.mesh, find_interfaces(part, ends))
        found.append(held_part(meshed_part(part.mesh, STEEL), grips, name).compliance)
    scale = np.sqrt(np.diag(found[0]))
    for other in found[1:]:
        assert other / np.outer(scale, scale) == pytest.approx(
            found[0] / np.outer(scale, scale), abs=1e-12
        )


def test_a_mesh_beyond_memory_is_refused_before_it_is_made():
    with pytest.raises(ComputationError, match="ask for fewer unknowns"):
        require_memory(1e9, "leg.step")
