"""Natural modes of a mechanism in each pose of its path, by lumped models, beams and solids.

Input: a robot in its postures, a reading of its file, meshes and the number of modes. Output:
`PathModes`, with frequencies, sampled shapes and harmonic responses in each pose. All models are
sampled at the same points (`mode_samples`), so that their shapes can be compared. Legs are reduced
to their ends with all modes up to a cut-off frequency. The cut-off frequency is raised until the
requested modes lie below it.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from fem.beams.line_beam import line_beam
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from lumped.arrays import Array
from lumped.equivalent_leg import sectioned_leg
from lumped.legs import GivenLeg, Leg, LineLeg, SectionedLeg
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.system.assembly import assembly
from validation.context import Preset
from validation.models.leg_models import filled
from validation.models.loads.leg_masses import leg_with_inside
from validation.models.options import ModelName, ModelOptions
from validation.models.robot_bodies import CUTOFF
from validation.models.robot_models import (
    PostureModes,
    modes_along,
    modes_on_drives,
    with_dynamic_bodies,
    with_enough_modes,
)
from validation.references.corners_and_steps import sections_with_jumps
from validation.references.mode_samples import Samples, samples_of
from validation.references.reference_legs import (
    SECTION_DIVISIONS,
    computed_elements,
    computed_sections,
    line_divisions,
)
from validation.references.reference_parts import Bodies, condensed_parts, solid_parts
from validation.references.robot_on_path import Holds, Reading, RobotOnPath, known_legs
from validation.responses.statics_and_modes import PathModes
from validation.solids.leg_meshes import COARSEST_WALLS, DIVISIONS, WALL_DIVISIONS, divisions_across
from validation.solids.solid_legs import ELEMENTS, held_solid

Build = Callable[[Leg, Ends, float], LegMatrices]


def modes_by_model(robot: RobotOnPath, model: ModelName, options: ModelOptions) -> PathModes | None:
    """Modes of a robot by a judged model. None if nothing has mass."""
    if model == "simplified":
        drives = modes_on_drives(robot.postures, robot.computed_count)
        modes = vibration_of(robot.samples, drives, robot.computed_count)
        return modes if np.isfinite(modes.frequencies).any(axis=1).all() else None
    return robot.context.get(model_vibration, robot.postures, model, options, robot.computed_count)


class LegMesh(NamedTuple):
    """Element counts of a prism's mesh across its section.

    `across` is the count along the smaller side of a rectangle, `walls` that across the walls and
    rims of any other section. Both determine the element length along the leg, too. `least`: if it
    exceeds `walls`, the section mesh has `least` elements across walls and rims, but the element
    length along the leg remains that of `walls`.
    """

    across: int
    walls: int
    least: int = 0

    def divisions(self, leg: SectionedLeg) -> int:
        """Number of elements across a section, from which their length along the leg follows."""
        return divisions_across(leg, self.across, self.walls)

    def section_divisions(self, leg: SectionedLeg) -> int:
        """Number of elements across a section in the section mesh, at least `least` for walls."""
        return divisions_across(leg, self.across, max(self.walls, self.least))


COMPUTED_SECTIONS = LegMesh(SECTION_DIVISIONS, SECTION_DIVISIONS)


class SolidMeshes(NamedTuple):
    """Coarse and fine mesh of the solid legs of a preset."""

    coarse: LegMesh
    fine: LegMesh

    def ratio(self, prisms: Iterable[SectionedLeg]) -> float:
        """Smallest ratio of coarse to fine element size over the legs `prisms`."""
        return min(self.fine.divisions(leg) / self.coarse.divisions(leg) for leg in prisms)


def solid_meshes(preset: Preset) -> SolidMeshes:
    """Coarse and fine mesh of solid legs for a preset."""
    across, walls = DIVISIONS[preset], WALL_DIVISIONS[preset]
    return SolidMeshes(LegMesh(across - 1, walls // 2), LegMesh(across, walls))


def modes_of_solids(robot: RobotOnPath, reading: Reading) -> PathModes:
    """Modes of the reference: legs and CAD parts as solids, and legs given by a compliance.

    Legs given by a 6×6 compliance alone have the mass distribution and interior stiffness that
    `reading` assumes. Thin walls have the same section mesh for one and for two divisions; the
    excess stiffness of that mesh against distortion does not appear if only the length of the
    elements is halved. Therefore the section of the fine mesh has at least four divisions. Walls
    thinner than about 1/30 of the section have one section mesh for one to four divisions; the
    error of that mesh is in both solids, and their difference does not show it.
    """
    meshes = solid_meshes(robot.context.meshes)
    mesh = meshes.fine._replace(least=COARSEST_WALLS) if reading.mesh else meshes.coarse
    return robot.context.get(solid_vibration, robot.postures, reading, mesh, robot.computed_count)


def vibration_of(samples: Samples, posture_modes: Iterable[PostureModes], count: int) -> PathModes:
    """Record of `count` modes in all postures, from the modes of each posture.

    Missing modes have NaN as frequency. Modes are missing if a robot has few lumped masses, or if
    all its bodies are rigid and a drive has no effect in a posture at the end of a stroke.
    """
    frequencies, shapes, energy_shares, responses, displacements = [], [], [], [], None
    for posture in posture_modes:
        # Bodies have the same models in all postures.
        displacements = displacements or samples.of_models(posture.system.models)
        padding = (0, count - len(posture.modes.frequencies))
        frequencies.append(np.pad(posture.modes.frequencies, padding, constant_values=np.nan))
        shapes.append(
            np.pad(
                samples.at(posture.system, posture.modes.shapes, displacements), ((0, 0), padding)
            )
        )
        energy_shares.append(
            np.pad(
                samples.energy_shares(posture.system, posture.modes.shapes, displacements), padding
            )
        )
        responses.append(posture.responses)
    return PathModes(
        np.array(frequencies),
        np.array(shapes),
        samples.weights,
        np.array(energy_shares),
        np.array(
            [
                [judged for posture in excitations for judged in posture.judged]
                for excitations in responses
            ]
        ),
        [
            np.array([posture.receptance for posture in excitation])
            for excitation in zip(*responses, strict=True)
        ],
    )


def model_vibration(
    postures: tuple[Posture, ...], model: ModelName, options: ModelOptions, count: int
) -> PathModes:
    """First `count` modes in each posture by segments or beams, with textbook section constants."""
    mechanism = postures[0].mechanism
    samples = samples_of(mechanism)

    def solve(bodies: Mapping[str, BodyModel]) -> PathModes:
        posture_modes = modes_along(assembly(mechanism, bodies), postures, count)
        return vibration_of(samples, posture_modes, count)

    return with_dynamic_bodies(
        model, mechanism, solve, _solved_frequencies, postures, count, options
    )


def built_vibration(
    postures: tuple[Posture, ...],
    build: Build,
    parts: Bodies,
    ends: Holds,
    count: int,
) -> PathModes:
    """First `count` modes in each posture, with matrices of each leg made by `build`.

    Arguments of `build` are a leg, its end condition, and the frequency (Hz) up to which its
    matrices must be accurate. `parts` are models of the CAD parts. `ends`: end condition of each
    leg by body name.
    """
    mechanism = postures[0].mechanism
    samples, legs = samples_of(mechanism), known_legs(mechanism)

    def solve(highest: float) -> PathModes:
        built: dict[tuple[object, Ends], LegMatrices] = {}
        bodies: dict[str, BodyModel] = {}
        for name, leg in legs.items():
            key = name if isinstance(leg, GivenLeg) else leg, ends[name]
            if key not in built:
                built[key] = filled(build(leg, ends[name], highest))
            bodies[name] = built[key]
        prepared = assembly(mechanism, {**bodies, **parts})
        return vibration_of(samples, modes_along(prepared, postures, count), count)

    return with_enough_modes(solve, _solved_frequencies, postures, count)


def _solved_frequencies(modes: PathModes) -> Array:
    return np.asarray(modes.frequencies[np.isfinite(modes.frequencies)])


def solid_vibration(
    postures: tuple[Posture, ...], reading: Reading, mesh: LegMesh, count: int
) -> PathModes:
    """First `count` modes in each posture, with legs as solids on `mesh` reduced to their ends.

    `reading` selects the mass and stiffness distributions in legs specified by their 6×6
    compliance, and the mesh of CAD parts.
    """

    def build(leg: Leg, ends: Ends, highest: float) -> LegMatrices:
        if isinstance(leg, GivenLeg):
            return leg_with_inside(leg, reading.inside, highest)
        divisions = mesh.divisions(leg), mesh.section_divisions(leg)
        return _reduced_solid(leg, *divisions, ends, highest)

    parts = solid_parts(postures, count, reading.ends, reading.part_mesh)
    return built_vibration(postures, build, parts, reading.ends, count)


# In memory, since robots that differ in one number have most legs in common.
@memo(16)
def _reduced_solid(
    leg: SectionedLeg, divisions: int, section_divisions: int, ends: Ends, highest: float
) -> LegMatrices:
    return craig_bampton(held_solid(leg, divisions, ends, section_divisions), highest).matrices


def computed_beam_vibration(
    postures: tuple[Posture, ...],
    mesh: LegMesh,
    ends: Holds | None,
    preset: Preset | None,
    count: int,
) -> PathModes:
    """Modes in each posture by beams whose section constants are computed on `mesh`.

    `ends`: end condition by body name; warping is restrained at rigid ends. If `ends` is None,
    warping is free at all ends. `preset` selects the solids from which compliance and mass of
    corners and steps are taken. If it is None, beams are without them.
    """
    mechanism = postures[0].mechanism
    build = partial(_computed_leg, mesh=mesh, warping=ends is not None, preset=preset)
    hold: Holds = ends or dict.fromkeys(known_legs(mechanism), "rigid")
    return built_vibration(postures, build, condensed_parts(mechanism), hold, count)


def _computed_leg(
    leg: Leg, ends: Ends, highest: float, *, mesh: LegMesh, warping: bool, preset: Preset | None
) -> LegMatrices:
    divisions = mesh.divisions(sectioned_leg(leg))
    if preset is not None and isinstance(leg, LineLeg):
        sections = computed_sections(leg, divisions)
        solid_divisions = line_divisions(preset, leg)[1]
        elements = line_beam(sections_with_jumps(sections, leg, solid_divisions), ELEMENTS)
    else:
        elements = computed_elements(leg, ends if warping else None, ELEMENTS, divisions)
    return craig_bampton(held_leg(elements), highest, CUTOFF["beam"] * highest).matrices
