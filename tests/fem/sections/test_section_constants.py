"""Section constants by finite elements against closed forms, series, thin walls and a package.

Also torsional waves along a leg, and the contraction of curved elements in bending.
"""

from dataclasses import replace

import numpy as np
import pytest
from support.robots.paper_legs import STEEL

from fem.sections.nonuniform_torsion import wave_frequency
from fem.sections.saint_venant import saint_venant, section_quadrature
from fem.sections.section_constants import beam_properties, held_contraction, section_constants
from fem.sections.waveguide import assembled, elasticity, strains, torsion_wave
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material
from lumped.sections import (
    Angle,
    Channel,
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Tee,
    Tube,
    flexure_moments,
    rectangle_torsion_constant,
)
from meshes.section.section_mesh import SectionMesh, section_mesh


def test_torsion_constant_has_twice_the_element_order():
    """Rectangle, J by Saint-Venant's series: quadratic elements have an error of order h⁴."""
    # The warping function minimises an energy, so that the error of J of a convex section falls as
    # h^2p; for rectangles slightly slower, because of a logarithmic corner term.
    meshes = [section_mesh(Rectangle(0.1, 0.2), divisions) for divisions in (3, 6)]
    exact = rectangle_torsion_constant(0.1, 0.2)
    errors = [section_constants(mesh, 0.0).torsion_constant / exact - 1.0 for mesh in meshes]
    assert errors[0] > errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.6)


@pytest.mark.parametrize(
    ("section", "accuracy"),
    [
        (Circle(0.1), 2e-3),
        (Tube(0.1, 0.03), 2e-3),
        # Thin walls: the shear flow turns at the corners.
        (HollowRectangle(0.1, 0.08, 0.004), 0.02),
        (ISection(0.05, 0.10, 0.006, 0.006), 0.02),
    ],
)
def test_flexure_moments_equal_finite_elements(section, accuracy):
    """∫yz τ dA of the shear stress across a unit force, in units of ∫y²z² dA/I, for ν = 0.3."""
    ratio = 0.3 / 2.6
    solution = saint_venant(section_mesh(section, 8), ratio)
    quad = solution.quadrature
    y, z = quad.points
    stresses = solution.flexure_stress[0, 1], solution.flexure_stress[1, 0]
    moments = [
        quad.integral(y * z * stress) * inertia
        for stress, inertia in zip(stresses, np.diag(solution.moments), strict=True)
    ]
    scale = quad.integral((y * z) ** 2)
    assert flexure_moments(section, ratio) == pytest.approx(moments, abs=accuracy * scale)


def test_ellipse_constants_equal_closed_form():
    """J = π a³b³/(a² + b²), Iz = π b a³/4: Timoshenko & Goodier, Theory of Elasticity, §106."""
    circle = section_mesh(Circle(2.0), 16)
    a, b = 0.5, 0.3
    constants = section_constants(replace(circle, nodes=circle.nodes * np.array([a, b])), 0.0)
    # With parabolic edges and 16 divisions the area has an error of 3e-6, second moments twice
    # that.
    assert constants.area == pytest.approx(np.pi * a * b, rel=1e-5)
    assert constants.second_moment_z == pytest.approx(np.pi * b * a**3 / 4.0, rel=2e-5)
    assert constants.second_moment_y == pytest.approx(np.pi * a * b**3 / 4.0, rel=2e-5)
    assert constants.torsion_constant == pytest.approx(
        np.pi * (a * b) ** 3 / (a**2 + b**2), rel=2e-5
    )
    # ω = −(a² − b²)/(a² + b²) y z, so Γ = ((a² − b²)/(a² + b²))² π a³b³/24.
    warping = ((a**2 - b**2) / (a**2 + b**2)) ** 2 * np.pi * (a * b) ** 3 / 24.0
    assert constants.warping_constant == pytest.approx(warping, rel=5e-5)


@pytest.mark.parametrize("section", [Rectangle(0.1, 0.16), Circle(0.1), Tube(0.1, 0.02)])
def test_shear_factors_equal_cowper(section):
    """Cowper (1966): 10(1+ν)/(12+11ν) for rectangles, 6(1+ν)/(7+6ν) for circles, and tubes."""
    for nu in (0.0, 0.3):
        constants = section_constants(section_mesh(section, 12), nu)
        # Discretisation error of the flexure function with 12 quadratic elements: 1e-5.
        assert constants.cowper_coefficients == pytest.approx(
            section.shear_coefficients(nu), rel=3e-5
        )
    if not isinstance(section, Rectangle):
        polar = constants.second_moment_y + constants.second_moment_z
        # A circle does not warp; its parabolic edges differ by 1e-5 of the radius.
        assert constants.torsion_constant == pytest.approx(polar, rel=1e-6)
        assert constants.warping_constant < 1e-9 * section.extent[0] ** 6
        assert polar == pytest.approx(section.torsion_constant, rel=5e-5)


