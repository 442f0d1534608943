"""Figures 3 to 13 of the paper with all models in the same axes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from lumped.arrays import Array
from validation.context import Context, Preset
from validation.drawing.charts.chart import Chart, Note, Panel, Series, compared, lettered
from validation.drawing.charts.scales import Scale, from_zero, largest, plain_log
from validation.drawing.text import percent
from validation.exhibits import FAMILY, STROKE
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.paper.robot import (
    ALPHAS,
    FIGURE_POINTS,
    LOAD,
    Deflections,
    Places,
    deflections,
    family,
    frequencies,
    stroke_of,
)
from validation.report.figures.declared import FigureGroup, Shown, compared_with, curves

T = TypeVar("T")
_PLACES = {"centre": "centre of the stroke", "left": "left end", "right": "right end"}
_MODES = 2
_POSTURES: Mapping[Preset, int] = {"quick": 21, "standard": 41, "fine": 81}
_LOADS = {
    "planar_x": ("x", "planar"),
    "planar_y": ("y", "planar"),
    "along_z": ("z", "along z"),
}
_FIRST, _BOTH = "first natural frequency (Hz)", "natural frequency (Hz)"
_LONGER = "Legs α times as long, stroke and sections unchanged."
over_stroke = FigureGroup(STROKE, "paper.figures")
over_family = FigureGroup(FAMILY, "paper.figures")


@dataclass(frozen=True)
class Line:
    """One model in a figure."""

    label: str
    model: ModelName
    options: ModelOptions = DEFAULT_OPTIONS


SIMPLIFIED = Line("simplified", "simplified")
GIVEN = Line("VJM, legs as given", "vjm")
EQUIVALENT = Line("VJM, equivalent legs", "vjm", ModelOptions(legs="equivalent"))
SEGMENTS = Line("segments", "segments")
PRINTED = Line("segments, eq. (25) as printed", "segments", ModelOptions(release="printed"))
BEAM = Line("beam FE", "beam")
ONE_FORMULATION = (EQUIVALENT, SEGMENTS, BEAM)
DYNAMIC = (SIMPLIFIED, SEGMENTS, BEAM)


@over_stroke.figure(
    "deflection.simplified",
    "Planar deflections, simplified model against beams (as the paper's Fig. 3)",
)
def simplified_deflections(context: Context) -> Shown:
    """Two panels on logarithmic axes: a force along x and one along y."""
    x, found = _over_the_stroke(context, (SIMPLIFIED, BEAM), _deflections)
    simple, beam = found[SIMPLIFIED], found[BEAM]
    high = beam.largest_planar
    scale = partial(plain_log, low=high / 100.0, high=1.6 * high)
    panels = [
        _panel(found, x, name, scale, "" if place else f"deflection under {LOAD:g} N (µm)", BEAM)
        for place, name in enumerate(("planar_x", "planar_y"))
    ]
    return curves(
        stroke_chart(x, lettered(panels)),
        "Norm of the planar deflection of B: drives alone elastic (simplified), and the legs as "
        "beams with their feet (finite elements). "
        f"Simplified: at most {simple.largest_planar:.2f} µm; under a force along x "
        f"{simple.planar_x[0]:.1f} and {simple.planar_x[-1]:.1f} µm at the ends of the stroke "
        "(where a curve falls to zero it leaves the logarithmic axis). "
        f"Beams: up to {high:.1f} µm, {high / simple.largest_planar:.1f} times as much. "
        "The simplified model is no estimate of the deflection.",
        compared_with(BEAM.label),
    )


@over_stroke.figure(
    "deflection.stroke", "Deflections over the stroke, all models (as the paper's Fig. 5)"
)
def all_deflections(context: Context) -> Shown:
    """Three panels: planar under a force along x, along y, and out of the plane."""
    x, found = _over_the_stroke(context, (SIMPLIFIED, GIVEN, *ONE_FORMULATION), _deflections)
    panels = [
        _panel(found, x, name, from_zero, "" if place else "deflection (µm)", GIVEN)
        for place, name in enumerate(_LOADS)
    ]
    given, planar = found[GIVEN], found[GIVEN].largest_planar
    along_z = float(given.along_z.max())
    alike = [found[line] for line in ONE_FORMULATION]
    apart = max(spread([getattr(one, name) for one in alike]) for name in _LOADS)
    return curves(
        stroke_chart(x, lettered(panels)),
        "Deflections of the loaded point. Virtual joints with the legs as given reach "
        f"{planar:.1f} µm in the plane, {planar / found[SIMPLIFIED].largest_planar:.1f} times the "
        f"simplified model, and {along_z:.1f} µm along z, {along_z / planar:.1f} times the planar "
        "ones: what the simplified model leaves out is the larger part. With the same equivalent "
        "legs, virtual joints, segments and beam elements lie on one curve (they differ by "
        f"{percent(apart, signed=False)}). What separates it from the legs as given is the data "
        "of the legs, not the formulation.",
        compared_with(GIVEN.label),
    )


@over_family.figure(
    "deflection.family", "Deflections of robots with longer legs (as the paper's Fig. 6)"
)
def deflections_of_the_family(context: Context) -> Shown:
    """A column of panels for each point of the stroke, a row for each load."""
    found = _over_the_family(context, (SIMPLIFIED, *ONE_FORMULATION), _deflections)
    panels = []
    for name, (load, meaning) in _LOADS.items():
        top = largest(getattr(one, name) for at in found.values() for one in at.values())
        label = f"{meaning}, {LOAD:g} N along {load}\n(µm)"
        panels += [
            family_panel(
                point, _deflected(at, np.array(ALPHAS), name), label, partial(from_zero, top=top)
            )
            for point, at in found.items()
        ]
    planar, along_z = found["centre"][BEAM].planar_x, found["centre"][BEAM].along_z
    return curves(
        family_chart(panels, high=1.9),
        _LONGER,
        f"At the centre the planar deflection under a force along x goes from {planar[0]:.1f} to "
        f"{planar[-1]:.1f} µm, the one along z from {along_z[0]:.0f} to {along_z[-1]:.0f} µm. The "
        "simplified model knows nothing of the deflection along z: an optimum found with it has "
        "legs that are too long.",
    )


@over_stroke.figure(
    "frequency.simplified",
    "First natural frequency, simplified model against beams (as the paper's Fig. 7)",
)
def simplified_frequency(context: Context) -> Shown:
    """Left all models on a logarithmic axis, right the simplified one alone."""
    x, found = _over_the_stroke(context, DYNAMIC, _frequencies)
    first = _of_modes(found, x, 1)
    alone = [one for one in first if one.label == SIMPLIFIED.label]
    panels = [
        Panel(first, "all models", _FIRST, hertz(first)),
        Panel(alone, "the simplified model alone"),
    ]
    simple, beam = found[SIMPLIFIED][:, 0], found[BEAM][:, 0]
    return curves(
        stroke_chart(x, lettered(panels), high=2.5),
        "The lowest frequency of the platform's mass on the drives, and of the whole robot. "
        f"Simplified: {simple.min():.0f} to {simple.max():.0f} Hz. With elastic legs and feet "
        f"and the legs' mass: {beam.min():.0f} to {beam.max():.0f} Hz, "
        f"{(simple / beam).max():.1f} times lower. The mode that limits the robot is not in "
        "the simplified model at all.",
    )


@over_stroke.figure(
    "frequency.stroke",
    "First two natural frequencies over the stroke (as the paper's Fig. 10)",
    effort=2.0,
)
def refined_frequencies(context: Context) -> Shown:
    """Both frequencies of segments and beams in one pair of axes, with the printed eq. (25)."""
    x, found = _over_the_stroke(context, (SEGMENTS, PRINTED, BEAM), _frequencies)
    beam, printed = (found[line][len(x) // 2] for line in (BEAM, PRINTED))
    apart = spread([found[SEGMENTS], found[BEAM]])
    series = _of_modes(found, x, _MODES)
    panel = Panel(series, y_label=_BOTH, scale=from_zero, notes=list(_numbers(x, found)))
    return curves(
        stroke_chart(x, [compared(panel, BEAM.label)], high=2.8),
        "First and second natural frequency of the whole robot, 20 elements in each leg. Segments "
        f"and beam elements agree to {percent(apart, signed=False)}; at "
        f"the centre they give {beam[0]:.0f} and {beam[1]:.0f} Hz. Eq. (25) as printed deletes row "
        "and column of φz from the joint's stiffness, which locks whatever motion is coupled to "
        f"φz: with it the second frequency is {printed[1]:.0f} Hz. Static condensation is the "
        "right release of a joint.",
        compared_with(BEAM.label),
    )


@over_family.figure(
    "frequency.family-simplified",
    "First natural frequency of robots with longer legs, simplified model against beams "
    "(as the paper's Fig. 12)",
)
def simplified_family(context: Context) -> Shown:
    """First frequency against α at three points, logarithmic axes."""
    found = _over_the_family(context, DYNAMIC, _frequencies)
    series = {point: _of_modes(at, np.array(ALPHAS), 1) for point, at in found.items()}
    scale = hertz([one for at in series.values() for one in at])
    simple, beam = found["centre"][SIMPLIFIED][:, 0], found["centre"][BEAM][:, 0]
    return curves(
        family_chart([family_panel(point, at, _FIRST, scale) for point, at in series.items()]),
        _LONGER,
        f"At the centre the simplified first frequency goes from {simple[0]:.0f} to "
        f"{simple[-1]:.0f} Hz, that of the beams from {beam[0]:.0f} to {beam[-1]:.0f} Hz: the two "
        "models ask for opposite changes of the design.",
    )


@over_family.figure(
    "frequency.family",
    "First two natural frequencies of robots with longer legs (as the paper's Fig. 13)",
)
def refined_family(context: Context) -> Shown:
    """Both frequencies against α at three points."""
    found = _over_the_family(context, (SEGMENTS, BEAM), _frequencies)
    first, second = found["centre"][BEAM].T
    apart = max(spread(list(at.values())) for at in found.values())
    top = largest(values for at in found.values() for values in at.values())
    panels = []
    for point, at in found.items():
        heights = np.max([values[:4] for values in at.values()], axis=(0, 1))
        notes = [
            Note(f"mode {mode + 1}", ALPHAS[0], float(height), (0.0, 6.0))
            for mode, height in enumerate(heights)
        ]
        series = _of_modes(at, np.array(ALPHAS), _MODES)
        panels.append(family_panel(point, series, _BOTH, partial(from_zero, top=top), notes))
    return curves(
        family_chart(panels),
        _LONGER,
        f"At the centre the first frequency goes from {first[0]:.0f} to {first[-1]:.0f} Hz, the "
        f"second from {second[0]:.0f} to {second[-1]:.0f} Hz. Segments and beam elements agree to "
        f"{percent(apart, signed=False)}.",
    )


def _deflections(context: Context, line: Line, places: Sequence[Places]) -> Deflections:
    return context.get(deflections, line.model, places, line.options)


def _frequencies(context: Context, line: Line, places: Sequence[Places]) -> Array:
    return context.get(frequencies, line.model, places, _MODES, line.options)


def _over_the_stroke(
    context: Context, lines: Sequence[Line], found: Callable[[Context, Line, Sequence[Places]], T]
) -> tuple[Array, dict[Line, T]]:
    """Positions x of B (m), and what each line's model says there."""
    mechanism = context.robot_file.mechanism
    x = cosine_spaced(*stroke_of(mechanism).ends, _POSTURES[context.preset])
    return x, {line: found(context, line, (Places(mechanism, x),)) for line in lines}


