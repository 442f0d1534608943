"""Pictures of the whole robot: its first two modes, and its shape under three loads."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.prisms import readable_factor
from validation.drawing.rendering import (
    Body,
    Scene,
    arrow,
    colour_bar,
    panel_pixels,
    picture_of,
    show,
    squares,
    triad,
    write,
)
from validation.drawing.scenes import Motion, interactive
from validation.drawing.style import MODELS, VERMILLION, canvas, csv_of, plot_style
from validation.drawing.view import View, fitted_view
from validation.exhibits import STROKE, Drawing, Figure, InteractiveScene
from validation.models.options import DEFAULT_OPTIONS
from validation.report.figures.curves.lines import as_in_paper
from validation.report.figures.pictures.element_columns import (
    load_columns,
    segments_like,
    sense,
    shape_columns,
)
from validation.report.figures.pictures.robot_shape import (
    LegShape,
    leg_shapes,
    load_displacement,
    segment_frames,
    slide_places,
    surroundings,
    top_of_joint,
)
from validation.studies.quantities import LOAD, MICRO, RobotModes, robot_modes

GROUP = "pictures"
_MODES_TITLE = f"First two mode shapes of the robot {as_in_paper(11)}"
# Largest displacement in a picture, as a share of the legs' mean length.
_DRAWN = 0.14
_MODES = 6
_HEIGHT, _SMALL_HEIGHT = 2.9, 2.5  # in, of a panel in two and in three columns
_ABOVE = (np.array([0.0, -0.3, 1.0]), np.array([0.0, 1.0, 0.0]))
_ASIDE = (np.array([0.25, -1.0, 0.5]), np.array([0.0, 0.0, 1.0]))


def drawings() -> tuple[Drawing, ...]:
    """Mode shapes, and the robot under loads."""
    return (
        Drawing(
            "robot.mode-shapes",
            _MODES_TITLE,
            mode_shapes,
            section=STROKE,
            group=GROUP,
            effort=3.0,
        ),
        Drawing(
            "robot.deformed",
            f"The robot under {LOAD:g} N along x, y and z",
            deformed_robot,
            section=STROKE,
            group=GROUP,
            effort=2.0,
        ),
    )


def mode_shapes(context: Context) -> Figure:
    """A panel for each mode: beams coloured by displacement, the segments' centres over them."""
    require_vtk()
    robot, x = context.robot, context.robot.centre
    beam, segments = (
        context.get(robot_modes, model, robot, x, _MODES) for model in ("beam", "segments")
    )
    columns: dict[str, Array] = {}
    said, scenes = [], []
    with plot_style():
        picture, panels = canvas(columns=2, height=_HEIGHT + 0.85)
        for mode, (axes, letter) in enumerate(zip(panels, "ab", strict=True)):
            shapes = _leg_shapes(robot, x, beam, mode)
            largest = max(float(shape.sizes.max()) for shape in shapes)
            factor = _DRAWN * _mean_length(robot) / largest
            along_z = float(beam.kinetic["z"][mode])
            moved = (beam.system.tool @ beam.modes.shapes[:, mode])[:3]
            direction = _ASIDE if along_z > 0.5 else _ABOVE
            bodies = surroundings(robot, x, factor * moved)
            bodies += [Body(shape.deformed(factor, largest)) for shape in shapes]
            scene = _scene(bodies, shapes, direction, panel_pixels(2, _HEIGHT), 1.0)
            show(axes, scene)
            points, lumped = segments_like(robot, x, segments, beam, mode)
            squares(axes, scene.view, points + factor * lumped, MODELS["segments"].colour)
            _annotate(axes, scene.view, robot, x, factor * moved)
            plane = "along z" if along_z > 0.5 else "in the plane"
            title = f"({letter}) mode {mode + 1}, {plane}: {beam.modes.frequencies[mode]:.1f} Hz"
            axes.set_title(title)
            displaced = (
                factor * sense(robot, x, segments, beam, mode) * (segments.modes.shapes[:, mode])
            )
            scenes.append(_scene_of(title, scene, robot, x, segments, displaced))
            colour_bar(picture, axes, (0.0, 1.0), "displacement, largest = 1")
            columns |= shape_columns(robot, x, beam, segments, mode, largest)
            said.append(
                f"Mode {mode + 1}: {100.0 * along_z:.0f} % of the kinetic energy of translation "
                f"is along z; {beam.modes.frequencies[mode]:.1f} Hz with beams, "
                f"{segments.modes.frequencies[mode]:.1f} Hz with segments."
            )
        drawn = picture_of(picture)
    return Figure(
        id="robot.mode-shapes",
        title=_MODES_TITLE,
        caption=" ".join(
            [
                f"Beam model at x = {x:.4g} m, legs drawn with their equivalent sections and "
                "coloured by displacement, thin lines: the robot at rest. Orange squares: the "
                "segments of the lumped model in the same mode; orange frames in three dimensions.",
                *said,
            ]
        ),
        section=STROKE,
        png=drawn.png,
        left_out=drawn.left_out,
        data=csv_of({heading: column.tolist() for heading, column in columns.items()}),
        scenes=tuple(scenes),
    )


