"""Pictures of a mechanism's first modes and of its shape under loads, with scenes that move."""

from collections.abc import Sequence

import numpy as np

from lumped.arrays import Array
from lumped.models.bodies import legs_of
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.agreement.mode_pairing import neighbours
from validation.case import Skip
from validation.context import Context
from validation.drawing.opengl import require_vtk
from validation.drawing.prisms import readable_factor
from validation.drawing.rendering import (
    Scene,
    arrow,
    clear_corner,
    colour_bar,
    panel_pixels,
    picture_of,
    show,
    squares,
    triad,
)
from validation.drawing.scenes import interactive
from validation.drawing.style import MODELS, VERMILLION, canvas, csv_of, plot_style
from validation.drawing.view import fitted_view
from validation.exhibits import PATH, Drawing, Figure, InteractiveScene
from validation.models.mechanism_modes import PostureModes
from validation.report.figures.mechanism.bodies import (
    Moved,
    compared_points,
    elastic,
    outlines_of,
    rails,
    surroundings,
)
from validation.report.figures.mechanism.drawn_modes import finite_elements
from validation.report.figures.mechanism.drawn_modes import segments as segments_beside

GROUP = "pictures"
_MODES = 4
# Modes of the segments among which those of the beams are looked for.
_BESIDES = 4
FORCE = 1000.0  # N
_MICRO = 1e6
# Largest displacement in a picture, of the size of the mechanism (half its extent).
_DRAWN = 0.16
_HEIGHT, _SMALL_HEIGHT = 2.9, 2.5  # in, of a panel in two and in three columns
_ABOVE = (np.array([0.0, -0.3, 1.0]), np.array([0.0, 1.0, 0.0]))
_ASIDE = (np.array([0.45, -0.9, 0.45]), np.array([0.0, 0.0, 1.0]))
_SHAPES = "First mode shapes of the mechanism"
_LOADED = f"The mechanism under {FORCE:g} N along x, y and z"


def drawings() -> tuple[Drawing, ...]:
    """Mode shapes, and the mechanism under loads."""
    return (
        Drawing(
            "mechanism.mode-shapes",
            _SHAPES,
            mode_shapes,
            section=PATH,
            group=GROUP,
            effort=4.0,
        ),
        Drawing(
            "mechanism.deformed",
            _LOADED,
            deformed,
            section=PATH,
            group=GROUP,
            effort=3.0,
        ),
    )


