"""Robot files in millimetres: the same robots, messages in the file's unit, results in SI."""

import json
import tomllib
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of as written

from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture, shown_pose
from lumped.robot_file import load_robot, robot_of
from lumped.robot_file.evidence import read_measured, with_options
from lumped.robot_file.load import with_measured
from lumped.robot_file.places import unit_of
from lumped.robot_file.rules.published import json_schema, key_comments
from lumped.robot_file.variation import variations_of, varied
from lumped.robot_file.written import toml_of
from validation import cli

ROOT = Path(__file__).parents[3]
FILES = [
    path
    for path in sorted([*ROOT.glob("lumped/robots/*.toml"), *ROOT.glob("examples/*/*.toml")])
    if "units" not in tomllib.loads(path.read_text("utf-8"))
]


def sections_of(section):
    """Tables of a section that contain lengths, with the names of their keys."""
    yield section, {*section} - {"shape", "parts", "ply", "layers"}
    yield section.get("ply", {}), ("thickness",)
    for part in section.get("parts", []):
        yield part, ("at",)
        yield from sections_of(part["section"])


def in_millimetres(tables):
    """Return the tables of a robot file with all its lengths in mm, by the guide's list of keys."""
    new = deepcopy(tables) | {"units": "mm"}
    moves = new.get("tool", {}).get("moves", [])

    def scale(table, *keys):
        for key in keys:
            if key in table and not isinstance(table[key], str):
                table[key] = (1000.0 * np.array(table[key])).tolist()

    def pose(values):
        return [1000.0 * v if m in "xyz" else v for m, v in zip(moves, values, strict=True)]

    scale(new.get("points", {}), *new.get("points", {}))
    scale(new.get("geometry", {}), "a", "tool_offset")
    scale(new.get("accept", {}), "displacement")
    for body in (*new.get("bodies", {}).values(), new.get("leg1", {}), new.get("leg2", {})):
        scale(body, "length", "mass_centre", "centre")
        for section, keys in sections_of(body.get("section", {})):
            scale(section, *keys)
        for station in body.get("sections", []):
            scale(station, *{*station} - {"shape", "at"})
        scale(body.get("place", {}), "at")
        for interface in body.get("interfaces", {}).values():
            for how in ("cylinder", "plane"):
                scale(interface.get(how, {}), "radius", "point", "tolerance")
    path = new.get("path", {})
    for key in ("from", "to"):
        if key in path:
            path[key] = pose(path[key])
    if "poses" in path:
        path["poses"] = [pose(values) for values in path["poses"]]
    for entry in new.get("measured", []):
        if "pose" in entry:
            entry["pose"] = pose(entry["pose"]) if moves else [1000.0 * x for x in entry["pose"]]
    return new


FIVE_BAR = load_robot("five-bar").tables
MILLI = in_millimetres(FIVE_BAR)


def numbers(value):
    """Return all numbers and texts in a nested record, keyed by their path of names and indices."""
    if isinstance(value, dict):
        items = value.items()
    elif hasattr(value, "__dataclass_fields__"):
        items = ((name, getattr(value, name)) for name in value.__dataclass_fields__)
    elif isinstance(value, list | tuple):
        items = enumerate(value)
    elif isinstance(value, bool | str | Path) or value is None or callable(value):
        return {(): str(value)} if isinstance(value, str) else {}
    else:
        return {(i,): x for i, x in enumerate(np.ravel(value).tolist())}
    return {
        (str(name), *path): number
        for name, inner in items
        if name != "lengths"
        for path, number in numbers(inner).items()
    }


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_file_in_mm_gives_same_robot(path, monkeypatch):
    """Every number of the mechanism agrees to 1e-12, the rounding error of a few operations."""
    monkeypatch.chdir(path.parent)
    tables = tomllib.loads(path.read_text("utf-8"))
    metres, milli = robot_of(tables), robot_of(in_millimetres(tables))
    assert (metres.mechanism.lengths.name, milli.mechanism.lengths.name) == ("m", "mm")
    expected, converted = numbers(metres.mechanism), numbers(milli.mechanism)
    assert set(converted) == set(expected)
    assert len(expected) > 100
    for key, value in expected.items():
        if isinstance(value, str):
            assert converted[key] == value, key
        else:
            assert converted[key] == pytest.approx(value, rel=1e-12, abs=1e-15), key
    assert milli.requirement == metres.requirement


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("points.P[2]", 2e5, "points.P[2] = 200000.0: must be at most 100000 mm"),
        (
            "bodies.rod1.section.width",
            700.0,
            "bodies.rod1.section.width = 700.0: must be below the leg's length, 460.977 mm; "
            "is this in µm?",
        ),
        (
            "bodies.rod1.section.thickness",
            30.0,
            "bodies.rod1.section.thickness = 30.0: closes the hollow; must be below half the "
            "smaller side, 25 mm",
        ),
        ("path.to[1]", 2e5, "path.to[1] = 200000.0: must be at most 100000 mm or rad"),
        (
            "path.to",
            [500.0, 900.0],
            "path, pose 9, x = 500 mm, y = 900 mm: cannot be reached: ",
        ),
        ("materials.steel.E", 2.1e5, "materials.steel.E = 210000.0: must be at least 1e+06 Pa"),
        ("units", "inch", 'units = "inch": must be "m" or "mm"'),
    ],
)
def test_error_has_length_unit_of_file(key, value, message):
    """Ranges in messages are in mm for a file in mm."""
    with pytest.raises(InputError) as refused:
        robot_of(with_value(MILLI, key, value))
    assert any(fault.startswith(f"dictionary: {message}") for fault in refused.value.faults), (
        refused.value.faults
    )


