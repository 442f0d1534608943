"""Robot files: the robots of valid files, one line per fault of others, schema and key list."""

import re
import runpy
import shutil
import tomllib
from dataclasses import replace
from functools import reduce
from hashlib import sha256
from math import inf
from operator import getitem
from pathlib import Path

import numpy as np
import pytest
from support.random.mutated_robots import places
from support.robots.gantry import GANTRY, STIFFNESSES
from support.robots.invalid_files import invalid_files
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import described, robot_of
from support.robots.valid_biglide import SOUND

from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface, Rigid
from lumped.models.bodies import legs_of
from lumped.robot_file import built_in_robots, load, load_robot, reading, write_template
from lumped.robot_file.load import described_by
from lumped.robot_file.mechanism.build import interface_of
from lumped.robot_file.reading import decimal_tables, printed_compliances
from lumped.robot_file.rules.published import json_schema
from lumped.robot_file.rules.tables.bodies import INTERFACE
from lumped.sections import HollowRectangle
from validation import cli


def joints_of(mechanism):
    return {joint.name: joint for joint in mechanism.joints}


def test_valid_biglide_file_is_read(tmp_path):
    """Legs by section and by 6×6, end condition, tool offset, and SHA-256 of the file."""
    loaded = robot_of(SOUND.replace("[leg1]", '[leg1]\nends = "rigid"'), tmp_path)
    path = tmp_path / "robot.toml"
    assert (loaded.source, loaded.built_in) == (str(path), False)
    assert loaded.sha256 == sha256(path.read_bytes()).hexdigest()
    leg1, leg2 = legs_of(loaded.mechanism).values()
    assert isinstance(leg1, ConstantLeg)
    assert (leg1.section, leg1.ends) == (HollowRectangle(0.10, 0.16, 0.008), "rigid")
    # Hollow steel rectangle of 0.1 × 0.16 × 0.008 m: area times 7850 kg/m³ times 0.85 m.
    assert leg1.mass == pytest.approx((0.016 - 0.084 * 0.144) * 7850 * 0.85)
    assert isinstance(leg2, GivenLeg)
    assert leg2.compliance[1, 5] == 3.0e-8
    assert loaded.mechanism.tool.datum == (0.0, 0.0, 0.1)
    assert "spring" not in joints_of(loaded.mechanism)


def test_byte_order_mark_and_crlf_are_read(tmp_path):
    """Files written by Windows editors."""
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SOUND.replace("\n", "\r\n").encode())
    slides = load_robot(path).mechanism.reference
    assert (slides["slide2"].position - slides["slide1"].position)[0] == 0.9


def test_all_loss_factors_are_read(tmp_path):
    """Loss factors of the biglide's legs, feet, drives and tool, and of a five-bar robot's body."""
    steel, lossy = "rho = 7850.0 }", "rho = 7850.0, loss = 0.01 }"
    text = f"{SOUND}\n[tool]\ncompliance = {(1e-9 * np.eye(6)).tolist()}\n".replace(steel, lossy)
    for table, loss in (("leg2", 0.02), ("foot", 0.03), ("actuators", 0.04), ("tool", 0.05)):
        text = text.replace(f"[{table}]", f"[{table}]\nloss = {loss}")
    mechanism = robot_of(text, tmp_path).mechanism
    losses = [mechanism.bodies[name].loss for name in ("leg1", "leg2", "platform")]
    assert losses == [0.01, 0.02, 0.0]
    joints = joints_of(mechanism)
    assert [joints[name].loss for name in ("foot1", "foot2", "spring")] == [0.03, 0.03, 0.05]
    assert [joints[name].drive.loss for name in ("drive1", "drive2")] == [0.04, 0.04]
    text = load_robot("five-bar").text.replace(steel, lossy)
    assert robot_of(text, tmp_path).mechanism.bodies["crank1"].loss == 0.01


def test_mass_and_modulus_are_read(tmp_path):
    """`mass` replaces the density. G is E/2(1 + ν) unless the file gives it."""
    text = SOUND.replace(", rho = 7850.0", "").replace("length = 0.85", "length = 0.85\nmass = 60")
    leg = legs_of(robot_of(text, tmp_path).mechanism)["leg1"]
    # E over 2(1 + ν)
    assert (leg.mass, leg.material.G) == (pytest.approx(60.0), pytest.approx(2.1e11 / 2.6))
    soft = robot_of(SOUND.replace("nu = 0.3", "nu = 0.3, G = 7e10"), tmp_path).mechanism
    assert legs_of(soft)["leg1"].material.G == 7e10


