"""Flexibility of tapered, stepped, curved and bent legs, against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad

from lumped.beam_properties import tip_compliance
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.models.segments import line_segment_chain, segment_leg, static_leg
from lumped.screws import move_compliance, shift
from lumped.sections import (
    Angle,
    Circle,
    HollowRectangle,
    ISection,
    Rectangle,
    Tube,
    symmetric_moments,
)

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
UP = (0.0, 0.0, 1.0)
LENGTH = 1.2
# Gauss quadrature differs from closed forms by rounding errors; its truncation error is smaller for
# tapers up to 3:1.
EXACT = 1e-11


def straight(*stations, material=STEEL, length=LENGTH):
    """Return a straight leg of `length` (m) with sections at distances (m) along it."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), UP)
    return LineLeg(line, stations, material)


def arc(radius, angle, section, material=STEEL):
    """Return a leg on an arc of `angle` (rad) in its x-y plane, bulging along y."""
    chord, rise = 2.0 * radius * np.sin(angle / 2.0), radius * (1.0 - np.cos(angle / 2.0))
    piece = LinePiece((0.0, 0.0, 0.0), (chord, 0.0, 0.0), (chord / 2.0, rise, 0.0))
    line = CentreLine((piece,), UP)
    return LineLeg(line, ((0.0, section), (line.length, section)), material)


def test_cone_compliance_is_exact():
    """Integrals of a cone whose radius r falls by s per metre from r₁ at the root to r₂ at the tip.

    Because fibres converge, tension is 1 + s² times ∫ 1/EA and bending 1 + 4/3 s² times ∫ u²/EI
    with the distance u from the tip (averages of 2 slope² over the section). Shear is due to the
    force Q r₂/r that is not carried by inclined fibres; shear and bending are coupled by
    4/3 s/πEr³ times (3 + 2ν)/4(1 + ν), with the shear stresses across the force. Twist as in
    Roark's Formulas, tapered beams.
    """
    root, tip = 0.12, 0.05
    leg = straight((0.0, Circle(root)), (LENGTH, Circle(tip)))
    compliance = leg.sections("timoshenko").tip_compliance
    E, G, nu = STEEL.E, STEEL.G, STEEL.nu
    slope, r1, r2 = 0.5 * (root - tip) / LENGTH, 0.5 * root, 0.5 * tip
    kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)
    inertia = np.pi * root**4 / 64.0
    bending = LENGTH**3 / (3.0 * E * inertia) * root / tip * (1.0 + 4.0 / 3.0 * slope**2)
    shear = r2**2 / (kappa * G * np.pi) * (r2**-3 - r1**-3) / (3.0 * slope)
    coupling = 8.0 / 3.0 * slope * r2 / (np.pi * E) * (3.0 + 2.0 * nu) / (4.0 + 4.0 * nu)
    coupling *= LENGTH**2 * (2.0 * r2 + r1) / (6.0 * r2**2 * r1**3)
    cubes = root**2 + root * tip + tip**2
    twist = 32.0 * LENGTH * cubes / (3.0 * np.pi * G * (root * tip) ** 3)
    tension = 4.0 * LENGTH / (np.pi * E * root * tip) * (1.0 + slope**2)
    deflection = bending + shear + coupling
    expected = [tension, deflection, deflection, twist]
    assert np.diag(compliance)[:4] == pytest.approx(expected, rel=EXACT)


def test_slender_wedge_compliance_is_exact():
    """Closed form of ∫ x²/h³ (Euler–Bernoulli) for linear height h(x) and constant width."""
    width, root, tip = 0.04, 0.1, 0.035
    leg = straight((0.0, Rectangle(width, root)), (LENGTH, Rectangle(width, tip)))
    ratio, slope, log = tip / root, (root - tip) / LENGTH, np.log(root / tip)
    bending = 12.0 * (log + 2.0 * ratio - 0.5 * ratio**2 - 1.5) / (STEEL.E * width * slope**3)
    slender = leg.sections("euler-bernoulli").tip_compliance
    assert slender[2, 2] == pytest.approx(bending, rel=EXACT)


