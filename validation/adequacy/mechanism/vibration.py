"""Natural modes of a mechanism over its path: by models, by solids and by beams between them.

Shapes of all models are sampled alike: displacements of the tool, twists of rigid bodies about
their centre, and four points in each of some sections of every leg, placed so that they have the
section's mass and rotary inertia.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import NamedTuple

import numpy as np

from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, equivalent_leg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.system.assembly import assembly
from validation.adequacy.mechanism.legs import SECTION_DIVISIONS, own_elements
from validation.adequacy.mechanism.parts import Bodies, condensed_parts, solid_parts
from validation.adequacy.mechanism.path import Holds, RobotOnPath, known_legs
from validation.adequacy.mechanism.samples import Samples, samples_of
from validation.agreement.responses import PathModes
from validation.context import Preset
from validation.models.legs import filled
from validation.models.loads.leg_masses import MASSES, Inside, leg_with_inside
from validation.models.mechanism import (
    CUTOFF,
    PostureModes,
    dynamic_bodies,
    modes_along,
    modes_on_drives,
    with_enough_modes,
)
from validation.models.options import ModelName, ModelOptions
from validation.parts.meshes import FINEST
from validation.solids.legs import (
    COARSEST_WALLS,
    DIVISIONS,
    ELEMENTS,
    WALL_DIVISIONS,
    divisions_across,
    held_solid,
)

Build = Callable[[Leg, Ends, float], LegMatrices]


def modes_by_model(robot: RobotOnPath, model: ModelName, options: ModelOptions) -> PathModes | None:
    """What a model answers; None where nothing has mass."""
    if model == "simplified":
        drives = modes_on_drives(robot.postures, robot.offered)
        found = vibration_of(robot.samples, drives, robot.offered)
        return found if np.isfinite(found.frequencies).any(axis=1).all() else None
    return robot.context.get(model_vibration, robot.postures, model, options, robot.offered)


class SolidMeshes(NamedTuple):
    """Divisions of two meshes of the solid legs, each across rectangles and across walls."""

    coarse: tuple[int, int]
    fine: tuple[int, int]

    def ratio(self, prisms: Iterable[ConstantLeg]) -> float:
        """By how much the coarse one's elements of these legs are larger at least."""
        return min(
            divisions_across(leg, *self.fine) / divisions_across(leg, *self.coarse)
            for leg in prisms
        )


def solid_meshes(preset: Preset) -> SolidMeshes:
    """The meshes whose step shows what they leave open."""
    across, walls = DIVISIONS[preset], WALL_DIVISIONS[preset]
    return SolidMeshes((across - 1, walls // 2), (across, walls))


def modes_of_solids(
    robot: RobotOnPath,
    ends: Holds,
    inside: Inside | None,
    *,
    fine: bool = True,
    level: int = FINEST,
) -> PathModes:
    """Solid legs on one of two meshes, given ones with such an `inside`, parts on one of three.

    Sections of thin walls are one mesh with one and with two divisions: how much too stiff it
    resists distortion no shorter slices would tell. The fine one has at least four.
    """
    meshes = solid_meshes(robot.context.meshes)
    divisions, section = (meshes.fine, COARSEST_WALLS) if fine else (meshes.coarse, 0)
    return robot.context.get(
        solid_vibration, robot.postures, *divisions, ends, inside, robot.offered, level, section
    )


def modes_of_own_beams(
    robot: RobotOnPath,
    ends: Holds | None,
    divisions: tuple[int, int] = (SECTION_DIVISIONS, SECTION_DIVISIONS),
) -> PathModes:
    """Beams of the sections' own constants from such meshes, with warping where ends are held."""
    return robot.context.get(own_vibration, robot.postures, *divisions, ends, robot.offered)


def vibration_of(samples: Samples, found: Iterable[PostureModes], count: int) -> PathModes:
    """Frequencies and sampled shapes of `count` modes, NaN beyond those that have mass; responses.

    Lumps of mass have few modes; on its drives alone a robot has fewer at the end of a stroke.
    """
    frequencies, shapes, seen, responses, of_models = [], [], [], [], None
    for one in found:
        # Bodies have the same models in every posture.
        of_models = of_models or samples.of_models(one.system.models)
        beyond = (0, count - len(one.modes.frequencies))
        frequencies.append(np.pad(one.modes.frequencies, beyond, constant_values=np.nan))
        shapes.append(np.pad(samples.at(one.system, one.modes.shapes, of_models), ((0, 0), beyond)))
        seen.append(np.pad(samples.seen(one.system, one.modes.shapes, of_models), beyond))
        responses.append(one.responses)
    return PathModes(
        np.array(frequencies),
        np.array(shapes),
        samples.weights,
        np.array(seen),
        np.array([[number for one in of for number in one.judged] for of in responses]),
        [np.array([one.receptance for one in ones]) for ones in zip(*responses, strict=True)],
    )


def model_vibration(
    postures: tuple[Posture, ...], model: ModelName, options: ModelOptions, count: int
) -> PathModes:
    """Modes by segments or beam elements of textbook constants."""
    mechanism = postures[0].mechanism
    samples = samples_of(mechanism)

    def solve(highest: float) -> PathModes:
        bodies = dynamic_bodies(model, mechanism, highest, options)
        along = modes_along(assembly(mechanism, bodies), postures, count)
        return vibration_of(samples, along, count)

    return with_enough_modes(solve, _known, postures, count)


def built_vibration(
    postures: tuple[Posture, ...],
    build: Build,
    parts: Bodies,
    ends: Holds,
    count: int,
) -> PathModes:
    """Modes with every leg as `build` makes it of leg, ends and highest frequency (Hz).

    `parts`: models of the CAD parts.
    """
    mechanism = postures[0].mechanism
    samples, legs = samples_of(mechanism), known_legs(mechanism)

    def solve(highest: float) -> PathModes:
        made: dict[tuple[object, Ends], LegMatrices] = {}
        bodies: dict[str, BodyModel] = {}
        for name, leg in legs.items():
            key = leg if isinstance(leg, ConstantLeg) else name, ends[name]
            if key not in made:
                made[key] = filled(build(leg, ends[name], highest))
            bodies[name] = made[key]
        prepared = assembly(mechanism, {**bodies, **parts})
        return vibration_of(samples, modes_along(prepared, postures, count), count)

    return with_enough_modes(solve, _known, postures, count)


def _known(found: PathModes) -> Array:
    return np.asarray(found.frequencies[np.isfinite(found.frequencies)])


def solid_vibration(
    postures: tuple[Posture, ...],
    divisions: int,
    walls: int,
    ends: Holds,
    inside: Inside | None,
    count: int,
    level: int = FINEST,
    section: int = 0,
) -> PathModes:
    """Modes with prisms as solids reduced to their ends, and given legs with a plausible inside.

    `divisions` across rectangles, `walls` across the sections that have walls, which are meshed
    with `section` divisions where those are more; CAD parts on the mesh of that `level`.
    """

    def build(leg: Leg, ends: Ends, highest: float) -> LegMatrices:
        if isinstance(leg, GivenLeg):
            return leg_with_inside(leg, inside or Inside(MASSES[0]), highest)
        number, face = (
            divisions_across(leg, divisions, one) for one in (walls, max(walls, section))
        )
        return _reduced_solid(leg, number, face, ends, highest)

    parts = solid_parts(postures, count, ends, level)
    return built_vibration(postures, build, parts, ends, count)


# Robots that differ in one number share most of their legs.
@memo(16)
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
) -> PathModes:
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
