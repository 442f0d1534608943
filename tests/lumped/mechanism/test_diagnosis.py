"""Mechanisms that cannot move: messages on a tilted joint axis and on legs in one line."""

from copy import deepcopy
from math import cos, radians, sin

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.robot_file import load_robot, robot_of

FIVE_BAR = load_robot("five-bar").tables
ORTHOGLIDE = load_robot("orthoglide").tables
MATERIAL = {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}
# Hinge and wrist of an Orthoglide leg need parallel axes: if they are not parallel, either of the
# two may be reported as tilted.
TWINS = {"hinge_x": "wrist_x", "wrist_x": "hinge_x"}


def faults(tables):
    with pytest.raises(InputError) as refused:
        robot_of(tables)
    return refused.value.faults


def tilted(tables, joint, towards):
    """Return the faults reported for a robot in which the axis of one joint is tilted by 1°."""
    new = deepcopy(dict(tables))
    axis = np.array(new["joints"][joint]["axis"])
    across = np.roll(axis, towards)
    new["joints"][joint]["axis"] = (cos(radians(1)) * axis + sin(radians(1)) * across).tolist()
    return faults(new)


@pytest.mark.parametrize("towards", [1, 2])
@pytest.mark.parametrize("joint", FIVE_BAR["joints"])
def test_tilted_hinge_axis_is_reported(joint, towards):
    """All five axes are parallel: the other four give the direction of the tilted one."""
    (fault,) = tilted(FIVE_BAR, joint, towards)
    assert fault.startswith(f"dictionary: joints.{joint}.axis = ")
    assert "keeps the tool from moving along " in fault
    assert fault.endswith("; along [0.0, 0.0, 1.0], 1° from it, it would move")


@pytest.mark.parametrize("joint", ["hinge_x", "pin_x1", "eye_x1", "pin_x2", "eye_x2", "wrist_x"])
def test_tilted_orthoglide_axis_is_reported(joint):
    """One axis tilted by 1°: the message names it, or two that it cannot tell apart."""
    fault = tilted(ORTHOGLIDE, joint, 1 if joint in TWINS else 2)[0]
    key = f"joints.{joint}.axis"
    if joint in TWINS:
        assert key in fault or f"(or the axis of {joint} is off as much)" in fault
        assert TWINS[joint] in fault
    else:
        assert fault.startswith(f"dictionary: {key} = ")
    assert "1° from it, it would move" in fault


def test_impossible_tool_moves_are_reported():
    """A planar robot cannot move along z."""
    new = deepcopy(dict(FIVE_BAR))
    new["tool"] = FIVE_BAR["tool"] | {"moves": ["x", "z"]}
    new.pop("path")
    assert any("tool.moves = ['x', 'z']" in fault for fault in faults(new))


def with_points(tables, points):
    new = deepcopy(dict(tables))
    new.pop("path")
    new["points"] |= {name: list(map(float, position)) for name, position in points.items()}
    return new


def test_stretched_five_bar_leg_is_reported():
    """Elbow B1 midway between motor and tool (leg stretched), then beyond the tool (leg folded)."""
    (fault,) = faults(with_points(FIVE_BAR, {"B1": [-0.075, 0.275, 0.0]}))
    assert fault == (
        "dictionary: points: the reference posture is singular: crank1 and rod1 are stretched out "
        "in one line; drives motor1 move while the tool cannot move along x, y; must be a posture "
        "inside the workspace"
    )
    (fault,) = faults(with_points(FIVE_BAR, {"B1": [0.075, 0.825, 0.0]}))
    assert "singular: crank1 and rod1 are folded into one line; drives motor1 move" in fault


def test_collinear_rods_are_reported():
    """Both rods lie along x: with locked drives the tool is free to move along y."""
    (fault,) = faults(with_points(FIVE_BAR, {"B1": [-0.35, 0.55, 0.0], "B2": [0.35, 0.55, 0.0]}))
    assert "singular: rod1 and rod2 are stretched out in one line; with all drives locked" in fault


