"""Models of the built-in mechanisms: one answer where they must agree, and what symmetry asks."""

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models.bodies import legs_of
from lumped.models.serial_chains import NoChainError
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved, strain_shares
from validation.cli import main
from validation.models.mechanism import (
    answers,
    constant_legs,
    dynamic_bodies,
    static_bodies,
)
from validation.models.options import DEFAULT_OPTIONS, ModelOptions

SERIAL = ("five-bar", "hexapod")
EULER_BERNOULLI = ModelOptions(theory="euler-bernoulli")
# One third of a turn about z, of twists.
THIRD = np.kron(
    np.eye(2), [[-0.5, -np.sqrt(0.75), 0.0], [np.sqrt(0.75), -0.5, 0.0], [0.0, 0.0, 1.0]]
)


def along_the_path(name: str):
    mechanism = load_robot(name).mechanism
    poses = mechanism.poses[:: max(1, len(mechanism.poses) // 3)]
    return [reference_posture(mechanism), *(posture(mechanism, pose) for pose in poses)]


def apart(found, expected) -> float:
    return max(
        np.abs(one.compliance - other.compliance).max() / np.abs(other.compliance).max()
        for one, other in zip(found, expected, strict=True)
    )


@pytest.mark.parametrize("name", [*SERIAL, "delta"])
def test_beams_links_segments_and_chains_have_one_static_answer(name):
    at = along_the_path(name)
    expected = answers("links", at, 0, EULER_BERNOULLI)
    others = ("beam", "segments", "vjm") if name in SERIAL else ("beam", "segments")
    for model in others:
        assert apart(answers(model, at, 0, EULER_BERNOULLI), expected) < 1e-9, model


def test_why_legs_are_no_chains_arrives_from_another_process():
    at = [reference_posture(load_robot("delta").mechanism)]
    with pytest.raises(NoChainError, match=r"branches at .*; take --model links") as raised:
        answers("vjm", at, 0)
    arrived = pickle.loads(pickle.dumps(raised.value))  # noqa: S301  its own bytes
    assert isinstance(arrived, NoChainError)
    assert (str(arrived), arrived.reason) == (str(raised.value), raised.value.reason)
    assert arrived.faults == raised.value.faults


@pytest.mark.parametrize(("name", "model"), [("delta", "beam"), ("hexapod", "segments")])
def test_threefold_symmetry_of_compliance_and_double_modes(name, model):
    """Twelve digits of the files' points leave 1e-11."""
    (found,) = answers(model, [reference_posture(load_robot(name).mechanism)], 10)
    turned = THIRD @ found.compliance @ THIRD.T
    assert np.abs(turned - found.compliance).max() <= 1e-9 * np.abs(found.compliance).max()
    # Modes of the symmetry's two-dimensional representation come in pairs, from the first on.
    first, second = found.frequencies[:2]
    assert second == pytest.approx(first, rel=1e-9)


def test_equal_bodies_are_reduced_once():
    mechanism = load_robot("hexapod").mechanism
    bodies = dynamic_bodies("beam", mechanism, 500.0)
    # The field of displacement is made with the body and kept with it.
    shapes = {id(body.centreline) for body in bodies.values()}
    sections = {(leg.section, round(leg.length, 9)) for leg in legs_of(mechanism).values()}
    assert len(shapes) == len(sections)


def test_a_leg_carries_the_printed_joint_at_its_tip_and_no_fixed_one():
    """The platform of the paper's robot is fixed to the tip of leg 1, leg 2 hinged there."""
    mechanism = load_robot("ifw").mechanism
    joints = [
        replace(joint, first=joint.second, second=joint.first) if joint.name == "seat" else joint
        for joint in mechanism.joints
    ]
    legs = constant_legs(replace(mechanism, joints=joints), ModelOptions(release="printed"))
    assert {name: own.release for name, _, own in legs} == {"leg1": "condensed", "leg2": "printed"}


def test_simplified_knows_nothing_of_what_its_joints_give():
    at = reference_posture(load_robot("ifw").mechanism)
    joints = tuple(replace(joint, compliance=None) for joint in at.mechanism.joints)
    stiff = replace(at, mechanism=replace(at.mechanism, joints=joints))
    (found,), (expected,) = (answers("simplified", [one], 0) for one in (at, stiff))
    assert found.compliance == pytest.approx(expected.compliance, rel=1e-12)


def test_strain_energy_is_shared_by_bodies_and_joints():
    at = reference_posture(load_robot("delta").mechanism)
    bodies = static_bodies("beam", at.mechanism)
    system = assemble(at, bodies)
    solution = solved(system)
    forces = np.eye(6, 3)
    displacements = solution.displacements(system.tool.T @ forces)
    shares = strain_shares(system, displacements)
    assert sum(shares.values()) == pytest.approx(np.ones(3), abs=1e-12)
    # What the drives take is what a rigid robot on them yields.
    simplified = compliance(solved(assemble(at, {})))
    drives = sum(share for part, share in shares.items() if part.kind == "drive")
    whole = np.diag(compliance(solution))[:3]
    assert drives * whole == pytest.approx(np.diag(simplified)[:3], rel=1e-9)


def test_legs_are_one_only_where_they_are_alike_to_the_last_digits_typed():
    described = load_robot("five-bar").mechanism
    lengths = {name: leg.length for name, leg, _ in constant_legs(described, DEFAULT_OPTIONS)}
    assert len(set(lengths.values())) < len(lengths)
    for change, apart in ((1e-12, False), (1e-6, True)):
        rod = described.bodies["rod1"]
        longer = replace(rod, shape=replace(rod.shape, length=(1.0 + change) * rod.shape.length))
        changed = replace(described, bodies={**described.bodies, "rod1": longer})
        known = {name: leg.length for name, leg, _ in constant_legs(changed, DEFAULT_OPTIONS)}
        assert (known["rod1"] != known["rod2"]) is apart


def solve(capsys, *arguments):
    code = main(["solve", *arguments])
    streams = capsys.readouterr()
    return code, streams.out, streams.err


def test_solve_gives_poses_and_idle_mobilities(capsys):
    pose = ("--pose", "-0.01,0,-0.5")
    code, out, _ = solve(capsys, "delta", "--model", "beam", "--modes", "2", "--json", *pose)
    (result,) = json.loads(out)["results"]
    assert code == 0
    assert result["pose"] == [-0.01, 0.0, -0.5]
    assert result["idle"] == 6
    assert np.shape(result["compliance"]) == (6, 6)
    assert len(result["frequencies"]) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["delta", "--model", "beam", "--x", "1"], "--x: poses of a mechanism are typed as --pose"),
        (["delta", "--model", "beam", "--leg", "1"], "--leg: bodies of a mechanism have names"),
        (["delta", "--model", "beam", "--pose", "1,2"], "--pose 1,2: must be x,y,z as finite"),
        (["delta", "--model", "beam", "--body", "arm"], "--body arm: no such body; must be one of"),
        (["delta", "--model", "beam", "--body", "bar1"], "--body bar1: is rigid; must be one of"),
        (["delta", "--model", "links", "--modes", "3"], "--modes: the links model is static"),
        (["delta", "--model", "links", "--legs", "given"], "--legs: no leg that is asked about is"),
        (["delta", "--model", "segments", "--release", "printed"], "--release: not an option of"),
    ],
)
def test_what_is_typed_wrong_is_refused_in_one_line(capsys, arguments, message):
    code, out, err = solve(capsys, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_more_modes_can_be_asked_for_than_two_elements_a_leg_have():
    middle = reference_posture(load_robot("ifw").mechanism)
    (answer,) = answers("beam", [middle], 60, ModelOptions(elements=10))
    assert len(answer.frequencies) == 60
