"""Pictures of a mechanism: at rest, its first mode shapes, and under unit forces.

Input: the context of a run. Output: scenes with caption and data. The shapes by beams (CAD parts as
solids) are drawn, and over them those by segments.
"""

from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.models.bodies import legs_of
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.case import Skip
from validation.context import Context
from validation.drawing.figures import FigureGroup
from validation.drawing.scene import Arrow, Marks, Scene, SceneGrid, readable_factor
from validation.drawing.style import LOOKS, VERMILLION, csv_of
from validation.drawing.text import number
from validation.kinematics.picture import scene
from validation.kinematics.solids import tool_position
from validation.models.robot_models import PostureModes
from validation.references.robot_on_path import path_postures
from validation.report.figures.bodies import (
    compared_points,
    displaced_solids,
    leg_outlines,
    rails,
)
from validation.report.figures.mode_names import IN_THE_PLANE, mode_names
from validation.report.figures.modes import finite_elements, segments
from validation.responses.mode_pairing import equal_frequency_groups
from validation.studies_and_figures import PATH, PORTRAIT

FORCE = 1000.0  # N
_MODES = 4
# Additional modes of the segments, among which partners of the beams' modes are searched.
_EXTRA_MODES = 4
# Relative frequency range within which two discretisations can mix modes.
_MIX = 0.02
_MICRO = 1e6
# Ratio of the largest drawn displacement to the size of the mechanism (half its extent).
_DRAWN_DISPLACEMENT = 0.16
# Inches: height of a panel in two columns, and in three; width of the picture beside the errors.
_HEIGHT, _SMALL_HEIGHT, _HALF = 2.9, 2.5, 4.2
_VIEW_FROM_ABOVE = (np.array([0.0, -0.3, 1.0]), np.array([0.0, 1.0, 0.0]))
_VIEW_FROM_SIDE = (np.array([0.35, -0.95, 0.5]), np.array([0.0, 0.0, 1.0]))
portraits = FigureGroup(PATH, "pictures")
figures = FigureGroup(PATH, "pictures")


