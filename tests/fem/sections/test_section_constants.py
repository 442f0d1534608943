"""Section constants from finite elements against closed forms, series and another package."""

from dataclasses import replace

import numpy as np
import pytest

from fem.sections.section_constants import beam_properties, section_constants
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material
from lumped.sections import (
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Tube,
    rectangle_torsion_constant,
)
from meshes.section.section_mesh import SectionMesh, section_mesh


def test_torsion_constant_converges_from_above_at_twice_the_order_of_the_element():
    # The warping minimises energy, so J of a convex section falls with refinement as h^2p, but
    # for rectangles (logarithmic corner term) a little slower.
    exact = rectangle_torsion_constant(0.1, 0.2)
    errors = [
        section_constants(section_mesh(Rectangle(0.1, 0.2), d), 0.0).torsion_constant / exact - 1.0
        for d in (3, 6)
    ]
    assert errors[0] > errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.6)


def test_ellipse():
    """J = π a³b³/(a² + b²), Iz = π b a³/4: Timoshenko & Goodier §106."""
    circle = section_mesh(Circle(2.0), 16)
    a, b = 0.5, 0.3
    constants = section_constants(replace(circle, nodes=circle.nodes * np.array([a, b])), 0.0)
    # Area of the parabolic edges: 3e-6 at 16 divisions, twice that in fourth moments.
    assert constants.area == pytest.approx(np.pi * a * b, rel=1e-5)
    assert constants.second_moment_z == pytest.approx(np.pi * b * a**3 / 4.0, rel=2e-5)
    assert constants.second_moment_y == pytest.approx(np.pi * a * b**3 / 4.0, rel=2e-5)
    exact = np.pi * a**3 * b**3 / (a**2 + b**2)
    assert constants.torsion_constant == pytest.approx(exact, rel=2e-5)
    # ω = −(a² − b²)/(a² + b²) y z, so Γ = ((a² − b²)/(a² + b²))² π a³b³/24.
    warping = ((a**2 - b**2) / (a**2 + b**2)) ** 2 * np.pi * (a * b) ** 3 / 24.0
    assert constants.warping_constant == pytest.approx(warping, rel=5e-5)


@pytest.mark.parametrize("section", [Rectangle(0.1, 0.16), Circle(0.1), Tube(0.1, 0.02)])
def test_cowper_coefficients_and_round_sections_that_do_not_warp(section):
    """Cowper (1966), exact for these three: 10(1+ν)/(12+11ν), 6(1+ν)/(7+6ν) and the tube's."""
    for nu in (0.0, 0.3):
        constants = section_constants(section_mesh(section, 12), nu)
        # Discretisation of the flexure function: 1e-5 at 12 quadratic cells.
        exact = section.shear_coefficients(nu)
        assert constants.cowper_coefficients == pytest.approx(exact, rel=3e-5)
    if not isinstance(section, Rectangle):
        polar = constants.second_moment_y + constants.second_moment_z
        # Only the faceting of the parabolic edges (1e-5 of the radius) makes the section warp.
        assert constants.torsion_constant == pytest.approx(polar, rel=1e-6)
        assert constants.warping_constant < 1e-9 * section.extent[0] ** 6
        assert polar == pytest.approx(section.torsion_constant, rel=5e-5)


def renton_rectangle(depth: float, width: float, nu: float) -> float:
    """κ of a rectangle sheared along `depth`, by strain energy (Renton 1991)."""
    odd_and_even, ratio = np.arange(1, 60), width / depth
    series = ratio * np.sum(np.tanh(odd_and_even * np.pi / ratio) / odd_and_even**5)
    bracket = 0.2 - 18.0 / np.pi**5 * series
    return float(1.0 / (1.2 + (nu / (1.0 + nu)) ** 2 * ratio**4 * bracket))


@pytest.mark.parametrize(
    ("section", "nu", "expected"),
    [
        *(
            (Rectangle(b, h), nu, (renton_rectangle(b, h, nu), renton_rectangle(h, b, nu)))
            for (b, h), nu in (((0.1, 0.1), 0.3), ((0.1, 0.2), 0.0), ((0.3, 0.1), 0.3))
        ),
        # 1/κ = 7/6 + (ν/(1 + ν))²/6.
        (Circle(0.1), 0.3, (1.0 / (7.0 / 6.0 + (0.3 / 1.3) ** 2 / 6.0),) * 2),
    ],
)
def test_energy_shear_coefficients(section, nu, expected):
    """Renton, Int. J. Solids Struct. 27 (1991)."""
    found = section_constants(section_mesh(section, 12), nu).shear_coefficients
    assert found == pytest.approx(expected, rel=2e-5)


def test_cubic_material_enters_through_its_shear_modulus():
    mesh = section_mesh(Rectangle(0.3, 0.1), 6)
    isotropic = section_constants(mesh, 0.25)
    # ν G/E is the same: 0.25 · 0.4 = 0.2 · 0.5.
    cubic = section_constants(mesh, 0.2, 0.5)
    assert cubic.shear_coefficients == pytest.approx(isotropic.shear_coefficients, rel=1e-13)
    assert section_constants(mesh, 0.2).shear_coefficients[1] != pytest.approx(
        isotropic.shear_coefficients[1], rel=1e-3
    )


