"""A biglide of schema 1 and the same written out in schema 2 are one mechanism."""

import re
from pathlib import Path

import numpy as np
import pytest

from lumped.biglide import mechanism
from lumped.mechanism.body import Given, Prism
from lumped.robot_file import load_robot

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guide" / "mechanisms.md"


def written_out(robot) -> str:
    """A biglide with legs given by their 6×6, foot springs and drives, as a file of schema 2."""
    at = robot.posture(robot.centre)
    points = {"A": at.root1, "C": at.root2, "B": at.tip, "P": at.tip + robot.tool_offset}
    lines = ["schema = 2", f'name = "{robot.name}"', "[points]"]
    lines += [f"{name} = {place.tolist()}" for name, place in points.items()]
    for name, leg, root in (("leg1", robot.leg1, "A"), ("leg2", robot.leg2, "C")):
        lines += [f"[bodies.{name}]", f'from = "{root}"', 'to = "B"', f"mass = {leg.mass}"]
        lines += [f"compliance = {leg.compliance.tolist()}"]
        lines += [f"mass_centre = {leg.mass_centre}", f"inertia = {leg.inertia.tolist()}"]
    lines += ["[bodies]", 'slide1 = { points = ["A"] }', 'slide2 = { points = ["C"] }']
    lines += ['platform = { points = ["B", "P"] }', "[joints]"]
    drive = f'drive = {{ stiffness = "rigid", simplified = {robot.actuator_stiffness} }}'
    foot = f"compliance = {robot.foot_compliance.tolist()}"
    for i, point in (("1", "A"), ("2", "C")):
        ends = f'at = "{point}", axis = [0, 0, 1]'
        lines += [
            f'drive{i} = {{ type = "prismatic", between = ["ground", "slide{i}"], at = "{point}", '
            f"axis = [0, 1, 0], {drive} }}",
            f'foot{i} = {{ type = "revolute", between = ["slide{i}", "leg{i}"], {ends}, {foot} }}',
        ]
    lines += [
        'hinge = { type = "revolute", between = ["leg1", "leg2"], at = "B", axis = [0, 0, 1] }',
        'seat = { type = "fixed", between = ["leg1", "platform"], at = "B" }',
        "[tool]",
        'body = "platform"',
        'point = "P"',
        'moves = ["x", "y"]',
        f"mass = {robot.platform_mass}",
        "[path]",
        f"poses = {mechanism(robot).poses[1:-1].tolist()}",
    ]
    return "\n".join(lines)


def same(found, expected, rounding):
    assert set(found.bodies) == set(expected.bodies)
    for name, body in expected.bodies.items():
        other = found.bodies[name]
        assert type(other.shape) is type(body.shape)
        assert set(other.interfaces) == set(body.interfaces)
        for point, place in body.interfaces.items():
            assert other.interfaces[point].position == pytest.approx(place.position, abs=rounding)
        for part in ("position", "rotation"):
            values = getattr(expected.reference[name], part)
            assert getattr(found.reference[name], part) == pytest.approx(values, abs=rounding)
        if isinstance(body.shape, Given):
            assert other.shape.mass == body.shape.mass
            assert other.shape.mass_centre == body.shape.mass_centre
            for matrix in ("compliance", "inertia"):
                assert np.array_equal(getattr(other.shape, matrix), getattr(body.shape, matrix))
        if isinstance(body.shape, Prism):
            assert (other.shape.section, other.shape.material) == (
                body.shape.section,
                body.shape.material,
            )
    joints = {joint.name: joint for joint in found.joints}
    assert set(joints) == {joint.name for joint in expected.joints}
    for joint in expected.joints:
        other = joints[joint.name]
        for field in ("kind", "first", "second", "drive"):
            assert getattr(other, field) == getattr(joint, field)
        assert np.array_equal(other.axes, joint.axes)
        assert (other.compliance is None) == (joint.compliance is None)
        if joint.compliance is not None:
            assert np.array_equal(other.compliance, joint.compliance)
    for field in ("body", "point", "mass"):
        assert getattr(found.tool, field) == getattr(expected.tool, field)


def test_the_papers_robot_written_out_is_the_same_mechanism(tmp_path):
    robot = load_robot("ifw").robot
    path = tmp_path / "ifw.toml"
    path.write_text(written_out(robot), encoding="utf-8")
    found = load_robot(path)
    assert found.is_mechanism
    same(found.mechanism, mechanism(robot), 1e-15)
    assert np.array_equal(found.mechanism.poses, mechanism(robot).poses[1:-1])


def test_the_one_of_the_guide_is_the_built_in_biglide(tmp_path):
    text = GUIDE.read_text(encoding="utf-8")
    path = tmp_path / "biglide.toml"
    found = re.search(r"^```toml written-out.toml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    path.write_text(found[1], encoding="utf-8")
    # Its points are given to twelve decimals.
    same(load_robot(path).mechanism, load_robot("biglide").mechanism, 1e-11)
