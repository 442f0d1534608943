"""Natural frequencies over the stroke and along the family of robots with longer legs."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.context import Context
from validation.drawing.chart import Note, Panel, Series, compared, lettered
from validation.drawing.scales import Scale, from_zero, largest, plain_log, up_to
from validation.exhibits import FAMILY, STROKE
from validation.report.figures.curves.computed import (
    FAMILY_SAID,
    along_the_family,
    family_chart,
    family_panel,
    frequencies_at,
    over_the_stroke,
    stroke_chart,
)
from validation.report.figures.curves.lines import (
    BEAM,
    DYNAMIC_LINES,
    SEGMENTS,
    SEGMENTS_PRINTED,
    SIMPLIFIED,
    Line,
    accuracy,
    as_in_paper,
    course,
    spread,
)
from validation.report.figures.declared import FigureGroup, Shown, compared_with, curves
from validation.studies.quantities import ALPHAS, family_frequencies

MODES = 2
Found: TypeAlias = Mapping[Line, Array]
_FIRST, _BOTH = "first natural frequency (Hz)", "natural frequency (Hz)"
_ALONE = "the simplified model alone"
over_stroke = FigureGroup(STROKE, "figures.dynamics")
over_family = FigureGroup(FAMILY, "figures.dynamics")


@over_stroke.figure(
    "frequency.simplified",
    f"First natural frequency, simplified model against beams {as_in_paper(7)}",
)
def simplified_frequency(context: Context) -> Shown:
    """Left all models on a logarithmic axis, right the simplified one alone."""
    x, found, notes = _over_the_stroke(context, DYNAMIC_LINES)
    first = _series(found, x, 1)
    alone = [one for one in first if one.label == SIMPLIFIED.label]
    panels = [Panel(first, "all models", _FIRST, _hertz(first)), Panel(alone, _ALONE)]
    caption = ["The lowest frequency of the platform's mass on the drives, and of the whole robot."]
    if SIMPLIFIED in found and BEAM in found:
        simple, beam = found[SIMPLIFIED][:, 0], found[BEAM][:, 0]
        caption.append(
            f"Simplified: {simple.min():.0f} to {simple.max():.0f} Hz. With elastic legs and feet "
            f"and the legs' mass: {beam.min():.0f} to {beam.max():.0f} Hz, "
            f"{(simple / beam).max():.1f} times lower. The mode that limits the robot is not in "
            "the simplified model at all."
        )
    return curves(stroke_chart(x, lettered(panels), high=2.5), *caption, notes)


@over_stroke.figure(
    "frequency.stroke",
    f"First two natural frequencies over the stroke {as_in_paper(10)}",
    effort=2.0,
)
def refined_frequencies(context: Context) -> Shown:
    """Both frequencies of segments and beams in one pair of axes, with the printed eq. (25)."""
    x, found, notes = _over_the_stroke(context, (SEGMENTS, SEGMENTS_PRINTED, BEAM))
    caption = ["First and second natural frequency of the whole robot, 20 elements in each leg."]
    if SEGMENTS in found and BEAM in found:
        apart = spread([found[SEGMENTS], found[BEAM]])
        beam = found[BEAM][len(x) // 2]
        caption.append(
            f"Segments and beam elements agree to {accuracy(apart)}; at the centre they give "
            f"{beam[0]:.0f} and {beam[1]:.0f} Hz."
        )
    if SEGMENTS_PRINTED in found:
        printed = found[SEGMENTS_PRINTED][len(x) // 2]
        caption.append(
            "Eq. (25) as printed deletes row and column of φz from the joint's stiffness, which "
            "locks whatever motion is coupled to φz: with it the second frequency is "
            f"{printed[1]:.0f} Hz. Static condensation is the right release of a joint."
        )
    panel = Panel(
        _series(found, x, MODES), y_label=_BOTH, scale=from_zero, notes=list(_names(x, found))
    )
    chart = stroke_chart(x, [compared(panel, BEAM.label)], high=2.8)
    return curves(chart, *caption, compared_with(BEAM.label) if BEAM in found else "", notes)


@over_family.figure(
    "frequency.family-simplified",
    "First natural frequency of robots with longer legs, simplified model against beams "
    f"{as_in_paper(12)}",
)
def simplified_family(context: Context) -> Shown:
    """First frequency against α at three points, logarithmic axes."""
    found, notes = _along_the_family(context, DYNAMIC_LINES)
    alphas = np.array(ALPHAS)
    series = {point: _series(at, alphas, 1) for point, at in found.items()}
    scale = _hertz([one for at in series.values() for one in at])
    caption = [FAMILY_SAID]
    centre = found["centre"]
    if SIMPLIFIED in centre and BEAM in centre:
        simple, beam = centre[SIMPLIFIED][:, 0], centre[BEAM][:, 0]
        caption.append(
            f"At the centre the simplified first frequency {course(simple)} from {simple[0]:.0f} "
            f"to {simple[-1]:.0f} Hz, that of the beams {course(beam)} from {beam[0]:.0f} to "
            f"{beam[-1]:.0f} Hz."
        )
        if course(simple) == "rises" and course(beam) == "falls":
            caption.append("The two models ask for opposite changes of the design.")
    panels = [family_panel(point, at, _FIRST, scale) for point, at in series.items()]
    return curves(family_chart(panels), *caption, notes)


@over_family.figure(
    "frequency.family",
    f"First two natural frequencies of robots with longer legs {as_in_paper(13)}",
)
def refined_family(context: Context) -> Shown:
    """Both frequencies against α at three points."""
    found, notes = _along_the_family(context, (SEGMENTS, BEAM))
    reference = list(found["centre"].values())[-1]
    first, second = reference[:, 0], reference[:, 1]
    caption = [
        FAMILY_SAID,
        f"At the centre the first frequency {course(first)} from {first[0]:.0f} to "
        f"{first[-1]:.0f} Hz, the second {course(second)} from {second[0]:.0f} to "
        f"{second[-1]:.0f} Hz.",
    ]
    if all(len(at) == 2 for at in found.values()):
        apart = max(spread(list(at.values())) for at in found.values())
        caption.append(f"Segments and beam elements agree to {accuracy(apart)}.")
    top = largest(values for at in found.values() for values in at.values())
    panels = [
        family_panel(
            point,
            _series(at, np.array(ALPHAS), MODES),
            _BOTH,
            partial(up_to, top=top),
            [
                Note(f"mode {mode + 1}", ALPHAS[0], highest, (0.0, 6.0))
                for mode, highest in enumerate(np.max([v[:4] for v in at.values()], axis=(0, 1)))
            ],
        )
        for point, at in found.items()
    ]
    return curves(family_chart(panels), *caption, notes)


def _over_the_stroke(context: Context, lines: Sequence[Line]) -> tuple[Array, Found, str]:
    x, gathered = over_the_stroke(
        context,
        lines,
        lambda line, x: context.get(
            frequencies_at, line.model, context.robot, x, MODES, line.options
        ),
    )
    return x, gathered.values, " ".join(gathered.notes)


def _along_the_family(context: Context, lines: Sequence[Line]) -> tuple[Mapping[str, Found], str]:
    return along_the_family(
        lines,
        lambda line, fraction: context.get(
            family_frequencies, line.model, context.robot, ALPHAS, fraction, MODES, line.options
        ),
    )


def _series(found: Found, x: Array, modes: int) -> list[Series]:
    """The curves of the first `modes` frequencies."""
    return [
        line.series(x, values[:, mode], f"frequency {mode + 1} (Hz)")
        for line, values in found.items()
        for mode in range(modes)
    ]


def _hertz(series: Sequence[Series]) -> Scale:
    """Logarithmic frequencies around the curves."""
    low = 0.8 * min(float(one.y.min()) for one in series)
    return partial(plain_log, low=low, high=1.25 * max(float(one.y.max()) for one in series))


def _names(x: Array, found: Found) -> Iterator[Note]:
    """The number of the mode at the right end of its curves, eq. (25)'s where it lies apart."""
    exact = [values for line, values in found.items() if line is not SEGMENTS_PRINTED]
    heights = [float(exact[-1][-1, mode]) for mode in range(MODES)] if exact else []
    for mode, height in enumerate(heights):
        yield Note(f"mode {mode + 1}", float(x[-1]), height, (6.0, -3.0))
    least = 0.07 * max(float(values.max()) for values in found.values())
    for mode, height in enumerate(found[SEGMENTS_PRINTED][-1] if SEGMENTS_PRINTED in found else ()):
        if all(abs(height - other) > least for other in heights):
            yield Note(f"mode {mode + 1},\neq. (25)", float(x[-1]), float(height), (6.0, -8.0))
