"""Warnings on implausible robots. Ordinary ones have none."""

from pathlib import Path
from typing import get_args

import pytest
from support.robots.drawn_parts import lug, written
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import described, robot_of

from lumped.robot_file import load_robot
from lumped.robots import RobotType
from validation.models.plausibility import robot_findings

FOLDER = Path(__file__).resolve().parents[3] / "examples"
# Its CAD parts take half a minute.
CAD_LEGS = FOLDER / "tapered-biglide" / "robot.toml"
EXAMPLES = sorted({*FOLDER.glob("*/*.toml")} - {CAD_LEGS})
# Two leaves 60 mm long and 20 mm × 0.5 mm thick, in millimetres as if these were metres.
LEAVES = """
schema = 2
name = "leaf stage in mm"
[points]
A = [0.0, 0.0, 0.0]
B = [0.0, 60.0, 0.0]
C = [50.0, 0.0, 0.0]
D = [50.0, 60.0, 0.0]
P = [25.0, 60.0, 0.0]
[materials]
steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
[bodies.leaf1]
from = "A"
to = "B"
section = { shape = "rectangle", width = 0.5, height = 20.0 }
material = "steel"
[bodies.leaf2]
from = "C"
to = "D"
section = { shape = "rectangle", width = 0.5, height = 20.0 }
material = "steel"
[bodies.stage]
points = ["B", "D", "P"]
mass = 0.3
centre = "P"
inertia = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]
[joints]
c1 = { type = "fixed", between = ["ground", "leaf1"], at = "A" }
c2 = { type = "fixed", between = ["ground", "leaf2"], at = "C" }
c3 = { type = "fixed", between = ["leaf1", "stage"], at = "B" }
c4 = { type = "fixed", between = ["leaf2", "stage"], at = "D" }
[tool]
body = "stage"
point = "P"
moves = []
"""
# A crane of such size: box legs 2 m × 2 m of 40 mm plates, 60 m long, and a bridge of 50 t.
CRANE = LEAVES.replace(
    'shape = "rectangle", width = 0.5, height = 20.0',
    'shape = "hollow-rectangle", width = 2.0, height = 2.0, thickness = 0.04',
).replace("mass = 0.3", "mass = 5e4")
ARM = """
schema = 2
name = "arm"
points = {{ A = [0.0, 0.0, 0.0], B = [0.16, 0.0, 0.0] }}
[bodies.arm]
step = "lug.step"
material = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
place = {{ at = {at}, x = [1.0, 0.0, 0.0], y = {y} }}
[bodies.arm.interfaces]
A = {{ cylinder = {{ radius = 0.008 }} }}
B = {{ cylinder = {{ radius = 0.005 }} }}
[joints.motor]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = {{ stiffness = 1.0e4 }}
[tool]
body = "arm"
point = "B"
moves = ["y"]
"""
# A telescope along x: the rod begins {start} m behind the tube's root, whose length is 0.5 m.
TELESCOPE = """
schema = 2
name = "telescope"
[points]
A = [0.0, 0.0, 0.0]
B = [1.0, 0.0, 0.0]
C = [0.5, 0.0, 0.0]
D = [{start}, 0.0, 0.0]
[materials]
steel = {{ E = 2.1e11, nu = 0.3, rho = 7850.0 }}
[bodies.tube]
from = "A"
to = "C"
section = {{ shape = "tube", diameter = 0.06, thickness = 0.004 }}
material = "steel"
[bodies.rod]
from = "D"
to = "B"
section = {{ shape = "circle", diameter = 0.04 }}
material = "steel"
[joints]
root = {{ type = "fixed", between = ["ground", "tube"], at = "A" }}
[joints.slide]
type = "prismatic"
between = ["tube", "rod"]
at = ["C", "D"]
axis = [1.0, 0.0, 0.0]
drive = {{ stiffness = 1.0e7 }}
[tool]
body = "rod"
point = "B"
moves = ["x"]
"""


@pytest.mark.parametrize(
    "robot",
    ["ifw", *get_args(RobotType), *EXAMPLES, pytest.param(CAD_LEGS, marks=pytest.mark.soak)],
    ids=str,
)
def test_ordinary_robot_has_no_warning(robot):
    """Built-in robots, templates and examples."""
    assert robot_findings(load_robot(str(robot)).mechanism) == ()


def test_lengths_in_mm_have_warning():
    """A leaf stage of 60 m and 4710 t."""
    findings = robot_findings(described(LEAVES))
    assert [finding.where for finding in findings] == [
        "bodies.leaf1",
        "bodies.leaf2",
        "bodies.stage",
    ]
    # 60 m × 20 m × 0.5 m of steel are 4710 t.
    assert findings[0].numbers == pytest.approx({"span": 60.0, "mass": 4.71e6})
    assert all(
        "are lengths given in mm? Lengths must be in m" in finding.wrong for finding in findings
    )


def test_large_crane_has_no_warning():
    """Lengths of a large crane are plausible in m."""
    assert robot_findings(described(CRANE)) == ()


@pytest.mark.parametrize("gravity", [[0, 0, -9810.0], [0, 9810.0, 0], [0, -6937.0, -6937.0]])
def test_gravity_in_mm_has_warning(gravity):
    """9810 in any direction is plausible in mm/s² only."""
    load = f'[[loads]]\nname = "weight"\ngravity = {gravity}\n'
    (finding,) = robot_findings(described(PENDULUM + load))
    assert finding.where == "loads.weight.gravity"
    assert finding.numbers["gravity"] == pytest.approx(9810.0, rel=1e-3)


@pytest.mark.parametrize("gravity", [[0, 0, -9.81], [0, 6.94, -6.94], [0, 0, -1.62]])
def test_earth_and_moon_gravity_has_no_warning(gravity):
    """9.81 and 1.62 m/s², in any direction."""
    load = f'[[loads]]\nname = "weight"\ngravity = {gravity}\n'
    assert robot_findings(described(PENDULUM + load)) == ()


def test_bore_across_joint_axis_has_warning(tmp_path):
    """The bore of a lug at 90° to the axis of its hinge."""
    written(tmp_path / "lug.step", lug)
    along = ARM.format(at="[-0.02, 0.0, 0.0]", y="[0.0, 1.0, 0.0]")
    assert robot_findings(robot_of(along, tmp_path).mechanism) == ()
    across = ARM.format(at="[-0.02, 0.0, 0.0]", y="[0.0, 0.0, 1.0]")
    (finding,) = robot_findings(robot_of(across, tmp_path).mechanism)
    assert finding.where == "bodies.arm.interfaces.A"
    assert finding.numbers["angle"] == pytest.approx(90.0)


@pytest.mark.parametrize(("start", "gap"), [(0.2, None), (0.5, None), (0.7, 0.2)])
def test_gap_in_sliding_joint_has_warning(start, gap):
    """Bodies of a telescope that are 0.2 m apart."""
    findings = robot_findings(described(TELESCOPE.format(start=start)))
    assert [finding.numbers["gap"] for finding in findings] == pytest.approx(
        [] if gap is None else [gap]
    )