def mode_shapes(context: Context) -> Figure:
    """A panel for each mode: beams coloured by displacement, places of the segments over them."""
    require_vtk()
    beam, segments = _drawn(context)
    frequencies = beam.modes.frequencies[:_MODES]
    rows = -(-len(frequencies) // 2)
    columns: dict[str, list[float | str]] = _places(beam.system)
    scenes = []
    with plot_style():
        picture, panels = canvas(rows, 2, rows * (_HEIGHT + 0.75))
        for axes in panels[len(frequencies) :]:
            axes.set_axis_off()
        for mode, (axes, frequency) in enumerate(zip(panels, frequencies, strict=False)):
            shape = beam.modes.shapes[:, mode]
            like = _like(beam, segments, mode)
            moved = elastic(beam.system, shape)
            largest = max(float(one.sizes.max()) for one in moved)
            factor = _DRAWN * beam.posture.mechanism.size / largest
            scene = _scene(beam.system, moved, shape, factor, largest, 1.0, (2, _HEIGHT))
            show(axes, scene)
            points, lumped = compared_points(segments.system, like)
            squares(axes, scene.view, points + factor * lumped, MODELS["segments"].colour)
            triad(axes, scene.view, place=clear_corner(scene))
            title = f"({'abcd'[mode]}) mode {mode + 1}: {frequency:.1f} Hz"
            axes.set_title(title)
            overlay = outlines_of(segments.system, factor * like)
            scenes.append(interactive(title, scene, [overlay]))
            colour_bar(picture, axes, (0.0, 1.0), "displacement, largest = 1")
            for name, (system, unknowns) in {
                "beam FE": (beam.system, shape),
                "segments": (segments.system, like),
            }.items():
                columns |= _columns(f"mode {mode + 1}, {name}", system, unknowns / largest)
        drawn = picture_of(picture)
    return _figure(
        "mechanism.mode-shapes",
        _SHAPES,
        f"{_drawn_by(beam)} in the middle of the path, coloured by displacement, thin lines: at "
        f"rest. Orange squares: the same mode {_beside(beam)}; orange outlines in three "
        "dimensions. Of modes of one frequency any mixture is one.",
        drawn.png,
        drawn.left_out,
        columns,
        scenes,
    )


def deformed(context: Context) -> Figure:
    """A panel for each force, each with its own scale."""
    require_vtk()
    beam, segments = _drawn(context)
    size = beam.posture.mechanism.size
    columns: dict[str, list[float | str]] = _places(beam.system)
    said, scenes = [], []
    with plot_style():
        picture, panels = canvas(1, 3, _SMALL_HEIGHT + 0.8)
        for place, (axes, name) in enumerate(zip(panels, "xyz", strict=True)):
            shape, lumped = (_under(one.system, place) for one in (beam, segments))
            moved = elastic(beam.system, shape)
            largest = max(float(one.sizes.max()) for one in moved)
            factor = readable_factor(largest, _DRAWN * size)
            tool, tip = _tool(beam.system), (beam.system.tool @ shape)[:3]
            direction = np.eye(3)[place]
            tail = tool + factor * tip + 0.1 * size * direction
            head = tail + 0.35 * size * direction
            scene = _scene(
                beam.system,
                moved,
                shape,
                factor,
                1.0 / _MICRO,
                largest * _MICRO,
                (3, _SMALL_HEIGHT),
                np.array([tail, head]),
            )
            show(axes, scene)
            triad(axes, scene.view, place=clear_corner(scene))
            arrow(axes, scene.view, tail, head, VERMILLION)
            title = f"({'abc'[place]}) {FORCE:g} N along {name}, drawn × {factor:g}"
            axes.set_title(title, fontsize=9.0)
            overlay = outlines_of(segments.system, factor * lumped)
            scenes.append(interactive(title, scene, [overlay], "push"))
            colour_bar(picture, axes, scene.limits, "displacement (µm)")
            columns |= _columns(f"force along {name} (µm)", beam.system, shape * _MICRO)
            said.append(f"{np.linalg.norm(tip) * _MICRO:.4g} µm under the force along {name}")
        drawn = picture_of(picture)
    return _figure(
        "mechanism.deformed",
        _LOADED,
        f"{_drawn_by(beam)} in the middle of the path, each picture with the enlargement named "
        f"above it. The loaded point moves {', '.join(said)}. Red arrow: the force; orange "
        f"outlines in three dimensions: the same {_beside(beam)}.",
        drawn.png,
        drawn.left_out,
        columns,
        scenes,
    )


def _drawn(context: Context) -> tuple[PostureModes, PostureModes]:
    """Finite elements, and the segments beside them."""
    mechanism = context.robot_file.mechanism
    if not (legs_of(mechanism) or mechanism.parts):
        raise Skip("all bodies are rigid: there are no shapes to be drawn")
    return finite_elements(context, _MODES), segments_beside(context, _MODES + _BESIDES)


def _drawn_by(drawn: PostureModes) -> str:
    mechanism = drawn.posture.mechanism
    if not mechanism.parts:
        return "Beam model"
    return "Parts as solids" + (" and other legs as beams" if legs_of(mechanism) else "")


def _beside(drawn: PostureModes) -> str:
    if not drawn.posture.mechanism.parts:
        return "of the segments"
    return "with parts condensed on their interfaces"


def _like(beam: PostureModes, segments: PostureModes, mode: int) -> Array:
    """Unknowns of the segments in the mixture of their modes that is most like the beam's mode.

    Of the modes close to its partner, so that sense and, of equal frequencies, mixture are its own.
    """
    wanted = compared_points(beam.system, beam.modes.shapes[:, mode])[1].ravel()
    nearest = int(np.argmin(np.abs(segments.modes.frequencies - beam.modes.frequencies[mode])))
    close = neighbours(segments.modes.frequencies, nearest)
    shapes = segments.modes.shapes[:, close]
    sampled = compared_points(segments.system, shapes)[1].reshape(len(wanted), -1)
    mixture = np.linalg.lstsq(sampled, wanted, rcond=None)[0]
    like: Array = shapes @ mixture
    return like


def _under(system: System, direction: int) -> Array:
    """Unknowns (n) under `FORCE` along an axis at the loaded point."""
    load = FORCE * system.tool[[direction]].T
    return solved(system).displacements(load)[:, 0]


def _scene(
    system: System,
    moved: Sequence[Moved],
    unknowns: Array,
    factor: float,
    unit: float,
    top: float,
    room: tuple[int, float],
    further: Array | None = None,
) -> Scene:
    """Legs and what is around them, colours from 0 to `top`; `further` points are kept inside."""
    around = surroundings(system, unknowns)
    bodies = [one.body(factor, unit) for one in (*around, *moved)]
    wires = [*rails(system), *(one.wire() for one in moved)]
    points = [body.surface.points for body in bodies] + [one.points for one in moved]
    points += [] if further is None else [further]
    toward, up = _direction(system, moved)
    view = fitted_view(np.vstack(points), toward, up, panel_pixels(*room), margin=0.07)
    return Scene(view, bodies, (0.0, top), tuple(wires))


def _direction(system: System, moved: Sequence[Moved]) -> tuple[Array, Array]:
    """From above for what stays in the plane of a flat mechanism, else from aside."""
    points = np.vstack([one.points for one in moved])
    flat = np.ptp(points[:, 2]) < 0.3 * system.posture.mechanism.size
    squares_of = np.square(np.vstack([one.displacements for one in moved])).sum(axis=0)
    return _ABOVE if flat and squares_of[2] < 0.5 * squares_of.sum() else _ASIDE


def _tool(system: System) -> Array:
    tool = system.posture.mechanism.tool
    frame = system.posture.frames[tool.body]
    return (frame @ system.posture.mechanism.bodies[tool.body].interfaces[tool.point]).position


def _places(system: System) -> dict[str, list[float | str]]:
    points, _ = compared_points(system, np.zeros(system.size))
    names = [*legs_of(system.posture.mechanism), *system.posture.mechanism.parts]
    each = len(points) // len(names)
    found: dict[str, list[float | str]] = {"body": [name for name in names for _ in range(each)]}
    return found | {f"{axis} (m)": points[:, i].tolist() for i, axis in enumerate("xyz")}


def _columns(what: str, system: System, unknowns: Array) -> dict[str, list[float | str]]:
    _, moved = compared_points(system, unknowns)
    return {f"{what}: along {axis}": moved[:, i].tolist() for i, axis in enumerate("xyz")}


def _figure(
    name: str,
    title: str,
    caption: str,
    png: bytes,
    left_out: str,
    columns: dict[str, list[float | str]],
    scenes: Sequence[InteractiveScene],
) -> Figure:
    return Figure(
        id=name,
        title=title,
        caption=caption,
        section=PATH,
        png=png,
        left_out=left_out,
        data=csv_of(columns),
        scenes=tuple(scenes),
    )
