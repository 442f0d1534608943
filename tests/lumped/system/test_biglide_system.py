"""The robot assembled from two legs: against shared unknowns, and known values."""

from dataclasses import replace

import numpy as np
import pytest
from like_ifw import DATA, LEG1, LEG2, placed_at, stations
from numpy.testing import assert_allclose
from shared_unknowns import by_hand

from lumped.dense.modes import solve_modes
from lumped.dense.statics import solve_statics
from lumped.legs import equivalent_leg
from lumped.mechanism.biglide import biglide
from lumped.models.segments import segment_chain, segment_leg, with_printed_tip_joint
from lumped.system.assembly import assemble
from lumped.system.solution import Solved, compliance, modes, solved
from validation.models.mechanism import as_printed

ROBOT = DATA | {"leg1": equivalent_leg(LEG1), "leg2": equivalent_leg(LEG2)}


def legs_of(data, elements: int, release: str):
    chains = [
        segment_chain(leg.timoshenko, leg.length, elements) for leg in (data["leg1"], data["leg2"])
    ]
    if release == "printed":
        chains[1] = with_printed_tip_joint(chains[1])
    return {f"leg{n}": segment_leg(chain) for n, chain in enumerate(chains, start=1)}


def build(data, x: float = 0.4975, elements: int = 20, release: str = "condensed") -> Solved:
    (at,) = placed_at(biglide(**data), x)
    if release == "printed":
        at = replace(at, mechanism=as_printed(at.mechanism))
    return solved(assemble(at, legs_of(data, elements, release)))


def test_first_frequencies_at_the_centre():
    """Known values: 113, 184, 213, 355 Hz; with Timoshenko's springs within 1 % of those."""
    assert_allclose(modes(build(ROBOT), 4).frequencies, [113.0, 184.0, 213.0, 355.0], rtol=0.01)


def test_printed_joints_move_the_second_frequency_to_300_hz():
    """Known values, eq. (25): about 300 Hz as printed instead of about 184 Hz."""
    frequencies = modes(build(ROBOT, release="printed"), 2).frequencies
    assert_allclose(frequencies[1], 300.0, rtol=0.01)


TOOL = np.diag([1e-9, 2e-9, 3e-9, 4e-7, 5e-7, 6e-7])
ROBOTS = {
    "as built": ROBOT,
    "rigid feet": ROBOT | {"foot_compliance": None},
    "tool": ROBOT | {"tool_offset": np.array([0.02, -0.03, 0.155]), "tool_compliance": TOOL},
}


@pytest.mark.parametrize("release", ["condensed", "printed"])
@pytest.mark.parametrize("data", ROBOTS.values(), ids=ROBOTS)
def test_joints_leave_what_shared_unknowns_leave(data, release):
    """An independent formulation: feet, hinge and tool by shared unknowns (`shared_unknowns`)."""
    for x in stations(biglide(**data), 3):
        found = build(data, x, 4, release)
        legs = legs_of(data, 4, release).values()
        stiffness, mass, loaded = by_hand(data, x, *legs, release)
        expected = loaded @ solve_statics(stiffness, loaded.T, "by hand")
        scale = 1.0 / np.sqrt(np.diag(expected))
        difference = (compliance(found) - expected) * scale[:, None] * scale
        assert np.abs(difference).max() < 1e-10
        exact = solve_modes(stiffness, mass, 10, "by hand")
        assert_allclose(modes(found, 10).frequencies, exact.frequencies, rtol=1e-10)