def _over_the_family(
    context: Context, lines: Sequence[Line], found: Callable[[Context, Line, Sequence[Places]], T]
) -> dict[str, dict[Line, T]]:
    """What each line's model says of the family, by point of the stroke."""
    told = {}
    for point, fraction in FIGURE_POINTS.items():
        members = context.get(family, context.robot_file, fraction)
        told[point] = {line: found(context, line, members) for line in lines}
    return told


def _deflected(found: Mapping[Line, Deflections], x: Array, name: str) -> list[Series]:
    load, meaning = _LOADS[name]
    quantity = f"deflection {meaning} under {LOAD:g} N along {load} (µm)"
    return [Series(line.label, x, getattr(one, name), quantity) for line, one in found.items()]


def _of_modes(found: Mapping[Line, Array], x: Array, modes: int) -> list[Series]:
    """The curves of the first `modes` frequencies."""
    return [
        Series(line.label, x, values[:, mode], f"frequency {mode + 1} (Hz)")
        for line, values in found.items()
        for mode in range(modes)
    ]


def _panel(
    found: Mapping[Line, Deflections], x: Array, name: str, scale: Scale, y_label: str, to: Line
) -> Panel:
    load, meaning = _LOADS[name]
    planar = "" if load == meaning[-1] else f"{meaning}, "
    panel = Panel(_deflected(found, x, name), f"{planar}{LOAD:g} N along {load}", y_label, scale)
    return compared(panel, to.label)


