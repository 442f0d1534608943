"""Loads whose wrenches over the path stand in a CSV file: as they are read, and every fault."""

import numpy as np
import pytest
from one_arm import ONE_ARM
from written_robot import robot_of

from lumped.errors import InputError

LINE = "from = [-0.1]\nto = [0.2]\ncount = 3"
LOAD = '[[loads]]\nname = "cutting"\nfile = "cutting.csv"\n'
ROBOT = f"{ONE_ARM}\n[path]\n{LINE}\n{LOAD}"
HEAD = "Fx,Fy,Fz,Mx,My,Mz"
ROWS = np.array([[10.0, 0, -5.0, 0, 0, 1.0], [20.0, 0, 0, 0, 0, 0], [0, 0, 0, 0.5, 0, 0]])
TEXTS = [",".join(map(str, row)) for row in ROWS]
SOUND = f"pose,{HEAD}\n1,{TEXTS[0]}\n2,{TEXTS[1]}\n3,{TEXTS[2]}\n"


def read(folder, csv, robot=ROBOT):
    (folder / "cutting.csv").write_text(csv, encoding="utf-8")
    return robot_of(robot, folder)


def test_rows_go_by_number_or_by_coordinates_in_any_order(tmp_path):
    by_number = read(tmp_path, SOUND)
    by_place = f"time,{HEAD},x\n0,{TEXTS[2]},0.2\n1,{TEXTS[1]},0.05\n2,{TEXTS[0]},-0.1\n"
    for robot in (by_number, read(tmp_path, by_place)):
        (load,) = robot.mechanism.loads
        np.testing.assert_array_equal(load.over_path, ROWS)
    # Another file is another robot.
    assert by_number.sha256 != robot.sha256


def test_a_pose_that_comes_again_has_one_wrench(tmp_path):
    there_and_back = ROBOT.replace(LINE, "poses = [[0.1], [0.1]]")
    rows = f"pose,{HEAD}\n1,{TEXTS[0]}\n2,"
    (load,) = read(tmp_path, f"{rows}{TEXTS[0]}\n", there_and_back).mechanism.loads
    np.testing.assert_array_equal(load.over_path, ROWS[[0, 0]])
    with pytest.raises(InputError, match=r"line 3: x = 0\.1 m: differs from the wrench of an"):
        read(tmp_path, f"{rows}{TEXTS[1]}\n", there_and_back)


@pytest.mark.parametrize(
    ("csv", "said"),
    [
        (SOUND.replace("Mz", "mz"), "lacks the column Mz"),
        (SOUND.replace("pose", "Pose"), "lacks the column pose (numbers of poses), or x"),
        (f"pose,{HEAD}\n", "holds no row"),
        (SOUND.replace("-5.0", "five"), 'line 2, column Fz = "five": must be a number'),
        (SOUND.replace("-5.0", "nan"), "line 2, column Fz = nan: not finite"),
        (SOUND.replace("0.5", "0,5"), "line 4: more cells than headings"),
        (SOUND.replace("3,", "4,"), "line 4, column pose = 4: must be at most 3"),
        (SOUND.replace("3,", "1.5,"), "line 4, column pose = 1.5: must be a whole number"),
        (SOUND.replace("3,", "2,"), "line 4: x = 0.05 m: differs from the wrench of"),
        (SOUND.rpartition("3,")[0], "no wrench for pose 3, x = 0.2 m"),
        (f"x,{HEAD}\n0.07,{TEXTS[0]}\n", "line 2: x = 0.07 m: must be a pose of the path"),
    ],
)
def test_every_fault_is_named_with_line_and_column(tmp_path, csv, said):
    with pytest.raises(InputError) as raised:
        read(tmp_path, csv)
    fault = raised.value.faults[0]
    assert "loads[1].file: " in fault
    assert "cutting.csv: " in fault
    assert said in fault, fault


def test_a_file_that_is_none_and_a_wrench_beside_it_are_refused(tmp_path):
    beside = f"{ROBOT.replace('cutting.csv', 'none.csv')}wrench = [1, 0, 0, 0, 0, 0]\n"
    with pytest.raises(InputError) as raised:
        robot_of(beside, tmp_path)
    without, missing = raised.value.faults
    assert "loads[1].wrench: must be left out beside a file" in without
    assert "none.csv: cannot be read" in missing
