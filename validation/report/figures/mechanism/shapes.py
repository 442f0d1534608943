"""Shapes of any robot: its first modes, and how it yields under loads, segments beside beams."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Side
from lumped.models.bodies import legs_of
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.agreement.mode_pairing import neighbours
from validation.drawing.scene import Arrow, Marks, Scene, readable_factor
from validation.drawing.style import LOOKS, VERMILLION, csv_of
from validation.report.figures.declared import Shown
from validation.report.figures.mechanism.bodies import (
    compared_points,
    moved,
    outlines_of,
    rails,
)
from validation.report.figures.mechanism.mode_names import IN_THE_PLANE, mode_names

FORCE = 1000.0  # N
_MICRO = 1e6
# Largest displacement in a picture, of the size of the mechanism (half its extent).
_DRAWN = 0.16
_HEIGHT, _SMALL_HEIGHT = 2.9, 2.5  # in, of a panel in two and in three columns
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

    `further` is said in the caption.
    """
    beam, segments = pair.beam, pair.segments
    names = mode_names(beam.system, beam.modes.shapes[:, :count])
    columns = _places(beam.system)
    scenes = []
    for mode in range(count):
        bent = _Bent(beam.system, beam.modes.shapes[:, mode], names.name(mode))
        like = _like(beam, segments, mode)
        factor = _DRAWN * beam.system.posture.mechanism.size / bent.largest
        frequency = beam.modes.frequencies[mode]
        called = f", {bent.name}" if bent.name else ""
        points, lumped = compared_points(segments.system, like)
        scene = replace(
            bent.scene(factor, bent.largest),
            title=f"({'abcd'[mode]}) mode {mode + 1}{called}: {frequency:.1f} Hz",
            bar="displacement, largest = 1",
            marks=[Marks(points + factor * lumped, "square", LOOKS["segments"].colour)],
            turned=[outlines_of(segments.system, factor * like)],
        )
        scenes.append(scene)
        for name, (system, unknowns) in {
            "beam FE": (beam.system, bent.unknowns),
            "segments": (segments.system, like),
        }.items():
            what = f"mode {mode + 1}, {name} (largest = 1)"
            columns |= _columns(what, system, unknowns / bent.largest)
    said = (
        f"{pair.said}, coloured by displacement, thin lines: at rest. Orange squares: the same "
        f"mode {pair.beside}; orange outlines in three dimensions."
    )
    caption = " ".join((said, *map(names.said, range(count)), *further))
    return Shown(caption, scenes=scenes, columns=2, height=_HEIGHT, data=csv_of(columns))


def under_loads(pair: Pair) -> Shown:
    """A panel for each force along x, y and z at the loaded point, each with its own scale."""
    beam, segments = pair.beam, pair.segments
    size = beam.system.posture.mechanism.size
    columns = _places(beam.system)
    scenes, moves = [], []
    for place, name in enumerate("xyz"):
        unknowns = _under(beam.system, place)
        named = mode_names(beam.system, unknowns[:, None]).name(0)
        bent = _Bent(beam.system, unknowns, named)
        factor = readable_factor(bent.largest, _DRAWN * size)
        tail = _tool(beam.system) + factor * bent.tip + 0.16 * size * np.eye(3)[place]
        head = tail + 0.4 * size * np.eye(3)[place]
        scene = bent.scene(factor, 1.0 / _MICRO)
        lumped = factor * _under(segments.system, place)
        scene = replace(
            scene,
            title=f"({'abc'[place]}) {FORCE:g} N along {name}, drawn × {_grouped(factor)}",
            bar="displacement (µm)",
            arrows=[Arrow(tail, head, VERMILLION)],
            turned=[outlines_of(segments.system, lumped)],
            motion="push",
            inside=[*scene.inside, np.array([tail, head])],
        )
        scenes.append(scene)
        far = np.linalg.norm(bent.tip) * _MICRO
        moves.append(f"{far:.4g} µm under the force along {name}")
        what = f"force along {name} (µm)"
        columns |= _columns(what, beam.system, bent.unknowns * _MICRO)
    caption = (
        f"{pair.said}, each picture with the enlargement named above it. The loaded point moves "
        f"{', '.join(moves)}. Red arrow: the force; orange outlines in three dimensions: the same "
        f"{pair.beside}."
    )
    return Shown(caption, scenes=scenes, columns=3, height=_SMALL_HEIGHT, data=csv_of(columns))


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
