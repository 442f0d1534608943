"""Sections of several materials: textbook numbers, series, and limits of one material."""

import numpy as np
import pytest

from lumped.legs import ConstantLeg, Material
from lumped.sections import (
    Channel,
    Circle,
    Composite,
    CompositePart,
    HollowRectangle,
    Polygon,
    Rectangle,
    Tube,
)

STEEL = (2.1e11, 0.3, 7850.0)
# A material of a seventh of the moduli at the same Poisson's ratio.
LIGHT = (3.0e10, 0.3, 2400.0)
# Boundary elements and products of inertia.
ROUNDING = 1e-6


def composite(*parts):
    return Composite(tuple(parts))


def beam_of(section, length=1.0):
    leg = ConstantLeg(length, section, Material(*section.mean_material))
    return leg.timoshenko


def layered(width, heights, materials):
    """Section of rectangles with these heights and materials, stacked from the bottom."""
    bottoms = np.cumsum([0.0, *heights])
    return composite(
        *(
            CompositePart(Rectangle(width, h), *material, at=(0.0, float(bottom + h / 2.0)))
            for h, bottom, material in zip(heights, bottoms[:-1], materials, strict=True)
        )
    )


@pytest.mark.parametrize(
    ("parts", "single"),
    [
        (
            [
                CompositePart(Rectangle(0.05, 0.01), *STEEL, at=(0.0, 0.005)),
                CompositePart(Rectangle(0.05, 0.02), *STEEL, at=(0.0, 0.02)),
            ],
            Polygon(((0.0, 0.0), (0.05, 0.0), (0.05, 0.03), (0.0, 0.03))),
        ),
        (
            [
                CompositePart(Rectangle(0.01, 0.1), *STEEL, at=(0.005, 0.05)),
                CompositePart(Rectangle(0.04, 0.012), *STEEL, at=(0.03, 0.006)),
                CompositePart(Rectangle(0.04, 0.012), *STEEL, at=(0.03, 0.094)),
            ],
            Channel(0.05, 0.1, 0.012, 0.01),
        ),
    ],
    ids=["rectangle", "channel"],
)
def test_parts_of_equal_material_equal_one_section(parts, single):
    """Rectangle of two parts and channel of three, all of steel: constants of one section."""
    section = composite(*parts)
    leg = ConstantLeg(1.0, single, Material.isotropic(*STEEL))
    composite_beam, single_beam = beam_of(section), leg.timoshenko
    for name in ("EA", "EIy", "EIz", "GJ", "GAy", "GAz", "mu", "rho_J", "rho_Iy", "centre_y"):
        expected = getattr(single_beam, name)
        assert getattr(composite_beam, name) == pytest.approx(expected, rel=ROUNDING, abs=1e-9), (
            name
        )
    assert (composite_beam.mass_y, composite_beam.mass_z) == (0.0, 0.0)


def test_wood_steel_beam_equals_gere():
    """J. M. Gere, Mechanics of Materials, 6th ed., example 6-1: inches and ksi.

    Wood 4 × 6, steel plate 4 × 0.5 below: neutral axis 5.031 in below the top, moments of inertia
    171.0 and 3.01 in⁴ about it (half a unit of the last digit).
    """
    wood, steel = (1500.0, 0.3, 1.0), (30_000.0, 0.3, 1.0)
    section = layered(4.0, [0.5, 6.0], [steel, wood])
    bending = beam_of(section).EIy
    assert bending == pytest.approx(1500.0 * 171.0 + 30_000.0 * 3.01, abs=75.0 + 150.0)
    # Centre of mass at equal densities, 3.25 in above the bottom; the neutral axis at 1.469 in.
    assert section.mass_centre[1] == pytest.approx(3.25 - (6.5 - 5.031), abs=5e-4)


def test_filled_tube_is_sum_of_parts():
    """Concentric circles twist and bend as one body: GJ and EI are sums."""
    tube, core = Tube(0.08, 0.01), Circle(0.06)
    beam = beam_of(composite(CompositePart(tube, *STEEL), CompositePart(core, *LIGHT)))
    shear = [E / 2.6 for E in (STEEL[0], LIGHT[0])]
    twisting = shear[0] * tube.torsion_constant + shear[1] * core.torsion_constant
    bending = STEEL[0] * tube.second_moment_y + LIGHT[0] * core.second_moment_y
    assert pytest.approx(twisting, rel=1e-4) == beam.GJ
    assert beam.EIy == pytest.approx(bending, rel=1e-6)
    assert beam.EIz == pytest.approx(bending, rel=1e-6)
    assert pytest.approx(STEEL[0] * tube.area + LIGHT[0] * core.area, rel=1e-12) == beam.EA


