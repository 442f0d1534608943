"""Figures that a robot file requests: forces under loads, responses, and a measured response.

Input: a robot file with loads, harmonic forces or a modal test, and the context of a run. Output:
planned figures of forces and stresses by beams over the path, and of receptances by all models over
frequency, with the uncertainty band of the reference.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from lumped.arrays import Array, ComplexArray
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from validation.adequacy.judged_models import judged_models
from validation.adequacy.posture_errors import solved_modes
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import (
    Chart,
    Panel,
    Scale,
    Series,
    degrees,
    octaves,
    powers,
    round_angles,
)
from validation.drawing.figures import FigureGroup
from validation.forces.analysis import forces_in
from validation.kinematics.poses import postures_on_path
from validation.measured.modes import modal_prediction
from validation.models.options import ModelOptions
from validation.references.modal_reference import dynamic_reference
from validation.references.responses import UNSOLVED, Responses
from validation.references.robot_on_path import robot_at, robot_on_path
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.studies_and_figures import PATH, PlannedFigure
from validation.verdicts import MEASURED_RESPONSE

# Smallest ratio of the lower end of an uncertainty band to the magnitude, since a logarithmic axis
# has no zero.
_LOWEST_SHARE = 0.01
# Ratio of the highest drawn frequency to the highest frequency of the measured modes.
_FREQUENCY_FACTOR = 1.2
_REFERENCE, _FREQUENCY = "solid", "frequency (Hz)"
# Parts condensed on their interfaces are exact in statics, whatever their number of interfaces.
_OPTIONS = ModelOptions(parts="condensed")


def figures(robot_file: RobotFile) -> tuple[PlannedFigure, ...]:
    """Planned figures: one for each load and response, and one of a measured response if any."""
    mechanism, forces, measured = robot_file.mechanism, FigureGroup(PATH, ""), FigureGroup(PATH, "")
    responses = FigureGroup(PATH, SHARED_SOLIDS)
    # In a single pose the figure shows section forces along legs.
    is_drawn = len(mechanism.poses) > 1 or bool(legs_of(mechanism))
    for load in mechanism.loads if is_drawn else ():
        identity = f"mechanism.forces.{load.name}", f"Forces and stresses: {load.name}"
        forces.figure(*identity)(partial(_forces, load=load.name))
    for number, excitation in enumerate(mechanism.excitations):
        identity = (
            f"mechanism.response.{excitation.name}",
            f"{'Response of the tool' if excitation.is_direct else 'Response'}: {excitation.name}",
        )
        responses.figure(*identity, effort=3.0)(partial(_response, number=number))
    if any(value.response is not None for value in robot_file.measured):
        title = "Measured response and responses of the models"
        measured.figure(MEASURED_RESPONSE, title, effort=2.0)(_measured)
    return (*forces(), *responses(), *measured())


def _measured(context: Context) -> Chart:
    robot_file, robot = context.robot_file, context.robot_file.mechanism
    value = next(value for value in robot_file.measured if value.response is not None)
    test, number = value.test, value.response
    if test is None or number is None:
        raise Skip("the modal test has no measured response")
    measured = test.responses[number]
    x = measured.frequencies[measured.frequencies <= _FREQUENCY_FACTOR * test.frequencies.max()]
    receptances = {"measured response": measured.receptance[: len(x)]}
    for name, model in judged_models(robot).items():
        responses = modal_prediction(model.kind, robot, test, model.options).responses
        if responses and (receptance := responses[number].receptance(x)).any():
            receptances[name] = receptance
    pose = shown_pose(robot, np.array(test.pose))
    return _chart(x, receptances, round_angles).captioned(
        "Receptance of a modal test: magnitude (displacement per force, µm/N) and phase "
        "over frequency. Displacement of "
        f"{measured.name}{pose and f', with the tool at {pose}'}. Black: measured. "
        "Damping of the models: "
        f"{'that of the robot file' if robot.is_damped else 'the measured one'}. A good model "
        "has its peaks at the measured frequencies, with the measured heights.",
    )


def _chart(
    x: Array,
    receptances: Mapping[str, ComplexArray],
    phases: Scale,
    size_ranges: Mapping[str, Array] | None = None,
) -> Chart:
    """Chart of magnitude and phase (−270° to 90°) of receptances (m/N) over frequencies x (Hz).

    `size_ranges`: lowest and highest magnitude (2×n, µm/N) at each of n frequencies, by name of the
    receptance. Receptances without an uncertainty are missing. `phases`: scale of the phase axis.
    """
    size, phase, intervals = "magnitude (µm/N)", "phase (°)", size_ranges or {}
    sizes = [
        Series(name, x, 1e6 * np.abs(receptance), size, interval=intervals.get(name))
        for name, receptance in receptances.items()
    ]
    angles = [
        Series(name, x, np.degrees(np.angle(1j * receptance)) - 90.0, phase)
        for name, receptance in receptances.items()
    ]
    panels = [Panel(sizes, size, scale=powers), Panel(angles, phase, scale=phases)]
    return Chart(panels, _FREQUENCY, 2, 3.0, {_FREQUENCY: x.tolist()}, octaves)


def _response(context: Context, number: int) -> Chart:
    """Chart of response `number` (from 0) in the middle pose, with the reference's uncertainty."""
    robot = robot_on_path(context)
    responses = Responses(robot)
    excitation, middle = robot.mechanism.excitations[number], len(robot.postures) // 2
    try:
        receptances_by_model = {
            name: receptances
            for name, modes in solved_modes(responses).items()
            # Models that are rigid along the force have neither magnitude nor phase.
            if (receptances := modes.receptances[number][middle]).any()
        }
        reference = dynamic_reference(responses)
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    bands = []
    for interpretation in reference.interpretations:
        modes = reference.model and responses.known_modes(reference.model, interpretation.reading)
        if modes:
            receptance = modes.receptances[number][middle]
            half_widths = sum(
                source.receptances[number][middle] for source in interpretation.budget.values()
            )
            half_width_range = np.outer([-1.0, 1.0], half_widths)
            bands.append(
                1e6 * np.abs(receptance) * np.maximum(1.0 + half_width_range, _LOWEST_SHARE)
            )
            receptances_by_model.setdefault(_REFERENCE, receptance)
    band = np.array([np.min(bands, axis=0)[0], np.max(bands, axis=0)[1]]) if bands else None
    force, motion = (
        ", ".join(f"{component:.3g}" for component in direction)
        for direction in (excitation.direction, excitation.displacement_direction)
    )
    loaded, moved = (
        "the loaded point" if point is None else f"{point[1]} of {point[0]}"
        for point in (excitation.loaded, excitation.moved)
    )
    where = (
        f"{loaded} along a harmonic force of 1 N in the direction ({force})"
        if excitation.is_direct
        else f"{moved} in the direction ({motion}) under a harmonic force of 1 N on {loaded} in "
        f"the direction ({force})"
    )
    pose = shown_pose(robot.mechanism, robot.postures[middle].pose)
    # Phases of the loaded point along the force lie between 0 and −180°: a force takes no energy
    # from its own point of application.
    phases = degrees if excitation.is_driving_point else round_angles
    shaded = {} if band is None else {_REFERENCE: band}
    return _chart(excitation.frequencies, receptances_by_model, phases, shaded).captioned(
        "Receptance: magnitude (displacement per force, µm/N) and phase over frequency. "
        f"Displacement of {where}{pose and f', with the tool at {pose}'}. "
        f"Solid: {reference.title}. "
        "Shaded: range of the reference over the data that the robot file leaves open, "
        "with its uncertainty. A model agrees with the reference if its curve lies in "
        "the shaded range.",
    )


def _forces(context: Context, load: str) -> Chart:
    mechanism = context.robot_file.mechanism
    loads = tuple(item for item in mechanism.loads if item.name == load)
    postures = postures_on_path(replace(mechanism, loads=loads), mechanism.poses)
    result = forces_in(robot_at(context, postures), "beam", _OPTIONS, part_meshes=False)
    if all(pose.loads[load] is None for pose in result.poses):
        raise Skip("the mechanism cannot move as the load requires")
    return result.chart(load)