def test_tool_compliance_is_symmetrised():
    """Compliances of tool and foot are symmetric if their entries agree to seven digits."""
    loaded = load_robot("ifw")
    assert "spring" not in joints_of(loaded.mechanism)
    # Entries that agree to seven digits are accepted as symmetric.
    values = {"tool.active": True, "foot.compliance[2,6]": 3.9400001e-8}
    active = joints_of(loaded.with_values(values).mechanism)
    assert active["spring"].compliance[1, 0] == -9.70e-11
    foot = active["foot1"].compliance
    assert np.array_equal(foot, foot.T)


def rows(**entries):
    """Return the text of a 6×6 of zeros with the given entries: c23="1.2" is row 2, column 3."""
    texts = [[entries.get(f"c{i}{j}", "0") for j in range(1, 7)] for i in range(1, 7)]
    return f"[{', '.join('[' + ', '.join(row) + ']' for row in texts)}]"


def test_rounding_half_width_is_half_unit_of_digit():
    """1.67e-10 has a half-width of 5e-13; zeros and the foot chosen by the designer have none."""
    entries = {"c11": "1.67e-10", "c22": "5.870E-9", "c33": "0.0025", "c44": "2e-7"}
    mirrored = {"c12": "0.0", "c21": "-0.0", "c23": "-1.5e-9", "c32": "-1.50e-9"}
    leg_text = f"compliance = {rows(**entries, **mirrored)}\n"
    tables = ("[leg1]", "[bodies.a]\nmass = 1.5", "[joints.'b.c']")
    # The foot's compliance is chosen by the designer: 5e-10 m/N is exact, not rounded from a
    # printed value between 4.5e-10 and 5.5e-10.
    foot_text = f"[foot]\ncompliance = {rows(c11='5e-10', c66='1.2e-7')}\n"
    text = "[path]\nfrom = [0.20, 0.50]\n" + "".join(f"{table}\n{leg_text}" for table in tables)
    *printed, of_designer = printed_compliances(decimal_tables(text + foot_text))
    expected = np.diag([0.5e-12, 0.5e-12, 0.5e-4, 0.5e-7, 0.0, 0.0])
    expected[1, 2] = expected[2, 1] = 0.05e-9
    for matrix in printed:
        assert np.array_equal(matrix.half, expected)
        assert np.diag(matrix.compliance).tolist() == [1.67e-10, 5.87e-9, 0.0025, 2e-7, 0.0, 0.0]
    assert (len(printed), of_designer.half.any()) == (3, False)


def test_number_too_small_for_float_is_exact_zero():
    """1e-99999999999999999999 has no rounding uncertainty."""
    entries = {"c11": "1.67e-10", "c12": "1e-99999999999999999999"}
    (foot,) = printed_compliances(decimal_tables(f"[foot]\ncompliance = {rows(**entries)}\n"))
    assert foot.compliance[0].tolist() == [1.67e-10, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert foot.half[0].tolist() == [0.5e-12, 0.0, 0.0, 0.0, 0.0, 0.0]


def faults_of(tables):
    with pytest.raises(InputError) as refused:
        described_by(tables, Path())
    return refused.value.faults


@pytest.mark.parametrize("wrong", list(invalid_files()), ids=str)
def test_error_names_allowed_values(wrong):
    """For each kind of wrong file: the expected lines, and no others."""
    faults = faults_of(wrong.tables())
    assert len(faults) == len(wrong.messages), faults
    for line in wrong.messages:
        assert any(fault.startswith(line) for fault in faults), (line, faults)
    assert not any("\n" in fault for fault in faults)


def test_empty_file_lists_missing_keys():
    """All required keys at once, not the first one only."""
    missing = {fault.split(": missing")[0] for fault in faults_of({})}
    keys = ("schema", "name", "type", "geometry", "platform", "actuators", "leg1", "leg2")
    assert missing == set(keys)


def test_unreadable_path_is_refused(tmp_path):
    """Missing file, misspelt robot, folder, other encoding, and a too long name."""
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'name = "Gr\xf6\xdfe"')
    robots = f"must be a robot file or a built-in robot ({', '.join(built_in_robots())})"
    for path, message in (
        (tmp_path / "none.toml", f"none.toml: no such file; {robots}"),
        ("IWF", f'IWF: no such file; {robots}; did you mean "ifw"?'),
        (tmp_path, f"{tmp_path}: is a folder; must be a robot file"),
        (latin, f"{latin}: byte 11 is not UTF-8; must be a TOML text in UTF-8"),
        (tmp_path / ("x" * 1000), "cannot be read"),
    ):
        with pytest.raises(InputError) as error:
            load_robot(path)
        (fault,) = error.value.faults
        assert message in fault


