"""Free twists of every kind of joint, by physics.md section 7, in a posture off the reference."""

from types import MappingProxyType

import numpy as np
import pytest

from lumped.mechanism.body import Body, Frame, Rigid
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import Mechanism, Posture, Tool
from lumped.models.chains import axis_rotation

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
OTHER = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
# Both bodies have turned since the reference posture, about axes that are none of the joint's.
FIRST = axis_rotation(np.array([0.0, 0.6, 0.8]), 0.7)
SECOND = axis_rotation(np.array([1.0, 0.0, 0.0]), -0.4)


def posture(kind, axes) -> tuple[Posture, Joint]:
    joint = Joint("j", kind, Side("a", "P"), Side("b", "P"), np.array(axes).reshape(-1, 3))
    place = Frame(np.array([0.1, 0.2, 0.3]), axis_rotation(np.array([0.0, 0.0, 1.0]), 0.2))
    bodies = {name: Body(name, Rigid(), {"P": Frame(np.array([0.0, 0.5, 0.0]))}) for name in "ab"}
    reference = {"a": place, "b": Frame()}
    mechanism = Mechanism(
        "two bodies",
        MappingProxyType(bodies),
        (joint,),
        Tool("b", "P"),
        reference,
        np.zeros((1, 0)),
    )
    now = {
        "a": Frame(np.array([1.0, 0.0, 0.0]), FIRST @ place.rotation),
        "b": Frame(np.zeros(3), SECOND),
    }
    return Posture(mechanism, np.zeros(0), now, {}), joint


@pytest.mark.parametrize(
    ("kind", "axes", "expected"),
    [
        ("fixed", [], np.zeros((0, 6))),
        ("revolute", [AXIS], [[0, 0, 0, *FIRST @ AXIS]]),
        ("prismatic", [AXIS], [[*FIRST @ AXIS, 0, 0, 0]]),
        ("cylindrical", [AXIS], [[*FIRST @ AXIS, 0, 0, 0], [0, 0, 0, *FIRST @ AXIS]]),
        ("universal", [AXIS, OTHER], [[0, 0, 0, *FIRST @ AXIS], [0, 0, 0, *SECOND @ OTHER]]),
        ("spherical", [], np.eye(6)[3:]),
    ],
)
def test_each_kind_leaves_its_own_twists_free(kind, axes, expected):
    found = free_twists(*posture(kind, axes)).T
    assert found == pytest.approx(np.array(expected), abs=1e-15)


def test_a_planar_joint_slides_across_its_normal_and_turns_about_it():
    found = free_twists(*posture("planar", [AXIS]))
    normal = FIRST @ AXIS
    assert found[3:, 2] == pytest.approx(normal, abs=1e-15)
    assert found[:3, 2] == pytest.approx(0.0, abs=1e-15)
    sliding = found[:3, :2]
    assert sliding.T @ sliding == pytest.approx(np.eye(2), abs=1e-15)
    assert np.cross(*sliding.T) == pytest.approx(normal, abs=1e-15)


def test_an_interface_is_where_its_body_carries_it():
    now, joint = posture("spherical", [])
    turned = FIRST @ axis_rotation(np.array([0.0, 0.0, 1.0]), 0.2) @ [0.0, 0.5, 0.0]
    expected = np.array([1.0, 0.0, 0.0]) + turned
    assert interface_position(now, joint.first) == pytest.approx(expected, abs=1e-15)
