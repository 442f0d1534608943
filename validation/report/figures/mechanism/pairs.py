"""Which mode of each model is which of the reference, and how alike their shapes are."""

import numpy as np

from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.mechanism.vibration import modes_by_model
from validation.adequacy.partners import partners
from validation.adequacy.response import Vibration
from validation.agreement.mode_pairing import mac_matrix
from validation.case import Skip
from validation.context import Context
from validation.drawing.charts.chart import Chart, Column, Panel, Series
from validation.exhibits import MODES
from validation.models.options import DEFAULT_OPTIONS, ModelName
from validation.report.figures.declared import FigureGroup, Shown, curves
from validation.solids.legs import SHARED_SOLIDS

_MODELS: tuple[ModelName, ...] = ("beam", "segments")
figures = FigureGroup(MODES, SHARED_SOLIDS)


@figures.figure("mechanism.pairs", "Modes paired by shape with those of the reference", effort=2.0)
def pairs(context: Context) -> Shown:
    """MAC of beams and segments with the reference, and by how much paired frequencies differ."""
    robot = robot_on_path(context)
    weights, reference = robot.samples.weights, dynamic_reference(robot)
    held = next(iter(reference.alternatives), None)
    if held is None or held.response.vibration is None:
        raise Skip(f"there is no reference of the frequencies: {reference.decides}")
    truth = held.response.vibration
    first = _middle(truth)
    shown = first.frequencies.shape[1]
    models = {
        name: _middle(modes)
        for name in _MODELS
        if (modes := modes_by_model(robot, name, DEFAULT_OPTIONS))
    }
    numbers = np.arange(1.0, shown + 1.0)
    columns: dict[str, Column] = {
        "mode": numbers.tolist(),
        "reference (Hz)": first.frequencies[0].tolist(),
    }
    panels: list[Panel] = []
    changes: list[Series] = []
    for name, model in models.items():
        mac = mac_matrix(first.samples[0], model.samples[0], weights)
        label = "" if panels else "mode of the reference"
        panels.append(Panel((), f"MAC with {name}", label, x_label=f"mode of {name}", matrix=mac))
        found = partners(first, model, weights, shown)
        change = 100.0 * (found.frequency[0] / first.frequencies[0] - 1.0)
        changes.append(Series(name, numbers, change))
        columns |= {
            f"{name}: partner": [float(k) + 1.0 for k in found.number[0]],
            f"{name} (Hz)": found.frequency[0].tolist(),
            f"{name}: MAC": found.likeness[0].tolist(),
        }
    panels.append(Panel(changes, "difference (%)", levels=(0.0,), staggered=False))
    return curves(
        Chart(panels, "mode of the reference", len(panels), 2.0, columns),
        f"In the middle of the path; reference: {held.name or 'solid'}. Left: modal assurance "
        "criterion (MAC), black where two shapes are equal; blocks are modes of nearly equal "
        "frequency, which may mix. Right: frequencies of paired modes; those without a partner are "
        "left out.",
    )


def _middle(found: Vibration) -> Vibration:
    """The modes in the middle pose alone, those that there are."""
    place = len(found.frequencies) // 2
    known = np.isfinite(found.frequencies[place])
    return Vibration(
        found.frequencies[place : place + 1, known], found.samples[place : place + 1][:, :, known]
    )