ROOT = Path(__file__).parents[3]
ROCKER = ROOT / "examples" / "rocker" / "robot.toml"
PATH = "from = [-0.20, 0.45]\nto = [0.20, 0.55]\ncount = 9"


def test_bodies_are_placed_by_points():
    """Arm, rod and platform of the built-in Delta, against coordinates by hand."""
    mechanism = load_robot("delta").mechanism
    arm, frame = mechanism.bodies["arm1"], mechanism.reference["arm1"]
    assert isinstance(arm.shape, ConstantLeg)
    assert arm.shape.length == pytest.approx(0.24, rel=1e-11)
    assert frame.position == pytest.approx([0.18, 0.0, 0.0])
    # The arm points 20° below the horizontal; its z axis points upwards.
    c, s = np.cos(np.radians(20.0)), np.sin(np.radians(20.0))
    axes = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    assert pytest.approx(axes, abs=1e-11) == frame.rotation.T
    rod = mechanism.reference["rod1l"].position - [0.0, 0.05, 0.0]
    assert (frame @ arm.interfaces["E1"]).position == pytest.approx(rod, abs=1e-11)
    platform = mechanism.bodies["platform"]
    assert isinstance(platform.shape, Rigid)
    assert (platform.shape.mass, platform.shape.inertia[2, 2]) == (0.6, 1.3e-3)
    # The mass centre is given in the body's frame, whose origin is the body's first point.
    at_tool = platform.interfaces["P"].position
    assert platform.shape.centre == pytest.approx(at_tool, abs=1e-15)
    assert np.linalg.norm(at_tool) > 0.01


def test_part_is_placed_by_its_axes(tmp_path):
    """The file's origin is at B, its x axis along base y, its y axis nearly along base −x."""
    text = ROCKER.read_text(encoding="utf-8")
    placement = 'place = { at = "B", x = [0.0, 2.0, 0.0], y = [-1.0, 0.1, 0.0] }\n'
    shutil.copy(ROCKER.with_name("rocker.step"), tmp_path)
    step = 'step = "rocker.step"\n'
    mechanism = robot_of(text.replace(step, step + placement), tmp_path).mechanism
    frame, body = mechanism.reference["rocker"], mechanism.bodies["rocker"]
    assert frame.position == pytest.approx([0.26, 0.0, 0.0])
    axes = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert pytest.approx(axes, abs=1e-15) == frame.rotation.T
    # Interface C in the axes of the file; its base coordinates are (0.09, 0.18).
    assert body.interfaces["C"].position == pytest.approx([0.18, 0.17, 0.0])


def test_digest_covers_included_files(tmp_path):
    """The SHA-256 of a robot changes with a file that its mesh file includes."""
    text = ROCKER.read_text(encoding="utf-8").replace('"rocker.step"', '"rocker.inp"')
    (tmp_path / "rocker.inp").write_text("*INCLUDE, INPUT=nodes.inp\n")
    digests = set()
    for coordinate in (0.1, 0.1, 0.2):
        (tmp_path / "nodes.inp").write_text(f"*NODE\n1, {coordinate}\n")
        digests.add(robot_of(text, tmp_path).sha256)
    assert len(digests) == 2


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({"faces": [3, 5], "coupling": "pin"}, PartInterface(ByFaces((3, 5)), "pin")),
        ({"name": "bore"}, PartInterface(ByName("bore"))),
        (
            {"cylinder": {"radius": 0.02, "axis": [0, 0, 1], "tolerance": 1e-3}},
            PartInterface(ByCylinder(0.02, (0.0, 0.0, 1.0), None, 1e-3)),
        ),
        (
            {"plane": {"normal": [1, 0, 0], "point": [0, 0, 2]}, "coupling": "average"},
            PartInterface(ByPlane((1.0, 0.0, 0.0), (0.0, 0.0, 2.0)), "average"),
        ),
    ],
)
def test_interface_faces_are_read(table, expected):
    """Faces by number, by name, as a cylinder or as a plane, with the kind of coupling."""
    assert interface_of(INTERFACE.read(table)) == expected


