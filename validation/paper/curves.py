"""Figures 3 to 13 of the paper with all models in the same axes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

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
    from_zero,
    largest,
    lettered,
    plain_log,
)
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
from validation.report.declared import FigureGroup, Shown, compared_with, curves

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


@over_stroke.figure(
    "deflection.stroke",
    "Deflections over the stroke, all models (as the paper's Figs 3 and 5)",
    effort=1.5,
)
def all_deflections(context: Context) -> Shown:
    """Three panels: planar under a force along x, along y, and out of the plane."""
    x, found = _over_the_stroke(context, (SIMPLIFIED, GIVEN, *ONE_FORMULATION), _deflections)
    panels = [
        _panel(found, x, name, from_zero, "" if place else "deflection (µm)", GIVEN)
        for place, name in enumerate(_LOADS)
    ]
    simple, given = found[SIMPLIFIED], found[GIVEN]
    planar = given.largest_planar
    along_z = float(given.along_z.max())
    alike = [found[line] for line in ONE_FORMULATION]
    apart = max(spread([getattr(one, name) for one in alike]) for name in _LOADS)
    return curves(
        stroke_chart(x, lettered(panels)),
        "Deflections of the loaded point. Drives alone elastic (simplified): at most "
        f"{simple.largest_planar:.2f} µm; under a force along x {simple.planar_x[0]:.1f} and "
        f"{simple.planar_x[-1]:.1f} µm at the ends of the stroke. "
        "Virtual joints with the legs as given reach "
        f"{planar:.1f} µm in the plane, {planar / simple.largest_planar:.1f} times as much, and "
        f"{along_z:.1f} µm along z, {along_z / planar:.1f} times the planar ones: "
        "what the simplified model leaves out is the larger part. With the same equivalent "
        "legs, virtual joints, segments and beam elements lie on one curve (they differ by "
        f"{percent(apart, signed=False)}). What separates it from the legs as given is the data "
        "of the legs, not the formulation.",
        compared_with(GIVEN.label),
    )


@over_family.figure(
    "deflection.family",
    "Deflections of robots with longer legs (as the paper's Fig. 6)",
    effort=3.0,
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
    "frequency.stroke",
    "First natural frequencies over the stroke (as the paper's Figs 7 and 10)",
    effort=3.0,
)
def frequencies_over_the_stroke(context: Context) -> Shown:
    """Two of segments and beams, with the printed eq. (25); the first beside the simplified one."""
    x, found = _over_the_stroke(context, (SIMPLIFIED, SEGMENTS, PRINTED, BEAM), _frequencies)
    simple, whole = found[SIMPLIFIED][:, 0], {one: found[one] for one in (SEGMENTS, PRINTED, BEAM)}
    beam, printed = (found[line][len(x) // 2] for line in (BEAM, PRINTED))
    apart = spread([found[SEGMENTS], found[BEAM]])
    first = _of_modes({one: found[one] for one in (SIMPLIFIED, SEGMENTS, BEAM)}, x, 1)
    both, notes = _of_modes(whole, x, _MODES), list(_numbers(x, whole))
    panels = [
        compared(panel, BEAM.label)
        for panel in (
            Panel(both, "the whole robot", _BOTH, from_zero, notes=notes),
            Panel(first, "the first, all models", _FIRST, hertz(first)),
        )
    ]
    return curves(
        stroke_chart(x, lettered(panels), high=2.8),
        "First and second natural frequency of the whole robot, 20 elements in each leg. Segments "
        f"and beam elements agree to {percent(apart, signed=False)}; at "
        f"the centre they give {beam[0]:.0f} and {beam[1]:.0f} Hz. Eq. (25) as printed deletes row "
        "and column of φz from the joint's stiffness, which locks whatever motion is coupled to "
        f"φz: with it the second frequency is {printed[1]:.0f} Hz. Static condensation is the "
        "right release of a joint. The platform's mass on the drives alone (simplified): "
        f"{simple.min():.0f} to {simple.max():.0f} Hz, up to "
        f"{(simple / found[BEAM][:, 0]).max():.1f} times the first of the whole robot: the mode "
        "that limits it is not in the simplified model at all.",
        compared_with(BEAM.label),
    )


@over_family.figure(
    "frequency.family",
    "First natural frequencies of robots with longer legs (as the paper's Figs 12 and 13)",
    effort=4.0,
)
def frequencies_of_the_family(context: Context) -> Shown:
    """Both frequencies against α at three points, of the simplified model the first."""
    found = _over_the_family(context, (SIMPLIFIED, SEGMENTS, BEAM), _frequencies)
    alphas = np.array(ALPHAS)
    shown, apart = {}, 0.0
    for point, at in found.items():
        whole = {line: at[line] for line in (SEGMENTS, BEAM)}
        apart = max(apart, spread(list(whole.values())))
        first = _of_modes({SIMPLIFIED: at[SIMPLIFIED]}, alphas, 1)
        shown[point] = [*first, *_of_modes(whole, alphas, _MODES)]
    scale = hertz([one for series in shown.values() for one in series])
    panels = [
        family_panel(
            point,
            series,
            _BOTH,
            scale,
            [
                Note(f"mode {mode + 1}", ALPHAS[0], float(height), (0.0, 6.0 if mode else -12.0))
                for mode, height in enumerate(found[point][BEAM][0])
            ],
        )
        for point, series in shown.items()
    ]
    simple, (first, second) = found["centre"][SIMPLIFIED][:, 0], found["centre"][BEAM].T
    return curves(
        family_chart(panels),
        _LONGER,
        f"At the centre the first frequency goes from {first[0]:.0f} to {first[-1]:.0f} Hz, the "
        f"second from {second[0]:.0f} to {second[-1]:.0f} Hz; segments and beam elements agree to "
        f"{percent(apart, signed=False)}. The simplified first frequency goes from "
        f"{simple[0]:.0f} to {simple[-1]:.0f} Hz: the two models ask for opposite changes of the "
        "design.",
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
