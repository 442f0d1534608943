"""How the error of a leg's bending frequencies falls with the number of elements."""

from functools import partial

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.agreement.convergence import order_of_errors
from validation.context import Context
from validation.drawing.chart import Chart, Note, Panel, Series
from validation.drawing.scales import power_ticks
from validation.drawing.style import LOOKS
from validation.exhibits import ELEMENTS
from validation.models.legs import constant_leg_of
from validation.report.figures.declared import FigureGroup, Shown, curves
from validation.studies.element_refinement import (
    COUNTS,
    MODES,
    element_frequencies,
    exact_frequencies,
)

# The element counts between which the order shows: below, higher terms count; above, rounding.
FITTED = {"literal": (10, 160), "half": (10, 160), "beam": (10, 40)}
_NAMES = {
    "literal": "segments, springs between elements only",
    "half": "segments, half springs at the ends",
    "beam": "beam FE",
}
_LOOKS = {
    "literal": LOOKS["segments-literal"],
    "half": LOOKS["segments"],
    "beam": LOOKS["beam"],
}
figures = FigureGroup(ELEMENTS, "figures.refinement")


@figures.figure(
    "refinement.elements",
    "Error of the first three bending frequencies against the number of elements",
    effort=3.0,
    subject="program",
)
def convergence_on_elements(context: Context) -> Shown:
    """A row of panels for each leg, a column for each mode, both axes logarithmic."""
    counts = np.array(COUNTS[context.preset])
    panels = []
    for number in (1, 2):
        errors = {name: 100.0 * _errors(context, number, name) for name in _NAMES}
        panels += [
            Panel(
                [
                    Series(label, counts, errors[name][:, mode], _LOOKS[name], quantity=of_mode)
                    for name, label in _NAMES.items()
                ],
                f"leg {number}, bending mode {mode + 1}",
                "" if mode else "|error of the frequency| (%)",
                partial(_counted, counts=counts),
                notes=[
                    Note(
                        f"order {fitted_order(counts, found[:, mode], *FITTED[name]):.2f}",
                        float(counts[-1]),
                        float(found[-1, mode]),
                        colour=_LOOKS[name].colour,
                        boxed=True,
                    )
                    for name, found in errors.items()
                ],
                levels=(1.0,),
                place=f"leg {number}",
                staggered=False,
            )
            for mode in range(MODES)
            for of_mode in [f"error of frequency {mode + 1} (%)"]
        ]
    table = {"elements": counts.tolist()}
    return curves(
        Chart(panels, "elements in the leg", MODES, 2.8, abscissa=table),
        _caption(context, counts),
    )


def _counted(axes: Axes, *, counts: Array) -> None:
    """Logarithmic axes, element counts as ticks, room for what is written at the curves' ends."""
    axes.set(xscale="log", yscale="log")
    power_ticks(axes.yaxis)
    axes.set_xticks(counts, [f"{count}" for count in counts])
    axes.minorticks_off()
    axes.set_xlim(counts[0] / 1.15, counts[-1] * 2.6)


def fitted_order(counts: Array, errors: Array, first: int, last: int) -> float:
    """Order of the errors between `first` and `last` elements, least squares in logarithms."""
    used = (counts >= first) & (counts <= last)
    return order_of_errors(1.0 / counts[used], errors[used])


def _errors(context: Context, number: int, name: str) -> Array:
    leg = constant_leg_of(context, f"leg{number}")
    found = context.get(element_frequencies, leg, name, COUNTS[context.preset])
    return np.abs(found / context.get(exact_frequencies, leg) - 1.0)


def _caption(context: Context, counts: Array) -> str:
    at = int(np.flatnonzero(counts == 20)[0])
    half, literal = (100.0 * _errors(context, 1, name)[at] for name in ("half", "literal"))
    return (
        "Bending y, clamped leg, against the exact Timoshenko beam; the number at "
        "the end of a curve is its observed order, the grey line is 1 %. With 20 elements and "
        f"half springs at both ends leg 1 is off by {half[0]:.2f}, {half[1]:.2f} and "
        f"{half[2]:.2f} % (order two); with springs between the elements alone, as the text of "
        f"the paper reads, by {literal[0]:.1f} % in the first mode (order one): a length L/n of "
        "the leg is then rigid. Beam elements are of order four until rounding takes over."
    )
