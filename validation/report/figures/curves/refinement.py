"""How the error of a leg's bending frequencies falls with the number of elements."""

import numpy as np

from lumped.arrays import Array
from validation.agreement.convergence import order_of_errors
from validation.context import Context
from validation.drawing.style import (
    MODELS,
    PURPLE,
    Look,
    canvas,
    csv_of,
    plot_style,
    power_ticks,
    svg_of,
)
from validation.exhibits import ELEMENTS, Drawing, Figure
from validation.models.legs import constant_leg_of
from validation.report.figures.curves.lines import legend_above
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
_LOOKS = {"literal": Look(PURPLE, "X", ":"), "half": MODELS["segments"], "beam": MODELS["beam"]}
_ID = "refinement.elements"
_TITLE = "Error of the first three bending frequencies against the number of elements"


def drawings() -> tuple[Drawing, ...]:
    """The convergence on the number of elements, both legs."""
    return (
        Drawing(
            _ID,
            _TITLE,
            convergence_on_elements,
            section=ELEMENTS,
            group="figures.refinement",
            effort=3.0,
            subject="program",
        ),
    )


def convergence_on_elements(context: Context) -> Figure:
    """A row of panels for each leg, a column for each mode, both axes logarithmic."""
    counts = np.array(COUNTS[context.preset])
    columns: dict[str, list[float]] = {"elements": counts.tolist()}
    with plot_style():
        picture, panels = canvas(rows=2, columns=MODES, height=6.4)
        for number, row in zip((1, 2), (panels[:MODES], panels[MODES:]), strict=True):
            for name, label in _NAMES.items():
                errors = _errors(context, number, name)
                for mode, axes in enumerate(row):
                    order = fitted_order(counts, errors[:, mode], *FITTED[name])
                    axes.loglog(
                        counts,
                        100.0 * errors[:, mode],
                        label=label,
                        **_LOOKS[name].options(),
                    )
                    axes.annotate(
                        f"order {order:.2f}",
                        (counts[-1], 100.0 * errors[-1, mode]),
                        xytext=(5.0, -3.0),
                        textcoords="offset points",
                        color=_LOOKS[name].colour,
                        fontsize=8.0,
                        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
                    )
                    columns[f"leg {number}, {label}: error of frequency {mode + 1} (%)"] = (
                        100.0 * errors[:, mode]
                    ).tolist()
            for mode, axes in enumerate(row):
                axes.axhline(1.0, color="#999999", linewidth=1.0)
                axes.set_title(f"leg {number}, bending mode {mode + 1}")
                axes.set_xticks(counts, [f"{count}" for count in counts])
                power_ticks(axes.yaxis)
                axes.minorticks_off()
                axes.set_xlim(counts[0] / 1.15, counts[-1] * 2.6)
            row[0].set_ylabel("|error of the frequency| (%)")
        for axes in panels[MODES:]:
            axes.set_xlabel("elements in the leg")
        legend_above(picture)
        svg = svg_of(picture)
    return Figure(
        id=_ID,
        title=_TITLE,
        caption=_caption(context, counts),
        section=ELEMENTS,
        svg=svg,
        data=csv_of(columns),
    )


def fitted_order(counts: Array, errors: Array, first: int, last: int) -> float:
    """Order of the errors between `first` and `last` elements, least squares in logarithms."""
    used = (counts >= first) & (counts <= last)
    return order_of_errors(1.0 / counts[used], errors[used])


def _errors(context: Context, number: int, name: str) -> Array:
    leg = constant_leg_of(context, number)
    found = context.get(element_frequencies, leg, name, COUNTS[context.preset])
    return np.abs(found / context.get(exact_frequencies, leg) - 1.0)


def _caption(context: Context, counts: Array) -> str:
    at = int(np.flatnonzero(counts == 20)[0])
    half, literal = (100.0 * _errors(context, 1, name)[at] for name in ("half", "literal"))
    return (
        "Bending out of the plane, clamped leg, against the exact Timoshenko beam; the number at "
        "the end of a curve is its observed order, the grey line is 1 %. With 20 elements and "
        f"half springs at both ends leg 1 is off by {half[0]:.2f}, {half[1]:.2f} and "
        f"{half[2]:.2f} % (order two); with springs between the elements alone, as the text of "
        f"the paper reads, by {literal[0]:.1f} % in the first mode (order one): a length L/n of "
        "the leg is then rigid. Beam elements are of order four until rounding takes over."
    )
