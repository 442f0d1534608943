"""Chart "Convergence with mesh": errors and CPU time over unknowns, one panel each.

Input: studies of a solid leg. Output: a chart with caption and data.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Note, Panel, Series, octaves, powers
from validation.drawing.text import number
from validation.studies_and_figures import Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Errors (%) below this are round-off and are not drawn.
_LOWEST = 1e-7
# Smallest number of meshes that shows an order of convergence.
GRIDS = 4
# Notes at the ends of curves are stacked at a distance of _LINE (pt) if the last values of the
# curves differ by less than the factor _NEAR.
_NEAR, _LINE = 2.0, 9.0


def mesh_curves(studies: Sequence[Study]) -> Chart:
    """Chart with a panel for each quantity of the studies: relative errors over unknowns.

    Errors are relative to the extrapolated limits. A quantity without a formal order, such as CPU
    time, is drawn as its values.
    """
    formal = {study.variant: study.formal_order for study in studies if study.formal_order}
    titles = list(dict.fromkeys(study.panel for study in studies))
    panels = [
        _panel([study for study in studies if study.panel == title], formal) for title in titles
    ]
    rows = [(study, index) for study in studies for index in range(len(study.x))]
    table: dict[str, Column] = {
        "quantity": [study.panel for study, _ in rows],
        "mesh": [study.variant for study, _ in rows],
        "unknowns": [study.x[index] for study, index in rows],
        "value": [_values(study)[index] for study, index in rows],
        "unit": [study.unit for study, _ in rows],
        "error (%)": [_error(study, index) for study, index in rows],
    }
    chart = Chart(panels, studies[0].x_label, min(2, len(panels)), 2.0, table)
    limits = "; ".join(_limit(study) for study in studies if study.limits)
    return chart.captioned(
        "Error panels: size of the relative error of one quantity, |value − "
        "limit|/limit, over the number of unknowns of the mesh; the limit is "
        "extrapolated from the hexahedral meshes. Bar: half-width of the uncertainty of "
        "the finest value; it covers the limit if it is at least as large as the error. "
        "Cost panel: CPU time for mesh, factorisation and modes. Held ends: end faces "
        "kept plane and rigid. Free ends: end faces free to warp and contract. "
        "Deflections and torsion are computed with thinner slices along the leg, hence "
        "with more unknowns. On logarithmic scales a straight line with the slope of "
        "the formal order shows asymptotic convergence. Limits, half-widths and observed "
        f"orders: {limits}.",
        *_without_order(studies),
    )


def _without_order(studies: Sequence[Study]) -> list[str]:
    """Sentence on quantities with too few meshes for an order of convergence, with a remedy.

    [] if there are no such quantities.
    """
    meshes: dict[str, int] = {}
    for study in studies:
        if study.formal_order:
            meshes[study.panel] = max(meshes.get(study.panel, 0), len(study.x))
    panels_without_order = [panel for panel, count in meshes.items() if count < GRIDS]
    if not panels_without_order:
        return []
    return [
        (
            f"{', '.join(panels_without_order)}: this preset has fewer than {GRIDS} meshes, "
            "too few to observe an order. To observe the orders of f1 to f4: flexproof "
            "converge ROBOT --body LEG --model solid."
        )
    ]


def _panel(studies: Sequence[Study], formal: Mapping[str, float]) -> Panel:
    curves, ends = [], []
    for study in studies:
        x, sizes = np.array(study.x), _sizes(study)
        order = f" (formal order {formal[study.variant]:.3g})" if study.variant in formal else ""
        bars = None
        if study.formal_order and np.isfinite(sizes[-1]):
            bars = _bar(study, sizes)
        curves.append(Series(f"{study.variant}{order}", x, sizes, of=study.variant, bars=bars))
        visible = np.flatnonzero(np.isfinite(sizes))
        if study.formal_order and len(visible) and len(study.x) >= GRIDS:
            last = int(visible[-1])
            ends.append((float(sizes[last]), float(x[last]), _order(study)))
    unit = "|error| (%)" if studies[0].formal_order else studies[0].y_label
    return Panel(curves, studies[0].panel, unit, _logarithmic, notes=_notes(ends), staggered=False)


def _logarithmic(axes: "Axes") -> None:
    octaves(axes)
    powers(axes)


def _values(study: Study) -> tuple[float, ...]:
    return study.series[study.variant]


def _error(study: Study, index: int) -> float | None:
    """Relative error in per cent of value number `index` of a study against the study's limit.

    None if the study has no limit.
    """
    limit = study.limits.get(study.variant)
    return None if limit is None else 100.0 * (_values(study)[index] / limit - 1.0)


def _sizes(study: Study) -> Array:
    """Magnitudes (n, per cent) of the errors on n meshes. NaN for an error below round-off.

    If the study has no formal order, its values are returned instead, in their unit.
    """
    if not study.formal_order:
        return np.array(_values(study))
    errors = [_error(study, index) for index in range(len(study.x))]
    sizes = np.array([np.nan if error is None else abs(error) for error in errors])
    sizes[sizes < _LOWEST] = np.nan
    return sizes


def _bar(study: Study, sizes: Array) -> Array | None:
    """Lengths (2×n, down and up, per cent) of the error bars at n errors `sizes`.

    The bar at the last error, which belongs to the finest mesh, is the half-width of its
    uncertainty. Downwards it is limited to 90 % of the error. The other lengths are NaN. None if
    the half-width is unknown.
    """
    width = study.uncertainties.get(study.variant)
    if width is None:
        return None
    bars = np.full((2, len(sizes)), np.nan)
    up = 100.0 * width / abs(study.limits[study.variant])
    # A half-width larger than the error would reach below any logarithmic axis.
    bars[:, -1] = min(up, 0.9 * sizes[-1]), up
    return bars


def _order(study: Study) -> str:
    order = study.orders.get(study.variant)
    if order is not None:
        return f"order {order:.2f}"
    return f"{len(study.x)} meshes" if len(study.x) < GRIDS else "no order"


def _limit(study: Study) -> str:
    """Text with limit, half-width and observed order of convergence of one study."""
    width = study.uncertainties.get(study.variant)
    spread = "" if width is None else f" ± {number(width, 2)}"
    value = number(study.limits[study.variant], 6)
    return f"{study.panel}, {study.variant}: {value}{spread} {study.unit}, {_order(study)}"


def _notes(ends: Sequence[tuple[float, float, str]]) -> list[Note]:
    """Notes with orders of convergence at the `ends` of curves, stacked if close to each other.

    An element of `ends` consists of the last error (per cent), its number of unknowns, and the text
    of the note.
    """
    notes: list[Note] = []
    height, last = -3.0, 0.0
    for size, count, text in sorted(ends):
        height = height + _LINE if size < _NEAR * last else -3.0
        notes.append(Note(text, count, size, (5.0, height)))
        last = size
    return notes