def wedge_errors(root, tip):
    """Relative errors of a wedge's compliance under apex force, tension, moment: plane stress.

    Timoshenko and Goodier, Theory of Elasticity: stresses P sin θ/(α − ½ sin 2α)/br across,
    P cos θ/(α + ½ sin 2α)/br along (Michell), and of a moment 2 sin 2θ/Dbr² with shear
    (cos 2θ − cos 2α)/Dbr², D = sin 2α − 2α cos 2α (Carothers). Their energies between the planes of
    root and tip are compared. Without Poisson's ratio, κ is 5/6.
    """
    width, material = 0.04, Material.isotropic(E=2.1e11, nu=0.0, rho=7850.0)
    leg = straight(
        (0.0, Rectangle(width, root)), (LENGTH, Rectangle(width, tip)), material=material
    )
    compliance = leg.sections("timoshenko").tip_compliance
    half = np.arctan(0.5 * (root - tip) / LENGTH)
    near = 0.5 * tip / np.tan(half)
    log, rigidity = np.log(1.0 + LENGTH / near), material.E * width
    across = 2.0 * log / (rigidity * (2.0 * half - np.sin(2.0 * half)))
    along = log / (rigidity * (half + 0.5 * np.sin(2.0 * half)))
    denominator = np.sin(2.0 * half) - 2.0 * half * np.cos(2.0 * half)

    def energy(angle):
        normal = 2.0 * np.sin(2.0 * angle) / denominator
        shear = (np.cos(2.0 * angle) - np.cos(2.0 * half)) / denominator
        density = normal**2 / material.E + shear**2 / material.G
        return float(density * np.cos(angle) ** 2)

    angular, _ = quad(energy, -half, half, epsabs=0.0, epsrel=1e-12)
    moment = angular / width * (near**-2 - (near + LENGTH) ** -2) / 2.0
    at_apex = move_compliance(compliance, np.array([near, 0.0, 0.0]))
    compliances = np.array([at_apex[2, 2], compliance[0, 0], compliance[4, 4]])
    return compliances / [across, along, moment] - 1.0


def test_wedge_equals_elasticity_to_fourth_order():
    """Errors fall by 2⁴ if the slope is halved; with parallel fibres they would fall by 2²."""
    steep, flat = wedge_errors(0.2, 0.07), wedge_errors(0.1, 0.035)
    assert np.abs(steep).max() < 3e-6
    assert steep / flat == pytest.approx(16.0, rel=0.01)


def test_constant_sections_give_prism():
    """Equal angle sections at both ends: compliance and mass of the prism."""
    section = Angle(0.05, 0.1, 0.005, 0.008)
    leg = straight((0.0, section), (LENGTH, section))
    prism = ConstantLeg(LENGTH, section, STEEL)
    for theory in ("timoshenko", "euler-bernoulli"):
        expected = tip_compliance(prism.properties(theory), LENGTH)
        compliance = leg.sections(theory).tip_compliance
        assert np.abs(compliance - expected).max() < EXACT * np.abs(expected).max()
    assert leg.mass == pytest.approx(prism.mass, rel=EXACT)


def test_stepped_leg_equals_two_prisms():
    """Compliances of both parts, moved to the tip, in series."""
    stout, slender, step = Circle(0.08), Circle(0.05), 0.4
    leg = straight((0.0, stout), (step, stout), (step, slender), (LENGTH, slender))
    first = tip_compliance(ConstantLeg(step, stout, STEEL).timoshenko, step)
    second_length = LENGTH - step
    second = tip_compliance(ConstantLeg(second_length, slender, STEEL).timoshenko, second_length)
    expected = move_compliance(first, np.array([second_length, 0.0, 0.0])) + second
    compliance = leg.sections("timoshenko").tip_compliance
    assert np.abs(compliance - expected).max() < EXACT * np.abs(expected).max()


