"""Section constants against textbook tables, steel tables and limits that must coincide."""

import numpy as np
import pytest

from lumped.sections import HollowRectangle, ISection, Tube, rectangle_torsion_constant


def test_torsion_constants_of_rectangles():
    """J/(b h³) by b/h: Timoshenko & Goodier §109, table of k1."""
    known = {1.0: 0.140577, 1.2: 0.166119, 1.5: 0.195761, 2.0: 0.228682, 2.5: 0.249365}
    known |= {3.0: 0.263317, 4.0: 0.280813, 5.0: 0.291317, 10.0: 0.312325}
    found = {ratio: rectangle_torsion_constant(ratio, 1.0) / ratio for ratio in known}
    assert found == pytest.approx(known, abs=1e-6)
    assert rectangle_torsion_constant(1.0, 100.0) == rectangle_torsion_constant(100.0, 1.0)


def plates(*each):
    """Area, Iy and Iz of plates of such widths, heights and places y, z by parallel axes."""
    b, h, y, z = np.array(each).T
    area = b * h
    return [sum(area), sum(area * (h**2 / 12 + z**2)), sum(area * (b**2 / 12 + y**2))]


def constants(section):
    return [section.area, section.second_moment_y, section.second_moment_z]


def test_hollow_rectangle_by_its_four_walls():
    b, h, t = 0.10, 0.16, 0.008
    section = HollowRectangle(b, h, t)
    across, along = (b - t) / 2.0, (h - t) / 2.0
    flanges = [(b, t, 0.0, z) for z in (-along, along)]
    webs = [(t, h - 2.0 * t, y, 0.0) for y in (-across, across)]
    assert constants(section) == pytest.approx(plates(*flanges, *webs), rel=1e-12)
    # Bredt 4 Am² t / s.
    bredt = 4.0 * ((b - t) * (h - t)) ** 2 * t / (2.0 * (b - t + h - t))
    assert section.torsion_constant == pytest.approx(bredt, rel=1e-12)


def test_i_section_by_its_three_plates():
    """IPE 300 without its fillets: h 300, b 150, tf 10.7, tw 7.1 mm."""
    b, h, tf, tw = 0.150, 0.300, 0.0107, 0.0071
    section = ISection(width=b, height=h, flange=tf, web=tw)
    flanges = [(b, tf, 0.0, z) for z in ((tf - h) / 2.0, (h - tf) / 2.0)]
    expected = plates(*flanges, (tw, h - 2.0 * tf, 0.0, 0.0))
    assert constants(section) == pytest.approx(expected, rel=1e-12)
    thin = (2.0 * b * tf**3 + (h - tf) * tw**3) / 3.0
    assert section.torsion_constant == pytest.approx(thin, rel=1e-12)
    # EN 10365 IPE 300: 53.81 cm², 8356 cm⁴, 603.8 cm⁴; the fillets are 4 % of the area.
    assert constants(section) == pytest.approx([53.81e-4, 8356e-8, 603.8e-8], rel=0.045)


def test_tube_by_its_middle_line():
    """A = π m t and I = π m t (m² + t²)/8, exact with the mean diameter m; J = 2 I."""
    t, m = 0.004, 0.046
    section, bending = Tube(0.05, t), np.pi * m * t * (m**2 + t**2) / 8.0
    assert constants(section) == pytest.approx([np.pi * m * t, bending, bending], rel=1e-12)
    assert section.torsion_constant == pytest.approx(2.0 * bending, rel=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_cowper_shear_coefficients(nu):
    """Cowper 1966: thin square tube; finite elements have those of other shapes."""
    cowper = 20.0 * (1.0 + nu) / (48.0 + 39.0 * nu)
    assert HollowRectangle(0.1, 0.1, 0.002).shear_coefficients(nu) == pytest.approx([cowper] * 2)
