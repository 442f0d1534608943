"""Harmonic responses against closed forms and against matrices solved without modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array
from support.robots.robot_from_text import described

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
# Stiffness (N/m) of the first spring, and total mass (kg) of both bodies and the tool.
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
def test_damped_oscillator_is_exact(ratio, loss):
    """1/(k(1 + iη) − mω²) with peak 1/kη at √(k/m); with damping ratio ζ peak 1/(2kζ√(1 − ζ²))."""
    (response,) = harmonic_responses(solution_of(pushed(loss, ratio)))
    assert response.excitation.judged == ("push", "push.frequency", "push.at")
    natural = np.sqrt(K / MASS)

    def receptance(frequency):
        speed = 2.0 * np.pi * frequency
        return 1.0 / (K * (1.0 + 1j * loss + 2j * ratio * speed / natural) - MASS * speed**2)

    expected = receptance(response.excitation.frequencies)
    np.testing.assert_allclose(response.receptance, expected, rtol=1e-10)
    size, frequency, size_at_75_hz = response.judged
    highest = 1.0 / (K * loss or 2.0 * K * ratio * np.sqrt(1.0 - ratio**2))
    assert size == pytest.approx(highest, rel=1e-12)
    peak = natural * np.sqrt(1.0 - 2.0 * ratio**2) / (2.0 * np.pi)
    assert frequency == pytest.approx(peak, rel=1e-7)
    assert size_at_75_hz == pytest.approx(abs(receptance(75.0)), rel=1e-10)


def test_loss_factor_and_damping_ratio_add():
    """Receptance 1/(k(1 + iη) − mω² + 2iζω√(km)); its peak is taken from a fine frequency grid."""
    loss, ratio = 0.2, 0.05
    (response,) = harmonic_responses(solution_of(pushed(loss, ratio)))

    def receptance(frequencies):
        speeds = 2.0 * np.pi * frequencies
        viscous = 2j * ratio * speeds * np.sqrt(K * MASS)
        return 1.0 / (K * (1.0 + 1j * loss) - MASS * speeds**2 + viscous)

    frequencies = response.excitation.frequencies
    # Rounding errors with body mode are below 1e-14.
    np.testing.assert_allclose(response.receptance, receptance(frequencies), rtol=1e-10)
    size, frequency, size_at_75_hz = response.judged
    grid = np.linspace(65.0, 75.0, 100_001)
    sizes = np.abs(receptance(grid))
    # The highest grid value is within half a grid step of the peak: an error of 1e-10 in height.
    assert size == pytest.approx(sizes.max(), rel=1e-8)
    assert frequency == pytest.approx(grid[sizes.argmax()], abs=2e-4)
    assert size_at_75_hz == pytest.approx(abs(receptance(75.0)), rel=1e-10)


def test_loss_and_damping_add_in_two_modes():
    """Equal loss factors of all parts: (K(1 + iη) + iωC − ω²M)⁻¹ with C of the damping ratio."""
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


def test_undamped_peak_is_infinite():
    """Within the range; below the natural frequency it is 1/(k − mω²) at the end of the range."""
    robot = pushed(0.0, 0.01)
    undamped = damped_modes(solution_of(replace(robot, damping=0.0)), 450.0).along(X)
    natural = np.sqrt(K / MASS) / (2.0 * np.pi)
    assert undamped.peak(10.0, 450.0) == (np.inf, pytest.approx(natural, rel=1e-9))
    size, frequency = undamped.peak(10.0, 50.0)
    assert frequency == 50.0
    assert size == pytest.approx(1.0 / (K - MASS * (100.0 * np.pi) ** 2), rel=1e-9)


def test_two_masses_with_unequal_losses_are_exact():
    """Reference: inverse and eigenvalues of a 2×2 matrix; for modal losses, strain energy, too.

    The energy estimate is of first order: its error falls with the square of the loss factors.
    """
    errors, give = [], np.diag([1e-7, *5 * [1e-9]]).tolist()
    for first, second in ((0.08, 0.02), (0.008, 0.002)):
        solution = solution_of(filled(TWO, FIRST=first, SECOND=second, GIVE=give))
        damped = damped_modes(solution, 1e6)
        drive, seat = 2.0e6 * (1.0 + 1j * first), 1.0e7 * (1.0 + 1j * second)
        stiffness, mass = np.array([[drive + seat, -seat], [-seat, seat]]), np.diag([7.0, 3.0])
        for frequency in (3.0, 70.0, 110.0, 400.0):
            expected = np.linalg.inv(stiffness - (2.0 * np.pi * frequency) ** 2 * mass)[1, 1]
            receptance = damped.along(X).receptance(np.array([frequency]))
            assert receptance[0] == pytest.approx(expected, rel=1e-9)
        roots = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)))
        frequencies = np.sqrt(roots.real) / (2.0 * np.pi)
        np.testing.assert_allclose(damped.frequencies[:2], frequencies, rtol=1e-9)
        np.testing.assert_allclose(damped.losses[:2], roots.imag / roots.real, rtol=1e-9)
        shares = strain_shares(solution.system, modes(solution, 2).shapes)
        estimate = first * shares[Portion("a", "drive")]
        estimate += second * shares[Portion("b", "compliance")]
        errors.append(np.abs(estimate / damped.losses[:2] - 1.0).max())
    assert 1e-6 < errors[0] < 1e-2
    assert errors[1] < 0.02 * errors[0]


DELTA = load_robot("delta").mechanism
BODY_LOSSES = {name: 0.002 * number for number, name in enumerate(DELTA.bodies, start=1)}


def on_drives(**changes):
    """Return the Delta robot's joints with another stiffness or loss factor of the drives."""
    return tuple(
        joint if joint.drive is None else replace(joint, drive=replace(joint.drive, **changes))
        for joint in DELTA.joints
    )


