"""Thin walls of fibre layers: published stiffnesses of laminates, and layers of one material."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from lumped.legs import ConstantLeg, Material
from lumped.sections import HollowRectangle, LaminateBox, LaminateTube, Layer, Tube

# T300/5208 carbon and epoxy (S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, 1980,
# table 1.7): Pa.
CARBON = {"E1": 181e9, "E2": 10.3e9, "G12": 7.17e9, "nu12": 0.28, "rho": 1600.0}
STEEL = {"E1": 2.1e11, "E2": 2.1e11, "G12": 2.1e11 / 2.6, "nu12": 0.3, "rho": 7850.0}
# Half a unit of the fourth digit, of which the published numbers have four.
FOUR_DIGITS = 2e-4


def layers(*angles, ply=CARBON, thickness=0.25e-3):
    return tuple(Layer(**ply, thickness=thickness, angle=angle) for angle in angles)


def beam_of(section):
    return ConstantLeg(1.0, section, Material(*section.mean_material)).timoshenko


def test_layer_at_45_degrees_equals_tsai():
    """Tsai & Hahn, table 3.5: Q̄ of T300/5208 at 45° in GPa."""
    stiffness = layers(45)[0].stiffness / 1e9
    expected = {(0, 0): 56.66, (1, 1): 56.66, (0, 1): 42.32, (2, 2): 46.59, (0, 2): 42.87}
    for index, value in expected.items():
        assert stiffness[index] == pytest.approx(value, rel=FOUR_DIGITS)


def test_axial_fibre_tube_has_fibre_modulus():
    """Layers at 0°: EA = E1 A, EI = E1 I, GJ = G12 J."""
    tube = Tube(0.06, 1e-3)
    beam = beam_of(LaminateTube(layers(0, 0, 0, 0), 0.06))
    assert pytest.approx(CARBON["E1"] * tube.area, rel=1e-12) == beam.EA
    assert beam.EIy == pytest.approx(CARBON["E1"] * tube.second_moment_y, rel=1e-12)
    assert pytest.approx(CARBON["G12"] * tube.torsion_constant, rel=1e-12) == beam.GJ
    assert beam.mu == pytest.approx(CARBON["rho"] * tube.area, rel=1e-12)


@pytest.mark.parametrize("thickness", [0.25e-3, 0.025e-3])
def test_tube_at_45_degrees_has_published_g(thickness):
    """GJ = 2πr³t Gxy with Gxy = 46.59 GPa; a ring of finite thickness has 1 + t²/4r² times that."""
    section = LaminateTube(layers(45, -45, -45, 45, thickness=thickness), 0.06)
    wall = 4.0 * thickness
    radius = 0.03 - wall / 2.0
    expected = 2.0 * pi * radius**3 * wall * (1.0 + wall**2 / (4.0 * radius**2)) * 46.59e9
    assert pytest.approx(expected, rel=FOUR_DIGITS) == beam_of(section).GJ
    # Ex = Q̄11 − Q̄12²/Q̄22 of the table.
    tension = (56.66 - 42.32**2 / 56.66) * 1e9
    assert pytest.approx(2.0 * pi * radius * wall * tension, rel=5e-4) == beam_of(section).EA


def test_quasi_isotropic_wall_equals_tsai():
    """Tsai & Hahn, table 4.3: E = 69.68 GPa, G = 26.88 GPa, ν = 0.296; G = E/2(1+ν)."""
    section = LaminateTube(layers(0, 45, -45, 90, 90, -45, 45, 0), 0.06)
    wall = section.wall / section.thickness / 1e9
    tension = wall[0, 0] - wall[0, 1] ** 2 / wall[1, 1]
    ratio = wall[0, 1] / wall[1, 1]
    assert tension == pytest.approx(69.68, rel=FOUR_DIGITS)
    assert wall[2, 2] == pytest.approx(26.88, rel=FOUR_DIGITS)
    assert ratio == pytest.approx(0.296, abs=5e-4)
    assert wall[2, 2] == pytest.approx(tension / (2.0 * (1.0 + ratio)), rel=1e-12)


@pytest.mark.parametrize("shape", ["tube", "box"])
def test_thin_quasi_isotropic_is_isotropic(shape):
    """The layers lie on different radii; the difference from isotropy falls with t/r."""
    errors = []
    for thickness in (1e-4, 1e-5):
        wall = layers(0, 45, -45, 90, thickness=thickness)
        if shape == "tube":
            section = LaminateTube(wall, 0.06)
            plain = Tube(0.06, 4.0 * thickness)
        else:
            section = LaminateBox(wall, 0.06, 0.04)
            plain = HollowRectangle(0.06, 0.04, 4.0 * thickness)
        G, tension = 26.88e9, 69.68e9
        beam = beam_of(section)
        ratios = [
            beam.EA / (tension * plain.area),
            beam.EIy / (tension * plain.second_moment_y),
            beam.EIz / (tension * plain.second_moment_z),
            beam.GJ / (G * plain.torsion_constant),
        ]
        errors.append(np.abs(np.array(ratios) - 1.0).max())
    assert errors[0] < 0.02
    assert errors[1] < errors[0] / 8.0 + FOUR_DIGITS


@pytest.mark.parametrize(
    ("section", "plain"),
    [
        (LaminateTube(layers(0, 30, -30, ply=STEEL), 0.06), Tube(0.06, 0.75e-3)),
        (LaminateBox(layers(20, -20, ply=STEEL), 0.06, 0.04), HollowRectangle(0.06, 0.04, 0.5e-3)),
    ],
    ids=["tube", "box"],
)
def test_steel_layers_equal_steel_section(section, plain):
    """All constants agree except the shear stiffness, which is that of Cowper's κ with ν = 0.

    Cowper's κ depends on ν, by up to 6 % in a round tube.
    """
    leg = ConstantLeg(1.0, plain, Material.isotropic(2.1e11, 0.3, 7850.0))
    laminate_beam, steel_beam = beam_of(section), leg.timoshenko
    for name in ("EA", "EIy", "EIz", "GJ", "mu", "rho_J", "rho_Iy", "rho_Iz"):
        assert getattr(laminate_beam, name) == pytest.approx(getattr(steel_beam, name), rel=1e-9), (
            name
        )
    without = [k * steel_beam.EA / 2.6 for k in plain.shear_coefficients(0.0)]
    assert [laminate_beam.GAy, laminate_beam.GAz] == pytest.approx(without, rel=5e-3)


def test_laminate_box_shear_equals_energy():
    """∮ q² ds/A66 of the shear flow q along the wall, by quadrature, for a unit force along z."""
    section = LaminateBox(layers(45, -45, -45, 45), 0.06, 0.04)
    b, h = 0.06 - section.thickness, 0.04 - section.thickness
    corners = np.array([(0.0, h), (b, h), (b, -h), (0.0, -h)]) / 2.0
    points = np.vstack([np.linspace(start, end, 20_001)[:-1] for start, end in pairwise(corners)])
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    middle = 0.5 * (points[1:, 1] + points[:-1, 1])
    inertia = 2.0 * np.sum(middle**2 * steps)
    flow = np.cumsum(middle * steps) / inertia
    flexibility = 2.0 * np.sum(flow**2 * steps) / section.wall[2, 2]
    assert section.shear_stiffnesses[1] == pytest.approx(1.0 / flexibility, rel=1e-3)


@pytest.mark.parametrize(
    ("section", "fault"),
    [
        (
            LaminateTube(layers(*[0] * 25), 0.06),
            "layers: together 0.00625 m thick; laminate theory is for thin walls; must be at most "
            "a tenth of the smaller side, 0.006 m",
        ),
        (
            LaminateTube(layers(0, ply=CARBON | {"nu12": 4.3}), 0.06),
            "layers[1].nu12 = 4.3: must be below √(E1/E2) in size, 4.192; no material has such "
            "constants",
        ),
    ],
)
def test_invalid_laminate_is_refused(section, fault):
    """A thick wall, and ν12 beyond √(E1/E2): one line with value and limit."""
    assert section.faults() == [fault]
