"""CSV files beside robot files: measured values and wrenches; and accuracy limits of models."""

import numpy as np
import pytest
from support.robots.robot_from_text import robot_of
from support.robots.single_arm import ONE_ARM

from lumped.acceptance.measured import Measured
from lumped.acceptance.quantities import measured_quantity
from lumped.acceptance.requirement import Requirement
from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.robot_file.evidence import read_measured, with_options
from lumped.robot_file.load import with_measured

HEAD = "quantity,pose,value,uncertainty,source,load\n"
ADDED_TABLES = """
[accept]
deflection = 0.02
z = 0.2
modes = 6
rely = ["vjm", "segments"]
[[measured]]
quantity = "z"
pose = [0.4975]
load = 1000.0
value = 27.0e-6
uncertainty = 0.3e-6
source = "dial gauge"
[[input_uncertainty]]
key = "foot.compliance"
relative = 0.05
"""


@pytest.fixture
def csv(tmp_path):
    """Function that writes a CSV file of measured values and returns its path."""

    def write(text):
        path = tmp_path / "measured.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_repeated_csv_column_is_refused(csv):
    path = csv("quantity,pose,value,value,uncertainty,source\nx,0.5,1e-6,2e-6,1e-7,gauge\n")
    with pytest.raises(InputError, match='has the column "value" twice; must have it once'):
        read_measured(path)


def test_measurements_are_read(tmp_path):
    """Tables [accept], rely, [[measured]] and [[input_uncertainty]] added to a robot file."""
    original = load_robot("ifw")
    robot = robot_of(original.text + ADDED_TABLES, tmp_path)
    requirement = robot.requirement
    limits = {quantity.name: requirement.limit(quantity) for quantity in requirement.quantities}
    assert [limits[name] for name in ("y", "z", "f6")] == [0.02, 0.2, 0.05]
    assert requirement.rely == ("vjm", "segments")
    assert robot.measured == (
        Measured(measured_quantity("z"), 27.0e-6, 0.3e-6, "dial gauge", (0.4975,), 1000.0),
    )
    assert robot.uncertain_inputs == {"foot.compliance": 0.05}
    changed = [robot.with_factors({"foot.compliance": relative}) for relative in (-0.05, 0.05)]
    foot, reduced, increased = (
        next(joint.compliance for joint in mechanism.joints if joint.name == "foot1")
        for mechanism in (original.mechanism, *changed)
    )
    np.testing.assert_allclose((reduced, increased), (0.95 * foot, 1.05 * foot), rtol=1e-12)


def test_accept_option_overrides_file():
    """`--accept` replaces single limits of [accept]; a group such as deflection sets several."""
    requirement = Requirement(rely=("beam",))
    quantities = ("x", "y", "z", "phi_x", "phi_y", "phi_z", "any_force", "f1", "f2", "f3", "f4")
    assert [quantity.name for quantity in requirement.quantities] == [*quantities, "order"]
    assert {requirement.limit(quantity) for quantity in requirement.quantities} == {0.05}
    typed = ("deflection=0.03", "frequency=0.1", "modes=2", "phi_x=0.5", "order=0.2")
    changed = with_options(requirement, typed, ("vjm", "segments"))
    limits = {quantity.name: changed.limit(quantity) for quantity in changed.quantities}
    assert [limits[name] for name in ("x", "phi_x", "f2", "order")] == [0.03, 0.5, 0.1, 0.2]
    assert (changed.modes, changed.rely) == (2, ("vjm", "segments"))
    assert with_options(requirement, (), ()).rely == ("beam",)


@pytest.mark.parametrize(
    "option", ["deflction=0.1", "x", "x=", "x=five", "x=5", "x=0", "x=nan", "modes=0", "modes=2.5"]
)
def test_invalid_accept_option_is_refused(option):
    """Unknown name, missing value or value out of range: one line for each fault."""
    with pytest.raises(InputError) as refused:
        with_options(Requirement(), (option, "y=1e9"), ("vjmm",))
    assert len(refused.value.faults) == 3
    assert any(option in fault for fault in refused.value.faults)


