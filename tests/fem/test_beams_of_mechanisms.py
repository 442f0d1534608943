"""Euler–Bernoulli frames of mechanisms at random: links and virtual joints say the same in statics.

Planar and spatial, overconstrained too, with all kinds of joints, off the reference posture.
"""

from functools import lru_cache
from itertools import combinations

import numpy as np
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st
from random_mechanisms import random_posture

from fem.beams.beam import beam_leg
from fem.reduction.superelement import held_leg, static_superelement
from lumped.errors import ComputationError
from lumped.models.bodies import legs_of, links, tip_compliances
from lumped.models.serial_chains import compliance as vjm_compliance
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved


@lru_cache
def beam(leg, elements):
    properties = leg.properties("euler-bernoulli")
    return static_superelement(held_leg(beam_leg(properties, leg.length, elements))).matrices


def agree(seed: int, *, planar: bool) -> None:
    posture = random_posture(seed, planar=planar, rigid=0.1)
    legs = tip_compliances(posture.mechanism, theory="euler-bernoulli")
    try:
        by_chains = vjm_compliance(posture, legs)
    except ComputationError:
        # Movable, or a leg that nothing yields in.
        reject()
    largest = np.abs(by_chains).max()
    # Softer than any of its parts: near a singular posture, where rounding grows as compliance.
    assume(largest < 1e-4)
    solution = solved(assemble(posture, links(posture.mechanism, legs)))
    # Two slides in series that are nearly parallel leave a body nearly idle: a stiffness method
    # loses 1e-16 over the smallest pivot there, chains lose nothing.
    assume(np.diag(solution.lower).min() ** 2 > 1e-6)
    elements = 1 + seed % 5
    beams = {name: beam(leg, elements) for name, leg in legs_of(posture.mechanism).items()}
    by_beams = compliance(solved(assemble(posture, beams)))
    by_links = compliance(solution)
    for one, other in combinations((by_chains, by_links, by_beams), 2):
        assert np.abs(one - other).max() <= 1e-9 * largest


@given(st.integers(0, 10**6), st.booleans())
@settings(max_examples=8)
def test_beams_links_and_virtual_joints_agree(seed, planar):
    agree(seed, planar=planar)
