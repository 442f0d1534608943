"""Pictures of the biglide: its portrait, its first two modes, and its shape under three loads."""

import numpy as np
from matplotlib.figure import Figure as Canvas

from lumped.legs import GivenLeg
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.prisms import Surface
from validation.drawing.rendering import Body, Wire, picture_of, staged, write
from validation.drawing.scenes import interactive
from validation.drawing.style import LOOKS, WIDTH, plot_style
from validation.exhibits import PORTRAIT, STROKE
from validation.models.biglide import robot_system
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.bodies import legs
from validation.report.figures.mechanism.shapes import FORCE, Pair, modes_of, under_loads
from validation.report.figures.pictures.stage import names, stage_of, top_of_joint
from validation.studies.quantities import RobotModes, robot_modes

# Of the beams, and of the segments among which those of the beams are looked for.
_MODES = 6
_SHOWN = 2
_TITLE = "The robot"
_HEIGHT = 3.3  # in
_CAMERA = np.array([0.35, -0.75, 0.9]), np.array([0.0, 0.3, 1.0])
_PATH = 41
portraits = FigureGroup(STROKE, "pictures")
figures = FigureGroup(STROKE, "pictures")


@portraits.figure(PORTRAIT, _TITLE)
def portrait(context: Context) -> Shown:
    """Legs with their sections (equivalent ones where a 6×6 is given), slides, path of B."""
    require_vtk()
    robot, x = context.robot, context.robot.centre
    system = robot_system("beam", robot, x)
    still = np.zeros(system.size)
    own = [Surface(one.points, one.faces) for one in legs(system, still)]
    around, _ = stage_of(robot, x).around(system, still)
    bodies = [*(Body(surface, LOOKS["vjm"].colour) for surface in own), *around]
    first, last = robot.stroke
    path = np.tile(top_of_joint(robot, x), (_PATH, 1))
    path[:, 0] += np.linspace(first, last, _PATH) - x
    pieces = np.column_stack([np.arange(_PATH - 1), np.arange(1, _PATH)])
    stroke = Wire(path, pieces, LOOKS["solid"].colour, 4.0)
    with plot_style():
        picture = Canvas(figsize=(WIDTH / 2.0, _HEIGHT), layout="constrained")
        axes = picture.subplots()
        scene = staged(axes, bodies, (stroke,), (0.0, 1.0), _CAMERA, (2, _HEIGHT), [path])
        for point, name, away in names(robot, x, np.zeros(3)):
            write(axes, scene.view, point, name, away)
        drawn = picture_of(picture)
    given = any(isinstance(leg, GivenLeg) for leg in (robot.leg1, robot.leg2))
    return Shown(
        f"At x = {x:.4g} m; the red line is the stroke of B, {first:.4g} to {last:.4g} m."
        + (" Legs known by a 6×6 are drawn with the section of their equivalent." * given),
        picture=drawn,
        scenes=(interactive(_TITLE, scene),),
    )


@figures.figure("robot.mode-shapes", "First two mode shapes of the robot", effort=3.0)
def mode_shapes(context: Context) -> Shown:
    """A panel for each mode: beams coloured by displacement, the segments' centres over them."""
    require_vtk()
    beam, segments = _modes(context)
    said = (
        f"Mode {mode + 1}: {beam.modes.frequencies[mode]:.1f} Hz with beams, "
        f"{segments.modes.frequencies[mode]:.1f} Hz with segments."
        for mode in range(_SHOWN)
    )
    return modes_of(_drawn(context), _SHOWN, *said)


@figures.figure("robot.deformed", f"The robot under {FORCE:g} N along x, y and z", effort=2.0)
def deformed_robot(context: Context) -> Shown:
    """A panel for each load, each with its own scale."""
    require_vtk()
    return under_loads(_drawn(context))


def _drawn(context: Context) -> Pair:
    x = context.robot.centre
    said = f"Beam model at x = {x:.4g} m, legs with their equivalent sections"
    return Pair(*_modes(context), said, "by segments", stage_of(context.robot, x))


def _modes(context: Context) -> tuple[RobotModes, RobotModes]:
    robot = context.robot
    beam, segments = (
        context.get(robot_modes, model, robot, robot.centre, _MODES)
        for model in ("beam", "segments")
    )
    return beam, segments