def renton_rectangle(depth: float, width: float, nu: float) -> float:
    """Return κ of a rectangle sheared along `depth`, by strain energy (Renton 1991)."""
    odd_and_even, ratio = np.arange(1, 60), width / depth
    series = ratio * np.sum(np.tanh(odd_and_even * np.pi / ratio) / odd_and_even**5)
    bracket = 0.2 - 18.0 / np.pi**5 * series
    return float(1.0 / (1.2 + (nu / (1.0 + nu)) ** 2 * ratio**4 * bracket))


def test_energy_shear_coefficients_equal_renton():
    """Rectangles: Renton, Int. J. Solids Struct. 27 (1991); circle: 1/κ = 7/6 + (ν/(1 + ν))²/6."""
    expected_of = {(Circle(0.1), 0.3): (1.0 / (7.0 / 6.0 + (0.3 / 1.3) ** 2 / 6.0),) * 2}
    for b, h, nu in ((0.1, 0.1, 0.3), (0.1, 0.2, 0.0), (0.3, 0.1, 0.3)):
        expected_of[Rectangle(b, h), nu] = renton_rectangle(b, h, nu), renton_rectangle(h, b, nu)
    for (section, nu), expected in expected_of.items():
        computed = section_constants(section_mesh(section, 12), nu).shear_coefficients
        assert computed == pytest.approx(expected, rel=2e-5)


def test_cubic_material_shear_is_exact():
    """With independent G, κ depends on νG/E alone: that of the isotropic material of equal νG/E."""
    mesh = section_mesh(Rectangle(0.3, 0.1), 6)
    # Shear coefficients depend on ν G/E, equal for the first two: 0.25 · 0.4 = 0.2 · 0.5.
    isotropic, cubic, other = (
        section_constants(mesh, *nu_and_ratio).shear_coefficients
        for nu_and_ratio in ((0.25,), (0.2, 0.5), (0.2,))
    )
    assert cubic == pytest.approx(isotropic, rel=1e-13)
    assert other[1] != pytest.approx(isotropic[1], rel=1e-3)


def test_half_ring_equals_roark():
    """Shear centre at 4R/π, Γ = 2tR⁵/3 (π³/8 − 12/π) (Roark, table of warping constants).

    The section is half of a thin ring about the origin, open towards −y.
    """
    radius, thickness = 0.1, 0.001
    strip = section_mesh(Rectangle(1.0, 1.0), (2, 48))
    r, angle = radius + thickness * strip.nodes[:, 0], np.pi * strip.nodes[:, 1]
    ring = replace(strip, nodes=np.column_stack([r * np.cos(angle), r * np.sin(angle)]))
    constants = section_constants(ring, 0.3)
    assert constants.centroid[0] == pytest.approx(2.0 * radius / np.pi, rel=1e-4)
    # Thin-wall theory neglects terms in (t/R)² and the warping across the wall: 1e-4.
    assert constants.shear_centre == pytest.approx((4.0 * radius / np.pi, 0.0), rel=5e-4, abs=1e-9)
    gamma = 2.0 * thickness * radius**5 / 3.0 * (np.pi**3 / 8.0 - 12.0 / np.pi)
    assert constants.warping_constant == pytest.approx(gamma, rel=5e-3)
    assert constants.torsion_constant == pytest.approx(np.pi * radius * thickness**3 / 3, rel=1e-2)


def test_rotated_section_constants_transform():
    """Rotated rectangle: Iyz = (Iη − Iζ) sin 2α / 2; J and Γ as for the upright one."""
    angle, shift = 0.4, np.array([0.3, -0.2])
    mesh = section_mesh(Rectangle(0.1, 0.2), 6)
    c, s = np.cos(angle), np.sin(angle)
    moved_mesh = replace(mesh, nodes=mesh.nodes @ np.array([[c, s], [-s, c]]) + shift)
    turned, upright = section_constants(moved_mesh, 0.3), section_constants(mesh, 0.3)
    i_y, i_z = 0.1 * 0.2**3 / 12.0, 0.2 * 0.1**3 / 12.0
    assert turned.product_moment == pytest.approx((i_z - i_y) * np.sin(2 * angle) / 2.0, rel=1e-12)
    assert turned.torsion_constant == pytest.approx(upright.torsion_constant, rel=1e-11)
    assert turned.warping_constant == pytest.approx(upright.warping_constant, rel=1e-10)
    assert turned.shear_centre == pytest.approx(tuple(shift), abs=1e-11)