def test_csv_values_are_read(csv):
    """Deflection, frequency and compliance entry with pose, force, uncertainty, source and unit."""
    x = "x,0.4975,8.9e-6,1e-7,laser tracker,1000\n"
    rows = "f1,0.4975,113.2,0.5,hammer,\nleg1.c22,,1.77e-7,2e-9,test stand,\n"
    measured = with_measured(load_robot("ifw"), csv(HEAD + x + rows)).measured
    assert measured == (
        Measured(measured_quantity("x"), 8.9e-6, 1e-7, "laser tracker", (0.4975,), 1000.0),
        Measured(measured_quantity("f1"), 113.2, 0.5, "hammer", (0.4975,)),
        Measured(measured_quantity("leg1.c22"), 1.77e-7, 2e-9, "test stand"),
    )
    assert (measured[2].quantity.leg, measured[2].quantity.column) == ("leg1", 7)
    assert (measured[1].quantity.mode, measured[0].quantity.mode) == (1, None)
    units = {"z": "m", "f2": "Hz", "leg1.c33": "m/N", "rod1.c53": "1/N", "leg2.c44": "rad/(N m)"}
    assert {name: measured_quantity(name).unit for name in units} == units


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("w,0.4975,1,1,s,", 'line 2.quantity = "w": must be one of'),
        ("leg3.c11,,1,1,s,", "line 2.quantity"),
        ("x,,1,1,s,", "line 2.pose: must be as many numbers as the tool"),
        ("leg1.c11,0.3,1,1,s,", "line 2.pose: must be left out"),
        ("x,5.0,1,1,s,", "line 2.pose: IFW demonstrator: x = 5"),
        ("x,0.3,0,1,s,", "line 2.value = 0.0: must be above 0, a deflection along its load"),
        ("leg1.c26,,0,1,s,", "line 2.value = 0.0: must be at least 1e-30 in size"),
        # Squares and quotients of measured values are numbers.
        ("f1,0.3,1e151,1,s,", "line 2.value = 1e+151: must be at most 1e+15"),
        ("f1,0.3,1e-151,1,s,", "line 2.value = 1e-151: must be at least 1e-30 in size"),
        ("f1,0.3,80,1e-151,s,", "line 2.uncertainty = 1e-151: must be at least 1e-30"),
        ("f1,0.3,80,1e151,s,", "line 2.uncertainty = 1e+151: must be at most 1e+15"),
        ("x,0.3,1,1,s,1e-300", "line 2.load = 1e-300: must be at least 1e-12 N or N m"),
        ("x,0.3,one,1,s,", 'line 2.value = "one": must be a number'),
    ],
)
def test_csv_error_has_line_and_value(csv, line, message):
    """Each fault of a file of measured values names file, line and column."""
    path = csv(f"{HEAD}{line}\n")
    with pytest.raises(InputError) as raised:
        with_measured(load_robot("ifw"), path)
    assert any(message in fault and str(path) in fault for fault in raised.value.faults), (
        raised.value
    )


def test_csv_without_values_is_refused(csv, tmp_path):
    """Wrong columns, a heading alone, or no such file."""
    for text, message in (("a,b\n1,2\n", "lacks the column"), (HEAD, "contains no")):
        with pytest.raises(InputError, match=message):
            read_measured(csv(text))
    with pytest.raises(InputError, match="cannot be read"):
        read_measured(tmp_path / "none.csv")


LINE = "from = [-0.1]\nto = [0.2]\ncount = 3"
LOAD = '[[loads]]\nname = "cutting"\nfile = "cutting.csv"\n'
ROBOT = f"{ONE_ARM}\n[path]\n{LINE}\n{LOAD}"
AXES = "Fx,Fy,Fz,Mx,My,Mz"
ROWS = np.array([[10.0, 0, -5.0, 0, 0, 1.0], [20.0, 0, 0, 0, 0, 0], [0, 0, 0, 0.5, 0, 0]])
CELLS = [",".join(map(str, row)) for row in ROWS]
WRENCHES = f"pose,{AXES}\n1,{CELLS[0]}\n2,{CELLS[1]}\n3,{CELLS[2]}\n"


