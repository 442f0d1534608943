"""Crane of one tapered arm between two bores, a part drawn by gmsh, with a mass at its tip."""

import re
from pathlib import Path
from typing import Any

from support.robots.drawn_parts import meshed, written

ROBOT = """
schema = 2
name = "crane"

[points]
A = [0.0, 0.0, 0.0]
B = [0.4, 0.0, 0.0]

[bodies.arm]
step = "arm.step"
material = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
interfaces = { A = { cylinder = { radius = 0.016 } }, B = { cylinder = { radius = 0.010 } } }

[joints.A]
type = "revolute"
between = ["ground", "arm"]
at = "A"
axis = [0.0, 0.0, 1.0]
drive = { stiffness = 1.0e6 }

[tool]
body = "arm"
point = "B"
moves = ["phi_z"]
mass = 4.0

[path]
from = [0.0]
to = [0.3]
count = 2
"""


# A robot of one arm like the crane, whose bores reach into each other.
OVERLAPPING = (
    ROBOT.replace("A = [0.0, 0.0, 0.0]", "A = [0.0, 0.0, -0.002]")
    .replace("B = [0.4, 0.0, 0.0]", "B = [0.035, 0.0, 0.002]")
    .replace('step = "arm.step"', 'mesh = "block.msh"\nunit = "mm"')
    .replace("radius = 0.016", "radius = 0.030")
    .replace("to = [0.3]\ncount = 2", "to = [0.0]\ncount = 1")
)


def write_crane(folder: Path) -> Path:
    """Write robot.toml and arm.step, which tapers from 120 to 25 mm and is 40 mm high."""

    def draw(occ: Any) -> None:
        corners = [(-45, -60), (430, -12.5), (430, 12.5), (-45, 60)]
        points = [occ.addPoint(x, y, -20) for x, y in corners]
        lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        arm = next(tag for dim, tag in occ.extrude([(2, face)], 0, 0, 40) if dim == 3)
        bores = [(3, occ.addCylinder(x, 0, -40, 0, 0, 80, r)) for x, r in ((0, 16), (400, 10))]
        occ.cut([(3, arm)], bores)
        # The face that was extruded.
        occ.remove(occ.getEntities(2))

    written(folder / "arm.step", draw)
    # Without the moment of writing every process keeps the same part under the same key.
    text = (folder / "arm.step").read_text("utf-8")
    (folder / "arm.step").write_text(re.sub(r"'\d{4}-\d\d-\d\dT[\d:]+'", "''", text), "utf-8")
    (folder / "robot.toml").write_text(ROBOT, "utf-8")
    return folder / "robot.toml"


def write_meshed_crane(folder: Path) -> Path:
    """Write the crane with arm.msh, a mesh of some thousand unknowns, instead of arm.step."""
    robot, step = write_crane(folder), folder / "arm.step"
    meshed(folder / "arm.msh", lambda kernel: kernel.importShapes(str(step)), 30.0, 12.0)
    step.unlink()
    robot.write_text(ROBOT.replace('step = "arm.step"', 'mesh = "arm.msh"\nunit = "mm"'), "utf-8")
    return robot


def write_overlapping_crane(folder: Path) -> None:
    """Write block.msh and robot.toml, with a wide blind bore from below around one from above.

    No material of the arm lies between its interfaces.
    """

    def draw(occ: Any) -> None:
        below, above = (0, 0, -50, 0, 0, 40, 30), (35, 0, 10, 0, 0, 40, 10)
        bores = [(3, occ.addCylinder(*cylinder)) for cylinder in (below, above)]
        occ.cut([(3, occ.addBox(-60, -60, -50, 140, 120, 100))], bores)

    meshed(folder / "block.msh", draw, 30.0, 12.0)
    (folder / "robot.toml").write_text(OVERLAPPING, "utf-8")
