"""Measured values from robot files and CSV files, or every fault of theirs."""

import numpy as np
import pytest

from lumped.acceptance.measured import Measured, digest
from lumped.errors import InputError
from lumped.robot_file import load_robot
from lumped.robot_file.evidence import read_measured
from lumped.robot_file.load import with_measured

GOOD = """quantity,pose,value,uncertainty,source,load
x,0.4975,8.9e-6,1e-7,laser tracker,1000
f1,0.4975,113.2,0.5,hammer,
leg1.c22,,1.77e-7,2e-9,test stand,
"""


@pytest.fixture
def robot_file():
    return load_robot("ifw")


def written(tmp_path, text):
    path = tmp_path / "measured.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_csv_file_joins_the_robot_s_own_values(robot_file, tmp_path):
    found = with_measured(robot_file, written(tmp_path, GOOD)).measured
    assert found == (
        Measured("x", 8.9e-6, 1e-7, "laser tracker", (0.4975,), 1000.0),
        Measured("f1", 113.2, 0.5, "hammer", (0.4975,)),
        Measured("leg1.c22", 1.77e-7, 2e-9, "test stand"),
    )
    assert found[2].leg_entry == ("leg1", 1, 1)
    assert (found[1].mode, found[0].mode) == (1, None)
    assert digest(found) != digest(found[:2])


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("w,0.4975,1,1,s,", 'line 2.quantity = "w": must be one of'),
        ("leg3.c11,,1,1,s,", "line 2.quantity"),
        ("x,,1,1,s,", "line 2.pose: must hold as many numbers as the tool"),
        ("leg1.c11,0.3,1,1,s,", "line 2.pose: must be left out"),
        ("x,5.0,1,1,s,", "line 2.pose: IFW demonstrator: x = 5"),
        ("x,0.3,0,1,s,", "line 2.value = 0.0: must be above 0, a deflection along its load"),
        ("leg1.c26,,0,1,s,", "line 2.value = 0.0: must be a number other than 0"),
        ("x,0.3,one,1,s,", 'line 2.value = "one": must be a number'),
    ],
)
def test_every_fault_of_a_csv_file_is_named(robot_file, tmp_path, line, said):
    path = written(tmp_path, f"{GOOD.splitlines()[0]}\n{line}\n")
    with pytest.raises(InputError) as raised:
        with_measured(robot_file, path)
    assert any(said in fault and str(path) in fault for fault in raised.value.faults), raised.value


def test_a_file_that_is_no_table_of_measured_values_is_refused(tmp_path):
    for text, said in (("a,b\n1,2\n", "lacks the column"), (GOOD.splitlines()[0], "holds no")):
        with pytest.raises(InputError, match=said):
            read_measured(written(tmp_path, text))
    with pytest.raises(InputError, match="cannot be read"):
        read_measured(tmp_path / "none.csv")


OWN = """
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


def test_a_robot_file_carries_measured_values_and_what_its_inputs_are_worth(robot_file, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(robot_file.text + OWN, encoding="utf-8")
    own = load_robot(path)
    assert own.measured == (Measured("z", 27.0e-6, 0.3e-6, "dial gauge", (0.4975,), 1000.0),)
    ((key, _, below, above),) = own.with_inputs_off()
    assert key == "foot.compliance"
    given, less, more = (
        {joint.name: joint for joint in one.joints}["foot1"].compliance
        for one in (robot_file.mechanism, below, above)
    )
    assert np.allclose(less, 0.95 * given, rtol=1e-12, atol=0.0)
    assert np.allclose(more, 1.05 * given, rtol=1e-12, atol=0.0)


def test_units():
    units = {"z": "m", "f2": "Hz", "leg1.c33": "m/N", "rod1.c53": "1/N", "leg2.c44": "rad/(N m)"}
    assert {name: Measured(name, 1.0, 0.1, "gauge").unit for name in units} == units