@pytest.mark.exhaustive
def test_constants_equal_sectionproperties():
    """Another finite element code with six-node triangles: van Leeuwen, sectionproperties."""
    library = pytest.importorskip("sectionproperties.pre.library")
    analysis = pytest.importorskip("sectionproperties.analysis")
    pre = pytest.importorskip("sectionproperties.pre")
    # Lengths in mm, because that package meshes with absolute tolerances.
    size = {"d": 160, "b": 100, "material": pre.Material("unit", 1.0, 0.3, 1.0, 1.0, "grey")}
    box = library.rectangular_hollow_section(t=12, r_out=0, n_r=1, **size)
    pairs = {
        ISection(100.0, 160.0, 12.0, 8.0): library.i_section(t_f=12, t_w=8, r=0, n_r=0, **size),
        HollowRectangle(100.0, 160.0, 12.0): box,
        Channel(100.0, 160.0, 12.0, 8.0): library.channel_section(
            t_f=12, t_w=8, r=0, n_r=0, **size
        ),
        Angle(100.0, 160.0, 12.0, 12.0): library.angle_section(t=12, r_r=0, r_t=0, n_r=1, **size),
        Tee(100.0, 160.0, 12.0, 8.0): library.tee_section(t_f=12, t_w=8, r=0, n_r=0, **size),
    }
    for section, geometry in pairs.items():
        geometry.create_mesh(mesh_sizes=[8.0])
        reference = analysis.Section(geometry)
        reference.calculate_geometric_properties()
        reference.calculate_warping_properties()
        computed = section_constants(section_mesh(section, 12), 0.3)
        assert computed.area == pytest.approx(reference.get_ea(), rel=1e-12)
        # Stresses are singular at re-entrant corners: both meshes have errors of up to 3e-3.
        assert computed.torsion_constant == pytest.approx(reference.get_ej(), rel=6e-3)
        shear_areas = np.array(computed.shear_coefficients) * computed.area
        assert shear_areas == pytest.approx(np.array(reference.get_eas()), rel=3e-3)
        centre = np.subtract(computed.shear_centre, computed.centroid)
        # Of a size of 160 mm. The tee of the other mesh is off by 0.15 mm.
        assert centre == pytest.approx(np.subtract(reference.get_sc(), reference.get_c()), abs=0.2)
        if not isinstance(section, Angle | Tee):
            # Walls that meet in one point warp only across their thickness.
            assert computed.warping_constant == pytest.approx(reference.get_egamma(), rel=5e-3)


def test_split_or_mirrored_mesh_is_refused():
    """Two squares 1 m apart, and a mesh whose elements are inside out."""
    mesh = section_mesh(Rectangle(0.1, 0.1), 2)
    nodes = np.vstack([mesh.nodes, mesh.nodes + np.array([1.0, 0.0])])
    cells = np.vstack([mesh.cells, mesh.cells + len(mesh.nodes)])
    with pytest.raises(ComputationError, match="not in one piece"):
        section_constants(SectionMesh(nodes, cells, mesh.element), 0.3)
    with pytest.raises(ComputationError, match="inside out"):
        section_constants(replace(mesh, nodes=mesh.nodes * np.array([1.0, -1.0])), 0.3)


def test_mesh_properties_equal_formulas():
    """Stiffnesses and masses of a rectangular beam, from a mesh and in closed form (ν = 0)."""
    material = Material(E=2.1e11, G=1.1e11, nu=0.0, rho=7850.0)
    section = Rectangle(0.1, 0.16)
    computed = beam_properties(section_constants(section_mesh(section, 16), 0.0), material)
    assert vars(computed) == pytest.approx(
        vars(ConstantLeg(1.0, section, material).timoshenko), rel=1e-5
    )


def test_circle_torsion_has_no_dispersion():
    """Pochhammer: the lowest torsional wave of a round bar runs at √(G/ρ) at any wave number."""
    mesh = section_mesh(Circle(0.1), 6)
    for k in (1.0, 30.0):
        # The mesh of the circle has an area error of 1e-5.
        np.testing.assert_allclose(
            torsion_wave(mesh, STEEL, k), k * np.sqrt(STEEL.G / STEEL.rho), rtol=1e-4
        )


