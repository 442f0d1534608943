"""Receptances between two points: a beam in closed form, reciprocity, and faults of keys."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from fem.beams.beam import beam_leg
from lumped.errors import ComputationError, InputError
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.models.bodies import legs_of
from lumped.system.assembly import assemble
from lumped.system.response import damped_modes, harmonic_responses
from lumped.system.solution import solved

# A clamped bar of two pieces: E (Pa), density (kg/m³), loss factor, lengths (m), side (m).
E, RHO, LOSS = 2.1e11, 7850.0, 0.02
MIDDLE, LENGTH, SIDE = 0.4, 1.0, 0.001
BAR = f"""
schema = 2
name = "bar"
points = {{ A = [0.0, 0.0, 0.0], M = [{MIDDLE}, 0.0, 0.0], P = [{LENGTH}, 0.0, 0.0] }}
materials.steel = {{ E = {E}, nu = 0.0, rho = {RHO}, loss = {LOSS} }}
bodies.first = {{ from = "A", to = "M", section = SQUARE, material = "steel" }}
bodies.second = {{ from = "M", to = "P", section = SQUARE, material = "steel" }}
joints.clamp = {{ type = "fixed", between = ["ground", "first"], at = "A" }}
joints.seam = {{ type = "fixed", between = ["first", "second"], at = "M" }}
tool = {{ body = "second", point = "P", moves = [] }}
""".replace("SQUARE", f'{{ shape = "rectangle", width = {SIDE}, height = {SIDE} }}')
RESPONSE = """
[[responses]]
name = "{name}"
direction = {direction}
from = {first}
to = {last}
count = 40
{rest}
"""


def responses_of(text, elements=20):
    mechanism = described(text)
    bodies = {
        name: beam_leg(leg.timoshenko, leg.length, elements)
        for name, leg in legs_of(mechanism).items()
    }
    return harmonic_responses(solved(assemble(reference_posture(mechanism), bodies)))


def response_table(name, direction, keys="", first=0.5, last=15.0):
    return RESPONSE.format(name=name, direction=direction, rest=keys, first=first, last=last)


def axial_receptance(frequencies, x, force_at):
    """Rod, force at ξ ≤ x: u = sin(kξ) cos(k(L − x))/(EAk cos kL), k = ω√(ρ/E*), complex E*."""
    modulus = E * (1.0 + 1j * LOSS)
    k = 2.0 * np.pi * frequencies * np.sqrt(RHO / modulus)
    near, far = sorted((x, force_at))
    stiffness = modulus * SIDE**2 * k
    return np.sin(k * near) * np.cos(k * (LENGTH - far)) / (stiffness * np.cos(k * LENGTH))


def bending_receptance(frequencies, x, force_at):
    """Cantilever of Euler and Bernoulli, EI w⁗ = ρAω² w, on both sides of the force.

    Four waves to the left of the force and four to its right: w = w′ = 0 at the clamp, w″ = w‴ = 0
    at the tip, w, w′, w″ continuous, and EI w‴ jumps by F.
    """
    bending = E * (1.0 + 1j * LOSS) * SIDE**4 / 12.0
    values = []
    for frequency in frequencies:
        wave = (RHO * SIDE**2 * (2.0 * np.pi * frequency) ** 2 / bending) ** 0.25
        rates = wave * np.array([1.0, -1.0, 1j, -1j])

        def row(position, order, side, rates=rates):
            entries = rates**order * np.exp(rates * position)
            zeros = np.zeros(4)
            return np.concatenate([entries, zeros] if side == 0 else [zeros, entries])

        jump = [row(force_at, n, 1) - row(force_at, n, 0) for n in range(4)]
        rows = [row(0.0, 0, 0), row(0.0, 1, 0), row(LENGTH, 2, 1), row(LENGTH, 3, 1), *jump]
        right = np.zeros(8)
        right[-1] = 1.0
        waves = np.linalg.solve(np.array(rows), right / bending)
        values.append(row(x, 0, int(x > force_at)) @ waves)
    return np.array(values)


def test_bar_receptance_is_exact():
    """From 100 to 900 Hz, below the first frequency, 1293 Hz; 60 elements have an error of 1e-6."""
    text = BAR + response_table("cross", [1.0, 0.0, 0.0], 'at = "M"\nof = "P"', 100.0, 900.0)
    (response,) = responses_of(text, 30)
    expected = axial_receptance(response.excitation.frequencies, LENGTH, MIDDLE)
    np.testing.assert_allclose(response.receptance, expected, rtol=1e-4)


def test_cantilever_receptance_is_exact():
    """Euler–Bernoulli's equation, whose first three frequencies are 0.84, 5.2 and 14.6 Hz.

    Shear and rotary inertia lower them by up to ½ k²r² (1 + E/κG) = 9e-6, which is 1e-3 of the
    receptance beside a peak of loss factor 0.02.
    """
    text = BAR
    text += response_table("to tip".replace(" ", "-"), [0.0, 1.0, 0.0], 'at = "M"')
    text += response_table("cross", [0.0, 1.0, 0.0], 'at = "M"\nof = "P"')
    text += response_table("back", [0.0, 1.0, 0.0], 'of = "M"')
    text += response_table("tip", [0.0, 1.0, 0.0])
    places = [(MIDDLE, MIDDLE), (LENGTH, MIDDLE), (MIDDLE, LENGTH), (LENGTH, LENGTH)]
    for response, (x, force_at) in zip(responses_of(text), places, strict=True):
        expected = bending_receptance(response.excitation.frequencies, x, force_at)
        np.testing.assert_allclose(response.receptance, expected, rtol=3e-3)


def test_receptances_are_reciprocal():
    """Betti's theorem: exchanging displacement and force leaves the receptance unchanged.

    The displacement of P along v under a force at M along u is that of M along u under a force at P
    along v.
    """
    text = BAR.replace("[0.4, 0.0, 0.0]", "[0.4, 0.3, 0.1]").replace(str(SIDE), "0.02")
    u, v = [0.3, 1.0, -0.2], [1.0, -0.4, 0.7]
    at_first = f'at = "P"\nof = {{ point = "M", body = "first", direction = {u} }}'
    text += response_table(
        "there", u, f'at = "M"\nof = {{ point = "P", direction = {v} }}', 10.0, 300.0
    )
    text += response_table("back", v, at_first, 10.0, 300.0)
    forward, reverse = responses_of(text)
    sizes = np.abs(forward.receptance)
    # Round-off of eigenvectors beside a resonance.
    assert (np.abs(forward.receptance - reverse.receptance) <= 1e-8 * sizes.max()).all()
    assert sizes.min() > 1e-6 * sizes.max()


def test_slender_bar_has_no_rounding_mode():
    """All modes of a bar that is 5e9 times stiffer axially have the loss factor of the material.

    Static responses that depend on the modes only through round-off gave a spurious undamped mode
    at 5.9 Hz.
    """
    mechanism = described(BAR.replace("[0.4, 0.0, 0.0]", "[0.4, 0.3, 0.1]"))
    bodies = {
        name: beam_leg(leg.timoshenko, leg.length, 20) for name, leg in legs_of(mechanism).items()
    }
    solution = solved(assemble(reference_posture(mechanism), bodies))
    np.testing.assert_allclose(damped_modes(solution, 15.0).losses, LOSS, rtol=1e-4)


def test_frequency_key_allows_receptance_points():
    """If `at` is a point, the key `frequency` has the frequency; a number `at` is a frequency."""
    text = BAR + response_table("cross", [0.0, 1.0, 0.0], 'at = "M"\nof = "P"\nfrequency = 5.0')
    text += response_table("tip", [0.0, 1.0, 0.0], "at = 5.0")
    cross, tip = responses_of(text)
    assert cross.excitation.judged == ("cross", "cross.frequency", "cross.at")
    expected = bending_receptance(np.array([5.0]), LENGTH, MIDDLE)
    assert cross.judged[2] == pytest.approx(abs(expected[0]), rel=1e-3)
    expected = bending_receptance(np.array([5.0]), LENGTH, LENGTH)
    assert tip.judged[2] == pytest.approx(abs(expected[0]), rel=1e-3)
    assert tip.excitation.is_direct
    assert not cross.excitation.is_direct


def test_symmetry_gives_zero_receptance():
    """A force along y displaces no point of a straight bar along z: zero without round-off.

    Modes of the square section along y and z have equal frequencies, so a solver returns mixtures.
    """
    text = BAR + response_table(
        "across", [0.0, 1.0, 0.0], 'at = "M"\nof = { point = "P", direction = [0.0, 0.0, 1.0] }'
    )
    (response,) = responses_of(text)
    assert not response.receptance.any()
    assert response.judged[0] == 0.0


FAULTS = {
    'at = "Q"': 'responses[1].at = "Q": must be a point of a body: A, M, P',
    'of = "Q"': 'responses[1].of = "Q": must be a point of a body: A, M, P',
    'body = "first"': (
        "responses[1].body: must be left out without `at`, because it names the body of that point"
    ),
    'at = "P"\nbody = "first"': 'responses[1].at = "P": must be a point of first: A, M',
    'of = { point = "P", direction = [0.0, 0.0, 0.0] }': (
        "responses[1].of.direction = [0.0, 0.0, 0.0]: must not be zero"
    ),
    'of = { point = "A", body = "second" }': (
        'responses[1].of.point = "A": must be a point of second: M, P'
    ),
    "at = 5.0\nfrequency = 6.0": (
        "responses[1].at = 5.0: must be a point, because responses[1].frequency is given"
    ),
    "frequency = 600.0": (
        "responses[1].frequency = 600.0: must be between responses[1].from and responses[1].to"
    ),
}


@pytest.mark.parametrize("lines", FAULTS)
def test_invalid_point_is_refused(lines):
    """Each fault of the points of a response gives one line with key and reason."""
    with pytest.raises(InputError) as error:
        described(BAR + response_table("a", [1.0, 0.0, 0.0], lines))
    assert error.value.faults == (FAULTS[lines],)


def test_receptance_of_idle_point_is_refused():
    """The point is a lug of a rod that spins idly between ball joints."""
    text = """
    schema = 2
    name = "rod"
    points = { A = [0.0, 0.0, 0.0], B = [0.5, 0.0, 0.0], L = [0.2, 0.1, 0.0] }
    bodies.rod = { points = ["A", "B", "L"], mass = 2.0, centre = "A" }
    bodies.head = { points = ["B"], mass = 1.0, centre = "B" }
    bodies.slide = { points = ["A"], mass = 0.5, centre = "A" }
    tool = { body = "head", point = "B", moves = ["x"] }
    damping = { ratio = 0.01 }
    [joints]
    guide = { type = "prismatic", between = ["ground", "head"], at = "B", axis = [1.0, 0.0, 0.0] }
    foot = { type = "spherical", between = ["slide", "rod"], at = "A" }
    ball = { type = "spherical", between = ["rod", "head"], at = "B" }
    [joints.motor]
    type = "prismatic"
    between = ["ground", "slide"]
    at = "A"
    axis = [1.0, 0.0, 0.0]
    drive = { stiffness = 1.0e6 }
    """
    mechanism = described(text + response_table("lug", [0.0, 0.0, 1.0], 'of = "L"'))
    solution = solved(assemble(reference_posture(mechanism), {}))
    with pytest.raises(ComputationError, match="an idle motion moves point L of rod"):
        harmonic_responses(solution)
