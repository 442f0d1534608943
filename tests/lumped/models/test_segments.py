"""Rigid segments on springs, eqs (13)–(25), as a model of a clamped beam."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.oracles.compliance_difference import scaled_difference
from support.robots.paper_legs import LEG_1, kind_frequencies

from lumped.arrays import dense
from lumped.beam_properties import tip_compliance
from lumped.errors import InputError
from lumped.models.segments import segment_chain, segment_leg, static_leg, with_printed_tip_joint
from lumped.screws import shift

LENGTH = LEG_1.length
BEAM = LEG_1.timoshenko
SLENDER = LEG_1.properties("euler-bernoulli")
# Roots of cos x cosh x = −1: natural frequencies of a clamped-free Euler–Bernoulli beam.
CLAMPED_FREE_ROOTS = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])


def along(distance):
    """Return the 6×6 matrix that gives the twist `distance` (m) further along the leg."""
    return shift(np.array([distance, 0.0, 0.0]))


def at_tip(leg):
    """Return the 6×6 tip compliance of the leg, clamped at its root."""
    return np.linalg.inv(dense(leg.stiffness)[6:, 6:])[:6, :6]


@pytest.mark.parametrize("properties", [SLENDER, BEAM], ids=["euler-bernoulli", "timoshenko"])
@pytest.mark.parametrize(
    ("leg_of", "elements", "digits"),
    # The relative rounding error grows with the condition number: as n⁴ for a chain of n segments
    # (1e-16 · 80⁴), as n for the condensed chain.
    [
        (segment_leg, 1, 1e-11),
        (segment_leg, 80, 1e-8),
        (static_leg, 1, 1e-11),
        (static_leg, 2000, 1e-11),
    ],
)
def test_segment_compliance_is_exact(properties, leg_of, elements, digits):
    """Closed form of a cantilever, for 1 to 2000 segments, with and without shear."""
    compliance = at_tip(leg_of(segment_chain(properties, LENGTH, elements)))
    assert scaled_difference(compliance, tip_compliance(properties, LENGTH)) < digits


@pytest.mark.parametrize(
    ("layout", "order", "error", "tolerance"),
    # The paper prints +5.2 % for the first frequency at n = 20 in the printed ("literal") layout.
    [("half", 2.0, 0.0, 0.002), ("literal", 1.0, 0.052, 0.0005)],
)
def test_segment_frequencies_have_order_two(layout, order, error, tolerance):
    """First three bending frequencies of a clamped-free Euler–Bernoulli leg, deflecting along y."""
    counts = np.array([20, 40, 80])
    exact = (CLAMPED_FREE_ROOTS / LENGTH) ** 2 * np.sqrt(SLENDER.EIz / SLENDER.mu) / (2.0 * np.pi)
    legs = [segment_leg(segment_chain(SLENDER, LENGTH, n, layout)) for n in counts]
    errors = np.array([kind_frequencies(leg, "bending z", 3) / exact - 1.0 for leg in legs])
    orders = -np.polyfit(np.log(counts), np.log(np.abs(errors)), 1)[0]
    assert orders[0] == pytest.approx(order, abs=0.05)
    assert errors[0, 0] == pytest.approx(error, abs=tolerance)
    if layout == "half":
        assert orders == pytest.approx(order, abs=0.05)
        assert np.all(np.abs(errors[0]) < 0.01)


def test_literal_layout_has_rigid_ends():
    """In the printed layout an elastic length L(1 − 1/n) lies between two rigid ends of L/2n."""
    compliance = at_tip(segment_leg(segment_chain(SLENDER, LENGTH, 8, "literal")))
    lever = along(LENGTH / 16.0)
    expected = lever @ tip_compliance(SLENDER, LENGTH * 7.0 / 8.0) @ lever.T
    assert_allclose(compliance, expected, rtol=1e-10, atol=1e-20)


@pytest.mark.parametrize("layout", ["half", "literal"])
def test_segments_have_mass_of_prism(layout):
    """Mass and moments of inertia of the chain about the middle, in both layouts."""
    chain = segment_chain(BEAM, LENGTH, 3, layout)
    motions = np.vstack([along(x) for x in (0.0, LENGTH, *chain.stations[1:-1])])
    about_middle = along(-LENGTH / 2.0)
    mass = motions.T @ (segment_leg(chain).mass @ motions)
    slender = BEAM.mu * LENGTH**3 / 12.0
    inertia = LENGTH * np.array([BEAM.rho_J, BEAM.rho_Iy, BEAM.rho_Iz]) + [0.0, slender, slender]
    expected = np.diag([*[BEAM.mu * LENGTH] * 3, *inertia])
    assert_allclose(about_middle.T @ mass @ about_middle, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("layout", ["half", "literal"])
@pytest.mark.parametrize("joined", [lambda chain: chain, with_printed_tip_joint])
def test_condensed_chain_is_schur_complement(layout, joined):
    """Stiffness of both ends by recursion, against a dense K_bb − K_bi K_ii⁻¹ K_ib."""
    chain = joined(segment_chain(BEAM, LENGTH, 6, layout))
    full, condensed = (dense(leg_of(chain).stiffness) for leg_of in (segment_leg, static_leg))
    expected = full[:12, :12] - full[:12, 12:] @ np.linalg.solve(full[12:, 12:], full[12:, :12])
    scale = condensed.max()
    assert_allclose(condensed / scale, expected / scale, atol=1e-12)


def test_printed_tip_joint_is_too_stiff_along_y():
    """Eq. (25) zeroes row and column φz of the tip's spring. All other compliances are exact."""
    chain = with_printed_tip_joint(segment_chain(BEAM, LENGTH, 4))
    tip, piece = chain.stiffnesses[-1], LENGTH / 8.0
    assert chain.springs_at[-1].tolist() == [LENGTH, 0.0, 0.0]
    assert_allclose(tip[5], 0.0)
    # Along y the half-length piece l resists with 12EI/l³, as if it were held against rotation at
    # both ends, instead of 3EI/l³.
    assert 1.0 / tip[1, 1] == pytest.approx(piece**3 / (12.0 * BEAM.EIz) + piece / BEAM.GAy)
    # With φz held, the compliances in x, z, φx and φy remain those of the cantilever.
    untouched = np.ix_([0, 2, 3, 4], [0, 2, 3, 4])
    compliance = np.linalg.inv(dense(static_leg(chain).stiffness)[6:11, 6:11])[untouched]
    assert_allclose(compliance, tip_compliance(BEAM, LENGTH)[untouched], rtol=1e-10, atol=1e-20)


def test_segment_centreline_follows_rigid_motion():
    """Points between segment centres move as the rigid leg does."""
    stations = (0.0, 0.1, 0.4, LENGTH)
    leg = segment_leg(segment_chain(BEAM, LENGTH, 3))
    rigid = np.vstack([along(share * LENGTH) for share in (0.0, 1.0, 1 / 6, 1 / 2, 5 / 6)])
    expected = np.vstack([along(station) for station in stations])
    assert_allclose(leg.centreline(np.array(stations)) @ rigid, expected, atol=1e-14)


@pytest.mark.parametrize(("elements", "layout"), [(0, "half"), (-3, "half"), (1, "literal")])
def test_too_few_segments_are_refused(elements, layout):
    """At least one segment; two in the literal layout."""
    with pytest.raises(InputError, match=f"elements = {elements}"):
        segment_chain(BEAM, LENGTH, elements, layout)
