"""The answer of the tool to a force that swings: its size and its phase, by all models."""

from functools import partial

import numpy as np

from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.compared import answering_modes
from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.response import UNSOLVED
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import Chart, Panel, Series, degrees, octaves, powers
from validation.exhibits import PATH, PlannedFigure
from validation.report.declared import FigureGroup, Shown, curves
from validation.solids.legs import SHARED_SOLIDS

# Of a size that is known to no digit the band ends at this part of it: a logarithm has no zero.
_LEAST = 0.01


def figures(mechanism: Mechanism) -> tuple[PlannedFigure, ...]:
    """A figure for each response that is asked for."""
    group = FigureGroup(PATH, SHARED_SOLIDS)
    for number, one in enumerate(mechanism.excitations):
        named = f"mechanism.response.{one.name}", f"Response of the tool: {one.name}"
        group.figure(*named, effort=3.0)(partial(_response, number=number))
    return group()


def _response(context: Context, number: int) -> Shown:
    """Size and phase over the frequency, in the middle of the path; the reference with its band."""
    robot = robot_on_path(context)
    asked, at = robot.mechanism.excitations[number], len(robot.postures) // 2
    try:
        found = {
            name: own
            for name, one in answering_modes(robot).items()
            # Models that are rigid along the force have neither size nor phase.
            if (own := one.receptances[number][at]).any()
        }
        reference = dynamic_reference(robot)
    except UNSOLVED as error:
        raise Skip(str(error)) from error
    bands = []
    for one in reference.alternatives:
        if one.response.vibration is not None and one.responses is not None:
            known = one.response.vibration.receptances[number][at]
            left_open = np.outer([-1.0, 1.0], one.responses.receptances[number][at])
            bands.append(np.abs(known) * np.maximum(1.0 + left_open, _LEAST))
            found.setdefault(_REFERENCE, known)
    band = np.array([np.min(bands, axis=0)[0], np.max(bands, axis=0)[1]]) if bands else None
    x, size, phase = asked.frequencies, "size (m/N)", "phase (°)"
    sizes = [
        Series(name, x, np.abs(one), size, left_open=band if name == _REFERENCE else None)
        for name, one in found.items()
    ]
    # From 0 to −180°: no force takes energy from where it acts.
    phases = [
        Series(name, x, np.degrees(np.angle(1j * one)) - 90.0, phase) for name, one in found.items()
    ]
    panels = [Panel(sizes, size, scale=powers), Panel(phases, phase, scale=degrees)]
    force = ", ".join(f"{one:.3g}" for one in asked.direction)
    place = shown_pose(robot.mechanism, robot.postures[at].pose)
    return curves(
        Chart(panels, _FREQUENCY, 2, 3.0, {_FREQUENCY: x.tolist()}, octaves),
        f"Displacement of the loaded point along a force of 1 N along ({force})"
        f"{place and f', with the tool at {place}'}. Solid: {reference.title}; shaded, what it "
        "leaves open.",
    )


_REFERENCE, _FREQUENCY = "solid", "frequency (Hz)"
