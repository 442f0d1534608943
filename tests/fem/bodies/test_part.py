"""Parts against closed forms."""

import numpy as np
import pytest
from drawn_parts import meshed, plane_ends
from prismatic_legs import STEEL

from fem.bodies.part import grips_of, held_part, meshed_part, require_memory
from lumped.errors import ComputationError
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part

LENGTH, ROOT, TIP = 0.5, 0.03, 0.02


def ends(path, draw, length, size, sides=4.0):
    """What is drawn, meshed, and its averaged plane ends."""
    part = read_part(meshed(path, draw, size, sides), "mm")
    found = find_interfaces(part, plane_ends(length, "average"))
    return meshed_part(part.mesh, STEEL), grips_of(part.mesh, found)


def test_a_cone_stretches_twists_and_bends_as_its_closed_form(tmp_path):
    part, grips = ends(
        tmp_path / "cone.msh",
        lambda kernel: kernel.addCone(0, 0, 0, 1e3 * LENGTH, 0, 0, 1e3 * ROOT, 1e3 * TIP),
        LENGTH,
        25.0,
        12.0,
    )
    compliance = np.diag(held_part(part, grips, "cone").compliance)
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


def test_a_bar_has_the_mass_the_centre_and_the_inertia_of_a_box(tmp_path):
    length, b, h = 0.12, 0.04, 0.024
    whole, _ = ends(
        tmp_path / "bar.msh", lambda kernel: kernel.addBox(0, -20, -12, 120, 40, 24), length, 20.0
    )
    properties, mass = whole.properties(), STEEL.rho * length * b * h
    assert properties.mass == pytest.approx(mass, rel=1e-12)
    assert properties.centre == pytest.approx([length / 2.0, 0.0, 0.0], abs=1e-14)
    box = mass / 12.0 * np.diag([b**2 + h**2, length**2 + h**2, length**2 + b**2])
    assert properties.inertia == pytest.approx(box, rel=1e-11, abs=1e-16)


def test_a_mesh_beyond_memory_is_refused_before_it_is_made():
    with pytest.raises(ComputationError, match="ask for fewer unknowns"):
        require_memory(1e9, "leg.step")
