"""What a solve will cost is known before, and what costs too much is refused with the estimate."""

import sys
from pathlib import Path

import pytest
from toy_runs import ENVIRONMENT, on_terminal

from fem.bodies.solid import coupled_leg, solid_leg, solid_mesh
from fem.solvers.factor import analyse
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import write_template
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from validation import cli
from validation.solve.cost import solid_cost

ROOT = Path(__file__).parents[3]
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
SECTIONS = (
    *(Rectangle(0.1, 0.14), HollowRectangle(0.1, 0.14, 0.01), Tube(0.12, 0.01), Circle(0.1)),
    ISection(0.1, 0.14, 0.02, 0.02),
)


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.shape)
def test_the_estimate_of_a_solid_is_near_to_its_mesh_and_factor(section):
    leg = ConstantLeg(0.6, section, STEEL)
    solid = solid_leg(leg, solid_mesh(leg, 4))
    unknowns = solid.stiffness.shape[0]
    coupled = coupled_leg(solid)
    factor = analyse(coupled.stiffness)
    cost = solid_cost((leg,), 4, modes=0)
    # Nodes that blocks share count twice: in a circle's small blocks half of them.
    assert unknowns <= cost.unknowns < 1.7 * unknowns
    assert factor.peak_bytes < cost.memory
    # Assembly, which the factor's own count leaves out, comes to as much in a leg as small as this.
    assert cost.memory < 6.0 * factor.peak_bytes


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.toml"
    write_template(path)
    return path


@pytest.mark.parametrize(
    "arguments",
    [
        ("solid", "--divisions", "999999999999999", "--leg", "1"),
        ("beam", "--elements", "10000000"),
        ("beam", "--elements", "3000", "--leg", "1"),
    ],
)
def test_what_costs_too_much_is_refused_with_the_estimate(robot, arguments, capsys):
    assert cli.main(["solve", str(robot), "--model", *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "unknowns" in line
    assert "GB" in line
    assert "more than the" in line


def test_ctrl_c_ends_a_long_solve_at_once(robot):
    program = "import sys; from validation.cli import main; sys.exit(main())"
    arguments = [sys.executable, "-c", program, "solve", str(robot), "--model", "solid"]
    asked = [*arguments, "--divisions", "6"]
    # What is computed, and what it will take, is shown while one waits.
    code, screen = on_terminal(asked, ENVIRONMENT, pressed=lambda screen: "unknowns" in screen)
    assert code == 3
    assert "interrupted" in screen
    assert "Traceback" not in screen
