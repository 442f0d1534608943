"""Plot of one model's deflections and natural frequencies, over the poses if there are several."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from lumped.arrays import Array
from validation.drawing.chart import Bars, Chart, Panel, Series, few_ticks, from_zero
from validation.drawing.plot import drawn_chart
from validation.drawing.style import plot_style

DEFLECTION = "deflection along a force of 1000 N (µm)"
FREQUENCY = "natural frequency (Hz)"


def solution_plot(places: Sequence[str], deflections: Array, frequencies: Array) -> Figure:
    """Bars for a single place, curves over the number of the pose for several.

    `deflections` (p×3, or p×2 in the plane; µm) and `frequencies` (p×m, Hz, NaN for a missing
    mode) belong to `places` (p). Without modes there is no panel of frequencies.
    """
    quantities = [(DEFLECTION, ["x", "y", "z"][: deflections.shape[1]], deflections)]
    if frequencies.shape[1]:
        names = [f"f{mode}" for mode in range(1, frequencies.shape[1] + 1)]
        quantities.append((FREQUENCY, names, frequencies))
    if len(places) == 1:
        panels = [
            Panel(title=title, bars=[Bars(places[0], values[0])], names=names)
            for title, names, values in quantities
        ]
        chart = Chart(panels, "", columns=len(panels), high=2.2)
    else:
        poses = np.arange(1.0, len(places) + 1.0)
        panels = [
            Panel(
                [Series(name, poses, values[:, k]) for k, name in enumerate(names)],
                title,
                scale=from_zero,
                staggered=False,
            )
            for title, names, values in quantities
        ]
        whole = partial(few_ticks, count=6, whole=True)
        chart = Chart(panels, "pose", columns=len(panels), high=2.2, x_scale=whole)
    with plot_style():
        return drawn_chart(chart)
