"""Condensation by doubling, held against direct solves, beam theory and extended precision."""

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import STEEL

from fem.bodies.doubling import (
    condensed_leg,
    doubled,
    joined,
    tip_compliance,
)
from fem.bodies.solid import clamped_leg, solid_leg
from fem.bodies.solid import tip_compliance as direct_compliance
from fem.sections.section_constants import beam_properties, section_constants
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.legs import tip_compliance as beam_tip_compliance
from lumped.screws import shift
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism.extrude import extrude, stations
from meshes.section.section_mesh import section_mesh

CUBIC = Material(E=2.1e11, G=1.2e11, nu=0.25, rho=7850.0)
SECTIONS = [
    (Rectangle(0.10, 0.16), 2),
    (Tube(0.12, 0.012), 4),
    (ISection(0.10, 0.16, 0.012, 0.008), 3),
]


def beam_compliance(leg, section):
    material = leg.material
    constants = section_constants(section, material.nu, material.G / material.E)
    return beam_tip_compliance(beam_properties(constants, material), leg.length)


@pytest.mark.parametrize(
    "slices", [1, 7, *(pytest.param(n, marks=pytest.mark.exhaustive) for n in (2, 12))]
)
@pytest.mark.parametrize("element", ["quad4", "quad9"])
@pytest.mark.parametrize(
    ("section", "divisions"), SECTIONS, ids=[section.shape for section, _ in SECTIONS]
)
def test_tip_compliance_is_that_of_the_direct_solve(section, divisions, element, slices):
    leg = ConstantLeg(0.8, section, CUBIC)
    face = section_mesh(section, divisions, element)
    condensed = condensed_leg(leg, face, slices)
    solid = solid_leg(leg, extrude(face, stations(leg.length, slices)))
    for ends in ("rigid", "free"):
        direct = direct_compliance(clamped_leg(solid, ends))
        # The limit. Slices hundred times as long as a wall is thick come closest to it:
        # there the direct solve loses digits to the condition of single elements.
        assert scaled_difference(tip_compliance(condensed, ends), direct) < 1e-9


# Quadratic on [0, 1]: integrals of N_a N_b, N_a′ N_b′ and N_a N_b′ for the nodes 0, ½, 1.
MASS = np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]], dtype=np.longdouble) / 30
SLOPES = np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]], dtype=np.longdouble) / 3
MIXED = np.array([[-3, 4, -1], [-4, 0, 4], [1, -4, 3]], dtype=np.longdouble) / 6


def block_stiffness(sizes, material):
    """hex27 (81×81, unknown 3·node + i) of a box in extended precision, its nodes by x, y, z."""
    forms = [(MASS * size, SLOPES / size, MIXED) for size in sizes]

    def integral(i, j):
        """∫ ∂ᵢN_a ∂ⱼN_b dV as a product of three integrals along the axes."""
        factors = []
        for axis, (mass, slopes, mixed) in enumerate(forms):
            both, first, second = axis == i == j, axis == i, axis == j
            factors.append(
                slopes if both else mixed.T if first else mixed if second else mass,
            )
        return np.kron(np.kron(factors[0], factors[1]), factors[2])

    E, nu = np.longdouble(material.E), np.longdouble(material.nu)
    shear = E / (2 * (1 + nu))
    lame = E * nu / ((1 + nu) * (1 - 2 * nu))
    K = np.zeros((27, 3, 27, 3), dtype=np.longdouble)
    for i in range(3):
        for j in range(3):
            K[:, i, :, j] = lame * integral(i, j) + shear * integral(j, i)
        K[:, i, :, i] += shear * sum(integral(j, j) for j in range(3))
    return K.reshape(81, 81)


def eliminated(matrix, count):
    """Schur complement of the first `count` unknowns, one at a time, in any precision."""
    matrix = matrix.copy()
    for row in range(count):
        rest = matrix[row + 1 :, row]
        matrix[row + 1 :, row + 1 :] -= np.outer(rest, matrix[row, row + 1 :]) / matrix[row, row]
    return matrix[count:, count:]