@pytest.fixture(scope="module")
def beams():
    """Return beam legs, each with 50 g beside its tip, so that bending also spins the leg idly."""
    legs = legs_of(DELTA)
    offset = shift(np.array([0.0, 0.02, 0.0]))[:3]
    models = {leg: beam_leg(leg.timoshenko, leg.length, 2) for leg in legs.values()}
    for leg, model in models.items():
        mass = dense(model.mass)
        mass[6:12, 6:12] += 0.05 * offset.T @ offset
        models[leg] = replace(model, mass=csr_array(mass))
    return {name: models[leg] for name, leg in legs.items()}


@pytest.fixture(scope="module")
def plain(beams):
    return solution_of(DELTA, beams)


@pytest.fixture(scope="module")
def lossy(beams):
    """Return the solution of a Delta robot with a loss factor in each part; its rods spin idly."""
    bodies = {name: replace(body, loss=BODY_LOSSES[name]) for name, body in DELTA.bodies.items()}
    return solution_of(replace(DELTA, bodies=bodies, joints=on_drives(loss=0.1)), beams)


def test_modal_sum_equals_inverse(beams, plain, lossy):
    """The imaginary part of K is assembled from bodies and drives scaled by their loss factors."""
    system, ratio = lossy.system, 0.02
    assert lossy.idle == 6
    losing = {
        name: replace(model, stiffness=BODY_LOSSES[name] * model.stiffness)
        for name, model in beams.items()
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
        for damped, imaginary in ((damped_modes(lossy, 1e9), lost), (modal, speed * viscous)):
            inverse = stiffness + 1j * imaginary - speed**2 * mass
            direct = system.tool @ np.linalg.solve(inverse, system.tool.T)
            receptance = damped.receptance(np.array([frequency]))[0]
            assert np.abs(receptance - direct).max() <= 1e-9 * np.abs(direct).max()
            assert np.linalg.eigvalsh(receptance.imag)[-1] <= 1e-12 * np.abs(receptance).max()


def test_truncated_modes_keep_exact_statics(plain, lossy):
    """Up to 200 Hz, modes above it act by their compliance: errors below 1e-4, none at 0 Hz."""
    few, every = damped_modes(lossy, 200.0), damped_modes(lossy, 1e9)
    assert len(few.inverses) < len(every.inverses) // 2
    frequencies = np.linspace(1.0, 200.0, 50)
    truncated, expected = (damped.receptance(frequencies)[:, :3, :3] for damped in (few, every))
    sizes = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(truncated - expected) <= 1e-4 * sizes).all()
    still, expected = damped_modes(plain, 200.0).receptance(np.array([1e-6]))[0], compliance(plain)
    assert np.abs(still - expected).max() <= 1e-9 * np.abs(expected).max()
