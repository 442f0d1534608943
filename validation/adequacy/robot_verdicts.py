"""Verdicts on the models of a run's robot, and of each of its legs alone.

Input: the robot file, path and preset of a run. Output: a `Subject` (models, references and steps
between them) and the matrix of verdicts. Rule: meshes are refined until half-widths are at most the
requested accuracy, or a fifth of the limit of each undecided error. A leg alone, clamped at its
root, shows errors that joints, drives and other legs conceal, such as torsion of open sections.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
import scipy

from lumped.acceptance.quantities import load_quantities, response_quantities
from lumped.errors import InputError
from lumped.legs import GivenLeg, Leg
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.placing import clamped_leg
from lumped.models.bodies import leg_of, on_equivalent_legs
from lumped.text import counted
from validation.adequacy.judged_models import (
    JUDGED,
    LEGS_AS_GIVEN,
    JudgedModel,
    judged_models_of,
)
from validation.adequacy.judgement import verdict_matrix
from validation.case import failure_reason
from validation.context import PRESETS, Context, Preset
from validation.models.loads.stability import stabilities, stability_notes
from validation.models.loads.statics import impossible_poses
from validation.models.reduced_parts import unknowns_of, with_finer_parts
from validation.references.modal_reference import dynamic_reference, mass_notes, modal_steps
from validation.references.modes_on_path import solid_meshes
from validation.references.reference import (
    InputUncertainties,
    Reference,
    Step,
    Steps,
    Subject,
    no_reference,
)
from validation.references.reference_parts import reduction_note
from validation.references.responses import UNSOLVED, Model, Responses
from validation.references.robot_on_path import (
    NOMINAL,
    RobotOnPath,
    coordinates,
    distinct_legs,
    known_legs,
    robot_at,
    robot_on_path,
)
from validation.references.static_reference import static_reference, static_steps
from validation.solids.solid_size import LARGEST, solid_unknowns
from validation.uncertainty.refinement import refined
from validation.verdicts import Matrix

# Presets that refine meshes without --accuracy, for robots with and without CAD parts. A quick run
# has one mesh of each kind, and finer meshes of parts take minutes.
_REFINING: Mapping[bool, tuple[Preset, ...]] = {False: ("standard", "fine"), True: ("fine",)}
# Number of robots with all inputs changed at once, by which the sum of single changes is checked.
_CHECKS: Mapping[Preset, int] = {"quick": 4, "standard": 8, "fine": 32}
# Models omitted for a leg alone: rigid legs have no compliance, and "links" equals "vjm".
_NOT_FOR_A_LEG = ("simplified", "links", "segments-stepped", "segments-condensed")
# Reference of statics or modes that are not compared.
_NO_REFERENCE = Reference("none")


def robot_adequacy(context: Context) -> Matrix:
    """Matrix of verdicts of the run's robot. Quantities without a reference are undecided."""
    return judged_robot(context)[1]


def judged_robot(context: Context) -> tuple[Subject, Matrix]:
    """Subject and matrix of verdicts of the run's robot, with sufficiently fine meshes.

    Half-widths due to meshes are at most the accuracy of --accuracy. Without this option they are
    at most a fifth of the limit of each undecided error, as far as `finer_context` allows. Raises
    InputError as `robot_subject` does.
    """
    requirement = context.robot_file.requirement

    def judge(context: Context) -> tuple[Subject, Matrix]:
        subject = robot_subject(context)
        return subject, verdict_matrix(subject, requirement)

    (subject, matrix), refinement = refined(
        context,
        judge,
        lambda result: _largest_mesh_half_width(result[1], requirement.accuracy),
        finer_context,
        requirement.accuracy or 1.0,
    )
    accuracy_notes = (refinement.text,) if requirement.accuracy else ()
    return subject, replace(matrix, notes=(*matrix.notes, *accuracy_notes))


def _largest_mesh_half_width(matrix: Matrix, accuracy: float | None) -> float:
    """Largest half-width of an error due to meshes.

    If `accuracy` is None, each half-width is relative to a fifth of the error's limit, and only
    undecided errors count.
    """
    shares = [
        entry.uncertainties["meshes"] / (1.0 if accuracy else entry.limit / 5.0)
        for entry in matrix.entries
        if "meshes" in entry.uncertainties and (accuracy or entry.verdict == "undecided")
    ]
    return max(shares, default=0.0)


