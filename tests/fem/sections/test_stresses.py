"""Stresses in sections against closed forms of bending, torsion and shear, and CalculiX."""

import re
import subprocess

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator

from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import calculix_program, calculix_version
from fem.sections.saint_venant import section_quadrature
from fem.sections.stresses import section_stresses
from lumped.legs import Material
from lumped.sections import (
    Angle,
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Tube,
    rectangle_torsion_constant,
)
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh

NU = 0.3
STEEL = Material.isotropic(2.1e11, NU, 7850.0)
N, QY, QZ, T, MY, MZ = np.eye(6)
SECTIONS = (
    Rectangle(0.1, 0.2),
    Circle(0.1),
    Tube(0.1, 0.01),
    HollowRectangle(0.1, 0.2, 0.01),
    ISection(0.1, 0.2, 0.015, 0.01),
    Angle(0.1, 0.15, 0.01, 0.012),
)


def stresses(section, divisions=8):
    return section_stresses(section_mesh(section, divisions), STEEL)


def node_at(computed, y, z):
    """Return the index of the node at (y, z); it must exist."""
    distances = np.linalg.norm(computed.points - [y, z], axis=1)
    assert distances.min() < 1e-9
    return int(np.argmin(distances))


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_stress_integrals_are_section_forces(section):
    """∫σ dA = N, ∫σ z dA = My, −∫σ y dA = Mz, ∫τ dA = Q and ∫(y τz − z τy) dA = T."""
    computed = stresses(section)
    quad = section_quadrature(section_mesh(section, 8))
    y, z = quad.points
    # Moments are divided by the size of the section, so that all components are forces.
    unit = np.array([1.0, 1.0, 1.0, *[max(section.extent)] * 3])
    for number, force in enumerate(np.diag(unit)):
        sigma = quad.value(computed.normal @ force)
        along_y, along_z = (quad.value(rows @ force) for rows in computed.shear)
        torque = y * along_z - z * along_y
        resultant = [sigma, along_y, along_z, torque, z * sigma, -y * sigma]
        integrals = [quad.integral(field) for field in resultant]
        # Stresses at nodes are means of gradients with errors of second order, largest at corners.
        tolerance = 1e-9 if number in (0, 4, 5) else 0.02
        np.testing.assert_allclose(integrals / unit, force / unit, atol=tolerance)


@pytest.mark.parametrize("section", SECTIONS[:5], ids=lambda section: section.shape)
def test_bending_stress_is_moment_over_modulus(section):
    """σ = M/W with W = I/(h/2) is largest at the rim; σ = N/A everywhere under N."""
    computed = stresses(section)
    width, height = section.extent
    # Arcs are meshed as parabolas: errors of moments of area up to 2e-4 for thin tubes.
    tolerance = 1e-3 if isinstance(section, Circle | Tube) else 1e-9
    for force, inertia, depth in (
        (MY, section.second_moment_y, height),
        (MZ, section.second_moment_z, width),
    ):
        largest = np.abs(computed.normal @ force).max()
        assert largest == pytest.approx(0.5 * depth / inertia, rel=tolerance)
        assert computed.von_mises(force[None]).max() == pytest.approx(largest, rel=1e-12)
    np.testing.assert_allclose(computed.normal @ N, 1.0 / section.area, rtol=tolerance)


def test_angle_bending_stress_equals_formula():
    """σ = (My (Iz z − Iyz y) + Mz (Iyz z − Iy y))/(Iy Iz − Iyz²).

    Source: Timoshenko, Strength of Materials I, §49.
    """
    section = SECTIONS[5]
    computed = stresses(section, 2)
    iy, iz, iyz = section.second_moment_y, section.second_moment_z, section.product_moment
    y, z = computed.points.T
    determinant = iy * iz - iyz**2
    np.testing.assert_allclose(computed.normal @ MY, (iz * z - iyz * y) / determinant, rtol=1e-7)
    np.testing.assert_allclose(computed.normal @ MZ, (iyz * z - iy * y) / determinant, rtol=1e-7)


