"""Patterns of copies about an axis: the same robot as with every copy written out."""

import tomllib
from copy import deepcopy

import numpy as np
import pytest

from lumped.audit import audit
from lumped.errors import InputError
from lumped.mechanism.mechanism import GROUND
from lumped.memo import fingerprint
from lumped.robot_file import load_robot, robot_of
from lumped.robot_file.mechanism.pattern import written_out
from lumped.robot_file.variation import variations_of, varied

# The built-in Delta robot, described by its first leg and a pattern of three copies.
DELTA = """
schema = 2
name = "Delta"

[patterns]
legs = { about = "z", count = 3 }

[points]
P = [0.0, 0.0, -0.522779314828]
A = { at = [0.18, 0.0, 0.0], pattern = "legs" }
E = { at = [0.405526228989, 0.0, -0.082084834398], pattern = "legs" }
El = { at = [0.405526228989, 0.05, -0.082084834398], pattern = "legs" }
Er = { at = [0.405526228989, -0.05, -0.082084834398], pattern = "legs" }
Cl = { at = [0.06, 0.05, -0.522779314828], pattern = "legs" }
Cr = { at = [0.06, -0.05, -0.522779314828], pattern = "legs" }

[materials]
steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
aluminium = { E = 7.0e10, nu = 0.33, rho = 2700.0 }

[bodies.arm]
from = "A"
to = "E"
section = { shape = "hollow-rectangle", width = 0.05, height = 0.07, thickness = 0.005 }
material = "aluminium"
pattern = "legs"

[bodies.bar]
points = ["E", "El", "Er"]
mass = 0.25
centre = "E"
pattern = "legs"

[bodies.rodl]
from = "El"
to = "Cl"
section = { shape = "tube", diameter = 0.02, thickness = 0.002 }
material = "aluminium"
pattern = "legs"

[bodies.rodr]
from = "Er"
to = "Cr"
section = { shape = "tube", diameter = 0.02, thickness = 0.002 }
material = "aluminium"
pattern = "legs"

[bodies.platform]
points = ["Cl1", "Cr1", "Cl2", "Cr2", "Cl3", "Cr3", "P"]
mass = 0.6
centre = "P"
inertia = [[7.0e-4, 0.0, 0.0], [0.0, 7.0e-4, 0.0], [0.0, 0.0, 1.3e-3]]

[joints]
clamp = { type = "fixed", between = ["arm", "bar"], at = "E", pattern = "legs" }
elbowl = { type = "spherical", between = ["bar", "rodl"], at = "El", pattern = "legs" }
wristl = { type = "spherical", between = ["rodl", "platform"], at = "Cl", pattern = "legs" }
elbowr = { type = "spherical", between = ["bar", "rodr"], at = "Er", pattern = "legs" }
wristr = { type = "spherical", between = ["rodr", "platform"], at = "Cr", pattern = "legs" }

[joints.motor]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 1.0, 0.0]
drive = { stiffness = 3.0e4 }
pattern = "legs"

[tool]
body = "platform"
point = "P"
moves = ["x", "y", "z"]
mass = 1.0

[path]
from = [-0.12, -0.08, -0.42]
to = [0.12, 0.08, -0.52]
count = 9
"""
TABLES = tomllib.loads(DELTA)


SIDED = [f"{part}{side}" for part in ("E", "C", "rod", "elbow", "wrist") for side in "lr"]


def built_in_name(name):
    """Return the name of a copy in the built-in robot: El1 and rodl1 become E1l and rod1l."""
    part, number = name[:-1], name[-1]
    return f"{part[:-1]}{number}{part[-1]}" if part in SIDED else name


def test_pattern_gives_built_in_delta():
    """The built-in robot's coordinates have twelve decimals: rounding errors of up to 5e-13 m."""
    mechanism, expected = robot_of(TABLES).mechanism, load_robot("delta").mechanism
    assert {built_in_name(name) for name in mechanism.bodies} == set(expected.bodies)
    for name, body in mechanism.bodies.items():
        other, frame = expected.bodies[built_in_name(name)], mechanism.reference[name]
        other_frame = expected.reference[built_in_name(name)]
        assert frame.position == pytest.approx(other_frame.position, abs=1e-12)
        # Errors of 5e-13 m at the ends of legs of 0.2 m and more.
        assert frame.rotation == pytest.approx(other_frame.rotation, abs=1e-11)
        assert {built_in_name(point) for point in body.interfaces} == set(other.interfaces)
        for point, interface in body.interfaces.items():
            position = other.interfaces[built_in_name(point)].position
            assert interface.position == pytest.approx(position, abs=1e-12)
        assert type(body.shape) is type(other.shape)
        assert body.shape.mass == pytest.approx(other.shape.mass, rel=1e-11)
    joints = {joint.name: joint for joint in expected.joints}
    assert {built_in_name(joint.name) for joint in mechanism.joints} == set(joints)
    for joint in mechanism.joints:
        other = joints[built_in_name(joint.name)]
        assert (joint.kind, joint.drive) == (other.kind, other.drive)
        ends = [
            (built_in_name(s.body), built_in_name(s.point)) for s in (joint.first, joint.second)
        ]
        assert ends == [(side.body, side.point) for side in (other.first, other.second)]
        assert joint.axes == pytest.approx(other.axes, abs=1e-12)