def finer_context(context: Context, factor: float) -> Context:
    """Context with finer meshes: the next finer preset for legs, more unknowns for CAD parts.

    The half-widths of CAD parts become smaller by `factor`. Raises InputError if no finer mesh
    exists. Without --accuracy, it also raises InputError if the preset does not refine meshes, or
    if the finer meshes have more unknowns than the preset allows. Raises ComputationError for lack
    of memory.
    """
    robot_file = context.robot_file
    requested = robot_file.requirement.accuracy is not None
    if not requested and context.preset not in _REFINING[bool(robot_file.mechanism.parts)]:
        raise InputError(f"preset {context.preset} refines meshes only with --accuracy")
    larger = PRESETS[PRESETS.index(context.meshes) + 1 :]
    if not robot_file.mechanism.parts and not larger:
        raise InputError("no preset has finer meshes of the bodies")
    mechanism = with_finer_parts(robot_file.mechanism, factor)
    finer = replace(
        context,
        robot_file=replace(robot_file, mechanism=mechanism),
        finer=larger[0] if larger else context.finer,
    )
    unknowns, largest = _solid_unknowns(finer), LARGEST[context.preset]
    if not requested and unknowns > largest:
        raise InputError(
            f"finer solids have {unknowns:.2g} unknowns; preset {context.preset} allows "
            f"at most {largest}"
        )
    return finer


def _solid_unknowns(context: Context) -> float:
    """Total unknowns of the fine meshes of all distinct legs and CAD parts."""
    mechanism, mesh = context.robot_file.mechanism, solid_meshes(context.meshes).fine
    legs = {leg for leg in known_legs(mechanism).values() if not isinstance(leg, GivenLeg)}
    solids = sum(solid_unknowns(leg, mesh.divisions(leg)) for leg in legs)
    return solids + sum(unknowns_of(body) for body in mechanism.parts.values())


def robot_subject(context: Context) -> Subject:
    """Subject of the run: its robot with models and references.

    Raises InputError if a change of an uncertain input leads to an impossible robot.
    """
    robot = robot_on_path(context)
    models = judged_models_of(robot)
    statics = static_subject(robot, models.values())
    responses = statics.responses
    try:
        reference = dynamic_reference(responses)
    except UNSOLVED as error:
        reference = no_reference(error)
    stable, faults = _stability_notes(robot)
    subject = replace(
        statics,
        dynamics=reference,
        modal_steps=_steps_by_model(
            modal_steps(robot, models["beam"], models["segments"]), lambda model: model.modal_steps
        ),
        notes=(*_notes(robot), *stable, *_assumption_notes(responses, reference)),
        faults=faults,
        parts=tuple(
            leg_subject(context, name, leg_of(robot.mechanism.bodies[name]))
            for name in distinct_legs(robot.mechanism)
        ),
        formulation=_constant_section_subject(robot, models),
    )
    return replace(subject, inputs=_input_uncertainties(subject))


def _input_uncertainties(subject: Subject) -> InputUncertainties | None:
    """Uncertain inputs of a robot. None if its file has none or there is no reference.

    Raises InputError if a change of an input leads to an impossible robot.
    """
    responses = subject.responses
    context = responses.robot.context
    relative = context.robot_file.uncertain_inputs
    if not relative or subject.statics.model is None:
        return None
    points = scipy.stats.qmc.Sobol(len(relative), seed=1).random(_CHECKS[context.preset])
    inputs = InputUncertainties(relative, scipy.special.ndtri(points))
    for factors in (*inputs.alone(-1), *inputs.alone(1), *inputs.together):
        responses.perturbed(replace(NOMINAL, factors=factors))
    return inputs


def static_subject(robot: RobotOnPath, models: Iterable[Model]) -> Subject:
    """Subject of a robot with the reference for statics only.

    If a leg cannot be modelled as a solid, the subject contains the reason instead of a reference.
    """
    responses, steps = Responses(robot), {}
    try:
        reference, steps = static_reference(responses), static_steps(robot)
    except UNSOLVED as error:
        reference = no_reference(error)
    return replace(
        subject_of(responses, models, statics=reference),
        static_steps=_steps_by_model(steps, lambda model: model.static_steps),
        loads=load_quantities([load.name for load in robot.mechanism.loads]),
        harmonics=response_quantities(robot.mechanism.judged_responses),
    )


def _steps_by_model(
    steps: Mapping[str, Step], names_of: Callable[[JudgedModel], Sequence[str]]
) -> Steps:
    """Steps that remove the errors of a model one by one, in order from the model to the reference.

    Keys are the names of the judged models. `steps`: steps that exist for the robot, by name.
    `names_of` returns the names of the steps of a judged model.
    """
    return {
        name: tuple(steps[step] for step in names_of(model) if step in steps)
        for name, model in JUDGED.items()
    }


