"""Natural modes of a mechanism over its path: by models, by solids and by beams between them.

Shapes of all models are sampled alike: displacements of the tool, twists of rigid bodies about
their centre, and four points in each of some sections of every leg, placed so that they have the
section's mass and rotary inertia.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, equivalent_leg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import assembly
from lumped.system.solution import mode_count, modes, solved
from validation.adequacy.mechanism.legs import (
    MASSES,
    SECTION_DIVISIONS,
    Masses,
    leg_with_masses,
    own_elements,
)
from validation.adequacy.mechanism.parts import Bodies, condensed_parts, solid_parts
from validation.adequacy.mechanism.path import Holds, RobotOnPath, has_given, known_legs
from validation.adequacy.mechanism.samples import Samples, samples_of
from validation.adequacy.response import Vibration
from validation.context import Preset
from validation.models.legs import filled
from validation.models.mechanism import (
    CUTOFF,
    dynamic_bodies,
    highest_frequency,
    on_drives_alone,
)
from validation.models.options import ModelName, ModelOptions
from validation.parts.meshes import FINEST
from validation.solids.legs import COARSEST_WALLS, divisions_across
from validation.solids.robots import (
    DIVISIONS,
    ELEMENTS,
    WALL_DIVISIONS,
    held_solid,
    renewed_where_needed,
)

Build = Callable[[Leg, Ends, float], LegMatrices]


def modes_by_model(robot: RobotOnPath, model: ModelName, options: ModelOptions) -> Vibration | None:
    """What a model answers; None where nothing has mass."""
    if model == "simplified":
        return simplified_vibration(robot.samples, robot.postures, robot.offered)
    return robot.context.get(model_vibration, robot.postures, model, options, robot.offered)


class SolidMeshes(NamedTuple):
    """Divisions of two meshes of the solid legs, each across rectangles and across walls."""

    coarse: tuple[int, int]
    fine: tuple[int, int]

    @property
    def ratio(self) -> float:
        """By how much the coarse one's elements are larger at least."""
        return min(fine / coarse for coarse, fine in zip(*self, strict=True))


