"""The paper's robot assembled from rigid segments: known values."""

from dataclasses import replace

import pytest
from like_ifw import EQUIVALENT, placed_at

from lumped.models.bodies import legs_of
from lumped.models.segments import segment_chain, segment_leg, with_printed_tip_joint
from lumped.system.assembly import assemble
from lumped.system.solution import modes, solved
from validation.models.mechanism import as_printed


def frequencies(release, count):
    (at,) = placed_at(EQUIVALENT)
    legs = legs_of(EQUIVALENT).items()
    chains = {name: segment_chain(leg.timoshenko, leg.length, 20) for name, leg in legs}
    if release == "printed":
        chains["leg2"] = with_printed_tip_joint(chains["leg2"])
        at = replace(at, mechanism=as_printed(at.mechanism))
    models = {name: segment_leg(chain) for name, chain in chains.items()}
    return modes(solved(assemble(at, models)), count).frequencies


def test_first_frequencies_at_the_centre():
    """113, 184, 213, 355 Hz; with Timoshenko's springs within 1 % of those."""
    assert frequencies("condensed", 4) == pytest.approx([113.0, 184.0, 213.0, 355.0], rel=0.01)


def test_printed_joints_move_the_second_frequency_to_300_hz():
    """Eq. (25): about 300 Hz as printed instead of about 184 Hz."""
    assert frequencies("printed", 2)[1] == pytest.approx(300.0, rel=0.01)