def test_bent_leg_equals_two_prisms():
    """Corner from (0, 0) over (0.3, 0.4) to (0.8, 0.4) m; the leg's x axis points at the tip."""
    section = Tube(0.06, 0.008)
    corner, end = np.array([0.3, 0.4, 0.0]), np.array([0.8, 0.4, 0.0])
    x = end / np.linalg.norm(end)
    to_leg = np.array([x, np.cross([0.0, 0.0, 1.0], x), [0.0, 0.0, 1.0]])
    knee, tip = to_leg @ corner, to_leg @ end
    pieces = (
        LinePiece((0.0, 0.0, 0.0), tuple(knee.tolist())),
        LinePiece(tuple(knee.tolist()), (float(tip[0]), 0.0, 0.0)),
    )
    line = CentreLine(pieces, UP)
    leg = LineLeg(line, ((0.0, section), (line.length, section)), STEEL)
    assert leg.line.corners == pytest.approx((0.5,))
    expected = np.zeros((6, 6))
    for start, stop in ((np.zeros(3), corner), (corner, end)):
        length = float(np.linalg.norm(stop - start))
        direction = (stop - start) / length
        axes = np.column_stack([direction, np.cross([0, 0, 1], direction), [0, 0, 1]])
        block = np.kron(np.eye(2), axes)
        prism = tip_compliance(ConstantLeg(length, section, STEEL).timoshenko, length)
        expected += move_compliance(block @ prism @ block.T, end - stop)
    block = np.kron(np.eye(2), to_leg)
    expected = block @ expected @ block.T
    compliance = leg.sections("timoshenko").tip_compliance
    assert np.abs(compliance - expected).max() < EXACT * np.abs(expected).max()


def test_quarter_ring_equals_elasticity():
    """Radial load on a quarter ring: Timoshenko & Goodier, Theory of Elasticity, §33.

    MacNeal and Harder (Finite Elem. Anal. Des. 1 (1985) 3) give 0.08734 for this beam, 1.4 % less
    than the elastic solution and than bending of the centre line, πPR³/4EI = 0.08854. Out of plane
    they give 0.5022; solid elements converge to 0.498.
    """
    inner, outer, thickness = 4.12, 4.32, 0.1
    material = Material.isotropic(E=1e7, nu=0.25, rho=1.0)
    leg = arc(4.22, np.pi / 2.0, Rectangle(outer - inner, thickness), material)
    compliance = leg.sections("timoshenko").tip_compliance
    radial = np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0])
    in_plane = float(radial @ compliance[:3, :3] @ radial)
    squares = inner**2 + outer**2
    denominator = inner**2 - outer**2 + squares * np.log(outer / inner)
    elastic = np.pi * squares / (material.E * thickness * denominator)
    # Shear contributes 5.5e-4 and depends on how the root is held; the difference was 1.2e-4.
    assert in_plane == pytest.approx(elastic, rel=2e-4)
    assert in_plane == pytest.approx(0.08734, rel=0.015)
    assert compliance[2, 2] == pytest.approx(0.5022, rel=0.004)


def test_thick_arc_bends_as_winkler_bar():
    """End moment on an arc with h/R = 0.4: φ = M α/(A e E) with e = R − h/ln(b/a) (Winkler)."""
    radius, height, width, angle = 0.25, 0.1, 0.03, 1.1
    leg = arc(radius, angle, Rectangle(height, width))
    turn = leg.sections("timoshenko").tip_compliance[5, 5]
    eccentricity = radius - height / np.log((radius + height / 2.0) / (radius - height / 2.0))
    expected = angle / (height * width * eccentricity * STEEL.E)
    # The first term of the series that the program omits is 3/112 (h/R)⁴ = 7e-4.
    assert turn / expected - 1.0 == pytest.approx(3.0 / 112.0 * 0.4**4, rel=0.2)


def test_moments_of_symmetric_shapes_equal_sums():
    """Sums over a fine grid of the bounding box; its cells give an error of 1 % for thin walls."""
    shapes = (
        Rectangle(0.03, 0.05),
        HollowRectangle(0.06, 0.04, 0.006),
        ISection(0.05, 0.06, 0.008, 0.006),
        Circle(0.05),
        Tube(0.05, 0.008),
    )
    for shape in shapes:
        width, height = shape.extent
        y, z = np.meshgrid(
            *(side * ((np.arange(800) + 0.5) / 800 - 0.5) for side in (width, height))
        )
        cell = width * height / y.size
        match shape:
            case Rectangle():
                inside = abs(y) < width
            case HollowRectangle():
                hole = shape.inner
                inside = (abs(y) > hole.width / 2.0) | (abs(z) > hole.height / 2.0)
            case ISection():
                inside = (abs(z) > height / 2.0 - shape.flange) | (abs(y) < shape.web / 2.0)
            case _:
                radius = np.hypot(y, z)
                inside = (radius < width / 2.0) & (radius > shape.inner_diameter / 2.0)
        integrands = (abs(y), abs(z), y**4, z**4, y**2 * z**2)
        sums = [float((values * inside).sum() * cell) for values in integrands]
        assert symmetric_moments(shape) == pytest.approx(sums, rel=0.01)
    assert symmetric_moments(Angle(0.05, 0.1, 0.005, 0.008)) is None