def test_varied_number_applies_to_all_copies():
    """`--vary` of a section or of a point that has three copies."""
    loaded = robot_of(TABLES)
    key = "bodies.arm.section.height"
    ((_, robot),) = varied(loaded, variations_of(loaded, [f"{key}=0.09:0.09:1"]))
    bodies = robot.mechanism.bodies
    assert [bodies[f"arm{n}"].shape.section.height for n in (1, 2, 3)] == [0.09] * 3
    key = "points.E.at[1]"
    ((_, robot),) = varied(loaded, variations_of(loaded, [f"{key}=0.4:0.4:1"]))
    radii = [np.hypot(*robot.mechanism.reference[f"bar{n}"].position[:2]) for n in (1, 2, 3)]
    assert radii == pytest.approx([0.4] * 3, rel=1e-14)


def test_point_without_pattern_may_be_a_table():
    """A table { at = … } without a pattern is the point itself, also as the centre of a pattern."""
    tables = deepcopy(TABLES)
    tables["points"]["O"] = {"at": [0.0, 0.0, 0.0]}
    tables["points"]["P"] = {"at": tables["points"]["P"]}
    tables["patterns"]["legs"]["through"] = "O"
    tables["bodies"]["frame"] = {"points": ["O"]}
    tables["joints"]["frame"] = {"type": "fixed", "between": ["ground", "frame"], "at": "O"}
    robot, expected = robot_of(tables).mechanism, robot_of(TABLES).mechanism
    for name, body in expected.bodies.items():
        assert name == GROUND or fingerprint(robot.bodies[name]) == fingerprint(body), name
    assert fingerprint(robot.joints[:-1]) == fingerprint(expected.joints)
    plain = load_robot("five-bar")
    points = {name: {"at": point} for name, point in plain.tables["points"].items()}
    as_tables = robot_of({**plain.tables, "points": points})
    assert fingerprint(as_tables.mechanism) == fingerprint(plain.mechanism)
    assert audit(as_tables) == audit(plain)


HALF = {"about": [0.0, 0.0, 2.0], "count": 2, "through": [1.0, 0.0, 0.0]}
COLUMN = {
    "schema": 2,
    "name": "two columns",
    "points": {
        "A": {"at": [0.0, 0.0, 0.0], "pattern": HALF},
        "B": {"at": [0.0, 0.0, 1.0], "pattern": HALF},
        "P": [1.0, 0.0, 1.0],
    },
    "materials": {"steel": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0}},
    "bodies": {
        "post": {
            "from": "A",
            "to": "B",
            "section": {"shape": "rectangle", "width": 0.05, "height": 0.03},
            "material": "steel",
            "pattern": HALF,
        },
        "lump": {
            "points": ["B"],
            "mass": 1.0,
            "centre": [0.1, 0.2, 1.0],
            "inertia": [[3e-3, 1e-3, 0.0], [1e-3, 4e-3, 5e-4], [0.0, 5e-4, 5e-3]],
            "pattern": HALF,
        },
        "beam": {"points": ["B1", "B2", "P"]},
    },
    "joints": {
        "foot": {
            "type": "fixed",
            "between": ["ground", "post"],
            "at": "A",
            "compliance": (np.diag([1e-9, 2e-9, 3e-9, 1e-7, 2e-7, 3e-7])).tolist(),
            "pattern": HALF,
        },
        "top": {"type": "fixed", "between": ["post", "beam"], "at": "B", "pattern": HALF},
        "seat": {"type": "fixed", "between": ["post", "lump"], "at": "B", "pattern": HALF},
    },
    "tool": {"body": "beam", "point": "P", "moves": []},
}