@portraits.figure(PORTRAIT, "The mechanism")
def portrait(context: Context) -> SceneGrid:
    """Scene with the robot in the middle pose as surfaces, in the first and last pose as lines."""
    postures = path_postures(context)
    drawn_postures = [postures[0], postures[len(postures) // 2], postures[-1]]
    return SceneGrid(
        "The robot at the middle pose of its path; thin lines: first and last pose. "
        "Orange: driven joints. Red: the loaded point of the tool, where forces act and "
        "displacements are compared.",
        scenes=[scene(context.robot_file.mechanism, drawn_postures, named=False)],
        width=_HALF,
        turned=False,
    )


@figures.figure("mechanism.mode-shapes", "First mode shapes of the mechanism", effort=4.0)
def mode_shapes(context: Context) -> SceneGrid:
    """Scenes of the first modes: beams coloured by displacement, with points of the segments."""
    beam, lumped = _compared_modes(context)
    count = min(_MODES, len(beam.modes.frequencies))
    names = mode_names(beam.system, beam.modes.shapes[:, :count])
    columns = _point_columns(beam.system)
    scenes = []
    for mode, frequency in enumerate(beam.modes.frequencies[:count]):
        shape = _DisplacedRobot(beam.system, beam.modes.shapes[:, mode], names.name(mode))
        partner = _matching_shape(beam, lumped, mode)
        factor = _DRAWN_DISPLACEMENT * beam.posture.mechanism.size / shape.largest
        suffix = f", {shape.name}" if shape.name else ""
        points, displaced = compared_points(lumped.system, partner)
        panel = replace(
            shape.scene(factor, shape.largest),
            title=f"({'abcd'[mode]}) mode {mode + 1}{suffix}: {frequency:.1f} Hz",
            bar="displacement, largest = 1",
            marks=[Marks(points + factor * displaced, "square", LOOKS["segments"].colour)],
            turned=[leg_outlines(lumped.system, factor * partner)],
        )
        scenes.append(panel)
        for name, system, unknowns in (
            ("beam FE", beam.system, shape.unknowns),
            ("segments", lumped.system, partner),
        ):
            heading = f"mode {mode + 1}, {name} (largest = 1)"
            columns |= _motion_columns(heading, system, unknowns / shape.largest)
    model, comparison = _model_texts(context)
    description = (
        f"{model}; colour: displacement relative to the largest one of the mode; thin "
        "lines: robot at rest. Orange squares (in 3-D: orange outlines): the same mode "
        f"{comparison}; the models agree where the squares lie on the coloured bodies."
    )
    mixture = "For modes of equal frequency, every linear combination is a mode, too."
    caption = " ".join((description, *map(names.sentence, range(count)), mixture))
    return SceneGrid(caption, scenes=scenes, columns=2, height=_HEIGHT, data=csv_of(columns))


@figures.figure(
    "mechanism.deformed", f"The mechanism under {FORCE:g} N along x, y and z", effort=3.0
)
def deformed(context: Context) -> SceneGrid:
    """Scenes under a force along x, y and z at the loaded point, each with its own scale."""
    beam, lumped = _compared_modes(context)
    size = beam.posture.mechanism.size
    columns = _point_columns(beam.system)
    scenes, motions = [], []
    for axis, name in enumerate("xyz"):
        unknowns = _force_unknowns(beam.system, axis)
        mode_name = mode_names(beam.system, unknowns[:, None]).name(0)
        shape = _DisplacedRobot(beam.system, unknowns, mode_name)
        factor = readable_factor(shape.largest, _DRAWN_DISPLACEMENT * size)
        tail = tool_position(beam.posture) + factor * shape.tip + 0.16 * size * np.eye(3)[axis]
        head = tail + 0.4 * size * np.eye(3)[axis]
        panel = shape.scene(factor, 1.0 / _MICRO)
        panel = replace(
            panel,
            title=f"({'abc'[axis]}) {FORCE:g} N along {name}, drawn × {_grouped(factor)}",
            bar="displacement (µm)",
            arrows=[Arrow(tail, head, VERMILLION)],
            turned=[leg_outlines(lumped.system, factor * _force_unknowns(lumped.system, axis))],
            motion="push",
            inside=[*panel.inside, np.array([tail, head])],
        )
        scenes.append(panel)
        distance = np.linalg.norm(shape.tip) * _MICRO
        motions.append(f"{number(distance, 4)} µm under the force along {name}")
        columns |= _motion_columns(f"force along {name} (µm)", beam.system, shape.unknowns * _MICRO)
    model, comparison = _model_texts(context)
    caption = (
        f"{model}; one panel for each force at the loaded point (red arrow). Colour: "
        "displacement in µm, drawn enlarged by the factor in the title. The loaded point "
        f"moves {', '.join(motions)}. Orange outlines in 3-D: displacement under the same "
        f"load {comparison}; the models agree where the outlines follow the coloured bodies."
    )
    return SceneGrid(caption, scenes=scenes, columns=3, height=_SMALL_HEIGHT, data=csv_of(columns))


def _compared_modes(context: Context) -> tuple[PostureModes, PostureModes]:
    """Modes by finite elements and by segments, in the middle of the path."""
    mechanism = context.robot_file.mechanism
    if not (legs_of(mechanism) or mechanism.parts):
        raise Skip("every body is rigid, so that no deformed shape exists")
    return finite_elements(context, _MODES), segments(context, _MODES + _EXTRA_MODES)


def _model_texts(context: Context) -> tuple[str, str]:
    """Texts for the caption: the drawn model with its pose, and the model drawn over it."""
    mechanism = context.robot_file.mechanism
    beams = " and other legs as beams" if legs_of(mechanism) else ""
    model = f"Parts as solids{beams}" if mechanism.parts else "Beam model"
    comparison = (
        "with parts condensed on their interfaces"
        if mechanism.parts
        else "by the model of rigid segments with springs"
    )
    return f"{model} at the middle pose of the path", comparison


class _DisplacedRobot:
    """Robot displaced by `unknowns` (n) of its system. `name`: name of the mode or load."""

    def __init__(self, system: System, unknowns: Array, name: str) -> None:
        self.system, self.unknowns, self.name = system, unknowns, name
        self.moved = displaced_solids(system, unknowns)
        self.deformed = [solid for solid in self.moved if solid.deforms]
        self.largest = max(float(solid.sizes.max()) for solid in self.deformed)
        self.tip = (system.tool @ unknowns)[:3]

    def scene(self, factor: float, unit: float) -> Scene:
        """Scene with displacements enlarged by `factor`.

        Bodies are coloured by displacement, as a multiple of `unit` (m). Motion in the plane of the
        mechanism is seen from above, any other motion from the side.
        """
        return Scene(
            [solid.body(factor, unit) for solid in self.moved],
            _VIEW_FROM_ABOVE if self.name == IN_THE_PLANE else _VIEW_FROM_SIDE,
            [*rails(self.system), *(solid.wire() for solid in self.deformed)],
            limits=(0.0, self.largest / unit),
            inside=[solid.solid.surface.points for solid in self.deformed],
        )


def _matching_shape(beam: PostureModes, lumped: PostureModes, mode: int) -> Array:
    """Combination of modes of the segments (`lumped`) closest in shape to a `mode` of the beams.

    The result has the unknowns (n) of the segments. Only modes close to each other in frequency are
    combined. The least-squares fit also selects the sign of the shape, and the combination of modes
    with equal frequency.
    """
    beam_samples = compared_points(beam.system, beam.modes.shapes[:, mode])[1].ravel()
    nearest = int(np.argmin(np.abs(lumped.modes.frequencies - beam.modes.frequencies[mode])))
    spaces = equal_frequency_groups(
        lumped.modes.frequencies, np.full(len(lumped.modes.frequencies), _MIX)
    )
    close = np.flatnonzero(spaces == spaces[nearest])
    shapes = lumped.modes.shapes[:, close]
    sampled = compared_points(lumped.system, shapes)[1].reshape(len(beam_samples), -1)
    mixture = np.linalg.lstsq(sampled, beam_samples, rcond=None)[0]
    partner: Array = shapes @ mixture
    return partner


def _force_unknowns(system: System, direction: int) -> Array:
    """Unknowns (n) of a system under `FORCE` at the loaded point along base axis `direction`."""
    load = FORCE * system.tool[[direction]].T
    return solved(system).displacements(load)[:, 0]


def _grouped(number: float) -> str:
    """Number as text, with a thin space before each group of three digits."""
    if number < 1.0:
        return f"{number:g}"
    return f"{number:,.0f}".replace(",", "\N{THIN SPACE}")


def _point_columns(system: System) -> dict[str, list[float | str]]:
    points, _ = compared_points(system, np.zeros(system.size))
    names = [*legs_of(system.posture.mechanism), *system.posture.mechanism.parts]
    count = len(points) // len(names)
    bodies: dict[str, list[float | str]] = {"body": [name for name in names for _ in range(count)]}
    return bodies | {f"{axis} (m)": points[:, i].tolist() for i, axis in enumerate("xyz")}


def _motion_columns(heading: str, system: System, unknowns: Array) -> dict[str, list[float | str]]:
    _, motions = compared_points(system, unknowns)
    return {f"{heading}: along {axis}": motions[:, i].tolist() for i, axis in enumerate("xyz")}