def test_path_poses_form_line_or_grid(tmp_path):
    """`from`, `to` and `count` give a line, `counts` a grid."""
    text = load_robot("five-bar").text.replace("[path]", "[accept]\nmodes = 2\n[path]")
    line = robot_of(text, tmp_path)
    assert line.requirement.modes == 2
    expected = np.array([[-0.2, 0.45], [0.0, 0.5], [0.2, 0.55]])
    assert line.mechanism.poses[[0, 4, 8]] == pytest.approx(expected)
    grid = text.replace(PATH, "from = [-0.1, 0.45]\nto = [0.1, 0.5]\ncounts = [3, 2]")
    poses = robot_of(grid, tmp_path).mechanism.poses
    expected = [[-0.1, 0.45], [-0.1, 0.5], [0.0, 0.45], [0.0, 0.5], [0.1, 0.45], [0.1, 0.5]]
    assert poses == pytest.approx(np.array(expected))


def test_two_points_give_slide_axis():
    """The axis of a hexapod's drive is the direction of its leg."""
    mechanism = load_robot("hexapod").mechanism
    drive = next(joint for joint in mechanism.joints if joint.name == "drive1")
    leg = mechanism.reference["strut1"].rotation[:, 0]
    assert drive.axes[0] == pytest.approx(-leg, abs=1e-10)
    assert drive.drive.stiffness == 6.0e7


def numbers(mechanism):
    """Return frames, beam constants, joint axes and compliances of a mechanism, keyed by name."""
    values = {"tool": [mechanism.tool.mass]}
    for name, body in mechanism.bodies.items():
        values[name] = mechanism.reference[name].rotation
        for point, interface in body.interfaces.items():
            values[name, point] = (mechanism.reference[name] @ interface).position
        if isinstance(body.shape, ConstantLeg):
            values[name, "beam"] = list(vars(body.shape.timoshenko).values())
    for joint in mechanism.joints:
        values[joint.name] = joint.axes
        key = (joint.name, joint.kind, joint.first, joint.second, joint.drive)
        values[key] = [] if joint.compliance is None else joint.compliance
    return values


def test_guide_biglide_is_built_in_biglide(tmp_path):
    """The robot file that the guide writes out body by body has all numbers of the built-in one."""
    guide = (ROOT / "docs" / "guide" / "mechanisms.md").read_text(encoding="utf-8")
    text = re.search(r"(?ms)^```toml written-out.toml\n(.*?)^```", guide)[1]
    robots = (robot_of(text, tmp_path), load_robot("biglide"))
    written_out, expected = (numbers(robot.mechanism) for robot in robots)
    assert set(written_out) == set(expected)
    for key, values in expected.items():
        # The guide gives the coordinates of points to twelve decimals.
        assert written_out[key] == pytest.approx(np.array(values), rel=1e-12, abs=1e-11), key


KINDS = {"object": dict, "array": list, "string": str, "number": int | float, "integer": int}
# Defaults of the JSON Schema keywords (draft 2020-12) that flexproof's schema uses.
NO_RULES = {"properties": {}, "required": (), "additionalProperties": True, "propertyNames": True}
NO_RULES |= {"type": "object", "pattern": "", "maxProperties": inf, "minItems": 0, "maxItems": inf}
NO_RULES |= {"minimum": -inf, "exclusiveMinimum": -inf, "maximum": inf, "exclusiveMaximum": inf}
SCHEMA = json_schema()


def valid(schema, value):
    """Return whether `value` satisfies the JSON schema, as draft 2020-12 defines it.

    Unlike the draft, a value that is not of the type a keyword applies to is never valid.
    """
    if isinstance(schema, bool):
        return schema
    rules = NO_RULES | schema
    if "if" in rules:
        return valid(rules["then" if valid(rules["if"], value) else "else"], value)
    for keyword, maximum in (("anyOf", inf), ("oneOf", 1)):
        if keyword in rules:
            return 1 <= sum(valid(branch, value) for branch in rules[keyword]) <= maximum
    if "enum" in rules or "const" in rules:
        allowed = rules.get("enum") or [rules["const"]]
        return any(type(entry) is type(value) and entry == value for entry in allowed)
    right_type = isinstance(value, KINDS[rules["type"]]) and not isinstance(value, bool)
    return right_type and fits(rules, value)