def test_copies_have_rotated_matrices():
    """Half a turn about the z direction through x = 1 m: x ↦ 2 − x, y ↦ −y, −Jxz and −Jyz."""
    new = written_out(COLUMN)
    assert new["points"]["A2"] == pytest.approx([2.0, 0.0, 0.0], abs=1e-15)
    assert new["bodies"]["lump2"]["centre"] == pytest.approx([1.9, -0.2, 1.0], abs=1e-15)
    inertia = np.array(new["bodies"]["lump2"]["inertia"])
    expected = [[3e-3, 1e-3, 0.0], [1e-3, 4e-3, -5e-4], [0.0, -5e-4, 5e-3]]
    assert inertia == pytest.approx(np.array(expected), abs=1e-17)
    # The z axis of a leg along base z is base x; that of its copy is −x.
    assert "up" not in new["bodies"]["post1"]
    assert new["bodies"]["post2"]["up"] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-15)
    quarter = deepcopy(COLUMN)
    turn = {"about": "z", "count": 4, "through": [1.0, 0.0, 0.0]}
    quarter["joints"]["foot"]["pattern"] = quarter["joints"]["top"]["pattern"] = turn
    (second,) = [
        np.diag(joint["compliance"])
        for name, joint in written_out(quarter)["joints"].items()
        if name == "foot2"
    ]
    assert second == pytest.approx([2e-9, 1e-9, 3e-9, 2e-7, 1e-7, 3e-7], rel=1e-12)
    assert robot_of(COLUMN).mechanism.bodies["lump2"].shape.mass == 1.0


def test_audit_reports_each_copy_in_mm():
    """A mass centre beyond the leg's tip is reported for each copy, also in a file in mm."""
    compliance = (np.diag([1e-9, 3e-7, 3e-7, 1e-6, 1e-6, 1e-6])).tolist()
    tables = deepcopy(COLUMN)
    post = {"from": "A", "to": "B", "compliance": compliance, "mass": 5.0, "mass_centre": 1.2}
    tables["bodies"]["post"] = post | {"pattern": HALF}
    metres = {(f.where, f.check): f.numbers for f in audit(robot_of(tables))}
    assert metres["bodies.post2.mass_centre", "mass centre"] == {"mass centre": 1.2, "length": 1.0}
    half = HALF | {"through": [1000.0, 0.0, 0.0]}
    milli = deepcopy(tables) | {"units": "mm"}
    for name, point in milli["points"].items():
        position = point if name == "P" else point["at"]
        position[:] = [1000.0 * x for x in position]
    milli["bodies"]["post"]["mass_centre"] = 1200.0
    milli["bodies"]["lump"]["centre"] = [100.0, 200.0, 1000.0]
    for table in ("points", "bodies", "joints"):
        for entry in milli[table].values():
            if "pattern" in entry:
                entry["pattern"] = half
    millimetres = {(f.where, f.check): f.numbers for f in audit(robot_of(milli))}
    assert millimetres.keys() == metres.keys()
    for key, values in metres.items():
        assert millimetres[key] == pytest.approx(values, rel=1e-12), key


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'at = "El", pattern = "legs"',
            'at = "El", pattern = "rods"',
            'joints.elbowl.pattern = "rods": must be the name of one of [patterns]: legs',
        ),
        (
            'about = "z", count = 3',
            'about = "z", count = 3, through = "E"',
            'patterns.legs.through = "E": must be the name of a point without a pattern, or '
            "[x, y, z]",
        ),
        (
            'about = "z", count = 3',
            "about = [0.0, 0.0, 0.0], count = 3",
            "patterns.legs.about = [0.0, 0.0, 0.0]: must not be zero, it is a direction",
        ),
        (
            "[bodies.platform]",
            '[bodies.arm2]\npoints = ["P"]\n[bodies.platform]',
            "bodies.arm2: is copy 2 of bodies.arm already; must have another name",
        ),
        (
            'A = { at = [0.18, 0.0, 0.0], pattern = "legs" }',
            "A = [0.18, 0.0, 0.0]",
            'bodies.arm.from = "A": has no pattern and lies off the axis of bodies.arm; must have '
            "the same pattern, or lie on the axis",
        ),
        (
            'material = "aluminium"\npattern = "legs"\n\n[bodies.bar]',
            'material = "aluminium"\npattern = { about = "z", count = 4 }\n\n[bodies.bar]',
            'joints.motor.between[2] = "arm": has another pattern than joints.motor; must be the '
            "same axis and count, or the name of one copy",
        ),
        (
            "count = 3 }",
            "count = 1 }",
            "patterns.legs.count = 1: must be at least 2",
        ),
        (
            "diameter = 0.02, thickness = 0.002 }",
            "diameter = 0.9, thickness = 0.002 }",
            "bodies.rodl3.section.diameter = 0.9: must be below the leg's length, 0.56 m; is this "
            "in mm?",
        ),
        (
            '"Cr3", "P"]',
            '"Cr", "P"]',
            'bodies.platform.points[6] = "Cr": must be the name of one of [points]; did you mean',
        ),
    ],
)
def test_pattern_error_names_entry(old, new, message):
    """Each fault of a pattern gives a line with the joint, body or point that has it."""
    assert old in DELTA
    tables = tomllib.loads(DELTA.replace(old, new))
    with pytest.raises(InputError) as refused:
        robot_of(tables)
    assert any(fault.startswith(f"dictionary: {message}") for fault in refused.value.faults), (
        refused.value.faults
    )
