"""The robot at rest in the middle of its path: the picture of the first screen."""

import numpy as np
from matplotlib.figure import Figure as Canvas

from lumped.legs import GivenLeg
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.rendering import (
    Body,
    Scene,
    Wire,
    panel_pixels,
    picture_of,
    show,
    triad,
    write,
)
from validation.drawing.scenes import interactive
from validation.drawing.style import MODELS, WIDTH, plot_style
from validation.drawing.view import fitted_view
from validation.exhibits import PORTRAIT, STROKE, Drawing, Figure
from validation.report.figures.pictures.robot_shape import (
    legs_at_rest,
    slide_places,
    surroundings,
    top_of_joint,
)

_TITLE = "The robot"
_HEIGHT = 3.3  # in
_TOWARD, _UP = np.array([0.35, -0.75, 0.9]), np.array([0.0, 0.3, 1.0])
_PATH = 41


def drawings() -> tuple[Drawing, ...]:
    """The picture of the robot."""
    return (Drawing(PORTRAIT, _TITLE, portrait, section=STROKE, group="pictures", effort=1.0),)


def portrait(context: Context) -> Figure:
    """Legs with their sections (equivalent ones where a 6×6 is given), slides, path of B."""
    require_vtk()
    robot, x = context.robot, context.robot.centre
    legs = [Body(surface, MODELS["vjm"].colour) for surface in legs_at_rest(robot, x)]
    bodies = [*legs, *surroundings(robot, x, np.zeros(3))]
    posture = robot.posture(x)
    first, last = robot.stroke
    path = np.tile(top_of_joint(robot, x), (_PATH, 1))
    path[:, 0] += np.linspace(first, last, _PATH) - x
    stroke = Wire(
        path,
        np.column_stack([np.arange(_PATH - 1), np.arange(1, _PATH)]),
        MODELS["solid"].colour,
        4.0,
    )
    points = np.vstack([*(body.surface.points for body in bodies), path])
    view = fitted_view(points, _TOWARD, _UP, panel_pixels(2, _HEIGHT), margin=0.07)
    scene = Scene(view, bodies, (0.0, 1.0), (stroke,))
    with plot_style():
        picture = Canvas(figsize=(WIDTH / 2.0, _HEIGHT), layout="constrained")
        axes = picture.subplots()
        show(axes, scene)
        place1, place2 = slide_places(robot, x)
        for point, name, away in (
            (top_of_joint(robot, x), "B", (0.0, 13.0)),
            (place1, "slide A", (0.0, -12.0)),
            (place2, "slide C", (0.0, -12.0)),
            ((posture.tip + posture.root1) / 2.0, "leg 1", (-26.0, 8.0)),
            ((posture.tip + posture.root2) / 2.0, "leg 2", (26.0, 8.0)),
        ):
            write(axes, view, point, name, away)
        triad(axes, view, place=(0.06, 0.9))
        drawn = picture_of(picture)
    given = any(isinstance(leg, GivenLeg) for leg in (robot.leg1, robot.leg2))
    return Figure(
        id=PORTRAIT,
        title=_TITLE,
        caption=(
            f"At x = {x:.4g} m; the red line is the stroke of B, {first:.4g} to {last:.4g} m."
            + (" Legs known by a 6×6 are drawn with the section of their equivalent." * given)
        ),
        section=STROKE,
        png=drawn.png,
        left_out=drawn.left_out,
        scenes=(interactive(_TITLE, scene),),
    )