def with_value(tables, key, value):
    tables = deepcopy(tables)
    names, _, index = key.rstrip("]").partition("[")
    *names_before, last = [*names.split("."), *([int(index) - 1] if index else [])]
    holder = tables
    for name in names_before:
        holder = holder[name]
    holder[last] = value
    return tables


def test_vary_uses_length_unit_of_file():
    """A width is varied to 25 in a file in mm and to 0.025 in a file in m."""
    milli, metres = robot_of(MILLI), robot_of(FIVE_BAR)
    key = "bodies.rod1.section.width"
    assert (unit_of(milli.tables, key), unit_of(metres.tables, key)) == ("mm", "m")
    assert unit_of(milli.tables, "path.from[1]") == "mm"
    assert unit_of(milli.tables, "materials.steel.E") == "Pa"
    for loaded, width in ((milli, "25"), (metres, "0.025")):
        ((_, robot),) = varied(loaded, variations_of(loaded, [f"{key}={width}:{width}:1"]))
        assert robot.mechanism.bodies["rod1"].shape.section.width == 0.025


def test_pose_in_file_unit_gives_si_results(tmp_path, capsys):
    """`--pose 50,500` of a file in mm equals 0.05,0.5 of the file in m; JSON is in SI units."""
    written(toml_of(MILLI), tmp_path)
    solve = ["solve", "--model", "links", "--json", "--pose"]
    cli.main([*solve, "50,500", str(tmp_path / "robot.toml")])
    (milli,) = json.loads(capsys.readouterr().out)["results"]
    cli.main([*solve, "0.05,0.5", "five-bar"])
    (metres,) = json.loads(capsys.readouterr().out)["results"]
    assert milli["pose"] == pytest.approx([0.05, 0.5], rel=1e-15)
    # Rounding errors of 1e-16 in the points, times the condition numbers of the loop equations and
    # of the stiffness matrix.
    scale = np.sqrt(np.outer(*2 * [np.diag(metres["compliance"])]))
    difference = np.subtract(milli["compliance"], metres["compliance"]) / scale
    assert np.abs(difference).max() < 1e-10
    mechanism = robot_of(MILLI).mechanism
    at_pose = posture(mechanism, np.array([0.05, 0.5]))
    assert shown_pose(mechanism, at_pose.pose) == "x = 50 mm, y = 500 mm"


def test_accuracy_limits_use_length_unit_of_file(tmp_path):
    """Limits on displacements and poses of measured values are in mm, measured values in m."""
    milli = robot_of(MILLI | {"accept": {"displacement": 0.02}})
    assert milli.requirement.displacement == 2e-5
    option = with_options(milli.requirement, ["displacement=0.03"], (), milli.mechanism.lengths)
    assert option.displacement == pytest.approx(3e-5, rel=1e-15)
    file = tmp_path / "measured.csv"
    file.write_text("quantity,pose,value,uncertainty,source\nx,50 500,1e-6,1e-8,gauge\n")
    (measured,) = with_measured(milli, file).measured
    assert measured.pose == (0.05, 0.5)
    assert measured.value == 1e-6
    with pytest.raises(InputError, match=r"pose\[2\] = 500: must be at most 100 m or rad"):
        read_measured(file)


def test_wrench_poses_use_length_unit(tmp_path, monkeypatch):
    """Coordinates of poses in a file of wrenches are in mm, forces in N."""
    monkeypatch.chdir(tmp_path)
    poses = {"poses": [[0.0, 500.0], [50.0, 500.0]]}
    rows = ["x,y,Fx,Fy,Fz,Mx,My,Mz", "0,500,1,0,0,0,0,0", "50,500,2,0,0,0,0,0"]
    (tmp_path / "forces.csv").write_text("\n".join(rows))
    loads = [{"name": "cut", "file": "forces.csv"}]
    (load,) = robot_of(MILLI | {"path": poses, "loads": loads}).mechanism.loads
    assert load.path_wrenches[:, 0].tolist() == [1.0, 2.0]
    (tmp_path / "forces.csv").write_text("\n".join(rows).replace("\n0,", "\n9,"))
    with pytest.raises(InputError, match="x = 9 mm, y = 500 mm: must be a pose of the path"):
        robot_of(MILLI | {"path": poses, "loads": loads})


def test_pose_angles_are_not_converted():
    """x and y of a pose are in mm, φz stays in rad."""
    robot = load_robot("3-rrr")
    assert robot.mechanism.tool.moves == ("x", "y", "phi_z")
    milli = robot_of(in_millimetres(robot.tables) | {"path": {"poses": [[10.0, 20.0, 0.1]]}})
    assert milli.mechanism.poses.tolist() == [[0.01, 0.02, 0.1]]
    with pytest.raises(InputError, match=r"x = 2000 mm, y = 0 mm, phi_z = 0\.1 rad: cannot"):
        posture(milli.mechanism, np.array([2.0, 0.0, 0.1]))


def test_key_list_uses_length_unit():
    """Ranges in the comments of `flexproof new` and in the schema follow `units`."""
    lines = key_comments(MILLI).split("\n")
    for line in (
        "# bodies.NAME.mass_centre: a number from -10000 to 10000 mm; ",
        "# joints.NAME.drive.stiffness: a number above 0 N/m or N m/rad and ",
    ):
        assert any(entry.startswith(line) for entry in lines), line
    schema = json_schema()
    for units, maximum in (("then", 100_000.0), ("else", 100.0)):
        points = schema[units]["else"]["properties"]["points"]
        coordinates, _ = points["additionalProperties"]["anyOf"]
        assert coordinates["items"]["maximum"] == maximum
