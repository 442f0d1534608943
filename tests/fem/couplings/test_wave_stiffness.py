"""Dynamic stiffness by waves against waves of whole wavelengths, beams, and solids."""

import numpy as np
import pytest
from prism_waves import prism_wave_frequency
from prismatic_legs import STEEL

from fem.couplings.wave_stiffness import prism_waves
from fem.sections.waveguide import bending_wave, wall_frequency
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.sections import HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import section_mesh
from validation.cases.leg_waves import dynamic_stiffness
from validation.solids.legs import own_beam

LENGTH = 0.9
BOX = HollowRectangle(0.14, 0.2, 0.01)
OPEN = ISection(0.1, 0.16, 0.012, 0.008)
SECTIONS = [BOX, Tube(0.12, 0.01), OPEN]


def waves_of(section, divisions):
    mesh = section_mesh(section, divisions)
    return {kind.fields.name: kind for kind in prism_waves(mesh, STEEL)}


@pytest.mark.parametrize(("along", "kind"), [("y", "bending z"), ("z", "bending y")])
@pytest.mark.parametrize("section", SECTIONS)
def test_half_a_wave_swings_between_pins(section, along, kind):
    """A standing wave of length 2L has pins at its nodes: no moment turns them at its frequency."""
    # Long enough for the I-section's flanges not to bend by themselves.
    length = 2.0 if section is OPEN else LENGTH
    mesh = section_mesh(section, 2)
    omega = bending_wave(mesh, STEEL, np.pi / length, along)
    pinned = waves_of(section, 2)[kind].stiffness(length, omega)[1::2, 1::2]
    values = np.abs(np.linalg.eigvalsh(pinned))
    assert values.min() < 1e-6 * values.max()


def test_the_bending_wave_of_a_section_mesh_is_that_of_polynomials():
    """Ritz's method on polynomials of the whole section; Timoshenko's wave is 0.4 % lower."""
    section = Rectangle(0.06, 0.1)
    k = 2.0 * np.pi / (6.0 * section.height)
    wave = bending_wave(section_mesh(section, 4), STEEL, k, "z") / (2.0 * np.pi)
    # One theory of elasticity, on nine-node elements and on polynomials.
    assert wave == pytest.approx(prism_wave_frequency(section, STEEL, "bending", k), rel=2e-4)


def test_the_walls_of_a_thin_tube_become_oval_as_hoppe_says():
    """ω² = n²(n² − 1)²/(n² + 1) EI/(μR⁴) of a ring, n = 2; long, so of E/(1 − ν²) (Love, §293)."""
    radius, wall = 0.05, 0.003
    mesh = section_mesh(Tube(2.0 * radius + wall, wall), 6)
    plate = STEEL.E / (1.0 - STEEL.nu**2) * wall**2 / (12.0 * STEEL.rho)
    expected = np.sqrt(36.0 / 5.0 * plate) / radius**2
    # The curved cells of the mesh are too stiff by 3 %; ν² alone is 9 %.
    assert wall_frequency(mesh, STEEL) == pytest.approx(expected, rel=4e-2)


@pytest.mark.parametrize("section", SECTIONS)
def test_slow_waves_are_a_timoshenko_beam(section):
    """Both are Saint-Venant's states as ω → 0: what is left falls with ω²."""
    omega = 2.0 * np.pi * 2.0
    expected = dynamic_stiffness(own_beam(ConstantLeg(LENGTH, section, STEEL), 4), omega)
    for name, kind in waves_of(section, 4).items():
        own = expected[np.ix_(kind.ends, kind.ends)]
        unit = 1.0 / np.sqrt(np.diag(own))
        off = (kind.stiffness(LENGTH, omega) - own) * np.outer(unit, unit)
        # An open section warps along its torsional wave; a round one's mesh leaves 1e-4.
        assert np.abs(off).max() < (5e-4 if name == "torsion" else 2e-4), name


def test_walls_that_move_and_waves_that_are_singular_by_rounding_are_no_beam(monkeypatch):
    with pytest.raises(ComputationError, match="walls of the section move by themselves"):
        waves_of(BOX, 2)["bending z"].stiffness(LENGTH, 2.0 * np.pi * 1500.0)
    # As of the softest leg beside one of the stiffest: a pivot of zero, then no number at all.
    monkeypatch.setattr(
        "fem.couplings.wave_stiffness.lu_solve", lambda _, right: np.full_like(right, np.inf)
    )
    with pytest.raises(ComputationError, match=r"bending z at .* Hz is lost in rounding"):
        waves_of(Rectangle(0.05, 0.08), 2)["bending z"].stiffness(LENGTH, 100.0)
