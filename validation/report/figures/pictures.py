"""Pictures of a mechanism: the one beside its verdict, its first modes, and how it yields."""

from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.models.bodies import legs_of
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.adequacy.mechanism.path import path_postures
from validation.agreement.mode_pairing import one_frequency
from validation.case import Skip
from validation.context import Context
from validation.drawing.figures import FigureGroup
from validation.drawing.scene import Arrow, Marks, Scene, SceneGrid, readable_factor
from validation.drawing.style import LOOKS, VERMILLION, csv_of
from validation.drawing.text import number
from validation.exhibits import PATH, PORTRAIT
from validation.kinematics.picture import scene
from validation.kinematics.solids import tool_position
from validation.models.mechanism import PostureModes
from validation.report.figures.bodies import (
    compared_points,
    moved,
    outlines_of,
    rails,
)
from validation.report.figures.mode_names import IN_THE_PLANE, mode_names
from validation.report.figures.modes import finite_elements, segments

FORCE = 1000.0  # N
_MODES = 4
# Modes of the segments among which those of the beams are looked for.
_BESIDES = 4
# Relative width of the space of modes in which two discretisations of a robot may mix them.
_MIX = 0.02
_MICRO = 1e6
# Largest displacement in a picture, of the size of the mechanism (half its extent).
_DRAWN = 0.16
# in, of a panel in two and in three columns, and the width of a picture beside the errors.
_HEIGHT, _SMALL_HEIGHT, _HALF = 2.9, 2.5, 4.2
_ABOVE = (np.array([0.0, -0.3, 1.0]), np.array([0.0, 1.0, 0.0]))
_ASIDE = (np.array([0.35, -0.95, 0.5]), np.array([0.0, 0.0, 1.0]))
portraits = FigureGroup(PATH, "pictures")
figures = FigureGroup(PATH, "pictures")