def half_ring(radius: float, thickness: float) -> SectionMesh:
    """Half a thin ring about the origin, open towards −y, y² + z² = radius²."""
    strip = section_mesh(Rectangle(1.0, 1.0), (2, 48))
    r = radius + thickness * strip.nodes[:, 0]
    angle = np.pi * strip.nodes[:, 1]
    return replace(strip, nodes=np.column_stack([r * np.cos(angle), r * np.sin(angle)]))


def test_shear_centre_and_warping_of_a_half_ring():
    """Shear centre at 4R/π, Γ = 2tR⁵/3 (π³/8 − 12/π) (Roark, table of warping constants)."""
    radius, thickness = 0.1, 0.001
    constants = section_constants(half_ring(radius, thickness), 0.3)
    assert constants.centroid[0] == pytest.approx(2.0 * radius / np.pi, rel=1e-4)
    # Thin-wall theory leaves out (t/R)² and, for Γ, the wall's own warping: 1e-4.
    assert constants.shear_centre == pytest.approx((4.0 * radius / np.pi, 0.0), rel=5e-4, abs=1e-9)
    gamma = 2.0 * thickness * radius**5 / 3.0 * (np.pi**3 / 8.0 - 12.0 / np.pi)
    assert constants.warping_constant == pytest.approx(gamma, rel=5e-3)
    assert constants.torsion_constant == pytest.approx(np.pi * radius * thickness**3 / 3, rel=1e-2)


def test_turned_and_moved_section():
    """A turned rectangle: Iyz = (Iη − Iζ) sin 2α / 2; J, Γ are those of the upright one."""
    angle, shift = 0.4, np.array([0.3, -0.2])
    mesh = section_mesh(Rectangle(0.1, 0.2), 6)
    c, s = np.cos(angle), np.sin(angle)
    turned = section_constants(
        replace(mesh, nodes=mesh.nodes @ np.array([[c, s], [-s, c]]) + shift), 0.3
    )
    upright = section_constants(mesh, 0.3)
    i_y, i_z = 0.1 * 0.2**3 / 12.0, 0.2 * 0.1**3 / 12.0
    assert turned.product_moment == pytest.approx((i_z - i_y) * np.sin(2 * angle) / 2.0, rel=1e-12)
    assert turned.torsion_constant == pytest.approx(upright.torsion_constant, rel=1e-11)
    assert turned.warping_constant == pytest.approx(upright.warping_constant, rel=1e-10)
    assert turned.shear_centre == pytest.approx(tuple(shift), abs=1e-11)


@pytest.mark.exhaustive
def test_sections_against_sectionproperties():
    """Another finite element code: van Leeuwen, sectionproperties (six-node triangles)."""
    library = pytest.importorskip("sectionproperties.pre.library")
    analysis = pytest.importorskip("sectionproperties.analysis")
    pre = pytest.importorskip("sectionproperties.pre")
    nu = 0.3
    # In mm: that package's meshing has absolute tolerances.
    steel = pre.Material("unit", 1.0, nu, 1.0, 1.0, "grey")
    pairs = [
        (
            ISection(100.0, 160.0, 12.0, 8.0),
            library.i_section(d=160, b=100, t_f=12, t_w=8, r=0, n_r=0, material=steel),
        ),
        (
            HollowRectangle(100.0, 160.0, 12.0),
            library.rectangular_hollow_section(d=160, b=100, t=12, r_out=0, n_r=1, material=steel),
        ),
    ]
    for section, geometry in pairs:
        geometry.create_mesh(mesh_sizes=[8.0])
        theirs = analysis.Section(geometry)
        theirs.calculate_geometric_properties()
        theirs.calculate_warping_properties()
        ours = section_constants(section_mesh(section, 12), nu)
        assert ours.area == pytest.approx(theirs.get_ea(), rel=1e-12)
        # Stress singularities at the re-entrant corners: both meshes are within 3e-3 of the limit.
        assert ours.torsion_constant == pytest.approx(theirs.get_ej(), rel=6e-3)
        shear_areas = np.array(ours.shear_coefficients) * ours.area
        assert shear_areas == pytest.approx(np.array(theirs.get_eas()), rel=3e-3)
        assert ours.warping_constant == pytest.approx(theirs.get_egamma(), rel=5e-3)


def test_sections_in_two_pieces_and_mirrored_ones_are_refused():
    mesh = section_mesh(Rectangle(0.1, 0.1), 2)
    apart = SectionMesh(
        np.vstack([mesh.nodes, mesh.nodes + np.array([1.0, 0.0])]),
        np.vstack([mesh.cells, mesh.cells + len(mesh.nodes)]),
        mesh.element,
    )
    with pytest.raises(ComputationError, match="not in one piece"):
        section_constants(apart, 0.3)
    with pytest.raises(ComputationError, match="inside out"):
        section_constants(replace(mesh, nodes=mesh.nodes * np.array([1.0, -1.0])), 0.3)


def test_beam_properties_equal_the_textbook_ones_where_these_are_exact():
    material = Material(E=2.1e11, G=1.1e11, nu=0.0, rho=7850.0)
    section = Rectangle(0.1, 0.16)
    ours = beam_properties(section_constants(section_mesh(section, 16), 0.0), material)
    textbook = ConstantLeg(1.0, section, material).timoshenko
    for name, value in vars(textbook).items():
        assert getattr(ours, name) == pytest.approx(value, rel=1e-5), name
