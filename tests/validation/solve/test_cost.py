"""What a solve will cost is known before, and what costs too much is refused with the estimate."""

import os
import pty
import select
import sys
import time
from pathlib import Path

import pytest

from fem.bodies.solid import coupled_leg, solid_leg, solid_mesh
from fem.solvers.cholesky import analyse
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
    factor = analyse(coupled.stiffness, coupled.leading)
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
        ("solid", "--modes", "100000000000", "--leg", "2"),
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
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(ROOT)
        os.execve(  # noqa: S606
            arguments[0], [*arguments, "--divisions", "6"], os.environ | {"TERM": "xterm"}
        )
    screen = b""
    begun = time.monotonic()
    pressed = False
    while time.monotonic() - begun < 60.0:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                screen += os.read(terminal, 65536)
            except OSError:
                break
        # What is computed, and what it will take, is shown while one waits.
        if not pressed and b"unknowns" in screen:
            os.write(terminal, b"\x03")
            pressed = True
    os.close(terminal)
    _, status = os.waitpid(process, 0)
    assert pressed, screen.decode()
    assert os.waitstatus_to_exitcode(status) == 3
    assert b"interrupted" in screen
    assert b"Traceback" not in screen
