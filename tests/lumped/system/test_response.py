"""Answers to forces that swing: closed forms first, then matrices solved without any modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array
from written_robot import described

from fem.beams.beam import beam_leg
from lumped.arrays import dense
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.screws import shift
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.response import damped_modes, harmonic_responses
from lumped.system.solution import compliance, modes, solved, strain_shares

TWO = """
schema = 2
name = "two"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0] }
bodies.coarse = { points = ["A", "B"], mass = 7.0, centre = "A" }
bodies.fine = { points = ["B"], mass = 2.0, centre = "B" }
tool = { body = "fine", point = "B", moves = ["x"], mass = 1.0 }
[joints.a]
type = "prismatic"
between = ["ground", "coarse"]
at = "A"
axis = [1.0, 0.0, 0.0]
drive = { stiffness = 2.0e6, loss = FIRST }
[joints.b]
type = "fixed"
between = ["coarse", "fine"]
at = "B"
compliance = GIVE
loss = SECOND
"""
PUSHED = """
[damping]
ratio = RATIO
[[responses]]
name = "push"
direction = [2.0, 0.0, 0.0]
from = 10.0
to = 450.0
count = 40
at = 75.0
"""
# Of both masses, the tool's with them, on the first spring alone.
K, MASS = 2.0e6, 10.0
X = np.array([1.0, 0.0, 0.0])


def filled(text, **values):
    for name, value in values.items():
        text = text.replace(name, str(value))
    return described(text)


def pushed(loss, ratio):
    rigid = TWO.replace("compliance = GIVE\nloss = SECOND\n", "")
    return filled(rigid + PUSHED, FIRST=loss, RATIO=ratio)


def solution_of(mechanism, models=None):
    return solved(assemble(reference_posture(mechanism), models or {}))


@pytest.mark.parametrize(("ratio", "loss"), [(0.0, 0.06), (0.03, 0.0)])
def test_damped_oscillator_equals_closed_form(ratio, loss):
    """1/(k(1 + iη) − mω²), of which the peak is 1/kη at √(k/m); viscous: 1/(2kζ√(1 − ζ²))."""
    (found,) = harmonic_responses(solution_of(pushed(loss, ratio)))
    asked = found.excitation
    assert asked.judged == ("push", "push.frequency", "push.at")
    natural = np.sqrt(K / MASS)

    def due(frequency):
        speed = 2.0 * np.pi * frequency
        return 1.0 / (K * (1.0 + 1j * loss + 2j * ratio * speed / natural) - MASS * speed**2)

    np.testing.assert_allclose(found.receptance, due(asked.frequencies), rtol=1e-10)
    size, where, there = found.judged
    highest = 1.0 / (K * loss or 2.0 * K * ratio * np.sqrt(1.0 - ratio**2))
    assert size == pytest.approx(highest, rel=1e-12)
    at = natural * np.sqrt(1.0 - 2.0 * ratio**2) / (2.0 * np.pi)
    assert where == pytest.approx(at, rel=1e-7)
    assert there == pytest.approx(abs(due(75.0)), rel=1e-10)


def test_loss_factor_and_damping_ratio_add():
    """Receptance 1/(k(1 + iη) − mω² + 2iζω√(km)), written out here; its highest value on a grid."""
    loss, ratio = 0.2, 0.05
    (response,) = harmonic_responses(solution_of(pushed(loss, ratio)))

    def receptance(frequencies):
        speeds = 2.0 * np.pi * frequencies
        viscous = 2j * ratio * speeds * np.sqrt(K * MASS)
        return 1.0 / (K * (1.0 + 1j * loss) - MASS * speeds**2 + viscous)

    frequencies = response.excitation.frequencies
    # Round-off of one mode is below 1e-14.
    np.testing.assert_allclose(response.receptance, receptance(frequencies), rtol=1e-10)
    size, frequency, there = response.judged
    grid = np.linspace(65.0, 75.0, 100_001)
    sizes = np.abs(receptance(grid))
    # The top of the grid is within half a step of the peak: 1e-10 of its height.
    assert size == pytest.approx(sizes.max(), rel=1e-8)
    assert frequency == pytest.approx(grid[sizes.argmax()], abs=2e-4)
    assert there == pytest.approx(abs(receptance(75.0)), rel=1e-10)


def test_both_dampings_of_many_modes_add():
    """Equal losses in all parts: (K(1 + iη) + iωC − ω²M)⁻¹ with modal C, solved directly."""
    give, loss, ratio = np.diag([1e-7, *5 * [1e-9]]).tolist(), 0.1, 0.03
    solution = solution_of(filled(TWO, FIRST=loss, SECOND=loss, GIVE=give))
    damped = replace(damped_modes(solution, 1e6), ratio=ratio).along(X)
    stiffness, mass = np.array([[1.2e7, -1e7], [-1e7, 1e7]]), np.diag([7.0, 3.0])
    squares, shapes = eigh(stiffness, mass)
    momenta = mass @ shapes
    viscous = momenta * (2.0 * ratio * np.sqrt(squares)) @ momenta.T
    for frequency in (3.0, 70.0, 110.0, 400.0):
        speed = 2.0 * np.pi * frequency
        dynamic = (1.0 + 1j * loss) * stiffness + 1j * speed * viscous - speed**2 * mass
        receptance = damped.receptance(np.array([frequency]))[0]
        assert receptance == pytest.approx(np.linalg.inv(dynamic)[1, 1], rel=1e-9)


def test_undamped_mode_has_infinite_peak():
    robot = pushed(0.0, 0.01)
    undamped = damped_modes(solution_of(replace(robot, damping=0.0)), 450.0).along(X)
    natural = np.sqrt(K / MASS) / (2.0 * np.pi)
    assert undamped.peak(10.0, 450.0) == (np.inf, pytest.approx(natural, rel=1e-9))
    size, where = undamped.peak(10.0, 50.0)
    assert where == 50.0
    assert size == pytest.approx(1.0 / (K - MASS * (100.0 * np.pi) ** 2), rel=1e-9)


def test_two_masses_with_different_losses():
    """The inverse of a 2×2 matrix, its eigenvalues, and the strain energies to first order."""
    misses, give = [], np.diag([1e-7, *5 * [1e-9]]).tolist()
    for first, second in ((0.08, 0.02), (0.008, 0.002)):
        solution = solution_of(filled(TWO, FIRST=first, SECOND=second, GIVE=give))
        found = damped_modes(solution, 1e6)
        one, two = 2.0e6 * (1.0 + 1j * first), 1.0e7 * (1.0 + 1j * second)
        stiffness, mass = np.array([[one + two, -two], [-two, two]]), np.diag([7.0, 3.0])
        for frequency in (3.0, 70.0, 110.0, 400.0):
            due = np.linalg.inv(stiffness - (2.0 * np.pi * frequency) ** 2 * mass)[1, 1]
            own = found.along(X).receptance(np.array([frequency]))
            assert own[0] == pytest.approx(due, rel=1e-9)
        roots = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)))
        frequencies = np.sqrt(roots.real) / (2.0 * np.pi)
        np.testing.assert_allclose(found.frequencies[:2], frequencies, rtol=1e-9)
        np.testing.assert_allclose(found.losses[:2], roots.imag / roots.real, rtol=1e-9)
        shares = strain_shares(solution.system, modes(solution, 2).shapes)
        estimate = first * shares[Portion("a", "drive")]
        estimate += second * shares[Portion("b", "compliance")]
        misses.append(np.abs(estimate / found.losses[:2] - 1.0).max())
    assert 1e-6 < misses[0] < 1e-2
    assert misses[1] < 0.02 * misses[0]


DELTA = load_robot("delta").mechanism
BODY_LOSSES = {name: 0.002 * number for number, name in enumerate(DELTA.bodies, start=1)}


def on_drives(**changes):
    """The joints with drives of another stiffness or loss."""
    return tuple(
        joint if joint.drive is None else replace(joint, drive=replace(joint.drive, **changes))
        for joint in DELTA.joints
    )


@pytest.fixture(scope="module")
def beams():
    """With 50 g beside every tip, 20 mm off the axis: what spins idly has a part in bending."""
    legs = legs_of(DELTA)
    beside = shift(np.array([0.0, 0.02, 0.0]))[:3]
    alike = {leg: beam_leg(leg.timoshenko, leg.length, 2) for leg in legs.values()}
    for leg, model in alike.items():
        mass = dense(model.mass)
        mass[6:12, 6:12] += 0.05 * beside.T @ beside
        alike[leg] = replace(model, mass=csr_array(mass))
    return {name: alike[leg] for name, leg in legs.items()}


@pytest.fixture(scope="module")
def plain(beams):
    return solution_of(DELTA, beams)


@pytest.fixture(scope="module")
def lossy(beams):
    """Every part has a loss of its own; six idle spins."""
    bodies = {name: replace(one, loss=BODY_LOSSES[name]) for name, one in DELTA.bodies.items()}
    return solution_of(replace(DELTA, bodies=bodies, joints=on_drives(loss=0.1)), beams)


def test_all_modes_equal_direct_solution(beams, plain, lossy):
    """K* put together anew, of bodies and drives as much softer as they lose."""
    system, ratio = lossy.system, 0.02
    assert lossy.idle == 6
    losing = {
        name: replace(one, stiffness=BODY_LOSSES[name] * one.stiffness)
        for name, one in beams.items()
    }
    (stiffness,) = {joint.drive.stiffness for joint in DELTA.joints if joint.drive}
    soft = replace(DELTA, joints=on_drives(stiffness=0.1 * stiffness))
    lost = assemble(reference_posture(soft), losing).stiffness
    stiffness, mass = dense(system.stiffness), dense(system.mass)
    squares, shapes = eigh(stiffness, mass)
    momenta = mass @ shapes
    viscous = momenta * (2.0 * ratio * np.sqrt(np.maximum(squares, 0.0))) @ momenta.T
    modal = replace(damped_modes(plain, 1e9), ratio=ratio)
    for frequency in (5.0, 61.0, 150.0, 900.0):
        speed = 2.0 * np.pi * frequency
        for found, imaginary in ((damped_modes(lossy, 1e9), lost), (modal, speed * viscous)):
            inverse = stiffness + 1j * imaginary - speed**2 * mass
            direct = system.tool @ np.linalg.solve(inverse, system.tool.T)
            own = found.receptance(np.array([frequency]))[0]
            assert np.abs(own - direct).max() <= 1e-9 * np.abs(direct).max()
            assert np.linalg.eigvalsh(own.imag)[-1] <= 1e-12 * np.abs(own).max()


def test_few_modes_suffice_and_statics_are_exact(plain, lossy):
    few, every = damped_modes(lossy, 200.0), damped_modes(lossy, 1e9)
    assert len(few.inverses) < len(every.inverses) // 2
    frequencies = np.linspace(1.0, 200.0, 50)
    own, expected = (one.receptance(frequencies)[:, :3, :3] for one in (few, every))
    sizes = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(own - expected) <= 1e-4 * sizes).all()
    still, expected = damped_modes(plain, 200.0).receptance(np.array([1e-6]))[0], compliance(plain)
    assert np.abs(still - expected).max() <= 1e-9 * np.abs(expected).max()