def _numbers(x: Array, found: Mapping[Line, Array]) -> Iterator[Note]:
    """The number of the mode at the right end of its curves, eq. (25)'s where it lies apart."""
    heights = found[BEAM][-1]
    least = 0.07 * max(float(values.max()) for values in found.values())
    for mode, height in enumerate(heights):
        yield Note(f"mode {mode + 1}", float(x[-1]), float(height), (6.0, -3.0))
    for mode, height in enumerate(found[PRINTED][-1]):
        if np.min(np.abs(height - heights)) > least:
            yield Note(f"mode {mode + 1},\neq. (25)", float(x[-1]), float(height), (6.0, -8.0))


def cosine_spaced(first: float, last: float, count: int) -> Array:
    """`count` positions x of B (m) over the stroke, both ends included, cosine-spaced.

    Curves go like √(L² − x²) at the ends of the stroke, which is smooth in the angle.
    """
    angles = np.linspace(0.0, np.pi, count)
    return np.clip(first + 0.5 * (last - first) * (1.0 - np.cos(angles)), first, last)


def stroke_chart(x: Array, panels: Sequence[Panel], *, high: float = 2.0) -> Chart:
    """Panels over the postures x (m) of B, side by side."""
    return Chart(panels, "x of B (m)", len(panels), high, {"x (m)": x.tolist()})


