"""Reference for the natural frequencies of a robot, and the causes of models' frequency errors.

Input: the robot along its path with its computed modes. Output: a `Reference` with one
interpretation for each set of end conditions and each plausible mass distribution that the robot
file allows, and for each judged model its sequence of intermediate models. Rule: legs with a
cross-section are 3-D solids reduced to their end faces, and CAD parts are solids reduced to their
interfaces. For legs specified by their 6×6 compliance there is an interpretation with each
plausible distribution of mass and stiffness between their ends.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from lumped.legs import SectionedLeg
from lumped.models.bodies import links, tip_compliances
from lumped.system.assembly import assembly
from validation.context import Preset
from validation.models.loads.leg_masses import plausible_insides
from validation.models.options import ModelOptions
from validation.models.robot_models import modes_along
from validation.parts.meshes import MIDDLE
from validation.references.corners_and_steps import CORNERS, SOURCE, STEPS, has_jumps
from validation.references.model_ladder import (
    COMPUTED_BEAMS,
    PART_STEPS,
    SOLID,
    WARPING_BEAMS,
    WITH_JUMPS,
    formulation_modes,
)
from validation.references.modes_on_path import modes_of_solids, solid_meshes
from validation.references.reference import (
    TIMOSHENKO,
    USE_SOLID,
    Interpretation,
    Reference,
    Remedy,
    Source,
    Step,
    finer_by,
    use,
)
from validation.references.reference_parts import FINER_PARTS, part_kinds
from validation.references.responses import Model, Responses
from validation.references.robot_on_path import Reading, RobotOnPath
from validation.references.uncertainty_sources import MODAL_ROWS, budget
from validation.responses.statics_and_modes import PathModes
from validation.solids.solid_legs import ELEMENTS
from validation.solids.solid_size import larger_preset, too_large

_SUPPOSED = "for every plausible distribution of the legs' mass and stiffness"


def dynamic_reference(responses: Responses) -> Reference:
    """Modal reference of a robot: the solid model under each reading that the robot file allows.

    If the preset cannot mesh a leg, the result is a record with the title "none" and the reason.
    """
    robot = responses.robot
    preset, holding, parts = robot.context.meshes, robot.holding, robot.mechanism.parts
    if reason := _reason_unmeshed(robot.prisms, preset):
        return Reference("none", decides=reason)
    interpretations = []
    for (name, ends), inside in product(
        holding.alternatives.items(), plausible_insides(robot.given.values())
    ):
        reading = Reading(ends, *(inside or ()))
        stated = name if robot.has_solids or not robot.given else ""
        interpretations.append(
            Interpretation(
                ", ".join(filter(None, (stated, str(inside or "")))),
                reading,
                budget(MODAL_ROWS, responses, reading),
            )
        )
    unspecified_masses = Source.MASSES if robot.given else ""
    return Reference(
        title=_reference_title(robot),
        model=SOLID,
        interpretations=interpretations,
        open=" and ".join(filter(None, (holding.unspecified, unspecified_masses))),
        decides="; ".join(filter(None, (holding.decides, robot.masses_instruction))),
        interior=robot.interior_instruction,
        finer=FINER_PARTS if parts else _finer_preset(robot.prisms, preset),
        remedy=None if robot.given else USE_SOLID,
        supposed=_SUPPOSED if robot.given else "",
        computed_by=("validation.references.modes_on_path.solid_vibration",),
    )


def _reference_title(robot: RobotOnPath) -> str:
    """Title of the modal reference in reports."""
    if robot.given:
        return (
            "robot whose legs have the specified 6×6 matrices and assumed distributions of mass "
            "and stiffness"
        )
    if robot.mechanism.parts:
        solid = " and solid legs" if robot.legs else ""
        return f"robot of solid parts{solid}, reduced"
    return "robot of solid legs, reduced to their ends"


def _reason_unmeshed(prisms: Sequence[SectionedLeg], preset: Preset) -> str:
    """Reason why the legs are too large to mesh with a preset. "" if they can be meshed."""
    divisions = [solid_meshes(preset).fine.divisions(leg) for leg in prisms]
    return too_large(prisms, divisions, preset)


def _finer_preset(prisms: Sequence[SectionedLeg], preset: Preset) -> str:
    """Instruction to use the next larger preset that can mesh the legs; a remark if none can."""
    return finer_by(larger_preset(preset, lambda larger: not _reason_unmeshed(prisms, larger)))


def mass_notes(responses: Responses, reference: Reference) -> tuple[str, ...]:
    """Note on the range of frequencies in the middle pose over all plausible mass distributions.

    Mass anywhere on a leg lowers frequencies (Rayleigh), so massless legs give an upper bound,
    which the note contains if no body is a solid. There is no lower bound, since the compliance of
    a leg has no information on the leg between its ends. Empty if the legs' mass distribution is
    known.
    """
    if not reference.supposed or reference.model is None:
        return ()
    robot = responses.robot
    all_frequencies = [
        modes.frequencies
        for interpretation in reference.interpretations
        if (modes := responses.known_modes(reference.model, interpretation.reading))
    ]
    middle_frequencies = np.array(
        [path[len(path) // 2, : robot.judged_count] for path in all_frequencies]
    )
    lows, highs = np.nanmin(middle_frequencies, axis=0), np.nanmax(middle_frequencies, axis=0)
    spans = [
        f"f{k + 1} {low:.4g} to {high:.4g} Hz"
        for k, (low, high) in enumerate(zip(lows, highs, strict=True))
    ]
    note = (
        f"Plausible distributions of the legs' mass and stiffness give {', '.join(spans)} "
        "at the middle pose of the path"
    )
    # Massless links give no upper bound for solids: rigid end faces make solids stiffer than the
    # links, and CAD parts are not links.
    if robot.has_solids:
        return (note,)
    middle = robot.postures[len(robot.postures) // 2]
    massless = links(robot.mechanism, tip_compliances(robot.mechanism))
    (upper_bound,) = modes_along(assembly(robot.mechanism, massless), [middle], robot.judged_count)
    bounds = [
        f"f{k + 1} {frequency:.4g} Hz" for k, frequency in enumerate(upper_bound.modes.frequencies)
    ]
    return (f"{note}; upper bounds, with massless legs: {', '.join(bounds)}",)


def modal_steps(robot: RobotOnPath, beam: Model, segments: Model) -> dict[str, Step]:
    """Steps of `all_modal_steps` that exist for a robot, by name."""
    steps = all_modal_steps(beam, segments)
    applicable = {*_OF_BEAMS, *part_kinds(robot.mechanism)}
    if robot.mechanism.parts:
        applicable.add("modes inside")
    if robot.prisms and not robot.given:
        applicable |= set(MODES_TO_SOLIDS)
    if not any(has_jumps(leg) for leg in robot.prisms):
        applicable.discard("jumps")
    return {name: steps[name] for name in applicable}


def all_modal_steps(beam: Model, segments: Model) -> dict[str, Step]:
    """Steps from all judged models to the modal reference, by name, with these judged models."""
    more_segments = f"increase the number of segments: --elements {2 * ELEMENTS}"
    return {
        "drives": Step(
            "elastic drives only, legs rigid and massless", "beam elements", beam, use("beam")
        ),
        "shear of segments": Step(_SHEAR, "Timoshenko segments", segments, TIMOSHENKO),
        "shear of beams": Step(_SHEAR, "Timoshenko beams", beam, TIMOSHENKO),
        # Second order in 1/n: a quarter of the error remains.
        "twice as many": Step(
            _DISCRETE,
            f"{2 * ELEMENTS} segments, then beam elements",
            Model("twice as many segments", modes=_on_twice_as_many),
            Remedy(more_segments, "--elements"),
        ),
        "beams": Step(
            _DISCRETE, "beam elements with the same section constants", beam, use("beam")
        ),
        **PART_STEPS,
        # Step from condensed parts with Guyan's mass to parts with interior modes.
        "modes inside": Step(
            "internal inertia of the parts (Guyan's mass matrix)",
            "parts reduced by Craig and Bampton on the medium mesh",
            Model("solids on a coarser mesh", modes=_on_middle_mesh),
        ),
        # Steps from textbook section constants to computed ones, then to restrained warping if ends
        # are rigid, then to corners and steps as solids.
        "own": Step(
            "section constants by textbook formulas",
            "fem.sections.section_constants, beam elements",
            COMPUTED_BEAMS,
        ),
        "warping": Step(
            "restrained warping at the ends (non-uniform torsion)",
            "beams with Reissner's torsion and the warping constant Γ of the section",
            WARPING_BEAMS,
        ),
        "jumps": Step(f"{CORNERS}, {STEPS}", SOURCE, WITH_JUMPS),
    }


def _on_twice_as_many(robot: RobotOnPath, reading: Reading) -> PathModes | None:
    """Modes by segments, with twice as many segments per leg as in the judged model.

    None if nothing has mass.
    """
    return formulation_modes("segments", ModelOptions(), robot, replace(reading, elements=2))


def _on_middle_mesh(robot: RobotOnPath, _: Reading) -> PathModes:
    """Modes of the reference, with the second finest mesh of CAD parts and the stiffest ends.

    The ends are the first of the end conditions that the robot file allows.
    """
    return modes_of_solids(robot, replace(robot.first_reading, part_mesh=MIDDLE))


_SHEAR = "shear deformation and rotary inertia neglected"
_DISCRETE = f"discretisation (n = {ELEMENTS})"
_OF_BEAMS = ("drives", "shear of segments", "shear of beams", "twice as many", "beams")
# Names of steps in `all_modal_steps`: from textbook section constants to solids, from beams and
# from segments to solids.
MODES_TO_SOLIDS = ("own", "warping", "jumps")
MODES_FROM_BEAMS = (*PART_STEPS, *MODES_TO_SOLIDS)
MODES_FROM_SEGMENTS = ("twice as many", "beams", *MODES_FROM_BEAMS)