def fits(rules, value):
    if isinstance(value, str):
        return re.search(rules["pattern"], value) is not None
    if isinstance(value, list):
        has_length = rules["minItems"] <= len(value) <= rules["maxItems"]
        return has_length and all(valid(rules["items"], item) for item in value)
    if isinstance(value, dict):
        kinds = {
            name: rules["properties"].get(name, rules["additionalProperties"]) for name in value
        }
        complete = set(rules["required"]) <= kinds.keys() and len(value) <= rules["maxProperties"]
        has_names = complete and all(valid(rules["propertyNames"], name) for name in value)
        return has_names and all(valid(kinds[name], entry) for name, entry in value.items())
    within = rules["minimum"] <= value <= rules["maximum"]
    return within and rules["exclusiveMinimum"] < value < rules["exclusiveMaximum"]


def test_robot_files_satisfy_schema():
    """All built-in robots and examples are valid by the JSON schema."""
    files = [*ROOT.glob("lumped/robots/*.toml"), *ROOT.glob("examples/*/*.toml")]
    texts = [SOUND, *(path.read_text("utf-8") for path in files)]
    assert len(texts) > 8
    for tables in map(tomllib.loads, texts):
        assert valid(SCHEMA, tables), tables["name"]


@pytest.mark.parametrize("robot", ["five-bar", "biglide"])
def test_misspelt_keys_violate_schema(robot):
    """Each key with a letter more, or with null, is invalid, except names that the user chooses."""
    text = load_robot(robot).text
    key_paths = [
        key_path for key_path in places(tomllib.loads(text)) if isinstance(key_path[-1], str)
    ]
    for *tables, key in key_paths:
        misspelt, with_null = tomllib.loads(text), tomllib.loads(text)
        table = reduce(getitem, tables, misspelt)
        table[f"{key}z"] = table.pop(key)
        # Names of points, materials, bodies and joints are free: another name is valid, too.
        free = bool(tables) and tables[-1] in {"points", "materials", "bodies", "joints"}
        assert valid(SCHEMA, misspelt) == free, (tables, key)
        reduce(getitem, tables, with_null)[key] = None
        assert not valid(SCHEMA, with_null), (tables, key)


def test_wrong_values_violate_schema():
    """The schema finds most of the wrong files; the others break rules between several keys."""
    assert sum(not valid(SCHEMA, wrong.tables()) for wrong in invalid_files()) == 76


def test_guide_lists_all_keys():
    """The list of keys in the guide is the one that `docs/pictures/keys.py` writes."""
    script = runpy.run_path(str(ROOT / "docs" / "pictures" / "keys.py"))
    page = script["PAGE"].read_text("utf-8")
    assert script["renewed"](page) == page, "renew it: python docs/pictures/keys.py"


@pytest.mark.parametrize(
    ("robot", "keys"),
    [("biglide", ("leg1.section", "foot.compliance")), ("delta", ("bodies.NAME.up",))],
)
def test_template_is_a_valid_robot(robot, keys, tmp_path):
    """The file of `flexproof new` is that built-in robot, with comments on all keys."""
    path = tmp_path / "new.toml"
    write_template(path, robot)
    text = path.read_text("utf-8")
    assert tomllib.loads(text) == load_robot(robot).tables
    assert all(f"\n# {key}: " in text for key in keys)


def test_schema_command_prints_schema(capsys):
    """`flexproof schema` prints a JSON schema of draft 2020-12."""
    assert cli.main(["schema"]) == 0
    assert '"https://json-schema.org/draft/2020-12/schema"' in capsys.readouterr().out


@pytest.mark.parametrize("axes", ["[0.0, 0.0, 1.0]", "[[0.0, 0.0, 1.0]]"])
def test_key_axes_needs_universal_joint(axes):
    """Other joints have one direction, `axis`."""
    with pytest.raises(InputError, match=r"joints.pivot.axes .*one axis has axis = \[x, y, z\]"):
        described(PENDULUM.replace("axis = [0.0, 0.0, 1.0]", f"axes = {axes}"))