def family_chart(panels: Sequence[Panel], high: float = 2.5) -> Chart:
    """Panels over α, a column for each point of the stroke, which the first row names."""
    columns = len(FIGURE_POINTS)
    rest = [replace(panel, title="") for panel in panels[columns:]]
    shown = [*lettered(panels[:columns]), *rest]
    return Chart(shown, "relative leg length α", columns, high, {"alpha": ALPHAS})


def family_panel(
    point: str, series: Sequence[Series], y_label: str, scale: Scale, notes: Sequence[Note] = ()
) -> Panel:
    """A panel of curves over α at a point of the stroke; the leftmost names the axis."""
    label = y_label if point == next(iter(FIGURE_POINTS)) else ""
    return Panel(series, _PLACES[point], label, scale, notes=notes, place=point)


def hertz(series: Sequence[Series]) -> Scale:
    """Logarithmic frequencies around the curves."""
    low = 0.8 * min(float(one.y.min()) for one in series)
    return partial(plain_log, low=low, high=1.25 * max(float(one.y.max()) for one in series))


def spread(curves_of_one: Sequence[Array]) -> float:
    """Largest difference between curves on the same points, relative to the largest value."""
    stacked = np.array(curves_of_one)
    return float(np.max(np.ptp(stacked, axis=0)) / np.max(np.abs(stacked)))
