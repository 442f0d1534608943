"""Rigid segments on springs, eqs (13)–(25), as a cantilever."""

import numpy as np
import pytest
from compliances import scaled_difference
from numpy.testing import assert_allclose

from lumped.arrays import dense
from lumped.dense.modes import solve_modes
from lumped.errors import InputError
from lumped.legs import constant_leg, tip_compliance
from lumped.models.segments import (
    SegmentChain,
    segment_chain,
    segment_leg,
    static_leg,
    with_printed_tip_joint,
)
from lumped.screws import shift

# Leg 1 of the IFW demonstrator as a constant section (paper §2.3 applied to its appendix).
LENGTH = 0.85
LEG = constant_leg(LENGTH, EA=8.613e8, EIy=4.771e6, EIz=1.832e6, GJ=9.212e6, mass=69.705)
SLENDER = LEG.properties("euler-bernoulli")
# Roots of cos x cosh x = −1 (any text on vibration of beams).
CLAMPED_FREE_ROOTS = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])


def exact_bending_z() -> np.ndarray:
    """First three Euler–Bernoulli frequencies (Hz) of the clamped-free leg, deflection along y."""
    return (CLAMPED_FREE_ROOTS / LENGTH) ** 2 * np.sqrt(SLENDER.EIz / SLENDER.mu) / (2.0 * np.pi)


def cantilever_compliance(chain: SegmentChain) -> np.ndarray:
    stiffness = dense(segment_leg(chain).stiffness)[6:, 6:]
    return np.linalg.solve(stiffness, np.eye(len(stiffness)))[:6, :6]


def condensed_compliance(chain: SegmentChain) -> np.ndarray:
    return np.linalg.inv(dense(static_leg(chain).stiffness)[6:, 6:])


def bending_z(chain: SegmentChain, count: int = 3) -> np.ndarray:
    """Frequencies (Hz) of the clamped chain that deflects along y alone."""
    leg = segment_leg(chain)
    plane = [i for i in range(6, leg.size) if i % 6 in (1, 5)]
    pick = np.ix_(plane, plane)
    return solve_modes(dense(leg.stiffness)[pick], dense(leg.mass)[pick], count, "leg").frequencies


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize(
    ("compliance_of", "elements", "digits"),
    # Rounding grows with the condition number, about n⁴: 1e-16 · 160⁴; of the condensed chain
    # with n.
    [
        (cantilever_compliance, 1, 1e-11),
        (cantilever_compliance, 160, 1e-7),
        (condensed_compliance, 1, 1e-11),
        (condensed_compliance, 2000, 1e-11),
    ],
)
def test_static_tip_compliance_is_exact(theory, compliance_of, elements, digits):
    properties = LEG.properties(theory)
    expected = tip_compliance(properties, LENGTH)
    found = compliance_of(segment_chain(properties, LENGTH, elements))
    assert scaled_difference(found, expected) < digits


@pytest.mark.parametrize(
    ("layout", "order", "error", "off"),
    # Known values: +5.2 % at n = 20 as printed.
    [("half", 2.0, 0.0, 0.002), ("literal", 1.0, 0.052, 0.0005)],
)
def test_frequencies_converge_at_the_order_of_the_layout(layout, order, error, off):
    counts = np.array([20, 40, 80, 160])
    exact = exact_bending_z()
    errors = np.array(
        [bending_z(segment_chain(SLENDER, LENGTH, n, layout)) / exact - 1 for n in counts]
    )
    orders = -np.polyfit(np.log(counts), np.log(np.abs(errors)), 1)[0]
    assert orders[0] == pytest.approx(order, abs=0.05)
    assert errors[0, 0] == pytest.approx(error, abs=off)
    if layout == "half":
        assert orders == pytest.approx(order, abs=0.05)
        assert np.all(np.abs(errors[0]) < 0.01)


def test_literal_layout_leaves_one_element_length_rigid():
    n = 8
    found = cantilever_compliance(segment_chain(SLENDER, LENGTH, n, "literal"))
    # Elastic length L(1 − 1/n) between two rigid ends of L/2n.
    elastic = tip_compliance(SLENDER, LENGTH * (1.0 - 1.0 / n))
    lever = shift(np.array([LENGTH / (2.0 * n), 0.0, 0.0]))
    assert_allclose(found, lever @ elastic @ lever.T, rtol=1e-10, atol=1e-20)


@pytest.mark.parametrize("layout", ["half", "literal"])
@pytest.mark.parametrize("printed", [False, True])
def test_condensed_chain_is_the_schur_complement_of_the_assembled_one(layout, printed):
    chain = segment_chain(LEG.timoshenko, LENGTH, 6, layout)
    if printed:
        chain = with_printed_tip_joint(chain)
    full = dense(segment_leg(chain).stiffness)
    ends, inner = full[:12, :12], full[12:, 12:]
    expected = ends - full[:12, 12:] @ np.linalg.solve(inner, full[12:, :12])
    found = dense(static_leg(chain).stiffness)
    assert_allclose(found / found.max(), expected / found.max(), atol=1e-12)


def test_printed_tip_joint_has_no_moment_but_is_too_stiff():
    chain = with_printed_tip_joint(segment_chain(LEG.timoshenko, LENGTH, 4))
    tip = chain.stiffnesses[-1]
    assert chain.springs_at[-1] == LENGTH
    assert_allclose(tip[5], 0.0)
    piece = LENGTH / 8.0
    # The half-length piece held at both ends against rotation resists y with 12EI/l³, not 3EI/l³.
    shear = piece / LEG.timoshenko.GAy
    expected = 1.0 / (piece**3 / (12.0 * LEG.timoshenko.EIz) + shear)
    assert_allclose(tip[1, 1], expected, rtol=1e-12)
    # What the joint does not turn about stays the cantilever's: x, z, φx, φy with φz held.
    stiffness = dense(static_leg(chain).stiffness)[6:11, 6:11]
    untouched = [0, 2, 3, 4]
    found = np.linalg.inv(stiffness)[np.ix_(untouched, untouched)]
    expected = tip_compliance(LEG.timoshenko, LENGTH)[np.ix_(untouched, untouched)]
    assert_allclose(found, expected, rtol=1e-10, atol=1e-20)


def test_centreline_follows_a_uniform_twist_and_a_rigid_rotation():
    inner = (np.arange(3) + 0.5) * LENGTH / 3
    rigid = np.vstack([shift(np.array([s, 0.0, 0.0])) for s in (0.0, LENGTH, *inner)])
    stations = np.array([0.0, 0.1, 0.4, LENGTH])
    expected = np.vstack([shift(np.array([s, 0.0, 0.0])) for s in stations])
    leg = segment_leg(segment_chain(LEG.timoshenko, LENGTH, 3))
    assert_allclose(leg.centreline(stations) @ rigid, expected, atol=1e-14)


@pytest.mark.parametrize(("elements", "layout"), [(0, "half"), (-3, "half"), (1, "literal")])
def test_too_few_elements_are_refused(elements, layout):
    with pytest.raises(InputError, match=f"elements = {elements}"):
        segment_chain(LEG.timoshenko, LENGTH, elements, layout)