BLOCKS = """
schema = 2
name = "two blocks"
points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0] }
bodies.first = { points = ["A", "B"], mass = 7.0, centre = "A" }
bodies.second = { points = ["B"], mass = 2.0, centre = "B" }
tool = { body = "second", point = "B", moves = ["x"] }
[joints.a]
type = "prismatic"
between = ["ground", "first"]
at = "A"
axis = [1.0, 0.0, 0.0]
drive = { stiffness = 2.0e6 DRIVE }
[joints.b]
type = "fixed"
between = ["first", "second"]
at = "B"
compliance = GIVE
JOINT
"""
BLOCKS = BLOCKS.replace("GIVE", str((1e-7 * np.eye(6)).tolist()))
SHAKEN = """
[[responses]]
name = "r"
direction = [1.0, 0.0, 0.0]
from = 10.0
to = 50.0
"""


@pytest.mark.parametrize("where", ["JOINT", "DRIVE", "RATIO"])
def test_one_loss_factor_allows_responses(tmp_path, where):
    """Loss factor of a joint or drive, or a damping ratio, suffices; otherwise it is refused."""
    text = {"JOINT": "loss = 0.1", "DRIVE": ", loss = 0.1", "RATIO": ""}
    damped = BLOCKS + SHAKEN + ("[damping]\nratio = 0.01\n" if where == "RATIO" else "")
    for key in ("JOINT", "DRIVE"):
        damped = damped.replace(key, text[key] if key == where else "")
    (excitation,) = robot_of(damped, tmp_path).mechanism.excitations
    assert excitation.name == "r"
    with pytest.raises(InputError, match="nothing damps them"):
        robot_of(BLOCKS.replace("JOINT", "").replace("DRIVE", "") + SHAKEN, tmp_path)


def test_load_acts_on_tool_body_by_default(tmp_path):
    """A load at B, a point of two bodies, acts on the tool's body; at A, on the body that has A."""
    text = BLOCKS.replace("JOINT", "").replace("DRIVE", "")
    push = '[[loads]]\nname = "{}"\nwrench = [6.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n{}\n'
    for number, where in enumerate(["", 'at = "B"', 'at = "A"', 'at = "B"\nbody = "first"']):
        text += push.format(number, where)
    loads = robot_of(text, tmp_path).mechanism.loads
    assert [(load.body, load.point) for load in loads] == [
        ("second", "B"),
        ("second", "B"),
        ("first", "A"),
        ("first", "B"),
    ]


@pytest.mark.parametrize("key", ["speed", "acceleration"])
def test_tiny_acceleration_is_refused(key, tmp_path):
    """The square of 5e-324 is zero, so that the vector would have no direction."""
    load = f'[[loads]]\nname = "a"\n{key} = [5e-324, 0.0, 0.0]\n'
    with pytest.raises(InputError, match=f"{key} = .*: must be 0 or at least 1e-12 in size"):
        robot_of(f"{GANTRY}{load}", tmp_path)


@pytest.mark.parametrize("stiffness", ["1e-300", "1e-150", "5e-324"])
def test_tiny_drive_stiffness_is_refused(stiffness, tmp_path):
    """Below 1e-12 N/m the inverse overflows."""
    soft = GANTRY.replace(f"stiffness = {STIFFNESSES[0]}", f"stiffness = {stiffness}")
    with pytest.raises(InputError, match=r"drive\.stiffness = .*: must be at least 1e-12 N/m"):
        robot_of(soft, tmp_path)


def test_robot_file_is_parsed_once(tmp_path, monkeypatch):
    """Changed numbers need a new mechanism, but no new reading of the text."""
    calls = []
    (tmp_path / "robot.toml").write_text(
        f"{load_robot('five-bar').text}\n# a text of its own\n", encoding="utf-8"
    )
    parse, draft = reading.tomllib.loads, load.draft
    monkeypatch.setattr(
        reading.tomllib,
        "loads",
        lambda text, **kinds: calls.append("parse") or parse(text, **kinds),
    )
    monkeypatch.setattr(load, "draft", lambda tables: calls.append("draft") or draft(tables))
    robot = load_robot(tmp_path / "robot.toml")
    assert calls == ["parse", "draft"]
    assert robot.schema == 2
    assert robot.uncertain_inputs == {}
    heavier = robot.with_values({"tool.mass": 7.0})
    robot.with_factors({"tool.mass": 0.1})
    assert replace(robot, supposed=0.05).uncertain_inputs
    assert robot.printed_compliances == heavier.printed_compliances == ()
    assert calls == ["parse", *3 * ["draft"]]
    # Robots with other values share the parsed tables, which stay unchanged.
    assert heavier.tables is robot.tables
    assert robot.tables == parse(robot.text)