def subject_of(
    responses: Responses,
    models: Iterable[Model],
    statics: Reference = _NO_REFERENCE,
    dynamics: Reference = _NO_REFERENCE,
) -> Subject:
    """Subject of the robot of `responses`: its models with the references that are compared."""
    robot = responses.robot
    return Subject(
        robot=robot.mechanism.name,
        coordinates=coordinates(robot.mechanism),
        poses=np.array([posture.pose for posture in robot.postures]),
        responses=responses,
        models=tuple(models),
        statics=statics,
        dynamics=dynamics,
    )


def _without_modes(models: Iterable[Model]) -> list[Model]:
    """Copies of the models without their modes, for a subject that is judged in statics only.

    `undefined_reason` becomes "" for a model that defines statics, because its missing modes are
    intended.
    """
    return [
        replace(
            model,
            modes=None,
            undefined_reason=model.undefined_reason if model.statics is None else "",
        )
        for model in models
    ]


def _constant_section_subject(robot: RobotOnPath, models: Mapping[str, Model]) -> Subject | None:
    """Subject for models of legs of constant section: the robot with prisms as its legs.

    Each leg specified by its 6×6 compliance is replaced by its equivalent prism, which is a solid
    in the reference. None if there is no such leg, or if the robot has CAD parts, whose
    idealisation would be part of the error.
    """
    if not robot.given or robot.mechanism.parts:
        return None
    mechanism = on_equivalent_legs(robot.mechanism)
    postures = [replace(posture, mechanism=mechanism) for posture in robot.postures]
    # Model and reference share the same legs, feet and tool, so digits cause no uncertainty.
    on_solids = replace(robot_at(robot.context, postures), printed=())
    constant_section_models = [model for name, model in models.items() if name not in LEGS_AS_GIVEN]
    return replace(
        static_subject(on_solids, _without_modes(constant_section_models)), robot="equivalent legs"
    )


def leg_subject(context: Context, name: str, shape: Leg) -> Subject:
    """Subject of one leg alone, clamped at its root, with the statics of its models."""
    leg = robot_at(context, [reference_posture(clamped_leg(name, shape))])
    left_out = _NOT_FOR_A_LEG if leg.given else (*_NOT_FOR_A_LEG, "vjm-equivalent")
    recipes = {name: recipe for name, recipe in JUDGED.items() if name not in left_out}
    subject = static_subject(leg, _without_modes(judged_models_of(leg, recipes).values()))
    if subject.statics.model is None:
        return subject
    title = "specified 6×6 compliance of the leg" if leg.given else "solid leg with clamped root"
    return replace(subject, statics=replace(subject.statics, title=title))


def _notes(robot: RobotOnPath) -> list[str]:
    """Notes on omitted poses, idle mobilities and the error of reduced CAD parts."""
    notes = []
    if len(robot.postures) < len(robot.mechanism.poses):
        all_poses = len(robot.mechanism.poses)
        notes.append(f"{len(robot.postures)} of the {all_poses} poses of the path were computed")
    if idle := mobility(robot.postures[0]).idle:
        counted_mobilities = counted(idle, "idle mobility does", "idle mobilities do")
        notes.append(
            f"{counted_mobilities} not move the tool; the corresponding zero frequencies are "
            "omitted"
        )
    notes += [
        f"Load {load.name} is not compared in {counted(count, 'pose', 'poses')} of "
        f"{len(robot.postures)}: the tool cannot move there as the load requires"
        for load in robot.mechanism.loads
        if (count := impossible_poses(robot.postures, load))
    ]
    with suppress(*UNSOLVED):
        notes += reduction_note(
            robot.postures, robot.computed_count, robot.holding.first, robot.judged_count
        )
    return notes


def _stability_notes(robot: RobotOnPath) -> tuple[Sequence[str], tuple[str, ...]]:
    """Notes on stability under the robot's loads, and names of the computations that failed."""
    subject = "stability under loads"
    try:
        results = robot.context.get(stabilities, "links", robot.postures)
        requirement = robot.context.robot_file.requirement
        return stability_notes(robot.postures, results, requirement), ()
    except Exception as error:  # noqa: BLE001  loses no model, only its note
        reason = failure_reason(subject, error)
        faults = () if isinstance(error, UNSOLVED) else (subject,)
        return [f"Stability under the robot's loads cannot be computed: {reason}"], faults


def _assumption_notes(responses: Responses, dynamics: Reference) -> list[str]:
    """Notes on assumptions behind probabilities and behind verdicts on frequencies."""
    notes = []
    if assumed := responses.robot.context.robot_file.supposed:
        notes.append(
            "Probabilities assume that every modulus, length and stiffness of the robot "
            f"file has a standard uncertainty of {100.0 * assumed:g} %"
        )
    return [*notes, *mass_notes(responses, dynamics)]
