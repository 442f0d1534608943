"""The paper's Figs 3 to 13, with all models in the same axes.

Input: the paper's robot. Output: charts of deflections and natural frequencies over the stroke, and
over the relative leg length α of robots with longer legs.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias, TypeVar

import numpy as np

from lumped.arrays import Array
from validation.context import Context, Preset
from validation.drawing.chart import (
    Chart,
    Note,
    Panel,
    Scale,
    Series,
    compared,
    compared_with,
    from_zero,
    largest,
    lettered,
    plain_log,
)
from validation.drawing.figures import FigureGroup
from validation.drawing.text import percent
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.paper.robot import (
    ALPHAS,
    FIGURE_POINTS,
    LOAD,
    Deflections,
    RobotOnStroke,
    deflections,
    family,
    frequencies,
    stroke_of,
)
from validation.studies_and_figures import FAMILY, STROKE

T = TypeVar("T")
_POINT_TITLES = {"centre": "centre of the stroke", "left": "left end", "right": "right end"}
_MODES = 2
# Number of postures over the stroke.
_POSTURES: Mapping[Preset, int] = {"quick": 21, "standard": 41, "fine": 81}
# Axis of the force and direction of the deflection, by field of `Deflections`.
_LOADS = {
    "planar_x": ("x", "planar"),
    "planar_y": ("y", "planar"),
    "along_z": ("z", "along z"),
}
_FIRST, _BOTH = "first natural frequency (Hz)", "natural frequency (Hz)"
_FAMILY_CAPTION = (
    "Family of robots with legs α times as long as those of the robot; stroke and sections "
    "are unchanged."
)
stroke_figures = FigureGroup(STROKE, "paper.figures")
family_figures = FigureGroup(FAMILY, "paper.figures")


@dataclass(frozen=True)
class PlottedModel:
    """Model with its options and its label in the figures."""

    label: str
    model: ModelName
    options: ModelOptions = DEFAULT_OPTIONS


SIMPLIFIED = PlottedModel("simplified", "simplified")
VJM = PlottedModel("VJM, legs as given", "vjm")
VJM_EQUIVALENT = PlottedModel("VJM, equivalent legs", "vjm", ModelOptions(legs="equivalent"))
SEGMENTS = PlottedModel("segments", "segments")
SEGMENTS_AS_PRINTED = PlottedModel(
    "segments, eq. (25) as printed", "segments", ModelOptions(release="printed")
)
BEAM = PlottedModel("beam FE", "beam")
# Models that all use the same legs of constant section.
EQUIVALENT_LEGS = (VJM_EQUIVALENT, SEGMENTS, BEAM)


@stroke_figures.figure(
    "deflection.stroke",
    "Deflections over the stroke, all models (as the paper's Figs 3 and 5)",
    effort=1.5,
)
def all_deflections(context: Context) -> Chart:
    """Chart of deflections over the stroke, with a panel for each direction of the force.

    The deflection is that in the plane for forces along x and y, and that along z for a force along
    z.
    """
    models = (SIMPLIFIED, VJM, *EQUIVALENT_LEGS)
    x, deflection = _over_the_stroke(context, models, _deflections)
    panels = [
        _panel(deflection, x, name, "" if number else "deflection (µm)", VJM)
        for number, name in enumerate(_LOADS)
    ]
    simplified, planar = deflection[SIMPLIFIED], deflection[VJM].largest_planar
    along_z = float(deflection[VJM].along_z.max())
    difference = max(
        spread([getattr(deflection[model], name) for model in EQUIVALENT_LEGS]) for name in _LOADS
    )
    ends = simplified.planar_x[0], simplified.planar_x[-1]
    at_ends = "below 0.05" if max(ends) < 0.05 else f"{ends[0]:.1f} and {ends[1]:.1f}"
    return stroke_chart(x, lettered(panels)).captioned(
        f"Deflections of the loaded point under {LOAD:g} N over its position on the stroke. With "
        "elastic drives and rigid legs (simplified) they are at most "
        f"{simplified.largest_planar:.2f} µm; under a force along x they are {at_ends} µm at the "
        "ends of the stroke. With virtual joints and the legs as given they reach "
        f"{planar:.1f} µm in the plane, {planar / simplified.largest_planar:.1f} times as much, "
        f"and {along_z:.1f} µm along z, {along_z / planar:.1f} times the planar ones. The "
        "compliance that the simplified model neglects is therefore the larger part. With each "
        "leg replaced by its equivalent uniform beam, virtual joints, segments and beam elements "
        f"coincide (largest difference {percent(difference, signed=False)}). Their difference from "
        "virtual joints with the legs as given is due to the data of the legs, not to the "
        "formulation.",
        compared_with(VJM.label),
    )


@family_figures.figure(
    "deflection.family",
    "Deflections of robots with longer legs (as the paper's Fig. 6)",
    effort=3.0,
)
def deflections_of_the_family(context: Context) -> Chart:
    """Chart of deflections over leg length α, one column for each point of the stroke."""
    by_point = _over_the_family(context, (SIMPLIFIED, *EQUIVALENT_LEGS), _deflections)
    panels = []
    for name, (axis, direction) in _LOADS.items():
        top = largest(
            getattr(deflection, name)
            for by_model in by_point.values()
            for deflection in by_model.values()
        )
        label = f"{direction}, {LOAD:g} N along {axis}\n(µm)"
        scale = partial(from_zero, top=top)
        panels += [
            family_panel(point, _deflection_series(by_model, np.array(ALPHAS), name), label, scale)
            for point, by_model in by_point.items()
        ]
    planar, along_z = by_point["centre"][BEAM].planar_x, by_point["centre"][BEAM].along_z
    return family_chart(panels, high=1.9).captioned(
        _FAMILY_CAPTION,
        "At the centre of the stroke, by beam elements, the planar deflection under a force along "
        f"x changes from {planar[0]:.1f} µm at α = 1 to {planar[-1]:.1f} µm at α = 2, and the "
        f"deflection along z from {along_z[0]:.0f} to {along_z[-1]:.0f} µm. The simplified model, "
        "with rigid legs on elastic drives, "
        "has no deflection along z. A design that is optimal by this model therefore has legs "
        "that are too long.",
    )


@stroke_figures.figure(
    "frequency.stroke",
    "First natural frequencies over the stroke (as the paper's Figs 7 and 10)",
    effort=3.0,
)
def frequencies_over_the_stroke(context: Context) -> Chart:
    """Chart of frequencies over the stroke in two panels.

    One panel has the first two frequencies by models with elastic legs, the other the first
    frequency by all models.
    """
    models = (SIMPLIFIED, SEGMENTS, SEGMENTS_AS_PRINTED, BEAM)
    x, frequency = _over_the_stroke(context, models, _frequencies)
    simplified = frequency[SIMPLIFIED][:, 0]
    elastic_legs = {model: frequency[model] for model in (SEGMENTS, SEGMENTS_AS_PRINTED, BEAM)}
    beam, printed = (frequency[model][len(x) // 2] for model in (BEAM, SEGMENTS_AS_PRINTED))
    difference = spread([frequency[SEGMENTS], frequency[BEAM]])
    exact_release = {model: frequency[model] for model in (SIMPLIFIED, SEGMENTS, BEAM)}
    first = _frequency_series(exact_release, x, 1)
    both = _frequency_series(elastic_legs, x, _MODES)
    notes = list(_mode_numbers(x, elastic_legs))
    panels = [
        compared(panel, BEAM.label)
        for panel in (
            Panel(both, "models with elastic legs", _BOTH, from_zero, notes=notes),
            Panel(first, "first frequency, all models", _FIRST, frequency_scale(first)),
        )
    ]
    return stroke_chart(x, lettered(panels), high=2.8).captioned(
        "First and second natural frequency of the robot over the stroke, 20 elements in each leg. "
        f"Segments and beam elements agree to {percent(difference, signed=False)}; at "
        f"the centre they give {beam[0]:.0f} and {beam[1]:.0f} Hz. Eq. (25) as printed deletes row "
        "and column of φz from the joint's stiffness, which locks every motion that is coupled to "
        f"φz; the second frequency is then {printed[1]:.0f} Hz. Static condensation is the correct "
        "release of a joint. With the platform's mass on the drives and rigid legs (simplified) "
        f"the first frequency is {simplified.min():.0f} to {simplified.max():.0f} Hz, up to "
        f"{(simplified / frequency[BEAM][:, 0]).max():.1f} times that with elastic legs. The "
        "simplified model does not contain the mode of the lowest frequency.",
        compared_with(BEAM.label),
    )


@family_figures.figure(
    "frequency.family",
    "First natural frequencies of robots with longer legs (as the paper's Figs 12 and 13)",
    effort=4.0,
)
def frequencies_of_the_family(context: Context) -> Chart:
    """Chart of frequencies over leg length α at three points of the stroke.

    Models with elastic legs have two frequencies, the simplified model has the first.
    """
    by_point = _over_the_family(context, (SIMPLIFIED, SEGMENTS, BEAM), _frequencies)
    alphas = np.array(ALPHAS)
    series_by_point, difference = {}, 0.0
    for point, by_model in by_point.items():
        elastic_legs = {model: by_model[model] for model in (SEGMENTS, BEAM)}
        difference = max(difference, spread(list(elastic_legs.values())))
        series_by_point[point] = [
            *_frequency_series({SIMPLIFIED: by_model[SIMPLIFIED]}, alphas, 1),
            *_frequency_series(elastic_legs, alphas, _MODES),
        ]
    scale = frequency_scale([curve for series in series_by_point.values() for curve in series])
    panels = [
        family_panel(
            point,
            series,
            _BOTH,
            scale,
            [
                Note(f"mode {mode + 1}", ALPHAS[0], float(height), (0.0, 6.0 if mode else -12.0))
                for mode, height in enumerate(by_point[point][BEAM][0])
            ],
        )
        for point, series in series_by_point.items()
    ]
    simplified = by_point["centre"][SIMPLIFIED][:, 0]
    first, second = by_point["centre"][BEAM].T
    return family_chart(panels).captioned(
        _FAMILY_CAPTION,
        "At the centre of the stroke, by beam elements, the first frequency changes from "
        f"{first[0]:.0f} Hz at α = 1 to {first[-1]:.0f} Hz at α = 2, the second from "
        f"{second[0]:.0f} to {second[-1]:.0f} Hz. At all points segments and beam elements agree "
        f"to {percent(difference, signed=False)}. With rigid legs and the platform's mass on "
        f"the drives (simplified model), the first frequency changes from {simplified[0]:.0f} to "
        f"{simplified[-1]:.0f} Hz. The simplified model and models with elastic legs therefore "
        "lead to opposite changes of the design.",
    )


# Function that computes the response of a plotted model for robots in positions on the stroke.
_Compute: TypeAlias = Callable[[Context, PlottedModel, Sequence[RobotOnStroke]], T]


def _deflections(
    context: Context, plotted: PlottedModel, robots: Sequence[RobotOnStroke]
) -> Deflections:
    return context.get(deflections, plotted.model, robots, plotted.options)


def _frequencies(context: Context, plotted: PlottedModel, robots: Sequence[RobotOnStroke]) -> Array:
    return context.get(frequencies, plotted.model, robots, _MODES, plotted.options)


def _over_the_stroke(
    context: Context, models: Sequence[PlottedModel], compute: _Compute[T]
) -> tuple[Array, dict[PlottedModel, T]]:
    """Positions x of point B (m), and the response of each model there."""
    mechanism = context.robot_file.mechanism
    x = cosine_spaced(*stroke_of(mechanism).ends, _POSTURES[context.preset])
    return x, {model: compute(context, model, (RobotOnStroke(mechanism, x),)) for model in models}


def _over_the_family(
    context: Context, models: Sequence[PlottedModel], compute: _Compute[T]
) -> dict[str, dict[PlottedModel, T]]:
    """Responses of each model for robots with longer legs, by point of the stroke."""
    responses = {}
    for point, fraction in FIGURE_POINTS.items():
        members = context.get(family, context.robot_file, fraction)
        responses[point] = {model: compute(context, model, members) for model in models}
    return responses


def _deflection_series(
    by_model: Mapping[PlottedModel, Deflections], x: Array, name: str
) -> list[Series]:
    axis, direction = _LOADS[name]
    quantity = f"deflection {direction} under {LOAD:g} N along {axis} (µm)"
    return [
        Series(model.label, x, getattr(deflection, name), quantity)
        for model, deflection in by_model.items()
    ]


def _frequency_series(by_model: Mapping[PlottedModel, Array], x: Array, modes: int) -> list[Series]:
    """Curves of the first `modes` frequencies of each model."""
    return [
        Series(model.label, x, values[:, mode], f"frequency {mode + 1} (Hz)")
        for model, values in by_model.items()
        for mode in range(modes)
    ]


def _panel(
    by_model: Mapping[PlottedModel, Deflections],
    x: Array,
    name: str,
    y_label: str,
    reference: PlottedModel,
) -> Panel:
    axis, direction = _LOADS[name]
    planar = "" if axis == direction[-1] else f"{direction}, "
    series = _deflection_series(by_model, x, name)
    panel = Panel(series, f"{planar}{LOAD:g} N along {axis}", y_label, from_zero)
    return compared(panel, reference.label)


def _mode_numbers(x: Array, by_model: Mapping[PlottedModel, Array]) -> Iterator[Note]:
    """Notes with the mode number at the right end of each curve.

    Curves of eq. (25) as printed have notes of their own if they are at least 7 % of the figure's
    height away from those of the other models, so that no two notes overlap.
    """
    heights = by_model[BEAM][-1]
    least_distance = 0.07 * max(float(values.max()) for values in by_model.values())
    for mode, height in enumerate(heights):
        yield Note(f"mode {mode + 1}", float(x[-1]), float(height), (6.0, -3.0))
    for mode, height in enumerate(by_model[SEGMENTS_AS_PRINTED][-1]):
        if np.min(np.abs(height - heights)) > least_distance:
            yield Note(f"mode {mode + 1},\neq. (25)", float(x[-1]), float(height), (6.0, -8.0))


def cosine_spaced(first: float, last: float, count: int) -> Array:
    """Positions x (`count`, m) of point B over the stroke with cosine spacing, ends included.

    At the ends of the stroke, curves vary as √(L² − x²) with the leg length L. Their slope in x is
    infinite there, so the positions are denser.
    """
    angles = np.linspace(0.0, np.pi, count)
    return np.clip(first + 0.5 * (last - first) * (1.0 - np.cos(angles)), first, last)


def stroke_chart(x: Array, panels: Sequence[Panel], *, high: float = 2.0) -> Chart:
    """Chart with panels side by side, over the position x (m) of point B."""
    return Chart(panels, "x of B (m)", len(panels), high, {"x (m)": x.tolist()})


def family_chart(panels: Sequence[Panel], high: float = 2.5) -> Chart:
    """Chart with panels over leg length α. Each point of the stroke has a column with a title."""
    columns = len(FIGURE_POINTS)
    lower_rows = [replace(panel, title="") for panel in panels[columns:]]
    all_panels = [*lettered(panels[:columns]), *lower_rows]
    return Chart(all_panels, "relative leg length α", columns, high, {"alpha": ALPHAS})


def family_panel(
    point: str, series: Sequence[Series], y_label: str, scale: Scale, notes: Sequence[Note] = ()
) -> Panel:
    """Panel of curves over α at a point of the stroke, which is a key of `FIGURE_POINTS`.

    Only the leftmost panel has a label of its y axis.
    """
    label = y_label if point == next(iter(FIGURE_POINTS)) else ""
    return Panel(series, _POINT_TITLES[point], label, scale, notes=notes, column_prefix=point)


def frequency_scale(series: Sequence[Series]) -> Scale:
    """Logarithmic scale over the range of the curves with a margin of 20 to 25 %."""
    low = 0.8 * min(float(curve.y.min()) for curve in series)
    return partial(plain_log, low=low, high=1.25 * max(float(curve.y.max()) for curve in series))


def spread(curves: Sequence[Array]) -> float:
    """Largest difference between curves at the same points, relative to the largest value."""
    values = np.array(curves)
    return float(np.max(np.ptp(values, axis=0)) / np.max(np.abs(values)))
