"""Which mode of each model is which of the reference, and how alike their shapes are."""

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.adequacy.mechanism.dynamics import dynamic_reference
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.mechanism.vibration import modes_by_model
from validation.adequacy.partners import partners
from validation.adequacy.response import Vibration
from validation.agreement.mode_pairing import mac_matrix
from validation.case import Skip
from validation.context import Context
from validation.drawing.style import LOOKS, canvas, csv_of, plot_style, svg_of
from validation.exhibits import PATH
from validation.models.options import DEFAULT_OPTIONS, ModelName
from validation.report.figures.declared import FigureGroup, Shown
from validation.solids.robots import SHARED_SOLIDS

_MODELS: tuple[ModelName, ...] = ("beam", "segments")
figures = FigureGroup(PATH, SHARED_SOLIDS)


@figures.figure("mechanism.pairs", "Modes paired by shape with the reference's", effort=2.0)
def pairs(context: Context) -> Shown:
    """MAC of beams and segments with the reference, and by how much paired frequencies differ."""
    robot = robot_on_path(context)
    weights, reference = robot.samples.weights, dynamic_reference(robot)
    held = next(iter(reference.alternatives), None)
    if held is None or held.response.vibration is None:
        raise Skip(f"there is no reference of the frequencies: {reference.decides}")
    truth = held.response.vibration
    first = _middle(truth)
    shown = min(robot.offered, truth.frequencies.shape[1])
    models = {
        name: _middle(modes)
        for name in _MODELS
        if (modes := modes_by_model(robot, name, DEFAULT_OPTIONS))
    }
    columns: dict[str, list[float]] = {
        "mode": [float(k) for k in range(1, shown + 1)],
        "reference (Hz)": first.frequencies[0, :shown].tolist(),
    }
    with plot_style():
        drawn, (left, middle, right) = canvas(1, 3, 3.3)
        for axes, (name, model) in zip((left, middle), models.items(), strict=True):
            mac = mac_matrix(first.samples[0][:, :shown], model.samples[0], weights)
            _matrix(axes, mac, name)
            found = partners(first, model, weights, shown)
            change = 100.0 * (found.frequency[0] / first.frequencies[0, :shown] - 1.0)
            look = LOOKS[name]
            right.plot(columns["mode"], change, label=name, linewidth=0.8, **look.options())
            columns |= {
                f"{name}: partner": [float(k) + 1.0 for k in found.number[0]],
                f"{name} (Hz)": found.frequency[0].tolist(),
                f"{name}: MAC": found.likeness[0].tolist(),
            }
        left.set_ylabel("mode of the reference")
        right.axhline(0.0, color="#999999", linewidth=0.8)
        right.set(title="difference (%)", xlabel="mode of the reference")
        right.legend(loc="best")
        svg = svg_of(drawn)
    return Shown(
        f"In the middle of the path, reference: {held.name}. Left: modal assurance "
        "criterion, dark where two shapes are one; blocks are modes of almost one frequency, of "
        "which any mixture is a mode. Right: frequencies of partners; a mode without one is left "
        "out.",
        svg,
        data=csv_of(columns),
    )


def _middle(found: Vibration) -> Vibration:
    """The modes in the middle pose alone, those that there are."""
    place = len(found.frequencies) // 2
    known = np.isfinite(found.frequencies[place])
    return Vibration(
        found.frequencies[place : place + 1, known], found.samples[place : place + 1][:, :, known]
    )


def _matrix(axes: Axes, mac: Array, name: str) -> None:
    rows, columns = mac.shape
    axes.pcolormesh(
        np.arange(columns + 1) + 0.5,
        np.arange(rows + 1) + 0.5,
        mac,
        cmap="Greys",
        vmin=0.0,
        vmax=1.0,
    )
    axes.set(title=f"MAC with {name}", xlabel=f"mode of {name}", aspect="equal")
    axes.grid(visible=False)
    axes.invert_yaxis()