def deformed_robot(context: Context) -> Figure:
    """A panel for each load, each with its own scale."""
    require_vtk()
    robot, x = context.robot, context.robot.centre
    beam = context.get(robot_modes, "beam", robot, x, _MODES, DEFAULT_OPTIONS)
    columns: dict[str, Array] = {}
    segments = context.get(robot_modes, "segments", robot, x, _MODES)
    said, scenes = [], []
    with plot_style():
        picture, panels = canvas(columns=3, height=_SMALL_HEIGHT + 0.8)
        for axes, letter, direction in zip(panels, "abc", np.eye(3), strict=True):
            name = "xyz"["abc".index(letter)]
            unknowns = load_displacement(beam.system, LOAD * direction)
            shapes = leg_shapes(robot, x, beam.system, beam.legs, unknowns)
            loaded = beam.system.tool @ unknowns
            largest = max(float(shape.sizes.max()) for shape in shapes)
            factor = readable_factor(largest, _DRAWN * _mean_length(robot))
            moved = factor * loaded[:3]
            bodies = surroundings(robot, x, moved)
            bodies += [Body(shape.deformed(factor, 1.0 / MICRO)) for shape in shapes]
            tail, head = _load_arrow(robot, x, moved, direction)
            scene = _scene(
                bodies,
                shapes,
                _ASIDE if name == "z" else _ABOVE,
                panel_pixels(3, _SMALL_HEIGHT),
                largest * MICRO,
                np.array([tail, head]),
            )
            show(axes, scene)
            _annotate(axes, scene.view, robot, x, moved)
            arrow(axes, scene.view, tail, head, VERMILLION)
            title = f"({letter}) {LOAD:g} N along {name}, drawn × {_grouped(factor)}"
            axes.set_title(title, fontsize=9.0)
            lumped = load_displacement(segments.system, LOAD * direction)
            scenes.append(_scene_of(title, scene, robot, x, segments, factor * lumped, "push"))
            colour_bar(picture, axes, scene.limits, "displacement (µm)")
            columns |= load_columns(robot, x, beam, unknowns, name)
            said.append(f"{np.linalg.norm(loaded[:3]) * MICRO:.1f} µm under the load along {name}")
        drawn = picture_of(picture)
    return Figure(
        id="robot.deformed",
        title=f"The robot under {LOAD:g} N along x, y and z",
        caption=(
            f"Beam model at x = {x:.4g} m, each picture with the enlargement named above it. The "
            f"loaded point moves {', '.join(said)}. The red arrow is the load; "
            "orange frames in three dimensions: the segments of the lumped model."
        ),
        section=STROKE,
        png=drawn.png,
        left_out=drawn.left_out,
        data=csv_of({heading: column.tolist() for heading, column in columns.items()}),
        scenes=tuple(scenes),
    )


def _scene_of(
    title: str,
    scene: Scene,
    robot: Biglide,
    x: float,
    segments: RobotModes,
    displaced: Array,
    motion: Motion = "swing",
) -> InteractiveScene:
    """The picture in three dimensions, the segments drawn over the beams."""
    overlay = segment_frames(
        robot, x, segments.system, segments.legs, displaced, DEFAULT_OPTIONS.elements
    )
    return interactive(title, scene, [overlay], motion)


def _leg_shapes(
    robot: Biglide, x: float, found: RobotModes, mode: int
) -> tuple[LegShape, LegShape]:
    return leg_shapes(robot, x, found.system, found.legs, found.modes.shapes[:, mode])


def _mean_length(robot: Biglide) -> float:
    return (robot.leg1.length + robot.leg2.length) / 2.0


def _scene(
    bodies: Sequence[Body],
    shapes: Sequence[LegShape],
    direction: tuple[Array, Array],
    size: tuple[int, int],
    top: float,
    further: Array | None = None,
) -> Scene:
    """Bodies and the edges of the robot at rest, colours from 0 to `top`.

    `further` points (n×3) are kept inside the picture too.
    """
    points = [body.surface.points for body in bodies] + [shape.points for shape in shapes]
    points += [] if further is None else [further]
    toward, up = direction
    view = fitted_view(np.vstack(points), toward, up, size, margin=0.09)
    return Scene(view, bodies, (0.0, top), tuple(shape.wire() for shape in shapes))


def _grouped(number: float) -> str:
    """A factor with its thousands set apart."""
    if number < 1.0:
        return f"{number:g}"
    return f"{number:,.0f}".replace(",", "\N{THIN SPACE}")


def _load_arrow(robot: Biglide, x: float, moved: Array, direction: Array) -> tuple[Array, Array]:
    """Tail and head (3, m) of a load that pushes the displaced joint at B."""
    point = robot.posture(x).tip + moved
    start = 0.1 * _mean_length(robot) * direction
    if direction[2]:
        start = start + np.array([0.0, 0.0, 0.2 * _mean_length(robot)])
    return point + start, point + start + 0.3 * _mean_length(robot) * direction


def _annotate(axes: Axes, view: View, robot: Biglide, x: float, moved: Array) -> None:
    """Names of the parts, and the directions of the axes; `moved` (3, m) is what B is drawn off."""
    posture = robot.posture(x)
    first, second = slide_places(robot, x)
    middle1, middle2 = ((posture.tip + root) / 2.0 for root in (posture.root1, posture.root2))
    for point, name, away in (
        (top_of_joint(robot, x) + moved, "B", (-16.0, 4.0)),
        (first, "slide A", (0.0, -12.0)),
        (second, "slide C", (0.0, -12.0)),
        (middle1, "leg 1", (-24.0, 10.0)),
        (middle2, "leg 2", (24.0, 10.0)),
    ):
        write(axes, view, point, name, away)
    triad(axes, view)
