"""Shapes of any robot: its first modes, and how it yields under loads, segments beside beams."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.models.bodies import legs_of
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.agreement.mode_pairing import neighbours
from validation.drawing.opengl import require_vtk
from validation.drawing.rendering import (
    Scene,
    arrow,
    canvas,
    colour_bar,
    picture_of,
    squares,
    staged,
)
from validation.drawing.scenes import interactive
from validation.drawing.style import LOOKS, VERMILLION, csv_of, plot_style
from validation.drawing.surfaces import readable_factor
from validation.report.figures.declared import Shown
from validation.report.figures.mechanism.bodies import (
    compared_points,
    elastic,
    outlines_of,
    rails,
    surroundings,
)
from validation.report.figures.mechanism.mode_names import IN_THE_PLANE, mode_names

FORCE = 1000.0  # N
_MICRO = 1e6
# Largest displacement in a picture, of the size of the mechanism (half its extent).
_DRAWN = 0.16
_HEIGHT, _SMALL_HEIGHT = 2.9, 2.5  # in, of a panel in two and in three columns
# Room (in) above the uppermost titles, which touch the edge of the picture without it.
_TITLE = 0.08
_ABOVE = (np.array([0.0, -0.3, 1.0]), np.array([0.0, 1.0, 0.0]))
_ASIDE = (np.array([0.35, -0.95, 0.5]), np.array([0.0, 0.0, 1.0]))


class Vibrating(Protocol):
    """An assembled robot with its lowest modes."""

    @property
    def system(self) -> System:
        """Its unknowns in one posture."""

    @property
    def modes(self) -> Modes:
        """The lowest of them."""


@dataclass(frozen=True, eq=False)
class Pair:
    """Two models of a robot, one drawn over the other: beams, say, beside segments.

    `said` is what the first one is and where it stands, `beside` what the other one is.
    """

    beam: Vibrating
    segments: Vibrating
    said: str
    beside: str


def modes_of(pair: Pair, count: int, *further: str) -> Shown:
    """A panel for each of the first modes of the beams, the same mode of the segments over it.

    `further` is said in the caption. Raises Skip where nothing can be drawn.
    """
    require_vtk()
    beam, segments = pair.beam, pair.segments
    names = mode_names(beam.system, beam.modes.shapes[:, :count])
    rows = -(-count // 2)
    columns = _places(beam.system)
    scenes = []
    with plot_style():
        picture, panels = canvas(rows, 2, rows * (_HEIGHT + 0.75) + _TITLE)
        for axes in panels[count:]:
            axes.set_axis_off()
        for mode, axes in enumerate(panels[:count]):
            bent = _Bent(beam.system, beam.modes.shapes[:, mode])
            like = _like(beam, segments, mode)
            factor = _DRAWN * beam.system.posture.mechanism.size / bent.largest
            scene = bent.shown(axes, factor, bent.largest, (2, _HEIGHT))
            points, lumped = compared_points(segments.system, like)
            squares(axes, scene.view, points + factor * lumped, LOOKS["segments"].colour)
            frequency = beam.modes.frequencies[mode]
            called = f", {bent.name}" if bent.name else ""
            title = f"({'abcd'[mode]}) mode {mode + 1}{called}: {frequency:.1f} Hz"
            axes.set_title(title)
            overlay = outlines_of(segments.system, factor * like)
            scenes.append(interactive(title, scene, [overlay]))
            colour_bar(picture, axes, scene.limits, "displacement, largest = 1")
            for name, (system, unknowns) in {
                "beam FE": (beam.system, bent.unknowns),
                "segments": (segments.system, like),
            }.items():
                what = f"mode {mode + 1}, {name} (largest = 1)"
                columns |= _columns(what, system, unknowns / bent.largest)
        drawn = picture_of(picture)
    said = (
        f"{pair.said}, coloured by displacement, thin lines: at rest. Orange squares: the same "
        f"mode {pair.beside}; orange outlines in three dimensions."
    )
    caption = " ".join((said, *map(names.said, range(count)), *further))
    return Shown(caption, picture=drawn, data=csv_of(columns), scenes=tuple(scenes))


def under_loads(pair: Pair) -> Shown:
    """A panel for each force along x, y and z at the loaded point, each with its own scale.

    Raises Skip where nothing can be drawn.
    """
    require_vtk()
    beam, segments = pair.beam, pair.segments
    size = beam.system.posture.mechanism.size
    columns = _places(beam.system)
    scenes, moved = [], []
    with plot_style():
        picture, panels = canvas(1, 3, _SMALL_HEIGHT + 0.8)
        for place, (axes, name) in enumerate(zip(panels, "xyz", strict=True)):
            bent = _Bent(beam.system, _under(beam.system, place))
            factor = readable_factor(bent.largest, _DRAWN * size)
            away = 0.16 * size * np.eye(3)[place]
            tail = _tool(beam.system) + factor * bent.tip + away
            head = tail + 0.4 * size * np.eye(3)[place]
            force = np.array([tail, head])
            scene = bent.shown(axes, factor, 1.0 / _MICRO, (3, _SMALL_HEIGHT), [force])
            arrow(axes, scene.view, tail, head, VERMILLION)
            title = f"({'abc'[place]}) {FORCE:g} N along {name}, drawn × {_grouped(factor)}"
            axes.set_title(title, fontsize=9.0)
            lumped = factor * _under(segments.system, place)
            overlay = outlines_of(segments.system, lumped)
            scenes.append(interactive(title, scene, [overlay], "push"))
            far = np.linalg.norm(bent.tip) * _MICRO
            moved.append(f"{far:.4g} µm under the force along {name}")
            colour_bar(picture, axes, scene.limits, "displacement (µm)")
            what = f"force along {name} (µm)"
            columns |= _columns(what, beam.system, bent.unknowns * _MICRO)
        drawn = picture_of(picture)
    caption = (
        f"{pair.said}, each picture with the enlargement named above it. The loaded point moves "
        f"{', '.join(moved)}. Red arrow: the force; orange outlines in three dimensions: the same "
        f"{pair.beside}."
    )
    return Shown(caption, picture=drawn, data=csv_of(columns), scenes=tuple(scenes))


class _Bent:
    """A robot displaced by `unknowns` (n) of its system."""

    def __init__(self, system: System, unknowns: Array) -> None:
        self.system, self.unknowns = system, unknowns
        self.name = mode_names(system, unknowns[:, None]).name(0)
        # From above what stays in the plane of the mechanism, else from aside.
        self.camera = _ABOVE if self.name == IN_THE_PLANE else _ASIDE
        self.moved = elastic(system, unknowns)
        self.largest = max(float(one.sizes.max()) for one in self.moved)
        self.tip = (system.tool @ unknowns)[:3]

    def shown(
        self,
        axes: Axes,
        factor: float,
        unit: float,
        room: tuple[int, float],
        further: Sequence[Array] = (),
    ) -> Scene:
        """Drawn on axes, `factor` times displaced, coloured by displacements in `unit` (m).

        `room`: columns of panels and their height (in); `further` points are kept inside.
        """
        displaced = factor * self.unknowns
        around = [one.body(1.0, 1.0) for one in surroundings(self.system, displaced)]
        bodies = [*around, *(one.body(factor, unit) for one in self.moved)]
        lines = (*rails(self.system), *(one.wire() for one in self.moved))
        limits = 0.0, self.largest / unit
        kept = [*(one.points for one in self.moved), *further]
        return staged(axes, bodies, lines, limits, self.camera, room, kept)


def _like(beam: Vibrating, segments: Vibrating, mode: int) -> Array:
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


def _tool(system: System) -> Array:
    tool = system.posture.mechanism.tool
    return interface_position(system.posture, Side(tool.body, tool.point))


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
