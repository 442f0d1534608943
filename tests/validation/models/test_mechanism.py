"""Models of the built-in mechanisms: equal statics, symmetry, and shared legs."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models.bodies import legs_of
from lumped.models.serial_chains import NoChainError
from lumped.robot_file import load_robot
from lumped.system.joint_motion import Portion
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.models.robot_bodies import dynamic_bodies, sectioned_legs
from validation.models.robot_models import (
    answers,
    highest_frequency,
    mechanism_modes,
    with_dynamic_bodies,
)

EULER_BERNOULLI = ModelOptions(theory="euler-bernoulli")
# One third of a turn about z, of twists.
THIRD = np.kron(
    np.eye(2), [[-0.5, -np.sqrt(0.75), 0.0], [np.sqrt(0.75), -0.5, 0.0], [0.0, 0.0, 1.0]]
)


def test_beams_and_segments_have_equal_statics():
    """Mechanisms with spatial closed loops, in postures other than the reference posture."""
    mechanism = load_robot("delta").mechanism
    postures = [posture(mechanism, pose) for pose in mechanism.poses[::4]]
    links, beam, segments = (
        answers(model, postures, 0, EULER_BERNOULLI).compliances
        for model in ("links", "beam", "segments")
    )
    for other in (beam, segments):
        np.testing.assert_allclose(other, links, rtol=0, atol=1e-9 * np.abs(links[0]).max())


def test_branching_error_can_be_pickled():
    """Errors raised in worker processes are pickled."""
    postures = [reference_posture(load_robot("delta").mechanism)]
    with pytest.raises(NoChainError, match=r"branches at .*; take --model links") as raised:
        answers("vjm", postures, 0)
    arrived = pickle.loads(pickle.dumps(raised.value))  # noqa: S301  its own bytes
    for attribute in ("faults", "reason"):
        assert getattr(arrived, attribute) == getattr(raised.value, attribute)


@pytest.mark.parametrize(("name", "model"), [("delta", "beam"), ("hexapod", "segments")])
def test_threefold_robot_has_symmetric_results(name, model):
    """Points of the robot files have twelve digits; results are symmetric to 1e-11."""
    answer = answers(model, [reference_posture(load_robot(name).mechanism)], 10)
    (compliance,) = answer.compliances
    turned = THIRD @ compliance @ THIRD.T
    assert np.abs(turned - compliance).max() <= 1e-9 * np.abs(compliance).max()
    # Modes of the symmetry's two-dimensional representation come in pairs, from the first on.
    first, second = answer.frequencies[0, :2]
    assert second == pytest.approx(first, rel=1e-9)


def test_equal_bodies_are_reduced_once():
    """The hexapod has as many reductions as it has pairs of section and length."""
    mechanism = load_robot("hexapod").mechanism
    bodies = dynamic_bodies("beam", mechanism, 500.0)
    # The field of displacement is made with the body and kept with it.
    shapes = {id(body.centreline) for body in bodies.values()}
    sections = {(leg.section, round(leg.length, 9)) for leg in legs_of(mechanism).values()}
    assert len(shapes) == len(sections)


@pytest.mark.parametrize(("elements", "solutions"), [(10, 1), (80, 2)])
def test_only_reduced_bodies_are_solved_again(elements, solutions):
    """A frequency above the estimate needs more modes of reduced bodies; others have all modes."""
    mechanism = load_robot("ifw").mechanism
    at, options = [reference_posture(mechanism)], ModelOptions(elements=elements)
    above = 1.01 * highest_frequency(at, 2, options)
    sizes = []

    def solve(bodies):
        sizes.append(sum(body.size for body in bodies.values()))
        return above

    with_dynamic_bodies("beam", mechanism, solve, np.array, at, 2, options)
    assert len(sizes) == solutions
    # Two legs of quadratic elements, with six unknowns at each node.
    assert (sizes[0] == 2 * 6 * (2 * elements + 1)) == (solutions == 1)


def test_printed_release_is_at_leg_tip():
    """In the paper the platform is fixed to the tip of leg 1, and leg 2 is hinged there."""
    mechanism = load_robot("ifw").mechanism
    joints = [
        replace(joint, first=joint.second, second=joint.first) if joint.name == "seat" else joint
        for joint in mechanism.joints
    ]
    legs = sectioned_legs(replace(mechanism, joints=joints), ModelOptions(release="printed"))
    assert {name: options.release for name, _, options in legs} == {
        "leg1": "condensed",
        "leg2": "printed",
    }


def test_simplified_model_ignores_joint_compliance():
    """The compliance equals that of the same robot with rigid joints."""
    robot_posture = reference_posture(load_robot("ifw").mechanism)
    joints = tuple(replace(joint, compliance=None) for joint in robot_posture.mechanism.joints)
    stiff = replace(robot_posture, mechanism=replace(robot_posture.mechanism, joints=joints))
    computed, expected = (
        answers("simplified", [solved_posture], 0).compliances
        for solved_posture in (robot_posture, stiff)
    )
    assert computed == pytest.approx(expected, rel=1e-12)


def test_legs_are_shared_only_if_identical():
    """Lengths that differ by 1e-12, a rounding error, are identical; by 1e-6 they are not."""
    described = load_robot("five-bar").mechanism
    lengths = {name: leg.length for name, leg, _ in sectioned_legs(described, DEFAULT_OPTIONS)}
    assert len(set(lengths.values())) < len(lengths)
    for change, are_distinct in ((1e-12, False), (1e-6, True)):
        rod = described.bodies["rod1"]
        longer = replace(rod, shape=replace(rod.shape, length=(1.0 + change) * rod.shape.length))
        changed = replace(described, bodies={**described.bodies, "rod1": longer})
        lengths_by_leg = {
            name: leg.length for name, leg, _ in sectioned_legs(changed, DEFAULT_OPTIONS)
        }
        assert (lengths_by_leg["rod1"] != lengths_by_leg["rod2"]) is are_distinct


def test_element_count_grows_for_many_modes():
    """Ten elements have too few unknowns for 60 modes."""
    middle = reference_posture(load_robot("ifw").mechanism)
    answer = answers("beam", [middle], 60, ModelOptions(elements=10))
    assert answer.frequencies.shape == (1, 60)


ELEMENTS = 20


def strains_of(leg, twists_at):
    """Energies (J) of the four kinds of deformation, by Gauss quadrature of difference quotients.

    `twists_at(x)` gives the sections' twists (m×6) of a centreline.
    """
    p, size = leg.timoshenko, leg.length / ELEMENTS
    places, weights = np.polynomial.legendre.leggauss(4)
    x = ((np.arange(ELEMENTS)[:, None] + 0.5 + 0.5 * places) * size).ravel()
    weight = np.tile(0.25 * size * weights, ELEMENTS)
    step = 1e-3 * size
    slope = (twists_at(x + step) - twists_at(x - step)) / (2.0 * step)
    turned = twists_at(x)
    shear_y, shear_z = slope[:, 1] - turned[:, 5], slope[:, 2] + turned[:, 4]
    return {
        "tension": weight @ (p.EA * slope[:, 0] ** 2),
        "torsion": weight @ (p.GJ * slope[:, 3] ** 2),
        "bending y": weight @ (p.EIy * slope[:, 4] ** 2 + p.GAz * shear_z**2),
        "bending z": weight @ (p.EIz * slope[:, 5] ** 2 + p.GAy * shear_y**2),
    }


def test_energy_shares_equal_strain_energy():
    """Tolerance 1e-5: difference quotients with a step of 1e-3 of an element."""
    robot_posture = reference_posture(load_robot("five-bar").mechanism)
    (solved_modes,) = mechanism_modes("beam", [robot_posture], 8)
    system, motions = solved_modes.system, solved_modes.system.motions
    for mode, shape in enumerate(solved_modes.modes.shapes.T):
        # Rayleigh, unit modal mass.
        total = 0.5 * (2.0 * np.pi * solved_modes.modes.frequencies[mode]) ** 2
        for name, leg in legs_of(robot_posture.mechanism).items():
            line, unknowns = (
                system.models[name].centreline,
                system.body_unknowns(name, shape[:, None]),
            )
            strains = strains_of(leg, lambda x, on=line, u=unknowns: (on(x) @ u).reshape(-1, 6))
            for kind, energy in strains.items():
                share = solved_modes.strain[Portion(name, kind)][mode]
                assert share == pytest.approx(energy / total, abs=1e-5), (mode, name, kind)
        for joint in robot_posture.mechanism.joints:
            if joint.drive is not None:
                point = interface_position(robot_posture, joint.second)
                turning = motions.at(joint.second.body, joint.second.point, point)[5]
                energy = 0.5 * joint.drive.stiffness * (turning @ shape[: system.outer]) ** 2
                share = solved_modes.strain[Portion(joint.name, "drive")][mode]
                assert share == pytest.approx(energy / total, abs=1e-9)


def test_energy_shares_sum_to_one():
    """If all bodies are rigid, the strain energy is in the drives."""
    postures = [reference_posture(load_robot("hexapod").mechanism)]
    (solved_modes,) = mechanism_modes("segments", postures, 60)
    expected = answers("segments", postures, 60)
    (compliance,), (frequencies,) = expected.compliances, expected.frequencies
    np.testing.assert_allclose(sum(solved_modes.strain.values()), np.ones(60), rtol=1e-12)
    np.testing.assert_allclose(solved_modes.modes.frequencies, frequencies, rtol=1e-12)
    # Relative to the largest entry: by symmetry some are rounding alone.
    scale = np.abs(compliance).max()
    np.testing.assert_allclose(solved_modes.compliance, compliance, rtol=0, atol=1e-12 * scale)
    (rigid,) = mechanism_modes("simplified", postures, 12)
    assert set(rigid.strain) == {Portion(f"drive{k}", "drive") for k in range(1, 7)}
    np.testing.assert_allclose(sum(rigid.strain.values()), np.ones(6), rtol=1e-12)


def test_modes_of_model_are_paired_with_themselves(command):
    """MAC 1, equal frequencies and energy shares of 1 for twelve modes of the Orthoglide."""
    words = ("--model", "beam", "--modes", "12", "--against", "beam")
    (result,) = command.json("solve", "orthoglide", *words)["results"]
    pairs = result["partners"]["pairs"]
    assert [pair["partner"] for pair in pairs] == list(range(1, 13))
    assert [pair["mac"] for pair in pairs] == pytest.approx([1.0] * 12, abs=1e-9)
    assert [pair["frequency"] for pair in pairs] == pytest.approx(result["frequencies"])
    assert sum(shares[0] for shares in result["strain"].values()) == pytest.approx(1.0)
    assert [pair["seen"] for pair in pairs] == pytest.approx([1.0] * 12, abs=1e-6)
