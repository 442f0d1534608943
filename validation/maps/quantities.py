"""Quantities mapped over a workspace: lowest stiffness, first frequency and error of a model.

Input: a mechanism without loads and the requirement of its robot file. Output: functions that
compute each quantity in any postures. Rule for the mapped model: the first model on which the robot
file relies; otherwise the simplest one with an error within the limit on the path; otherwise the
one with the smallest error.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fem.beams.stepped import SteppedLeg
from lumped.acceptance.quantities import ANY_FORCE
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.legs import SectionedLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import links
from lumped.system.assembly import Assembly, assembly
from lumped.system.sweep import swept
from validation.adequacy.judged_models import JudgedModel, judged_models, why_unable
from validation.context import Context
from validation.maps.workspace import Solve
from validation.models.leg_models import reduced_leg
from validation.models.options import ModelOptions
from validation.models.robot_models import CUTOFF, bodies_of, with_enough_modes
from validation.references.model_ladder import model_statics
from validation.references.reference_legs import solid_tip
from validation.references.reference_parts import solid_parts
from validation.references.responses import UNSOLVED
from validation.references.robot_on_path import RobotOnPath, path_postures, robot_at
from validation.responses.displacement import relative
from validation.responses.statics_and_modes import Statics

_MICRO, _PERCENT = 1e-6, 100.0


@dataclass(frozen=True, eq=False)
class MappedQuantity:
    """A quantity over the workspace, with a `description` for the caption of its map.

    `model`: name of the model that computes it. `solve`: function that computes it in postures.
    `largest`: true if the worst value is the largest, false if it is the smallest.
    """

    id: str
    title: str
    unit: str
    model: str
    description: str
    solve: Solve
    largest: bool = False


def mapped_quantities(context: Context, mechanism: Mechanism) -> list[MappedQuantity]:
    """Mapped quantities that can be solved for a `mechanism`, the run's robot without loads.

    Stiffness and error are those of the mapped model (rule in the docstring of this module).
    """
    postures = [replace(posture, mechanism=mechanism) for posture in path_postures(context)]
    robot = robot_at(context, postures)
    references: Sequence[Assembly] = ()
    with suppress(*UNSOLVED):
        references = _references(robot)
    name, model = _mapped_model(robot, references, context.robot_file.requirement)
    quantities = [
        MappedQuantity(
            "map.stiffness",
            "lowest stiffness",
            "N/µm",
            name,
            "smallest stiffness over all directions of force at the tool (inverse of the "
            f"largest eigenvalue of the translational compliance), by {name}",
            partial(_lowest_stiffness, model),
        )
    ]
    elements = "beam elements" + (", parts as solids" if mechanism.parts else "")
    with suppress(*UNSOLVED):
        quantities.append(
            MappedQuantity(
                "map.f1",
                "first frequency",
                "Hz",
                elements,
                f"lowest natural frequency, by {elements}",
                partial(_first_frequency, _finite_elements(robot)),
            )
        )
    if references:
        quantities.append(
            MappedQuantity(
                "map.error",
                f"error of {name}",
                "%",
                name,
                "relative error of the displacement, for the direction of force with the "
                "largest error and for the least favourable end conditions that the "
                "robot file allows",
                partial(_error, model, references),
                largest=True,
            )
        )
    return quantities


def _mapped_model(
    robot: RobotOnPath, references: Sequence[Assembly], requirement: Requirement
) -> tuple[str, JudgedModel]:
    """Name and options of the model to be mapped: beams if the error of no model is known."""
    models = {
        name: model
        for name, model in judged_models(robot.mechanism).items()
        if not why_unable(robot.postures, model)
    }
    for name in requirement.rely:
        if name in models:
            return name, models[name]
    errors = {}
    for name, model in models.items() if references else ():
        with suppress(*UNSOLVED):
            errors[name] = float(np.max(_error(model, references, robot.postures)))
            if errors[name] <= _PERCENT * requirement.limit(ANY_FORCE):
                break
    name = min(errors, key=errors.__getitem__, default="beam")
    return name, models[name]


def _references(robot: RobotOnPath) -> list[Assembly]:
    """Reference for statics under each set of end conditions that the robot file allows."""
    references = []
    for ends in robot.holding.alternatives.values():
        tips = {name: solid_tip(robot.context, leg, ends[name]) for name, leg in robot.legs.items()}
        parts = solid_parts(robot.postures, robot.computed_count, ends)
        references.append(assembly(robot.mechanism, {**links(robot.mechanism, tips), **parts}))
    return references


def _finite_elements(robot: RobotOnPath) -> Assembly:
    """Assembly of reduced beams, with CAD parts as solids."""
    mechanism, options = robot.mechanism, ModelOptions(parts="condensed")
    parts = solid_parts(robot.postures, robot.computed_count, robot.holding.first)

    def reduced_assembly(highest: float) -> Assembly:
        def reduce(leg: SectionedLeg | SteppedLeg, leg_options: ModelOptions) -> LegMatrices:
            return reduced_leg("beam", leg, leg_options, highest, CUTOFF["beam"] * highest)

        return assembly(mechanism, {**bodies_of(mechanism, options, reduce), **parts})

    def frequencies(assembled: Assembly) -> Array:
        return _first_frequency(assembled, robot.postures)

    return with_enough_modes(reduced_assembly, frequencies, robot.postures, 1, options)


def _lowest_stiffness(model: JudgedModel, postures: Sequence[Posture]) -> Array:
    compliances = model_statics(postures, model.kind, model.options).compliances[:, :3, :3]
    with np.errstate(divide="ignore"):
        return np.asarray(_MICRO / np.linalg.eigvalsh(compliances)[:, -1])


def _first_frequency(assembled: Assembly, postures: Sequence[Posture]) -> Array:
    return swept(assembled, postures, 1).frequencies[:, 0]


def _error(
    model: JudgedModel, references: Sequence[Assembly], postures: Sequence[Posture]
) -> Array:
    """Largest error (%) of the displacement under any force, against all references."""
    statics = model_statics(postures, model.kind, model.options)
    no_loads = np.zeros_like(statics.load_displacements)
    reference_statics = [
        Statics(swept(reference, postures, 0).compliances, no_loads) for reference in references
    ]
    sizes = [
        relative(statics - reference, reference, ANY_FORCE).size for reference in reference_statics
    ]
    return np.asarray(_PERCENT * np.max(sizes, axis=0))