def test_half_ring_opens_as_castigliano():
    """Slender half ring, opposite forces at its ends: ∫ (R sin θ)²/EI R dθ without tension."""
    radius, diameter = 1.0, 0.002
    leg = arc(radius, np.pi, Circle(diameter))
    opening = leg.sections("euler-bernoulli").tip_compliance
    relative = opening[0, 0]
    bending = np.pi / 2.0 * radius**3 / (STEEL.E * np.pi * diameter**4 / 64.0)
    # Tension and its coupling to bending add (d/R)²/16 of the bending term.
    assert relative == pytest.approx(bending, rel=1e-6)


@pytest.mark.parametrize("elements", [1, 4, 7])
@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
def test_curved_segments_are_exact(elements, theory):
    """Curved, tapered leg: for any number of segments the tip compliance is the exact integral."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.3, 0.1)),), UP)
    leg = LineLeg(line, ((0.0, Rectangle(0.05, 0.1)), (line.length, Rectangle(0.03, 0.04))), STEEL)
    sections = leg.sections(theory)
    expected = sections.tip_compliance
    chain = line_segment_chain(sections, elements)
    for model in (static_leg(chain), segment_leg(chain)):
        clamped = np.linalg.inv(model.stiffness.toarray()[6:, 6:])[:6, :6]
        assert np.abs(clamped - expected).max() < EXACT * np.abs(expected).max()


@pytest.mark.parametrize("layout", ["half", "literal"])
def test_curved_segments_keep_mass(layout):
    """Mass and inertia of a curved tube: those of its integrals, ρ times volume (Pappus)."""
    leg = arc(0.5, 2.0, Tube(0.05, 0.004))
    sections = leg.sections("timoshenko")
    chain = line_segment_chain(sections, 6, layout)
    about = sections.masses(sections.ends[[0, -1]], np.zeros((1, 3)))[0]
    motions = [shift(point) for point in chain.points]
    total = sum(
        motion.T @ mass @ motion for motion, mass in zip(motions, chain.masses, strict=True)
    )
    assert np.abs(total - about).max() < EXACT * np.abs(about).max()
    volume = np.pi * (0.05**2 - 0.042**2) / 4.0 * 0.5 * 2.0
    assert leg.mass == pytest.approx(STEEL.rho * volume, rel=EXACT)


def test_doubled_count_halves_every_element():
    """A leg with a corner whose pieces have lengths of 4 : 3, and one with a short middle span."""
    corner = CentreLine(
        (
            LinePiece((0.0, 0.0, 0.0), (0.32, 0.24, 0.0)),
            LinePiece((0.32, 0.24, 0.0), (0.5, 0.0, 0.0)),
        ),
        UP,
    )
    square = Rectangle(0.04, 0.04)
    frame = LineLeg(corner, ((0.0, square), (corner.length, square)), STEEL)
    wide = Rectangle(0.06, 0.04)
    stepped = straight((0.0, wide), (0.5, wide), (0.55, square), (LENGTH, square))
    for leg, spans in ((frame, 2), (stepped, 3)):
        sections = leg.sections("timoshenko")
        assert len(sections.ends) == spans + 1
        for count in range(spans, 41):
            edges = sections.edges(count)
            np.testing.assert_allclose(sections.edges(2 * count)[::2], edges, atol=1e-15)
            assert len(edges) - 1 >= count


def test_part_of_line_is_the_line_between_two_positions():
    """An arc and a straight piece, cut on both sides of their corner."""
    pieces = (
        LinePiece((0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (0.3, 0.06, 0.0)),
        LinePiece((0.6, 0.0, 0.0), (0.6, 0.0, 0.4)),
    )
    line = CentreLine(pieces, (0.0, 1.0, 0.0))
    start, end = line.ends[1] - 0.2, line.ends[1] + 0.1
    cut = CentreLine(line.part(start, end), line.up)
    assert cut.ends == pytest.approx([0.0, 0.2, 0.3], rel=1e-12)
    assert cut.pieces[0].radius == pytest.approx(pieces[0].radius, rel=1e-9)
    positions = np.linspace(0.0, 0.3, 8)
    for part, whole in zip(cut.frames(positions), line.frames(start + positions), strict=True):
        assert part == pytest.approx(whole, abs=1e-12)
    assert line.part(line.ends[1], line.length) == pieces[1:]