def test_round_torsion_stress_is_exact():
    """τ = 16 T/πd³ at the rim of a circle, T r/J in a tube; no other stress."""
    for section, expected in (
        (Circle(0.1), 16.0 / (np.pi * 0.1**3)),
        (Tube(0.1, 0.01), 0.05 / (np.pi / 32.0 * (0.1**4 - 0.08**4))),
    ):
        computed = stresses(section, 8)
        largest = np.linalg.norm(computed.shear @ T, axis=0).max()
        # Parabolas instead of arcs change the torsion constant by 1e-4.
        assert largest == pytest.approx(expected, rel=2e-4)
        assert not (computed.normal @ T).any()


def test_rectangle_torsion_stress_equals_series():
    """τ in the middle of the long side (Timoshenko & Goodier, Theory of Elasticity, §109)."""
    width, height = 0.1, 0.2
    n = np.arange(1, 99, 2)
    series = 1.0 - 8.0 / np.pi**2 * (1.0 / n**2 / np.cosh(0.5 * n * np.pi * height / width)).sum()
    expected = width * series / rectangle_torsion_constant(width, height)
    errors = []
    for divisions in (4, 8, 16):
        computed = stresses(Rectangle(width, height), divisions)
        middle = node_at(computed, 0.5 * width, 0.0)
        largest = np.linalg.norm(computed.shear @ T, axis=0)
        assert largest[middle] == pytest.approx(largest.max(), rel=1e-6)
        errors.append(abs(largest[middle] / expected - 1.0))
    assert errors[-1] < 4e-4
    # Gradients of quadratic elements converge with second order.
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.3)


def test_circle_shear_equals_elasticity():
    """Shear stress of a round bar under a transverse force P, by the theory of elasticity.

    (3+2ν)/8(1+ν) Pr²/I at the centre, (1+2ν)/4(1+ν) Pr²/I at the sides (Timoshenko, §115).
    """
    computed = stresses(Circle(0.1), 16)
    scale = 0.05**2 / (np.pi * 0.05**4 / 4.0)
    along = computed.shear[1] @ QZ
    centre = (3.0 + 2.0 * NU) / (8.0 * (1.0 + NU)) * scale
    side = (1.0 + 2.0 * NU) / (4.0 * (1.0 + NU)) * scale
    # Errors of second order at 16 divisions.
    assert along[node_at(computed, 0.0, 0.0)] == pytest.approx(centre, rel=5e-3)
    assert along[np.argmax(computed.points[:, 0])] == pytest.approx(side, rel=5e-3)


@pytest.mark.parametrize(
    ("section", "walls"),
    [(HollowRectangle(0.1, 0.2, 0.004), 2), (ISection(0.1, 0.2, 0.008, 0.004), 1)],
    ids=["box", "i"],
)
def test_web_shear_equals_jourawski(section, walls):
    """τ = Q S/(I t) on the neutral axis (Jourawski); t is the thickness of all webs together."""
    computed = stresses(section, 16)
    width, height = section.extent
    flange, web = (0.004, 0.004) if walls == 2 else (0.008, 0.004)
    half = height / 2.0 - flange
    first = width * flange * (height - flange) / 2.0 + walls * web * half**2 / 2.0
    expected = first / (section.second_moment_y * walls * web)
    z = computed.points[:, 1]
    on_axis = np.abs(z) < 1e-9
    mean = (computed.shear[1] @ QZ)[on_axis].mean()
    # Across the web the stress varies by (thickness/height)².
    assert mean == pytest.approx(expected, rel=3e-3)


def test_box_torsion_equals_bredt():
    """τ = T/(2 A_m t) in the middle of the walls, with the area A_m within the middle line."""
    width, height, wall = 0.1, 0.2, 0.002
    computed = stresses(HollowRectangle(width, height, wall), 8)
    expected = 1.0 / (2.0 * (width - wall) * (height - wall) * wall)
    y, z = computed.points.T
    in_web = (np.abs(z) < 1e-9) & (y > 0.0)
    mean = np.abs(computed.shear[1] @ T)[in_web].mean()
    # Bredt neglects the Saint-Venant torsion of the walls, a term in t² over the enclosed area.
    assert mean == pytest.approx(expected, rel=1e-3)