def test_stretched_legs_are_reported():
    """All three legs of a 3-RRR stretched: each is named, and the motions lost and free."""
    points = load_robot("3-rrr").tables["points"]
    middles = {f"B{i}": 0.5 * (np.array(points[f"A{i}"]) + points[f"C{i}"]) for i in (1, 2, 3)}
    (fault,) = faults(with_points(load_robot("3-rrr").tables, middles))
    for i in (1, 2, 3):
        assert f"crank{i} and rod{i} are stretched out in one line" in fault
    assert (
        "the tool cannot move along x, y; with all drives locked the tool is free to turn" in fault
    )


def test_dead_centre_names_no_ground():
    """A slider-crank at its dead centre: motor and guide lie in one line with crank and rod."""
    leg = {"section": {"shape": "circle", "diameter": 0.03}, "material": MATERIAL}
    hinge = {"type": "revolute", "axis": [0.0, 0.0, 1.0]}
    press = {
        "schema": 2,
        "name": "press",
        "points": {"O": [0.0, 0.0, 0.0], "A": [0.0, 0.06, 0.0], "B": [0.0, 0.31, 0.0]},
        "bodies": {
            "crank": {"from": "O", "to": "A", **leg},
            "rod": {"from": "A", "to": "B", **leg},
            "ram": {"points": ["B"], "mass": 2.0, "centre": "B"},
        },
        "joints": {
            "motor": hinge
            | {"between": ["ground", "crank"], "at": "O", "drive": {"stiffness": 5.0e5}},
            "elbow": hinge | {"between": ["crank", "rod"], "at": "A"},
            "pin": hinge | {"between": ["rod", "ram"], "at": "B"},
            "guide": {
                "type": "prismatic",
                "between": ["ground", "ram"],
                "at": "B",
                "axis": [0.0, 1.0, 0.0],
            },
        },
        "tool": {"body": "ram", "point": "B", "moves": ["y"]},
    }
    (fault,) = faults(press)
    assert fault == (
        "dictionary: points: the reference posture is singular: crank and rod are stretched out in "
        "one line; drives motor move while the tool cannot move along y; must be a posture inside "
        "the workspace"
    )


@pytest.mark.parametrize(("side", "state"), [(1.0, "stretched out in"), (-1.0, "folded into")])
def test_stretched_delta_leg_is_reported(side, state):
    """The rods hang from a bar that is clamped to the arm: their lines meet the motor's axis."""
    points = load_robot("delta").tables["points"]
    foot, elbow = np.array(points["A1"]), np.array(points["E1"])
    wrist = 0.5 * (np.array(points["C1l"]) + points["C1r"])
    along = (wrist - foot) / np.linalg.norm(wrist - foot)
    stretched = foot + side * np.linalg.norm(elbow - foot) * along
    moved = {
        f"E1{end}": stretched + np.array([0.0, y, 0.0])
        for end, y in (("", 0), ("l", 0.05), ("r", -0.05))
    }
    (fault,) = faults(with_points(load_robot("delta").tables, moved))
    assert f"singular: rod1l and rod1r are {state} one line with the axis of motor1;" in fault


def test_rods_across_their_slides_are_reported():
    """A linear Delta whose rods lie level, at right angles to the vertical screws."""
    tables = deepcopy(dict(load_robot("linear-delta").tables))
    tables.pop("path")
    for name in ("A", "El", "Er"):
        tables["points"][name]["at"][2] = -400.0
    (fault,) = faults(tables)
    for i in (1, 2, 3):
        assert f"rodl{i} and rodr{i} are at right angles to the slide of screw{i}" in fault


@pytest.mark.filterwarnings("error")
def test_platform_of_one_place_is_no_leg():
    """A platform whose two points coincide has no direction."""
    tables = with_points(FIVE_BAR, {"B1": [-0.075, 0.275, 0.0]})
    tables["points"]["Q"] = tables["points"]["P"]
    tables["bodies"]["platform"] = {"points": ["P", "Q"], "mass": 1.0, "centre": "P"}
    tables["joints"]["seat"] = {"type": "fixed", "between": ["rod1", "platform"], "at": "P"}
    tables["joints"]["pin"]["between"] = ["platform", "rod2"]
    tables["tool"] = FIVE_BAR["tool"] | {"body": "platform", "point": "Q", "moves": ["x", "y"]}
    assert any("crank1 and rod1 are stretched out in one line" in fault for fault in faults(tables))
