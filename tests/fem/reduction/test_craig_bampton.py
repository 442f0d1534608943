"""Craig–Bampton legs against the unreduced robot, and the bounds against the true error."""

import numpy as np
import pytest
from like_ifw import EQUIVALENT, system_of
from numpy.testing import assert_allclose
from prismatic_legs import STEEL, meshed
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from fem.bodies.solid import solid_leg_matrices
from fem.reduction.counted_modes import interface_modes
from fem.reduction.craig_bampton import craig_bampton, frequency_bounds
from fem.reduction.superelement import held_leg
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from lumped.models.bodies import legs_of
from lumped.models.segments import segment_chain, segment_leg
from lumped.sections import Rectangle
from lumped.system.solution import compliance, modes, solved

LEG_1, LEG_2 = legs_of(EQUIVALENT).values()
POSTURES = (0.145, 0.4975, 0.85)
COUNT = 20
# Just above the twentieth frequency of the robot in all postures, 3.5 to 3.7 kHz.
HIGHEST = 3800.0
# Rounding of dense frequencies, 1e-12, with a margin.
ROUNDING = 1e-10


NAMES = ("leg1", "leg2")
MODELS = {
    "segments": lambda leg: segment_leg(segment_chain(leg.timoshenko, leg.length, 20)),
    "beam": lambda leg: beam_leg(leg.timoshenko, leg.length, 12),
    "solid": lambda leg: solid_leg_matrices(meshed(leg, 1, 4)),
}


@pytest.fixture(scope="module", params=MODELS.values(), ids=MODELS)
def legs(request):
    """Unreduced legs, and the same held at both ends."""
    unreduced = [request.param(leg) for leg in (LEG_1, LEG_2)]
    return unreduced, [held_leg(leg) for leg in unreduced]


@pytest.fixture(scope="module")
def unreduced_robot(legs):
    """Per posture the robot of unreduced legs and its modes."""
    robots = [solved(system_of(x, *legs[0])) for x in POSTURES]
    return [(robot, modes(robot, COUNT)) for robot in robots]


def test_robot_of_reduced_legs_is_the_unreduced_one(legs, unreduced_robot):
    """Required: statics 1e-9, twenty frequencies 1e-4, mass-weighted MAC 0.9999."""
    unreduced, held = legs
    reduced = [craig_bampton(leg, HIGHEST) for leg in held]
    for x, (whole, exact) in zip(POSTURES, unreduced_robot, strict=True):
        robot = solved(system_of(x, *(leg.matrices for leg in reduced)))
        expected = compliance(whole)
        scale = 1.0 / np.sqrt(np.diag(expected))
        difference = (compliance(robot) - expected) * scale[:, None] * scale
        assert np.abs(difference).max() < 1e-9
        found = modes(robot, COUNT)
        assert_allclose(found.frequencies, exact.frequencies, rtol=1e-4)
        # Both are mass-normalised, so the product of two shapes is the root of their MAC.
        platform = robot.system.tool[:3] @ found.shapes, whole.system.tool[:3] @ exact.shapes
        gram = 46.0 * platform[0].T @ platform[1]
        for name, superelement, leg in zip(NAMES, reduced, unreduced, strict=True):
            field = superelement.recover(robot.system.own(name, found.shapes))
            gram += field.T @ (leg.mass @ whole.system.own(name, exact.shapes))
        assert np.min(np.diag(gram) ** 2) > 0.9999


@pytest.mark.parametrize("factor", [1.1, 2.5])
def test_bounds_enclose_the_true_frequencies(legs, unreduced_robot, factor):
    reduced = [craig_bampton(leg, HIGHEST, factor * HIGHEST) for leg in legs[1]]
    for x, (_, exact) in zip(POSTURES, unreduced_robot, strict=True):
        robot = system_of(x, *(leg.matrices for leg in reduced))
        bounds = frequency_bounds(robot, dict(zip(NAMES, reduced, strict=True)), COUNT)
        assert np.all(bounds.lower <= exact.frequencies * (1.0 + ROUNDING))
        assert np.all(exact.frequencies <= bounds.upper * (1.0 + ROUNDING))
        error = bounds.upper / exact.frequencies - 1.0
        assert np.all(error <= bounds.relative_width + ROUNDING)
        # A cut-off just above the highest frequency has a real error; the usual one promises
        # what is asked for.
        if factor == 1.1:
            assert error.max() > 1e-4
        else:
            assert bounds.relative_width.max() < 2e-4


SQUARE = ConstantLeg(0.8, Rectangle(0.1, 0.1), STEEL)


@pytest.mark.parametrize(
    ("leg", "divisions", "slices", "count"),
    [
        # Every bending mode twice.
        (SQUARE, 2, 6, 11),
        # Two thirds of 687 unknowns: more than Lanczos may look for.
        (LEG_1, 1, 8, 450),
    ],
)
def test_interface_modes_are_those_of_the_clamped_clamped_matrices(leg, divisions, slices, count):
    """All of them, and none besides: against a dense solution."""
    whole = solid_leg_matrices(meshed(leg, divisions, slices))
    assert whole.size > 400
    held = whole.stiffness.toarray()[12:, 12:], whole.mass.toarray()[12:, 12:]
    frequencies = np.sqrt(eigh(*held, eigvals_only=True)) / (2.0 * np.pi)
    found = interface_modes(held_leg(whole), 0.5 * (frequencies[count - 1] + frequencies[count]))
    assert_allclose(found.frequencies, frequencies[:count], rtol=1e-8)
    gram = found.shapes.T @ (whole.mass @ found.shapes)
    assert_allclose(gram, np.eye(count), atol=1e-8)


def test_cut_off_below_the_asked_frequencies_is_refused():
    held = held_leg(MODELS["beam"](LEG_1))
    with pytest.raises(InputError, match=r"cut-off = 900 Hz: must be above .*, 1000 Hz"):
        craig_bampton(held, 1000.0, cutoff=900.0)
    with pytest.raises(InputError, match=r"highest frequency = -1\.0 Hz"):
        craig_bampton(held, -1.0)
    reduced = [craig_bampton(held_leg(MODELS["beam"](leg)), 400.0, 500.0) for leg in (LEG_1, LEG_2)]
    robot = system_of(0.4975, *(leg.matrices for leg in reduced))
    with pytest.raises(InputError, match=r"frequency 12 .* cut off at 500 Hz"):
        frequency_bounds(robot, dict(zip(NAMES, reduced, strict=True)), 12)