def test_thick_i_section_wave_equals_reissner():
    """E. Reissner, J. Math. Phys. 31 (1952) 268: a rod with one warping function."""
    mesh = section_mesh(ISection(width=0.1, height=0.16, flange=0.02, web=0.02), 4)
    k = np.pi / 1.6
    rod = wave_frequency(section_constants(mesh, STEEL.nu), STEEL, k)
    # Warping raises the frequency by 8 %; one warping function errs by 1.4 % of that (observed).
    np.testing.assert_allclose(torsion_wave(mesh, STEEL, k) / (2.0 * np.pi), rod, rtol=2e-3)


def test_thin_i_section_wave_equals_vlasov():
    """V. Z. Vlasov: ω² = (GJ k² + EΓ k⁴)/(ρI_p + ρΓ k²), without shear of the walls."""
    mesh = section_mesh(ISection(width=0.1, height=0.2, flange=0.004, web=0.003), 4)
    constants, k = section_constants(mesh, 0.0), np.pi / 4.0
    m = Material.isotropic(2.1e11, 0.0, 7850.0)
    polar = constants.second_moment_y + constants.second_moment_z
    gamma = constants.warping_constant * k**2
    stiffness = m.G * constants.torsion_constant + m.E * gamma
    vlasov = k * np.sqrt(stiffness / (m.rho * (polar + gamma))) / (2.0 * np.pi)
    # Shear of the walls lowers it by less than 1 %, distortion of the walls by as much at most.
    np.testing.assert_allclose(wave_frequency(constants, m, k), vlasov, rtol=0.01)
    np.testing.assert_allclose(torsion_wave(mesh, m, k) / (2.0 * np.pi), vlasov, rtol=0.02)


@pytest.mark.parametrize(
    ("section", "nu"), [(HollowRectangle(0.1, 0.16, 0.01), 0.3), (Circle(0.1), 0.0)]
)
def test_straight_sided_section_contracts_freely(section, nu):
    """Only curved elements with ν > 0 restrain contraction in bending."""
    assert not held_contraction(section_quadrature(section_mesh(section, 2)), nu, 0.4).any()


AUXETIC = Material.isotropic(2.1e11, -0.9, 7850.0)
SOFT = Material(E=1.0, G=2.0, nu=0.25, rho=1.0)


@pytest.mark.parametrize("material", [STEEL, AUXETIC, SOFT])
@pytest.mark.parametrize("section", [Circle(0.1), Tube(0.1, 0.02)])
def test_curved_section_moments_equal_energy(section, material):
    """Reference: least strain energy over the displacements in the plane, with εxx = y or z.

    The energy f₀ − fᵀK⁺f is computed with dense matrices (generalised plane strain). Divided by E
    it is the second moment with restrained contraction.
    """
    quad = section_quadrature(section_mesh(section, 4))
    moduli, field = elasticity(material), strains(quad, 0.0)
    local = np.einsum("mqsi,st,mqtj,mq->mij", field, moduli, field, quad.weights, optimize=True)
    cells = 3 * quad.mesh.cells[:, :, None] + np.arange(3)
    expected = np.zeros((2, 2))
    loads = np.zeros((3 * len(quad.mesh.nodes), 2))
    for i, s in enumerate(quad.points):
        by_cell = np.einsum("mqsi,s,mq->mi", field, moduli[:, 0], s * quad.weights)
        np.add.at(loads[:, i], cells.reshape(len(local), -1), by_cell)
        for j, other in enumerate(quad.points):
            expected[i, j] = moduli[0, 0] * quad.integral(s * other)
    relaxed = np.linalg.lstsq(assembled(quad, local), loads, rcond=1e-11)[0]
    expected -= loads.T @ relaxed
    moments = np.array([[quad.integral(a * b) for b in quad.points] for a in quad.points])
    stiffened = moments + held_contraction(quad, material.nu, material.G / material.E)
    # Rounding error of the pseudoinverse, worst for ν = −0.9, where moduli differ 40-fold.
    expected /= material.E
    np.testing.assert_allclose(stiffened, expected, rtol=0.0, atol=1e-9 * moments[0, 0])
    assert stiffened[0, 0] > moments[0, 0] * (1.0 + 1e-6)
