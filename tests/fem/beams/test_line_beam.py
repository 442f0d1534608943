"""Beam elements of tapered and curved legs: order, published frequencies, limits."""

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from fem.beams.line_beam import line_beam
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.models.bodies import clamped_modes, tip_compliance_of
from lumped.models.segments import line_segment_chain, segment_leg
from lumped.sections import Angle, Circle, Rectangle

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
UP = (0.0, 0.0, 1.0)
STRAIGHT = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), UP)
ARC = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.3, 0.1)),), UP)
THEORIES = ("timoshenko", "euler-bernoulli")


def tapered(line, root=None, tip=None, material=STEEL):
    sections = root or Rectangle(0.05, 0.1), tip or Rectangle(0.03, 0.04)
    return LineLeg(line, ((0.0, sections[0]), (line.length, sections[1])), material)


def frequencies(leg, theory, elements, count=4):
    return clamped_modes(line_beam(leg.sections(theory), elements), count).frequencies


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("section", [Rectangle(0.05, 0.1), Angle(0.05, 0.1, 0.005, 0.008)])
def test_equal_sections_give_prism_beam(section, theory):
    """A line leg with equal end sections has the frequencies and shapes of the prism."""
    leg = tapered(STRAIGHT, section, section)
    line, prism = (
        line_beam(leg.sections(theory), 4),
        beam_leg(ConstantLeg(1.0, section, STEEL).properties(theory), 1.0, 4),
    )
    # Rounding error of four elements; 1e-13 was observed.
    modes, expected = clamped_modes(line, 10), clamped_modes(prism, 10)
    assert modes.frequencies == pytest.approx(expected.frequencies, rel=1e-11)
    points = np.array([[0.1, 0.02, -0.03], [0.55, 0.0, 0.01], [1.0, 0.02, 0.04]])
    motion, expected_motion = (
        np.abs(model.displacements(points) @ shapes.shapes[:, 0])
        for model, shapes in ((line, modes), (prism, expected))
    )
    assert motion == pytest.approx(expected_motion, abs=1e-10 * expected_motion.max())


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("line", [STRAIGHT, ARC])
def test_tapered_beam_statics_are_exact(line, theory):
    """Reference: flexibility integrals of a straight and of a curved tapered leg."""
    sections = tapered(line).sections(theory)
    expected = sections.tip_compliance
    for elements in (1, 3):
        compliance = tip_compliance_of(line_beam(sections, elements))
        assert np.abs(compliance - expected).max() < 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("line", [STRAIGHT, ARC])
def test_tapered_beam_has_order_four(line, theory):
    """Frequencies of straight and curved tapered legs, relative to those of 80 elements."""
    leg = tapered(line)
    limit = frequencies(leg, theory, 80)
    coarse, fine = (frequencies(leg, theory, n) / limit - 1.0 for n in (10, 20))
    # Frequencies converge from above (Rayleigh).
    assert (fine > 0.0).all()
    assert fine.max() < 1e-4
    assert np.log2(coarse / fine) == pytest.approx(4.0, abs=0.15)


@pytest.mark.parametrize("line", [STRAIGHT, ARC])
def test_tapered_segment_order_is_two(line):
    """Frequencies relative to 80 beam elements; the literal layout has order one."""
    sections = tapered(line).sections("timoshenko")
    limit = clamped_modes(line_beam(sections, 80), 3).frequencies
    errors = [
        clamped_modes(segment_leg(line_segment_chain(sections, n)), 3).frequencies / limit - 1.0
        for n in (20, 40)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    literal = [
        clamped_modes(segment_leg(line_segment_chain(sections, n, "literal")), 3).frequencies
        / limit
        - 1.0
        for n in (20, 40)
    ]
    assert np.log2(literal[0] / literal[1]) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(
    ("root", "tip", "published"),
    [
        (Rectangle(0.1, 0.1), Rectangle(0.1, 0.05), (3.8238, 18.3173, 47.2648)),
        (Circle(0.1), Circle(0.05), (4.6252, 19.5476, 48.5789)),
    ],
)
def test_wedge_and_cone_have_published_modes(root, tip, published):
    """Values are ω √(ρA₀L⁴/EI₀) of Euler–Bernoulli cantilevers whose height halves towards the tip.

    S. Naguleswaran, J. Sound Vib. 172 (1994) 289; H. H. Mabie, C. B. Rogers, J. Acoust. Soc. Am. 51
    (1972) 1771.
    """
    leg = tapered(STRAIGHT, root, tip)
    angular = 2.0 * np.pi * frequencies(leg, "euler-bernoulli", 60, 12)
    scale = np.sqrt(STEEL.E * root.second_moment_y / (STEEL.rho * root.area))
    for expected in published:
        # The published digits are rounded or truncated.
        assert np.abs(angular / scale - expected).min() < 1e-4


def test_ring_frequency_equals_love():
    """Thin ring, two waves in its plane: ω = n(n² − 1)/√(n² + 1) √(EI/ρAR⁴) (A. E. H. Love, §293).

    Half of the ring is modelled, with symmetry conditions at its ends.
    """
    section = Circle(0.002)
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (1.0, 1.0, 0.0)),), UP)
    leg = line_beam(tapered(line, section, section).sections("euler-bernoulli"), 24)
    free = np.setdiff1d(np.arange(leg.size), [1, 2, 3, 4, 5, 7, 8, 9, 10, 11])
    stiffness, mass = (matrix.toarray()[np.ix_(free, free)] for matrix in (leg.stiffness, leg.mass))
    squared = eigh(stiffness, mass, eigvals_only=True)
    scale = STEEL.E * section.second_moment_y / (STEEL.rho * section.area)
    expected = 6.0 / np.sqrt(5.0) * np.sqrt(scale)
    # The thickness, by (d/R)², and 24 elements change the frequency by less than 1e-5.
    assert np.abs(np.sqrt(np.abs(squared)) / expected - 1.0).min() < 2e-5