def read(folder, csv, robot=ROBOT):
    (folder / "cutting.csv").write_text(csv, encoding="utf-8")
    return robot_of(robot, folder)


def test_wrench_rows_match_pose_or_coordinates(tmp_path):
    """Rows are assigned by the number of the pose or by its coordinates, in any order."""
    by_number = read(tmp_path, WRENCHES)
    by_coordinate = f"time,{AXES},x\n0,{CELLS[2]},0.2\n1,{CELLS[1]},0.05\n2,{CELLS[0]},-0.1\n"
    for robot in (by_number, read(tmp_path, by_coordinate)):
        (load,) = robot.mechanism.loads
        np.testing.assert_array_equal(load.path_wrenches, ROWS)
    # The digest of a robot covers its CSV files.
    assert by_number.sha256 != robot.sha256


def test_wrenches_of_a_pose_must_be_equal(tmp_path):
    """A path that visits a pose twice needs equal wrenches for both visits."""
    repeated = ROBOT.replace(LINE, "poses = [[0.1], [0.1]]")
    rows = f"pose,{AXES}\n1,{CELLS[0]}\n2,"
    (load,) = read(tmp_path, f"{rows}{CELLS[0]}\n", repeated).mechanism.loads
    np.testing.assert_array_equal(load.path_wrenches, ROWS[[0, 0]])
    with pytest.raises(InputError, match=r"line 3: x = 0\.1 m: differs from the wrench of an"):
        read(tmp_path, f"{rows}{CELLS[1]}\n", repeated)


@pytest.mark.parametrize(
    ("csv", "message"),
    [
        (WRENCHES.replace("Mz", "mz"), "lacks the column Mz"),
        (WRENCHES.replace("pose", "Pose"), "lacks the column pose (numbers of poses), or x"),
        (f"pose,{AXES}\n", "contains no row"),
        (WRENCHES.replace("-5.0", "five"), 'line 2, column Fz = "five": must be a number'),
        (WRENCHES.replace("-5.0", "nan"), "line 2, column Fz = nan: not finite"),
        (WRENCHES.replace("0.5", "0,5"), "line 4: more cells than headings"),
        (WRENCHES.replace("3,", "4,"), "line 4, column pose = 4: must be at most 3"),
        (WRENCHES.replace("3,", "1.5,"), "line 4, column pose = 1.5: must be a whole number"),
        (WRENCHES.replace("3,", "2,"), "line 4: x = 0.05 m: differs from the wrench of"),
        (WRENCHES.rpartition("3,")[0], "no wrench for pose 3, x = 0.2 m"),
        (f"x,{AXES}\n0.07,{CELLS[0]}\n", "line 2: x = 0.07 m: must be a pose of the path"),
    ],
)
def test_wrench_error_has_line_and_column(tmp_path, csv, message):
    """Each fault names the key `loads[1].file`, the CSV file and the cell."""
    with pytest.raises(InputError) as raised:
        read(tmp_path, csv)
    fault = raised.value.faults[0]
    assert "loads[1].file: " in fault
    assert "cutting.csv: " in fault
    assert message in fault, fault


def test_missing_wrench_csv_is_refused(tmp_path):
    """A wrench beside the file is refused in a line of its own."""
    text = f"{ROBOT.replace('cutting.csv', 'none.csv')}wrench = [1, 0, 0, 0, 0, 0]\n"
    with pytest.raises(InputError) as raised:
        robot_of(text, tmp_path)
    without, missing = raised.value.faults
    assert "loads[1].wrench: must be left out, because a file" in without
    assert "none.csv: cannot be read" in missing
