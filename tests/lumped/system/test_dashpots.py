"""Viscous dashpots in drives and joints against closed forms and directly inverted matrices."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.system.assembly import assemble
from lumped.system.response import damped_modes, harmonic_responses
from lumped.system.solution import solved

# Mass (kg) of a carriage and stiffness (N/m) of its drive; critical damping in N s/m.
MASS, STIFFNESS = 10.0, 2.0e6
CRITICAL = 2.0 * np.sqrt(STIFFNESS * MASS)
NATURAL = np.sqrt(STIFFNESS / MASS)
X = np.array([1.0, 0.0, 0.0])
CARRIAGE = """
schema = 2
name = "carriage"
points = { A = [0.0, 0.0, 0.0] }
bodies.carriage = { points = ["A"], mass = 10.0, centre = "A" }
tool = { body = "carriage", point = "A", moves = ["x"] }
[joints.slide]
type = "prismatic"
between = ["ground", "carriage"]
at = "A"
axis = [1.0, 0.0, 0.0]
drive = { stiffness = 2.0e6DRIVE }
SLIDE
[[responses]]
name = "push"
direction = [1.0, 0.0, 0.0]
from = 10.0
to = 450.0
count = 40
at = 75.0
"""
# A coarse carriage on a drive with a dashpot, and a fine carriage on the coarse one by an elastic
# joint with another dashpot.
TWO = """
schema = 2
name = "two"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0] }
bodies.coarse = { points = ["A", "B"], mass = 7.0, centre = "A" }
bodies.fine = { points = ["B"], mass = 3.0, centre = "B" }
tool = { body = "fine", point = "B", moves = ["x"] }
[joints.a]
type = "prismatic"
between = ["ground", "coarse"]
at = "A"
axis = [1.0, 0.0, 0.0]
drive = { stiffness = 2.0e6, damping = FIRST, loss = LOSS }
[joints.b]
type = "fixed"
between = ["coarse", "fine"]
at = "B"
up = [1.0, 0.0, 0.0]
stiffness = { axial = 1.0e7, radial = "rigid", torsion = "rigid", tilting = "rigid" }
damping = { axial = SECOND }
"""


def solution_of(text, **values):
    for name, value in values.items():
        text = text.replace(name, str(value))
    mechanism = described(text)
    return solved(assemble(reference_posture(mechanism), {}))


@pytest.mark.parametrize("element", ["drive", "joint"])
@pytest.mark.parametrize("ratio", [0.03, 0.6, 1.0, 4.0])
def test_dashpot_receptance_is_exact(ratio, element):
    """Receptance 1/(k − mω² + iωc); for ζ < 1/√2 the peak is 1/(2kζ√(1 − ζ²)) at ω√(1 − 2ζ²)."""
    damping = ratio * CRITICAL
    text = {"DRIVE": "", "SLIDE": ""}
    text |= (
        {"DRIVE": f", damping = {damping}"}
        if element == "drive"
        else {"SLIDE": f"damping = {{ along = {damping} }}"}
    )
    (response,) = harmonic_responses(solution_of(CARRIAGE, **text))

    def receptance(frequencies):
        speeds = 2.0 * np.pi * frequencies
        return 1.0 / (STIFFNESS - MASS * speeds**2 + 1j * damping * speeds)

    frequencies = response.excitation.frequencies
    # The program changes a critical damping by 1e-6 of itself; rounding errors are below 1e-12.
    tolerance = 2e-6 if ratio == 1.0 else 1e-10
    np.testing.assert_allclose(response.receptance, receptance(frequencies), rtol=tolerance)
    size, frequency, size_at_75_hz = response.judged
    assert size_at_75_hz == pytest.approx(abs(receptance(75.0)), rel=tolerance)
    if ratio < np.sqrt(0.5):
        assert size == pytest.approx(1.0 / (2.0 * STIFFNESS * ratio * np.sqrt(1.0 - ratio**2)))
        peak = NATURAL * np.sqrt(1.0 - 2.0 * ratio**2) / (2.0 * np.pi)
        assert frequency == pytest.approx(max(peak, 10.0), rel=1e-6)
    else:
        assert (size, frequency) == (pytest.approx(abs(receptance(10.0)), rel=tolerance), 10.0)


def test_dashpot_keeps_natural_frequency():
    """Natural frequency √(k/m) and loss factor 2ζ = c/√(km) for every damping ratio ζ below 1."""
    for ratio in (0.01, 0.4, 0.9):
        solution = solution_of(CARRIAGE, DRIVE=f", damping = {ratio * CRITICAL}", SLIDE="")
        modes = damped_modes(solution, 450.0)
        assert modes.frequencies[0] == pytest.approx(NATURAL / (2.0 * np.pi), rel=1e-9)
        assert modes.losses[0] == pytest.approx(2.0 * ratio, rel=1e-9)


@pytest.mark.parametrize("first", [50.0, 8000.0, 5.0e5])
def test_dashpots_on_two_masses_are_exact(first):
    """Inverse of a 2×2 matrix with loss factor and dashpots; 5e5 N s/m overdamps one mode."""
    loss, second = 0.06, 900.0
    solution = solution_of(TWO, FIRST=first, SECOND=second, LOSS=loss)
    modes = damped_modes(solution, 1e6).along(X)
    k, seat = 2.0e6 * (1.0 + 1j * loss), 1.0e7
    mass = np.diag([7.0, 3.0])
    for frequency in (3.0, 70.0, 110.0, 400.0):
        s = 2j * np.pi * frequency
        a, b = k + s * first, seat + s * second
        dynamic = np.array([[a + b, -b], [-b, b]]) + s**2 * mass
        computed = modes.receptance(np.array([frequency]))[0]
        assert computed == pytest.approx(np.linalg.inv(dynamic)[1, 1], rel=1e-9)


def test_damping_ratio_adds_to_dashpot():
    """Dynamic stiffness k(1 + iη) − mω² + iωc + 2iζω√(km)."""
    text = CARRIAGE + "[damping]\nratio = 0.05\n"
    solution = solution_of(text, DRIVE=", damping = 300.0, loss = 0.1", SLIDE="")
    (response,) = harmonic_responses(solution)
    speeds = 2.0 * np.pi * response.excitation.frequencies
    viscous = 300.0 + 2.0 * 0.05 * np.sqrt(STIFFNESS * MASS)
    expected = STIFFNESS * (1.0 + 0.1j) - MASS * speeds**2 + 1j * viscous * speeds
    # The program applies ζ at the natural frequency of the mode with loss factor η: an error of
    # second order in η = 0.1.
    np.testing.assert_allclose(response.receptance, 1.0 / expected, rtol=5e-3)


def test_tiny_dashpot_has_no_effect():
    """A dashpot of 1e-12 N s/m changes the receptance by less than 1e-9 of it."""
    vanishing = solution_of(TWO.replace("damping = { axial = SECOND }", ""), FIRST=1e-12, LOSS=0.06)
    plain = solution_of(
        TWO.replace("damping = { axial = SECOND }", "").replace("damping = FIRST, ", ""), LOSS=0.06
    )
    frequencies = np.array([3.0, 70.0, 110.0])
    computed, expected = (
        damped_modes(solution, 1e6).receptance(frequencies)[:, 0, 0]
        for solution in (vanishing, plain)
    )
    np.testing.assert_allclose(computed, expected, rtol=1e-9)


def test_dashpot_damps_idle_rod():
    """A rod spins idly between ball joints, one damped. Reference: direct solution, no modes."""
    text = """
    schema = 2
    name = "rod"
    points = { A = [0.0, 0.0, 0.0], B = [0.5, 0.0, 0.0] }
    bodies.rod = { points = ["A", "B"], mass = 2.0, centre = [0.2, 0.05, 0.0], inertia = INERTIA }
    bodies.head = { points = ["B"], mass = 1.0, centre = "B" }
    bodies.slide = { points = ["A"], mass = 0.5, centre = "A" }
    tool = { body = "head", point = "B", moves = ["x"] }
    [joints.guide]
    type = "prismatic"
    between = ["ground", "head"]
    at = "B"
    axis = [1.0, 0.0, 0.0]
    stiffness = { normal = 3.0e6, lateral = 3.0e6, roll = "rigid", pitch = 5.0e4, yaw = 5.0e4 }
    [joints.motor]
    type = "prismatic"
    between = ["ground", "slide"]
    at = "A"
    axis = [1.0, 0.0, 0.0]
    drive = { stiffness = 1.0e6 }
    [joints.foot]
    type = "spherical"
    between = ["slide", "rod"]
    at = "A"
    up = [0.0, 1.0, 0.0]
    stiffness = { axial = 2.0e6, radial = 3.0e6 }
    damping = { turning = 1.5 }
    [joints.ball]
    type = "spherical"
    between = ["rod", "head"]
    at = "B"
    """
    inertia = np.diag([0.01, 0.08, 0.08])
    solution = solution_of(text, INERTIA=inertia.tolist())
    system = solution.system
    assert solution.idle == 1
    # The slide does not rotate: the dashpot is driven by the rod's rotation alone.
    rows = system.motions.at("rod", "A", np.zeros(3))[3:]
    viscous = 1.5 * rows.T @ rows
    modes = damped_modes(solution, 500.0)
    for frequency in (2.0, 40.0, 90.0, 300.0):
        s = 2j * np.pi * frequency
        dynamic = system.stiffness + s * viscous + s**2 * system.mass
        direct = system.tool @ np.linalg.solve(dynamic, system.tool.T)
        computed = modes.receptance(np.array([frequency]))[0]
        assert np.abs(computed - direct).max() <= 1e-9 * np.abs(direct).max()


FAULTS = {
    "damping = { tilting = 1.0 }": (
        "joints.slide.damping.tilting: does not belong to a prismatic joint; its directions are "
        "normal, lateral, roll, pitch, yaw, along"
    ),
    "damping = { roll = 1.0 }": (
        "joints.slide.damping.roll: the joint is rigid there, a dashpot has no effect; must be "
        "left out, or the direction be given a stiffness"
    ),
    "damping = { along = 0.0 }": ("joints.slide.damping.along = 0.0: must be above 0 N s/m"),
    "damping = {}": "joints.slide.damping: has no number; must have one of normal, lateral, roll, "
    "pitch, yaw, along",
}


@pytest.mark.parametrize("line", FAULTS)
def test_invalid_joint_damping_is_refused(line):
    """Each fault of `damping` of a joint gives one line with key, value and range."""
    with pytest.raises(InputError) as error:
        described(CARRIAGE.replace("DRIVE", "").replace("SLIDE", line) + "[damping]\nratio = 0.1\n")
    assert error.value.faults == (FAULTS[line],)


def test_dashpot_of_rigid_drive_is_refused():
    """A rigid drive does not move, so that its dashpot would have no effect."""
    text = CARRIAGE.replace("2.0e6DRIVE", '"rigid", damping = 5.0').replace("SLIDE", "")
    with pytest.raises(InputError) as error:
        described(text + "[damping]\nratio = 0.1\n")
    assert error.value.faults == (
        "joints.slide.drive.damping: a rigid drive does not move; must be left out, or the drive "
        "be given a stiffness",
    )