@portraits.figure(PORTRAIT, "The mechanism")
def portrait(context: Context) -> SceneGrid:
    """The middle pose in full, the first and the last as lines."""
    postures = path_postures(context)
    shown = [postures[0], postures[len(postures) // 2], postures[-1]]
    return SceneGrid(
        "In the middle of its path; thin lines: first and last pose. Driven joints are orange, the "
        "loaded point red.",
        scenes=[scene(context.robot_file.mechanism, shown, named=False)],
        width=_HALF,
        turned=False,
    )


@figures.figure("mechanism.mode-shapes", "First mode shapes of the mechanism", effort=4.0)
def mode_shapes(context: Context) -> SceneGrid:
    """A panel for each mode: beams coloured by displacement, places of the segments over them."""
    beam, lumped = _both(context)
    count = min(_MODES, len(beam.modes.frequencies))
    names = mode_names(beam.system, beam.modes.shapes[:, :count])
    columns = _places(beam.system)
    scenes = []
    for mode, frequency in enumerate(beam.modes.frequencies[:count]):
        bent = _Bent(beam.system, beam.modes.shapes[:, mode], names.name(mode))
        like = _like(beam, lumped, mode)
        factor = _DRAWN * beam.posture.mechanism.size / bent.largest
        called = f", {bent.name}" if bent.name else ""
        points, displaced = compared_points(lumped.system, like)
        shown = replace(
            bent.scene(factor, bent.largest),
            title=f"({'abcd'[mode]}) mode {mode + 1}{called}: {frequency:.1f} Hz",
            bar="displacement, largest = 1",
            marks=[Marks(points + factor * displaced, "square", LOOKS["segments"].colour)],
            turned=[outlines_of(lumped.system, factor * like)],
        )
        scenes.append(shown)
        for name, system, unknowns in (
            ("beam FE", beam.system, bent.unknowns),
            ("segments", lumped.system, like),
        ):
            what = f"mode {mode + 1}, {name} (largest = 1)"
            columns |= _columns(what, system, unknowns / bent.largest)
    model, beside = _said(context)
    said = (
        f"{model}, coloured by displacement; thin lines: at rest. Orange squares, and outlines in "
        f"3-D: the same mode {beside}."
    )
    mixture = "Any mixture of modes of equal frequency is a mode, too."
    caption = " ".join((said, *map(names.said, range(count)), mixture))
    return SceneGrid(caption, scenes=scenes, columns=2, height=_HEIGHT, data=csv_of(columns))


@figures.figure(
    "mechanism.deformed", f"The mechanism under {FORCE:g} N along x, y and z", effort=3.0
)
def deformed(context: Context) -> SceneGrid:
    """A panel for each force along x, y and z at the loaded point, each with its own scale."""
    beam, lumped = _both(context)
    size = beam.posture.mechanism.size
    columns = _places(beam.system)
    scenes, moves = [], []
    for place, name in enumerate("xyz"):
        unknowns = _under(beam.system, place)
        called = mode_names(beam.system, unknowns[:, None]).name(0)
        bent = _Bent(beam.system, unknowns, called)
        factor = readable_factor(bent.largest, _DRAWN * size)
        tail = tool_position(beam.posture) + factor * bent.tip + 0.16 * size * np.eye(3)[place]
        head = tail + 0.4 * size * np.eye(3)[place]
        shown = bent.scene(factor, 1.0 / _MICRO)
        shown = replace(
            shown,
            title=f"({'abc'[place]}) {FORCE:g} N along {name}, drawn × {_grouped(factor)}",
            bar="displacement (µm)",
            arrows=[Arrow(tail, head, VERMILLION)],
            turned=[outlines_of(lumped.system, factor * _under(lumped.system, place))],
            motion="push",
            inside=[*shown.inside, np.array([tail, head])],
        )
        scenes.append(shown)
        far = np.linalg.norm(bent.tip) * _MICRO
        moves.append(f"{number(far, 4)} µm in all under the force along {name}")
        columns |= _columns(f"force along {name} (µm)", beam.system, bent.unknowns * _MICRO)
    model, beside = _said(context)
    caption = (
        f"{model}, displacements enlarged as the titles say. The loaded point moves "
        f"{', '.join(moves)}. Red arrow: the force; orange outlines in 3-D: the same {beside}."
    )
    return SceneGrid(caption, scenes=scenes, columns=3, height=_SMALL_HEIGHT, data=csv_of(columns))


def _both(context: Context) -> tuple[PostureModes, PostureModes]:
    """Finite elements, and the segments beside them."""
    mechanism = context.robot_file.mechanism
    if not (legs_of(mechanism) or mechanism.parts):
        raise Skip("all bodies are rigid: there are no shapes to be drawn")
    return finite_elements(context, _MODES), segments(context, _MODES + _BESIDES)


def _said(context: Context) -> tuple[str, str]:
    """What is drawn, and what it is compared with."""
    mechanism = context.robot_file.mechanism
    beams = " and other legs as beams" if legs_of(mechanism) else ""
    model = f"Parts as solids{beams}" if mechanism.parts else "Beam model"
    beside = "with parts condensed on their interfaces" if mechanism.parts else "by segments"
    return f"{model} in the middle of the path", beside


class _Bent:
    """A robot displaced by `unknowns` (n) of its system, in a way that has a `name`."""

    def __init__(self, system: System, unknowns: Array, name: str) -> None:
        self.system, self.unknowns, self.name = system, unknowns, name
        self.moved = moved(system, unknowns)
        self.deformed = [one for one in self.moved if one.deforms]
        self.largest = max(float(one.sizes.max()) for one in self.deformed)
        self.tip = (system.tool @ unknowns)[:3]

    def scene(self, factor: float, unit: float) -> Scene:
        """Drawn `factor` times displaced, coloured by displacements in `unit` (m).

        From above what stays in the plane of the mechanism, else from aside.
        """
        return Scene(
            [one.body(factor, unit) for one in self.moved],
            _ABOVE if self.name == IN_THE_PLANE else _ASIDE,
            [*rails(self.system), *(one.wire() for one in self.deformed)],
            limits=(0.0, self.largest / unit),
            inside=[one.solid.surface.points for one in self.deformed],
        )


def _like(beam: PostureModes, lumped: PostureModes, mode: int) -> Array:
    """Unknowns of the segments in the mixture of their modes that is most like the beam's mode.

    Of the modes close to its partner, so that sense and, of equal frequencies, mixture are its own.
    """
    wanted = compared_points(beam.system, beam.modes.shapes[:, mode])[1].ravel()
    nearest = int(np.argmin(np.abs(lumped.modes.frequencies - beam.modes.frequencies[mode])))
    spaces = one_frequency(lumped.modes.frequencies, np.full(len(lumped.modes.frequencies), _MIX))
    close = np.flatnonzero(spaces == spaces[nearest])
    shapes = lumped.modes.shapes[:, close]
    sampled = compared_points(lumped.system, shapes)[1].reshape(len(wanted), -1)
    mixture = np.linalg.lstsq(sampled, wanted, rcond=None)[0]
    like: Array = shapes @ mixture
    return like


def _under(system: System, direction: int) -> Array:
    """Unknowns (n) under `FORCE` along an axis at the loaded point."""
    load = FORCE * system.tool[[direction]].T
    return solved(system).displacements(load)[:, 0]


def _grouped(number: float) -> str:
    """A factor with its thousands set apart."""
    if number < 1.0:
        return f"{number:g}"
    return f"{number:,.0f}".replace(",", "\N{THIN SPACE}")


def _places(system: System) -> dict[str, list[float | str]]:
    points, _ = compared_points(system, np.zeros(system.size))
    names = [*legs_of(system.posture.mechanism), *system.posture.mechanism.parts]
    each = len(points) // len(names)
    found: dict[str, list[float | str]] = {"body": [name for name in names for _ in range(each)]}
    return found | {f"{axis} (m)": points[:, i].tolist() for i, axis in enumerate("xyz")}


def _columns(what: str, system: System, unknowns: Array) -> dict[str, list[float | str]]:
    _, moved = compared_points(system, unknowns)
    return {f"{what}: along {axis}": moved[:, i].tolist() for i, axis in enumerate("xyz")}