def test_von_mises_stress_is_exact():
    """Under tension, bending and torque: σ_v² = (4N/πd² + 32M/πd³)² + 3 (16T/πd³)² at the rim."""
    d, tension, bending, torque = 0.1, 4.0e4, 900.0, 1500.0
    computed = stresses(Circle(d), 16)
    sigma = 4.0 * tension / (np.pi * d**2) + 32.0 * bending / (np.pi * d**3)
    tau = 16.0 * torque / (np.pi * d**3)
    forces = tension * N + bending * MZ + torque * T
    assert computed.von_mises(forces[None]).max() == pytest.approx(
        np.hypot(sigma, 3**0.5 * tau), rel=1e-3
    )


def test_corner_nodes_are_excluded():
    """Nodes within area/perimeter of a re-entrant corner are excluded: stress is singular there."""
    for section in SECTIONS[:3]:
        assert stresses(section).regular.all()
    computed = stresses(HollowRectangle(0.1, 0.2, 0.01))
    excluded = computed.points[~computed.regular]
    # Area over perimeter: outer perimeter 0.6 m, inner 0.52 m.
    radius = HollowRectangle(0.1, 0.2, 0.01).area / (0.6 + 0.52)
    corners = np.abs(excluded) - [0.04, 0.09]
    assert len(excluded) >= 4
    assert (np.linalg.norm(corners, axis=1) <= radius + 1e-12).all()


@pytest.mark.skipif(not calculix_version(), reason="CalculiX is not installed")
def test_stresses_equal_calculix(tmp_path):
    """σxx, τxy and τxz at the integration points of the middle third, under each unit wrench."""
    width, height, length = 0.06, 0.1, 0.45
    section = Rectangle(width, height)
    mesh = tetrahedra(section, length, 2)
    text = deck_text(leg_deck(mesh, STEEL, modes=0))
    output_request = "*EL PRINT, ELSET=PART1\nS\n*EL PRINT, ELSET=PART1\nCOORD\n*END STEP"
    (tmp_path / "leg.inp").write_text(text.replace("*END STEP", output_request))
    subprocess.run([calculix_program(), "-i", "leg"], cwd=tmp_path, check=True, capture_output=True)
    blocks = re.split(r"\n *\n", (tmp_path / "leg.dat").read_text())
    numbers = [
        np.array([line.split() for line in b.splitlines()], float)
        for b in blocks
        if contains_numbers(b)
    ]
    computed = stresses(section, 8)
    interpolated = LinearNDInterpolator(
        computed.points, np.stack([computed.normal, *computed.shear], axis=1).reshape(-1, 18)
    )
    by_case = {len(block[0]): [] for block in numbers}
    for block in numbers:
        by_case[len(block[0])].append(block)
    for wrench, values, positions in zip(np.eye(6), by_case[8], by_case[5], strict=True):
        x, y, z = positions[:, 2:].T
        middle = np.abs(x - length / 2.0) < length / 6.0
        forces = np.tile(wrench, (int(middle.sum()), 1))
        beyond = length - x[middle]
        forces[:, 4] -= wrench[2] * beyond
        forces[:, 5] += wrench[1] * beyond
        units = interpolated(np.column_stack([y, z])[middle]).reshape(-1, 3, 6)
        expected = np.einsum("pif,pf->pi", units, forces)
        solid = values[middle][:, [2, 5, 6]]
        # The least-squares factor between both must be one. The linear stresses of these coarse
        # tetrahedra scatter by 10 % in torsion, with twice as many by 3 %.
        factor = (solid * expected).sum() / (expected**2).sum()
        assert factor == pytest.approx(1.0, abs=0.01 if wrench[3] else 5e-4)
        assert np.linalg.norm(solid - expected) <= 0.12 * np.linalg.norm(expected)


def contains_numbers(block):
    """Return whether a block of CalculiX's output contains a table of numbers."""
    return bool(re.match(r"\s*\d+\s+\d+\s+\S+E", block))
