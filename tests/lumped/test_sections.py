"""Section constants against textbook tables, steel tables and limits that must coincide."""

import pytest

from lumped.sections import (
    HollowRectangle,
    ISection,
    rectangle_torsion_constant,
)

# J/(b h³) by b/h: Timoshenko & Goodier §109, table of k1.
TORSION_CONSTANTS = {1.0: 0.140577, 1.2: 0.166119, 1.5: 0.195761, 2.0: 0.228682, 2.5: 0.249365}
TORSION_CONSTANTS |= {3.0: 0.263317, 4.0: 0.280813, 5.0: 0.291317, 10.0: 0.312325}


def test_torsion_constants_of_rectangles():
    for ratio, known in TORSION_CONSTANTS.items():
        assert rectangle_torsion_constant(ratio, 1.0) / ratio == pytest.approx(known, abs=1e-6)
    assert rectangle_torsion_constant(1.0, 100.0) == rectangle_torsion_constant(100.0, 1.0)


def test_hollow_rectangle_by_its_four_walls():
    """Parallel-axis theorem on two flanges and two webs; Bredt 4 Am² t / s."""
    b, h, t = 0.10, 0.16, 0.008
    section = HollowRectangle(b, h, t)
    flange_arm, web = (h - t) / 2.0, h - 2.0 * t
    iy = 2.0 * (b * t**3 / 12.0 + b * t * flange_arm**2) + 2.0 * t * web**3 / 12.0
    iz = 2.0 * t * b**3 / 12.0 + 2.0 * (web * t**3 / 12.0 + web * t * ((b - t) / 2.0) ** 2)
    assert section.area == pytest.approx(2.0 * b * t + 2.0 * web * t, rel=1e-12)
    assert section.second_moment_y == pytest.approx(iy, rel=1e-12)
    assert section.second_moment_z == pytest.approx(iz, rel=1e-12)
    perimeter = 2.0 * (b - t + h - t)
    assert section.torsion_constant == pytest.approx(
        4.0 * ((b - t) * (h - t)) ** 2 * t / perimeter, rel=1e-12
    )


def test_i_section_by_its_three_plates():
    """IPE 300 without its fillets: h 300, b 150, tf 10.7, tw 7.1 mm; plates by parallel axes."""
    b, h, tf, tw = 0.150, 0.300, 0.0107, 0.0071
    section = ISection(width=b, height=h, flange=tf, web=tw)
    web = h - 2.0 * tf
    iy = tw * web**3 / 12.0 + 2.0 * (b * tf**3 / 12.0 + b * tf * ((h - tf) / 2.0) ** 2)
    iz = web * tw**3 / 12.0 + 2.0 * tf * b**3 / 12.0
    assert section.area == pytest.approx(2.0 * b * tf + web * tw, rel=1e-12)
    assert section.second_moment_y == pytest.approx(iy, rel=1e-12)
    assert section.second_moment_z == pytest.approx(iz, rel=1e-12)
    assert section.torsion_constant == pytest.approx(
        (2.0 * b * tf**3 + (h - tf) * tw**3) / 3.0, rel=1e-12
    )
    # EN 10365 IPE 300: 53.81 cm², 8356 cm⁴, 603.8 cm⁴; the fillets are 4 % of the area
    assert section.area == pytest.approx(53.81e-4, rel=0.045)
    assert section.second_moment_y == pytest.approx(8356e-8, rel=0.045)
    assert section.second_moment_z == pytest.approx(603.8e-8, rel=0.005)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_cowper_shear_coefficients(nu):
    """Cowper 1966: thin square tube; finite elements have those of other shapes."""
    assert HollowRectangle(0.1, 0.1, 0.002).shear_coefficients(nu) == pytest.approx(
        [20.0 * (1.0 + nu) / (48.0 + 39.0 * nu)] * 2
    )
