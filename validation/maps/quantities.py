"""Quantities mapped over a workspace: lowest stiffness, first frequency and error of a model.

Input: `Responses` of the robot without loads, and the requirement of its robot file. Output: each
quantity as a function of responses. Rule for the mapped model: the first model on which the robot
file relies; otherwise the simplest one with an error within the limit on the path; otherwise the
one with the smallest error.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

import numpy as np

from fem.beams.stepped import SteppedLeg
from lumped.acceptance.quantities import ANY_FORCE
from lumped.acceptance.requirement import Requirement
from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from lumped.legs import SectionedLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.mechanism import Posture
from lumped.system.assembly import Assembly, assembly
from lumped.system.sweep import swept
from validation.adequacy.judged_models import judged_models_of
from validation.adequacy.model_errors import ModelErrors
from validation.adequacy.robot_verdicts import subject_of
from validation.models.leg_models import reduced_leg
from validation.models.options import ModelOptions
from validation.models.robot_bodies import CUTOFF, bodies_of
from validation.models.robot_models import with_enough_modes
from validation.references.model_ladder import SOLID
from validation.references.reference import Interpretation, Reference
from validation.references.reference_parts import solid_parts
from validation.references.responses import UNSOLVED, Model, Responses
from validation.references.robot_on_path import NOMINAL, Holds, Reading, RobotOnPath
from validation.responses.statics_and_modes import PathModes

_MICRO, _PERCENT = 1e-6, 100.0


@dataclass(frozen=True, eq=False)
class MappedQuantity:
    """A quantity over the workspace, with a `description` for the caption of its map.

    `model`: name of the model that computes it. `values`: function of responses that returns the
    values of the quantity in all their postures. `largest`: true if the worst value is the largest,
    false if it is the smallest.
    """

    id: str
    title: str
    unit: str
    model: str
    description: str
    values: Callable[[Responses], Array]
    largest: bool = False


def mapped_quantities(responses: Responses, requirement: Requirement) -> list[MappedQuantity]:
    """Mapped quantities of a robot without loads, as far as they can be solved on its path.

    The module docstring has the rule for the model whose stiffness and error are mapped.
    `responses` must be strict: they raise the errors of solutions instead of recording them.
    """
    robot = responses.robot
    reference = _reference(responses)
    model = _mapped_model(responses, reference, requirement)
    quantities = [
        MappedQuantity(
            "map.stiffness",
            "lowest stiffness",
            "N/µm",
            model.name,
            "smallest stiffness over all directions of force at the tool (inverse of the "
            f"largest eigenvalue of the translational compliance), by {model.name}",
            partial(_lowest_stiffness, model),
        )
    ]
    elements = "beam elements" + (", parts as solids" if robot.mechanism.parts else "")
    with suppress(*UNSOLVED):
        _beams_with_solid_parts(robot, robot.first_reading)
        quantities.append(
            MappedQuantity(
                "map.f1",
                "first frequency",
                "Hz",
                elements,
                f"lowest natural frequency, by {elements}",
                partial(
                    _first_frequency, Model(elements, modes=_first_modes, modal_fields=("ends",))
                ),
            )
        )
    if reference:
        quantities.append(
            MappedQuantity(
                "map.error",
                f"error of {model.name}",
                "%",
                model.name,
                "relative error of the displacement, for the direction of force with the "
                "largest error and for the least favourable end conditions that the "
                "robot file allows",
                partial(_error, model, reference),
                largest=True,
            )
        )
    return quantities


def _mapped_model(
    responses: Responses, reference: Reference | None, requirement: Requirement
) -> Model:
    """Model to be mapped, by the rule in the docstring of this module.

    Beams if no model is relied on and no error is known.
    """
    models = {
        name: model
        for name, model in judged_models_of(responses.robot).items()
        if model.statics is not None
    }
    for name in requirement.rely:
        if name in models:
            return models[name]
    if reference is None:
        return models["beam"]
    errors = {}
    for name, model in models.items():
        with suppress(*UNSOLVED):
            errors[name] = float(
                np.nan_to_num(_error(model, reference, responses), nan=np.inf).max()
            )
            if errors[name] <= _PERCENT * requirement.limit(ANY_FORCE):
                break
    return models[min(errors, key=errors.__getitem__, default="beam")]


def _reference(responses: Responses) -> Reference | None:
    """Solid model under each set of end conditions that the robot file allows.

    It has no half-widths. None if a solid cannot be meshed, or if no posture can be solved.
    """
    robot = responses.robot
    interpretations = [
        Interpretation(name, Reading(ends)) for name, ends in robot.holding.alternatives.items()
    ]
    for posture in robot.postures:
        try:
            for interpretation in interpretations:
                responses.at([posture]).required_statics(SOLID, interpretation.reading)
        except InputError:
            return None
        except ComputationError:
            continue
        return Reference("solid", SOLID, interpretations)
    return None


def _beams_with_solid_parts(robot: RobotOnPath, reading: Reading) -> Assembly:
    """Assembly of reduced beams, with CAD parts as solids, computed once per run and process."""
    return robot.context.get(
        _finite_elements, robot.reduction_postures, robot.computed_count, reading.ends
    )


def _finite_elements(postures: tuple[Posture, ...], count: int, ends: Holds) -> Assembly:
    mechanism, options = postures[0].mechanism, ModelOptions(parts="condensed")
    parts = solid_parts(postures, count, ends)

    def reduced_assembly(highest: float) -> Assembly:
        def reduce(leg: SectionedLeg | SteppedLeg, leg_options: ModelOptions) -> LegMatrices:
            return reduced_leg("beam", leg, leg_options, highest, CUTOFF["beam"] * highest)

        return assembly(mechanism, {**bodies_of(mechanism, options, reduce), **parts})

    def frequencies(assembled: Assembly) -> Array:
        return swept(assembled, postures, 1).frequencies[:, 0]

    return with_enough_modes(reduced_assembly, frequencies, postures, 1, options)


def _first_modes(robot: RobotOnPath, reading: Reading) -> PathModes:
    assembled = _beams_with_solid_parts(robot, reading)
    return PathModes.unsampled(swept(assembled, robot.postures, 1).frequencies)


def _lowest_stiffness(model: Model, responses: Responses) -> Array:
    compliances = responses.required_statics(model, NOMINAL).compliances[:, :3, :3]
    with np.errstate(divide="ignore"):
        return np.asarray(_MICRO / np.linalg.eigvalsh(compliances)[:, -1])


def _first_frequency(model: Model, responses: Responses) -> Array:
    reading = responses.robot.first_reading
    return responses.required_modes(model, reading).frequencies[:, 0]


def _error(model: Model, reference: Reference, responses: Responses) -> Array:
    """Largest error (p, %) of the displacement under any force, against all interpretations.

    NaN if the reference is rigid under a force and the model is not. Shapes: p postures.
    """
    errors = ModelErrors(subject_of(responses, [model], statics=reference), modes=0)
    return np.asarray(_PERCENT * errors.required_errors(model, ANY_FORCE).error.max(axis=0))