def series_of_two_layers(G, widths, height):
    """GJ of two rectangles side by side along y by Fourier series of Prandtl's stress function.

    ∇²φ = −2G in each layer, φ = 0 on the rim, φ and (∂φ/∂y)/G continuous.
    φ = Σ Z_k(y) sin(kπz/h) with Z″ − κ²Z = −8G/kπ; GJ = 2 ∫ φ dA.
    """
    b = np.array(widths)
    total = 0.0
    for k in range(1, 120, 2):
        kappa = k * np.pi / height
        p, half = 8.0 * np.array(G) / (k * np.pi * kappa**2), np.tanh(0.5 * kappa * b)
        # Z = p (1 − (sinh κ(b−d) + sinh κd)/sinh κb) + Z₀ sinh κ(b−d)/sinh κb at a distance d
        # from the interface, where the slopes Z′/G to both sides cancel.
        at_interface = np.sum(p * half / G) / np.sum(1.0 / np.tanh(kappa * b) / G)
        integrals = p * b + (at_interface - 2.0 * p) * half / kappa
        total += 2.0 * integrals.sum() * 2.0 * height / (k * np.pi)
    return total


@pytest.mark.parametrize("ratio", [1.0, 0.3, 0.01])
def test_layered_torsion_equals_series(ratio):
    """The series has converged to 1e-6 after 60 terms (k⁻⁵)."""
    G, widths, height = (8.0e10, ratio * 8.0e10), (0.03, 0.02), 0.05
    parts = [
        CompositePart(Rectangle(w, height), 2.6 * modulus, 0.3, 1.0, at=(y, 0.0))
        for w, modulus, y in zip(widths, G, (-0.015, 0.01), strict=True)
    ]
    assert (
        pytest.approx(series_of_two_layers(G, widths, height), rel=2e-5)
        == beam_of(composite(*parts)).GJ
    )


def test_sandwich_shear_equals_layer_integral():
    """At ν = 0, τ = V ∫E z dz/EI in each layer, the same over the width: 1/GA = b ∫ τ²/G dz."""
    width, face, core = 0.04, 0.002, 0.03
    stiff, soft = (7.0e10, 0.0, 2700.0), (1.0e9, 0.0, 100.0)
    beam = beam_of(layered(width, [face, core, face], [stiff, soft, stiff]))
    z = np.linspace(-(core / 2.0 + face), core / 2.0 + face, 200_001)
    E = np.where(np.abs(z) > core / 2.0, stiff[0], soft[0])
    middle, step = 0.5 * (z[1:] + z[:-1]), np.diff(z)
    E = 0.5 * (E[1:] + E[:-1])
    EI = width * np.sum(E * middle**2 * step)
    flow = np.cumsum(E * middle * step)
    flexibility = width * np.sum((flow / EI) ** 2 / (E / 2.0) * step)
    # The steps of the sum at the faces of the core.
    assert beam.GAz == pytest.approx(1.0 / flexibility, rel=2e-4)


def test_composite_torsion_needs_only_g():
    """GJ depends on G alone: two pairs (E, ν) of equal G."""
    box = HollowRectangle(0.1, 0.06, 0.02)
    sections = [
        composite(
            CompositePart(box, 2.0 * 8.0e10 * (1.0 + nu), nu, 1.0),
            CompositePart(Rectangle(0.06, 0.02), 2.0e10 * 2.5, 0.25, 1.0),
        )
        for nu in (0.25, 0.4)
    ]
    beam, other = (beam_of(section).GJ for section in sections)
    assert beam == pytest.approx(other, rel=1e-9)


@pytest.mark.parametrize(
    ("parts", "fault"),
    [
        (
            [CompositePart(Circle(0.08), *STEEL), CompositePart(Circle(0.06), *LIGHT)],
            "parts[2]: overlaps parts[1]; parts must lie beside each other (a core within a part "
            "with a hole of its size)",
        ),
        (
            [
                CompositePart(Rectangle(0.08, 0.08), *STEEL),
                CompositePart(Rectangle(0.06, 0.06), *LIGHT, at=(0.06, 0.0)),
            ],
            "parts[2]: overlaps parts[1]; parts must lie beside each other (a core within a part "
            "with a hole of its size)",
        ),
        (
            [
                CompositePart(Rectangle(0.08, 0.08), *STEEL),
                CompositePart(Rectangle(0.06, 0.06), *LIGHT, at=(0.07, 0.07)),
            ],
            "parts[2]: has no common edge with the other parts; must touch one of them",
        ),
        (
            [
                CompositePart(Tube(0.08, 0.05), *STEEL),
                CompositePart(Circle(0.06), *LIGHT),
            ],
            "parts[1].section.thickness = 0.05: closes the bore; must be below half the diameter, "
            "0.04 m",
        ),
    ],
)
def test_invalid_composite_is_refused(parts, fault):
    """Parts that overlap, do not touch, or have no bore: one line with the number of the part."""
    assert composite(*parts).faults() == [fault]
