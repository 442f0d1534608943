"""Answers to forces that swing: closed forms first, then matrices solved without any modes."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from lumped.arrays import dense
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import legs_of
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion
from lumped.system.response import damped_modes, tool_responses
from lumped.system.solution import compliance, modes, solved, strain_shares

K, MASS = 4.0e6, 3.0
SLIDE = f"""
schema = 2
name = "slide"
points = {{ A = [0.0, 0.0, 0.0] }}
bodies.mass = {{ points = ["A"], mass = {MASS}, centre = "A" }}
joints.a.type = "prismatic"
joints.a.between = ["ground", "mass"]
joints.a.at = "A"
joints.a.axis = [1.0, 0.0, 0.0]
joints.a.drive = {{ stiffness = {K}, loss = LOSS }}
tool = {{ body = "mass", point = "A", moves = ["x"] }}
damping.ratio = RATIO
[[responses]]
name = "push"
direction = [2.0, 0.0, 0.0]
from = 20.0
to = 900.0
count = 40
at = 150.0
"""
TWO = """
schema = 2
name = "two"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0] }
bodies.coarse = { points = ["A", "B"], mass = 7.0, centre = "A" }
bodies.fine = { points = ["B"], mass = 2.0, centre = "B" }
joints.a.type = "prismatic"
joints.a.between = ["ground", "coarse"]
joints.a.at = "A"
joints.a.axis = [1.0, 0.0, 0.0]
joints.a.drive = { stiffness = 2.0e6, loss = FIRST }
joints.b.type = "fixed"
joints.b.between = ["coarse", "fine"]
joints.b.at = "B"
joints.b.compliance = GIVE
joints.b.loss = SECOND
tool = { body = "fine", point = "B", moves = ["x"], mass = 1.0 }
"""
X = np.array([1.0, 0.0, 0.0])


def described(text: str, **numbers: float) -> Mechanism:
    for name, number in numbers.items():
        text = text.replace(name, repr(number))
    text = text.replace("GIVE", str(np.diag([1e-7, *5 * [1e-9]]).tolist()))
    return described_by(tomllib.loads(text), Path())[0]


def solution_of(mechanism: Mechanism, models=None):
    return solved(assemble(reference_posture(mechanism), models or {}))


@pytest.mark.parametrize(("ratio", "loss"), [(0.0, 0.06), (0.03, 0.0)])
def test_one_mass_on_a_spring_that_loses_energy(ratio, loss):
    """1/(k(1 + iη) − mω²), of which the peak is 1/kη at √(k/m); viscous: 1/(2kζ√(1 − ζ²))."""
    (found,) = tool_responses(solution_of(described(SLIDE, LOSS=loss, RATIO=ratio)))
    asked = found.excitation
    assert asked.judged == ("push", "push.frequency", "push.at")
    natural = np.sqrt(K / MASS)

    def due(frequency):
        speed = 2.0 * np.pi * frequency
        return 1.0 / (K * (1.0 + 1j * loss + 2j * ratio * speed / natural) - MASS * speed**2)

    np.testing.assert_allclose(found.receptance, due(asked.frequencies), rtol=1e-10)
    size, where, there = found.judged
    highest, at = 1.0 / (K * loss or 2.0 * K * ratio * np.sqrt(1.0 - ratio**2)), natural
    if ratio:
        at = natural * np.sqrt(1.0 - 2.0 * ratio**2)
    assert size == pytest.approx(highest, rel=1e-12)
    assert where == pytest.approx(at / (2.0 * np.pi), rel=1e-7)
    assert there == pytest.approx(abs(due(150.0)), rel=1e-10)


def test_a_mode_that_nothing_damps_has_no_bound_and_one_beyond_does_not_matter():
    robot = described(SLIDE, LOSS=0.0, RATIO=0.01)
    undamped = damped_modes(solution_of(replace(robot, damping=0.0)), 900.0).along(X)
    natural = np.sqrt(K / MASS) / (2.0 * np.pi)
    assert undamped.peak(20.0, 900.0) == (np.inf, pytest.approx(natural, rel=1e-9))
    size, where = undamped.peak(20.0, 100.0)
    assert where == 100.0
    assert size == pytest.approx(1.0 / (K - MASS * (200.0 * np.pi) ** 2), rel=1e-9)


def test_two_masses_whose_springs_lose_differently():
    """The inverse of a 2×2 matrix, its roots, and the strain energies to first order."""

    def matrices(first, second):
        one, two = 2.0e6 * (1.0 + 1j * first), 1.0e7 * (1.0 + 1j * second)
        return np.array([[one + two, -two], [-two, two]]), np.diag([7.0, 3.0])

    misses = []
    for scale in (1.0, 0.1):
        first, second = 0.08 * scale, 0.02 * scale
        solution = solution_of(described(TWO, FIRST=first, SECOND=second))
        found = damped_modes(solution, 1e6)
        stiffness, mass = matrices(first, second)
        for frequency in (3.0, 70.0, 110.0, 400.0):
            (k11, k12), (_, k22) = stiffness - (2.0 * np.pi * frequency) ** 2 * mass
            expected = k11 / (k11 * k22 - k12**2)
            receptance = found.along(X).receptance(np.array([frequency]))
            assert receptance[0] == pytest.approx(expected, rel=1e-9)
        # λ² m₁m₂ − λ (k₁₁m₂ + k₂₂m₁) + det K = 0.
        (k11, k12), (_, k22) = stiffness
        roots = np.sort(np.roots([21.0, -(3.0 * k11 + 7.0 * k22), k11 * k22 - k12**2]))
        np.testing.assert_allclose(
            found.frequencies[:2], np.sqrt(roots.real) / (2.0 * np.pi), rtol=1e-9
        )
        np.testing.assert_allclose(found.losses[:2], roots.imag / roots.real, rtol=1e-9)
        shares = strain_shares(solution.system, modes(solution, 2).shapes)
        estimate = (
            first * shares[Portion("a", "drive")] + second * shares[Portion("b", "compliance")]
        )
        misses.append(np.abs(estimate / found.losses[:2] - 1.0).max())
    assert 1e-6 < misses[0] < 1e-2
    assert misses[1] < 0.02 * misses[0]


@pytest.fixture(scope="module")
def delta():
    """Six idle spins; every part has a loss of its own."""
    robot = load_robot("delta").mechanism
    names = list(robot.bodies)
    bodies = {
        name: replace(body, loss=0.002 * (1 + names.index(name)))
        for name, body in robot.bodies.items()
    }
    joints = tuple(
        joint if joint.drive is None else replace(joint, drive=replace(joint.drive, loss=0.1))
        for joint in robot.joints
    )
    return replace(robot, bodies=bodies, joints=joints)


def beams_of(mechanism: Mechanism):
    found = {}
    return {
        name: found.setdefault(leg, beam_leg(leg.timoshenko, leg.length, 2))
        for name, leg in legs_of(mechanism).items()
    }


def test_all_modes_together_are_the_matrices_solved_directly(delta):
    """K* put together anew, of bodies and drives as much softer as they lose."""
    models = beams_of(delta)
    solution = solution_of(delta, models)
    system = solution.system
    assert solution.idle == 6
    losing = {
        name: replace(one, stiffness=delta.bodies[name].loss * one.stiffness)
        for name, one in models.items()
    }
    joints = tuple(
        joint
        if joint.drive is None
        else replace(joint, drive=replace(joint.drive, stiffness=0.1 * joint.drive.stiffness))
        for joint in delta.joints
    )
    lost = assemble(reference_posture(replace(delta, joints=joints)), losing).stiffness
    stiffness, mass = dense(system.stiffness), dense(system.mass)
    found = damped_modes(solution, 1e9)
    squares, shapes = eigh(stiffness, mass)
    speeds = np.sqrt(np.maximum(squares, 0.0))
    ratio = 0.02
    viscous = (mass @ shapes) * (2.0 * ratio * speeds) @ (mass @ shapes).T
    plain = solution_of(_without_losses(delta), models)
    modal = replace(damped_modes(plain, 1e9), ratio=ratio)
    for frequency in (5.0, 61.0, 150.0, 900.0):
        speed = 2.0 * np.pi * frequency
        inertia = speed**2 * mass
        direct = system.tool @ np.linalg.solve(stiffness + 1j * lost - inertia, system.tool.T)
        own = found.receptance(np.array([frequency]))[0]
        assert np.abs(own - direct).max() <= 1e-9 * np.abs(direct).max()
        assert np.linalg.eigvalsh(own.imag)[-1] <= 1e-12 * np.abs(own).max()
        direct = system.tool @ np.linalg.solve(
            stiffness + 1j * speed * viscous - inertia, system.tool.T
        )
        own = modal.receptance(np.array([frequency]))[0]
        assert np.abs(own - direct).max() <= 1e-9 * np.abs(direct).max()


def test_few_modes_are_enough_and_standing_still_is_the_compliance(delta):
    models = beams_of(delta)
    solution = solution_of(delta, models)
    few, all_of = damped_modes(solution, 200.0), damped_modes(solution, 1e9)
    assert len(few.inverses) < len(all_of.inverses) // 2
    frequencies = np.linspace(1.0, 200.0, 50)
    own, expected = (one.receptance(frequencies)[:, :3, :3] for one in (few, all_of))
    sizes = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(own - expected) <= 1e-4 * sizes).all()
    plain = solution_of(_without_losses(delta), models)
    still = damped_modes(plain, 200.0).receptance(np.array([1e-6]))[0]
    expected = compliance(plain)
    assert np.abs(still - expected).max() <= 1e-9 * np.abs(expected).max()


def _without_losses(robot: Mechanism) -> Mechanism:
    return replace(
        robot,
        bodies={name: replace(body, loss=0.0) for name, body in robot.bodies.items()},
        joints=tuple(
            joint if joint.drive is None else replace(joint, drive=replace(joint.drive, loss=0.0))
            for joint in robot.joints
        ),
    )
