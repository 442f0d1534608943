"""The answer to a force that swings, of the tool or measured: size and phase, by all models."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from lumped.arrays import Array, ComplexArray
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import RobotFile
from validation.adequacy.compared import solved_modes
from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.models import judged_models
from validation.adequacy.responses import UNSOLVED, Responses
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
from validation.exhibits import PATH, PlannedFigure
from validation.measured.modes import modal_answer
from validation.solids.legs import SHARED_SOLIDS
from validation.verdicts import MEASURED_RESPONSE

# Of a size that is known to no digit the band ends at this part of it: a logarithm has no zero.
_LEAST = 0.01
# Frequencies up to so many times that of the highest measured mode.
_SHOWN = 1.2


def figures(mechanism: Mechanism) -> tuple[PlannedFigure, ...]:
    """A figure for each response that is asked for."""
    group = FigureGroup(PATH, SHARED_SOLIDS)
    for number, one in enumerate(mechanism.excitations):
        named = f"mechanism.response.{one.name}", f"Response of the tool: {one.name}"
        group.figure(*named, effort=3.0)(partial(_response, number=number))
    return group()


def measured_figures(robot_file: RobotFile) -> tuple[PlannedFigure, ...]:
    """The response of a modal test from which most values were read, where it has any."""
    group = FigureGroup(PATH, "")
    if any(one.response is not None for one in robot_file.measured):
        group.figure(MEASURED_RESPONSE, "Measured response, and the models'", effort=2.0)(_measured)
    return group()


def _measured(context: Context) -> Chart:
    robot_file, robot = context.robot_file, context.robot_file.mechanism
    one = next(one for one in robot_file.measured if one.response is not None)
    test, number = one.test, one.response
    if test is None or number is None:
        raise Skip("no response was measured")
    own = test.responses[number]
    x = own.frequencies[own.frequencies <= _SHOWN * test.frequencies.max()]
    found = {"measured response": own.receptance[: len(x)]}
    for name, (model, _, options) in judged_models(robot).items():
        responses = modal_answer(model, robot, test, options).responses
        if responses and (told := responses[number].receptance(x)).any():
            found[name] = told
    place = shown_pose(robot, np.array(test.pose))
    return _chart(x, found, round_angles).captioned(
        f"Displacement of {own.name}{place and f', with the tool at {place}'}; black: as measured. "
        f"Models are damped as {'the robot file says' if robot.is_damped else 'measured'}.",
    )


def _chart(
    x: Array,
    found: Mapping[str, ComplexArray],
    phases: Scale,
    left_open: Mapping[str, Array] | None = None,
) -> Chart:
    """Size and phase (from −270° to 90°) of receptances (m/N) over frequencies x (Hz).

    `left_open`: the least and largest size (2×n, µm/N) of some of them.
    """
    size, phase, open_of = "size (µm/N)", "phase (°)", left_open or {}
    sizes = [
        Series(name, x, 1e6 * np.abs(one), size, interval=open_of.get(name))
        for name, one in found.items()
    ]
    angles = [
        Series(name, x, np.degrees(np.angle(1j * one)) - 90.0, phase) for name, one in found.items()
    ]
    panels = [Panel(sizes, size, scale=powers), Panel(angles, phase, scale=phases)]
    return Chart(panels, _FREQUENCY, 2, 3.0, {_FREQUENCY: x.tolist()}, octaves)


def _response(context: Context, number: int) -> Chart:
    """Size and phase over the frequency, in the middle of the path; the reference with its band."""
    robot = robot_on_path(context)
    responses = Responses(robot)
    asked, at = robot.mechanism.excitations[number], len(robot.postures) // 2
    try:
        found = {
            name: own
            for name, one in solved_modes(responses).items()
            # Models that are rigid along the force have neither size nor phase.
            if (own := one.receptances[number][at]).any()
        }
        reference = dynamic_reference(responses)
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    bands = []
    for one in reference.interpretations:
        modes = reference.model and responses.known_modes(reference.model, one.reading)
        if modes:
            known = modes.receptances[number][at]
            half_widths = sum(of.receptances[number][at] for of in one.budget.values())
            left_open = np.outer([-1.0, 1.0], half_widths)
            bands.append(1e6 * np.abs(known) * np.maximum(1.0 + left_open, _LEAST))
            found.setdefault(_REFERENCE, known)
    band = np.array([np.min(bands, axis=0)[0], np.max(bands, axis=0)[1]]) if bands else None
    force = ", ".join(f"{one:.3g}" for one in asked.direction)
    place = shown_pose(robot.mechanism, robot.postures[at].pose)
    # Phases from 0 to −180°: no force takes energy from where it acts.
    shaded = {} if band is None else {_REFERENCE: band}
    return _chart(asked.frequencies, found, degrees, shaded).captioned(
        f"Displacement of the loaded point along a force of 1 N along ({force})"
        f"{place and f', with the tool at {place}'}. Solid: {reference.title}; shaded, what it "
        "leaves open.",
    )


_REFERENCE, _FREQUENCY = "solid", "frequency (Hz)"