@pytest.mark.skipif(
    np.finfo(np.longdouble).eps > 1e-18, reason="needs floats of 80 bits or more (numpy longdouble)"
)
@pytest.mark.parametrize("length", [0.8, 4.0])
def test_512_slices_keep_their_digits(length):
    """Elimination plane by plane in extended precision.

    In double precision it is wrong by 4e-10 and 9e-8: rounding in the entries of K holds a leg
    that should be free to turn, with an effect that grows as n⁴.
    """
    width, height, slices = 0.16, 0.08, 512
    one = block_stiffness((np.longdouble(length) / slices, width, height), STEEL)
    middle_first = np.r_[27:54, 0:27, 54:81]
    one = eliminated(one[np.ix_(middle_first, middle_first)], 27)
    onto_plane = one[27:, 27:]
    for _ in range(slices - 1):
        longer = one.copy()
        longer[:27, :27] += onto_plane
        onto_plane = eliminated(longer, 27)
    places = np.array([0.0, 0.5, 1.0]) - 0.5
    points = [np.array([0.0, y * width, z * height]) for y in places for z in places]
    rigid = np.vstack([shift(point)[:3] for point in points])
    tip = (rigid.T @ onto_plane @ rigid).astype(float)
    scale = 1.0 / np.sqrt(np.diag(tip))
    reference = np.linalg.inv(tip * scale[:, None] * scale) * scale[:, None] * scale

    leg = ConstantLeg(length, Rectangle(width, height), STEEL)
    condensed = condensed_leg(leg, section_mesh(leg.section, (1, 1)), slices)
    # The limit; the reference's own error is 2e-10 in the longer leg (it grows as n⁴).
    assert scaled_difference(tip_compliance(condensed), reference) < 1e-9


@pytest.mark.parametrize("material", [STEEL, CUBIC], ids=["isotropic", "cubic"])
@pytest.mark.parametrize("length", [0.8, 8.0])
def test_free_ends_reach_beam_theory(length, material):
    """Saint-Venant's solution but for the cubic deflection on quadratic slices: error ~ n⁻⁴."""
    leg = ConstantLeg(length, Rectangle(0.16, 0.08), material)
    section = section_mesh(leg.section, (2, 1))
    beam = beam_compliance(leg, section)
    coarse, fine = (
        scaled_difference(tip_compliance(condensed_leg(leg, section, n), "free"), beam)
        for n in (256, 1024)
    )
    # (L/h)² of slenderness stands before n⁻⁴; rounding (1e-12) shows in the order of the shorter.
    assert coarse < 1e-7
    assert fine < 1e-9
    assert np.log(coarse / fine) / np.log(4.0) == pytest.approx(4.0, abs=0.2)


def test_rigid_ends_of_a_slender_leg_tend_to_beam_theory():
    """Plane end faces stiffen by a share h/L (known values): ten times longer, a tenth."""
    section = Rectangle(0.16, 0.08)
    face = section_mesh(section, (2, 1))
    differences = []
    for length in (4.0, 40.0):
        leg = ConstantLeg(length, section, STEEL)
        condensed = condensed_leg(leg, face, int(length / 0.01))
        beam = beam_compliance(leg, face)
        assert np.all(np.diag(tip_compliance(condensed)) < np.diag(beam))
        differences.append(scaled_difference(tip_compliance(condensed), beam))
    assert differences[1] < 1.5e-3
    # One power of h/L exactly but for the slices' own error in the long one.
    assert differences[0] / differences[1] == pytest.approx(10.0, rel=0.02)


@pytest.fixture(scope="module")
def i_leg():
    leg = ConstantLeg(0.8, ISection(0.10, 0.16, 0.012, 0.008), STEEL)
    return condensed_leg(leg, section_mesh(leg.section, 3), 5)


def test_doubling_by_symmetry_is_joining(i_leg):
    fast, plain = doubled(i_leg.piece), joined(i_leg.piece, i_leg.piece)
    for name in ("length", "compliance", "twists", "own", "across"):
        reference = np.asarray(getattr(plain, name))
        # A thousand roundings: sums over 400 unknowns of a face.
        np.testing.assert_allclose(
            getattr(fast, name), reference, atol=1e-12 * np.abs(reference).max(), rtol=0.0
        )


def test_impossible_requests_are_refused():
    leg = ConstantLeg(0.8, Rectangle(0.10, 0.16), STEEL)
    face = section_mesh(leg.section, 1)
    with pytest.raises(InputError, match=r"slices = 0: must be at least 1"):
        condensed_leg(leg, face, 0)
    with pytest.raises(InputError, match="shorter than"):
        condensed_leg(ConstantLeg(0.1, leg.section, STEEL), face, 4)
    with pytest.raises(InputError, match="only quad4 and quad9"):
        condensed_leg(leg, section_mesh(leg.section, 1, "tri6"), 4)
