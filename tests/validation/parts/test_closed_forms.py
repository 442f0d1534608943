"""Identified parts against closed forms: within what is stated of them, and within 0.1 %.

Ends are averaged, so that a moment, a torque and a tension enter as Saint-Venant's tractions. Rod
theory leaves out the stresses across the rod that its slope s needs, of energy (E/G)s² beside that
of the others; where a force enters evenly a third of (h/2L)²; and that a bent end, curved across by
Poisson's ratio, is in the mean ν(h²/12)/L² away from its middle.
"""

import numpy as np
import pytest
from drawn_parts import plane_ends
from scipy.integrate import quad

from lumped.legs import Material
from meshes.gmsh_session import gmsh_model
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.parts.identify import identify

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
E, G = STEEL.E, STEEL.G
LENGTH = 0.6
UNKNOWNS = 15_000


def identified(folder, draw, monkeypatch):
    """`draw` adds a part along x, in mm, to the kernel."""
    monkeypatch.setenv("FLEXPROOF_CACHE", "off")
    path = folder / "part.step"
    with gmsh_model("part") as gmsh:
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    part = read_part(path)
    ends = plane_ends(LENGTH, "average")
    points = {"A": np.zeros(3), "B": np.array([LENGTH, 0.0, 0.0])}
    return identify(part, find_interfaces(part, ends, points), STEEL, UNKNOWNS, 0)


def assert_stated(found, row, column, exact, left_out):
    """`left_out`: what rod theory leaves out, a share of the number."""
    value = found.compliance[row, column]
    stated = found.compliance_refinement[row, column]
    assert abs(value - exact) <= stated + left_out * abs(exact), (row, column)
    assert value == pytest.approx(exact, rel=1e-3), (row, column)


@pytest.mark.exhaustive
def test_a_tapered_cantilever_has_its_integrals(tmp_path, monkeypatch):
    """30 mm wide, its height falls from 40 to 30 mm."""
    width, root, tip = 0.030, 0.040, 0.030

    def draw(occ):
        corners = [(0, -20), (600, -15), (600, 15), (0, 20)]
        points = [occ.addPoint(x, -15, z) for x, z in corners]
        lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.extrude([(2, face)], 0, 30, 0)

    found = identified(tmp_path, draw, monkeypatch)

    def integral(of):
        height = lambda x: root + (tip - root) * x / LENGTH  # noqa: E731  the drawing
        return quad(lambda x: of(height(x), LENGTH - x), 0.0, LENGTH, epsabs=0.0)[0]

    # In closed form ∫dx/h = L ln(h₀/h₁)/(h₀ − h₁) and ∫dx/h³ = L(h₀ + h₁)/2h₀²h₁².
    once = LENGTH * np.log(root / tip) / (root - tip)
    cubed = LENGTH * (root + tip) / (2.0 * (root * tip) ** 2)
    assert integral(lambda h, _: 1.0 / h) == pytest.approx(once, rel=1e-12)
    assert integral(lambda h, _: h**-3) == pytest.approx(cubed, rel=1e-12)
    taper = E / G * ((root - tip) / 2.0 / LENGTH) ** 2
    curved = STEEL.nu * root**2 / 12.0 / LENGTH**2
    assert_stated(found, 0, 0, once / (E * width), taper)
    assert_stated(found, 4, 4, 12.0 * cubed / (E * width), taper)
    assert_stated(found, 5, 5, 12.0 * once / (E * width**3), taper)
    lever = integral(lambda h, arm: arm / h**3)
    assert_stated(found, 2, 4, -12.0 * lever / (E * width), taper + curved)
    # Under forces with the shear of a rectangle, κ = 5/6 by energy for height and width alike.
    shear = once / (5.0 / 6.0 * G * width)
    uneven = (root / 2.0 / LENGTH) ** 2 / 3.0
    along_z = 12.0 / (E * width) * integral(lambda h, arm: arm**2 / h**3) + shear
    along_y = 12.0 / (E * width**3) * integral(lambda h, arm: arm**2 / h) + shear
    assert_stated(found, 2, 2, along_z, taper + curved + uneven)
    assert_stated(found, 1, 1, along_y, taper + curved + uneven)


def test_a_cone_has_its_closed_forms(tmp_path, monkeypatch):
    """Radii of 20 and 16 mm: A = πr², I = πr⁴/4, J = 2I, r linear."""
    root, tip = 0.020, 0.016
    found = identified(tmp_path, lambda occ: occ.addCone(0, 0, 0, 600, 0, 0, 20, 16), monkeypatch)
    squares = LENGTH / (root * tip)
    fourth = LENGTH * (root**2 + root * tip + tip**2) / (3.0 * (root * tip) ** 3)
    taper = E / G * ((root - tip) / LENGTH) ** 2
    assert_stated(found, 0, 0, squares / (np.pi * E), taper)
    assert_stated(found, 3, 3, 2.0 * fourth / (np.pi * G), taper)
    assert_stated(found, 4, 4, 4.0 * fourth / (np.pi * E), taper)
    assert_stated(found, 5, 5, 4.0 * fourth / (np.pi * E), taper)