def solid_meshes(preset: Preset) -> SolidMeshes:
    """The meshes whose step shows what they leave open."""
    across, walls = DIVISIONS[preset], WALL_DIVISIONS[preset]
    return SolidMeshes((across - 1, walls // 2), (across, walls))


def modes_of_solids(
    robot: RobotOnPath,
    ends: Holds,
    masses: Masses | None,
    *,
    fine: bool = True,
    level: int = FINEST,
) -> Vibration:
    """Solid legs on one of two meshes, given ones with such masses, parts on one of three.

    Sections of thin walls are one mesh with one and with two divisions: how much too stiff it
    resists distortion no shorter slices would tell. The fine one has at least four.
    """
    meshes = solid_meshes(robot.context.preset)
    divisions, section = (meshes.fine, COARSEST_WALLS) if fine else (meshes.coarse, 0)
    return robot.context.get(
        solid_vibration, robot.postures, *divisions, ends, masses, robot.offered, level, section
    )


def modes_of_own_beams(
    robot: RobotOnPath,
    ends: Holds | None,
    divisions: tuple[int, int] = (SECTION_DIVISIONS, SECTION_DIVISIONS),
) -> Vibration:
    """Beams of the sections' own constants from such meshes, with warping where ends are held."""
    return robot.context.get(own_vibration, robot.postures, *divisions, ends, robot.offered)


def vibration(
    samples: Samples, postures: Sequence[Posture], bodies: Mapping[str, BodyModel], count: int
) -> Vibration:
    """The first `count` modes in every posture with these models of the legs.

    Of legs whose mass is one lump, and of parts condensed on their interfaces, as many as have
    mass in every posture.
    """
    prepared = assembly(postures[0].mechanism, {name: filled(one) for name, one in bodies.items()})
    if has_given(postures[0].mechanism) or postures[0].mechanism.parts:
        known = [mode_count(solved(prepared.at(posture))) for posture in postures]
        count = min(count, *known)
    frequencies, shapes = [], []
    of_bodies = samples.of_models(bodies)
    for posture in postures:
        system = prepared.at(posture)
        found = modes(solved(system), count)
        frequencies.append(found.frequencies)
        shapes.append(samples.at(system, found.shapes, of_bodies))
    return Vibration(np.array(frequencies), np.array(shapes))


def simplified_vibration(
    samples: Samples, postures: Sequence[Posture], count: int
) -> Vibration | None:
    """Rigid bodies on elastic drives, NaN beyond the modes that they have; None without mass."""
    rigid = on_drives_alone(postures[0].mechanism)
    prepared = assembly(rigid, {})
    frequencies, shapes = [], []
    for posture in postures:
        system = prepared.at(replace(posture, mechanism=rigid))
        solution = solved(system)
        known = min(count, mode_count(solution)) if system.size else 0
        if not known:
            return None
        found = modes(solution, known)
        own = samples.at(system, found.shapes, {})
        frequencies.append(np.append(found.frequencies, np.full(count - known, np.nan)))
        shapes.append(np.hstack([own, np.zeros((len(own), count - known))]))
    return Vibration(np.array(frequencies), np.array(shapes))


def model_vibration(
    postures: tuple[Posture, ...], model: ModelName, options: ModelOptions, count: int
) -> Vibration:
    """Modes by segments or beam elements of textbook constants."""
    mechanism = postures[0].mechanism
    samples = samples_of(mechanism)

    def solve(highest: float) -> Vibration:
        return vibration(
            samples, postures, dynamic_bodies(model, mechanism, highest, options), count
        )

    return _renewed(postures, count, solve)


def built_vibration(
    postures: tuple[Posture, ...],
    build: Build,
    parts: Bodies,
    ends: Holds,
    count: int,
) -> Vibration:
    """Modes with every leg as `build` makes it of leg, ends and highest frequency (Hz).

    `parts`: models of the CAD parts.
    """
    mechanism = postures[0].mechanism
    samples, legs = samples_of(mechanism), known_legs(mechanism)

    def solve(highest: float) -> Vibration:
        made: dict[tuple[object, Ends], LegMatrices] = {}
        bodies: dict[str, BodyModel] = {}
        for name, leg in legs.items():
            key = leg if isinstance(leg, ConstantLeg) else name, ends[name]
            if key not in made:
                made[key] = build(leg, ends[name], highest)
            bodies[name] = made[key]
        return vibration(samples, postures, {**bodies, **parts}, count)

    return _renewed(postures, count, solve)


def _renewed(
    postures: Sequence[Posture], count: int, solve: Callable[[float], Vibration]
) -> Vibration:
    return renewed_where_needed(
        highest_frequency(postures, count), solve, frequencies=lambda found: found.frequencies
    )


def solid_vibration(
    postures: tuple[Posture, ...],
    divisions: int,
    walls: int,
    ends: Holds,
    masses: Masses | None,
    count: int,
    level: int = FINEST,
    section: int = 0,
) -> Vibration:
    """Modes with prisms as solids reduced to their ends, and given legs with plausible masses.

    `divisions` across rectangles, `walls` across the sections that have walls, which are meshed
    with `section` divisions where those are more; CAD parts on the mesh of that `level`.
    """

    def build(leg: Leg, ends: Ends, highest: float) -> LegMatrices:
        if isinstance(leg, GivenLeg):
            return leg_with_masses(leg, masses or MASSES[0], highest)
        number, face = (
            divisions_across(leg, divisions, one) for one in (walls, max(walls, section))
        )
        return _reduced_solid(leg, number, face, ends, highest)

    parts = solid_parts(postures, count, ends, level)
    return built_vibration(postures, build, parts, ends, count)


# Robots that differ in one number share most of their legs.
@lru_cache(maxsize=16)
def _reduced_solid(
    leg: ConstantLeg, number: int, face: int, ends: Ends, highest: float
) -> LegMatrices:
    return craig_bampton(held_solid(leg, number, ends, face), highest).matrices


def own_vibration(
    postures: tuple[Posture, ...],
    divisions: int,
    walls: int,
    ends: Holds | None,
    count: int,
) -> Vibration:
    """Modes by beams of the sections' own constants; with warping, held as `ends` say.

    `divisions` of the mesh of rectangles, `walls` of the others, as in `solid_vibration`.
    """
    mechanism = postures[0].mechanism
    build = partial(_own_leg, divisions=divisions, walls=walls, warping=ends is not None)
    hold: Holds = ends or dict.fromkeys(known_legs(mechanism), "rigid")
    return built_vibration(postures, build, condensed_parts(mechanism), hold, count)


def _own_leg(
    leg: Leg, ends: Ends, highest: float, *, divisions: int, walls: int, warping: bool
) -> LegMatrices:
    number = divisions_across(equivalent_leg(leg), divisions, walls)
    whole = own_elements(leg, ends if warping else None, ELEMENTS, number)
    return craig_bampton(held_leg(whole), highest, CUTOFF["beam"] * highest).matrices
