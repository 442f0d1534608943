"""Natural frequencies over the stroke and along the family of robots with longer legs."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.context import Context
from validation.exhibits import FAMILY, STROKE, Drawing, Figure
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
    plain_log,
    spread,
)
from validation.report.figures.curves.panels import (
    STROKE_LABEL,
    Panel,
    all_from_zero,
    along_the_family,
    common_top,
    family_panels,
    family_svg,
    family_table,
    over_the_stroke,
    panels_svg,
    stroke_table,
)
from validation.report.figures.curves.sweeps import frequencies_at
from validation.studies.quantities import ALPHAS, family_frequencies

MODES = 2
_SIMPLIFIED_TITLE = f"First natural frequency, simplified model against beams {as_in_paper(7)}"
_STROKE_TITLE = f"First two natural frequencies over the stroke {as_in_paper(10)}"
_FAMILY_SIMPLIFIED_TITLE = (
    "First natural frequency of robots with longer legs, simplified model against beams "
    f"{as_in_paper(12)}"
)
_FAMILY_TITLE = f"First two natural frequencies of robots with longer legs {as_in_paper(13)}"
_GROUP = "figures.dynamics"


def drawings() -> tuple[Drawing, ...]:
    """First frequencies over the stroke and along the family, simplified and refined."""
    return (
        Drawing(
            "frequency.simplified",
            _SIMPLIFIED_TITLE,
            simplified_frequency,
            section=STROKE,
            group=_GROUP,
        ),
        Drawing(
            "frequency.stroke",
            _STROKE_TITLE,
            refined_frequencies,
            section=STROKE,
            group=_GROUP,
            effort=2.0,
        ),
        Drawing(
            "frequency.family-simplified",
            _FAMILY_SIMPLIFIED_TITLE,
            simplified_family,
            section=FAMILY,
            group=_GROUP,
        ),
        Drawing(
            "frequency.family",
            _FAMILY_TITLE,
            refined_family,
            section=FAMILY,
            group=_GROUP,
        ),
    )


def simplified_frequency(context: Context) -> Figure:
    """Left all models on a logarithmic axis, right the simplified one alone."""
    x, (gathered, notes) = _over_the_stroke(context, DYNAMIC_LINES)
    first = {line: values[:, 0] for line, values in gathered.items()}
    alone = {SIMPLIFIED: first[SIMPLIFIED]} if SIMPLIFIED in first else {}
    panels = [
        Panel("all models", [first], "first natural frequency (Hz)"),
        Panel("the simplified model alone", [alone]),
    ]
    caption = ["The lowest frequency of the platform's mass on the drives, and of the whole robot."]
    if SIMPLIFIED in first and BEAM in first:
        simple, beam = first[SIMPLIFIED], first[BEAM]
        caption.append(
            f"Simplified: {simple.min():.0f} to {simple.max():.0f} Hz. With elastic legs and feet "
            f"and the legs' mass: {beam.min():.0f} to {beam.max():.0f} Hz, "
            f"{(simple / beam).max():.1f} times lower. The mode that limits the robot is not in "
            "the simplified model at all."
        )
    return Figure(
        id="frequency.simplified",
        title=_SIMPLIFIED_TITLE,
        caption=" ".join([*caption, *notes]),
        section=STROKE,
        svg=panels_svg(
            x,
            STROKE_LABEL,
            panels,
            lambda drawn: _hertz(drawn[:1], list(first.values())),
            columns=2,
        ),
        data=stroke_table(x, _columns({k: v[:, :1] for k, v in gathered.items()})),
    )


def refined_frequencies(context: Context) -> Figure:
    """Both frequencies of segments and beams in one pair of axes, with the printed eq. (25)."""
    x, (gathered, notes) = _over_the_stroke(context, (SEGMENTS, SEGMENTS_PRINTED, BEAM))

    def named(drawn: Sequence[Axes]) -> None:
        all_from_zero(drawn)
        _name_modes(drawn[0], x, gathered)

    caption = ["First and second natural frequency of the whole robot, 20 elements in each leg."]
    if SEGMENTS in gathered and BEAM in gathered:
        apart = spread([gathered[SEGMENTS], gathered[BEAM]])
        beam = gathered[BEAM][len(x) // 2]
        caption.append(
            f"Segments and beam elements agree to {accuracy(apart)}; at the centre they give "
            f"{beam[0]:.0f} and {beam[1]:.0f} Hz."
        )
    if SEGMENTS_PRINTED in gathered:
        printed = gathered[SEGMENTS_PRINTED][len(x) // 2]
        caption.append(
            "Eq. (25) as printed deletes row and column of φz from the joint's stiffness, which "
            "locks whatever motion is coupled to φz: with it the second frequency is "
            f"{printed[1]:.0f} Hz. Static condensation is the right release of a joint."
        )
    panels = [Panel("", _stacks(gathered), "natural frequency (Hz)")]
    return Figure(
        id="frequency.stroke",
        title=_STROKE_TITLE,
        caption=" ".join([*caption, *notes]),
        section=STROKE,
        svg=panels_svg(x, STROKE_LABEL, panels, named, columns=1, height=3.9, against=BEAM),
        data=stroke_table(x, _columns(gathered)),
    )


def simplified_family(context: Context) -> Figure:
    """First frequency against α at three points, logarithmic axes."""
    found, notes = _along_the_family(context, DYNAMIC_LINES)
    everything = [v[:, 0] for gathered in found.values() for v in gathered.values()]
    caption = ["Legs α times as long, stroke and sections unchanged."]
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
    return Figure(
        id="frequency.family-simplified",
        title=_FAMILY_SIMPLIFIED_TITLE,
        caption=" ".join([*caption, *notes]),
        section=FAMILY,
        svg=family_svg(
            family_panels(
                found, lambda gathered: _stacks(gathered)[:1], "first natural frequency (Hz)"
            ),
            lambda drawn: _hertz(drawn, everything),
        ),
        data=family_table(
            {p: _columns({k: v[:, :1] for k, v in g.items()}) for p, g in found.items()}
        ),
    )


def refined_family(context: Context) -> Figure:
    """Both frequencies against α at three points."""
    found, notes = _along_the_family(context, (SEGMENTS, BEAM))

    def named(drawn: Sequence[Axes]) -> None:
        for axes, gathered in zip(drawn, found.values(), strict=True):
            for mode, stack in enumerate(_stacks(gathered)):
                highest = max(float(curve[:4].max()) for curve in stack.values())
                _write(axes, f"mode {mode + 1}", ALPHAS[0], highest, (0.0, 6.0))
        common_top(drawn)

    reference = list(found["centre"].values())[-1]
    first, second = reference[:, 0], reference[:, 1]
    caption = [
        "Legs α times as long, stroke and sections unchanged.",
        f"At the centre the first frequency {course(first)} from {first[0]:.0f} to "
        f"{first[-1]:.0f} Hz, the second {course(second)} from {second[0]:.0f} to "
        f"{second[-1]:.0f} Hz.",
    ]
    if all(len(gathered) == 2 for gathered in found.values()):
        apart = max(spread(list(gathered.values())) for gathered in found.values())
        caption.append(f"Segments and beam elements agree to {accuracy(apart)}.")
    return Figure(
        id="frequency.family",
        title=_FAMILY_TITLE,
        caption=" ".join([*caption, *notes]),
        section=FAMILY,
        svg=family_svg(family_panels(found, _stacks, "natural frequency (Hz)"), named),
        data=family_table({point: _columns(gathered) for point, gathered in found.items()}),
    )


def _over_the_stroke(
    context: Context, lines: Sequence[Line]
) -> tuple[Array, tuple[Mapping[Line, Array], tuple[str, ...]]]:
    x, gathered = over_the_stroke(
        context,
        lines,
        lambda line, x: context.get(
            frequencies_at, line.model, context.robot, x, MODES, line.options
        ),
    )
    return x, (gathered.values, gathered.notes)


def _along_the_family(
    context: Context, lines: Sequence[Line]
) -> tuple[Mapping[str, Mapping[Line, Array]], tuple[str, ...]]:
    return along_the_family(
        lines,
        lambda line, fraction: context.get(
            family_frequencies, line.model, context.robot, ALPHAS, fraction, MODES, line.options
        ),
    )


def _stacks(gathered: Mapping[Line, Array]) -> list[Mapping[Line, Array]]:
    """A stack of curves for each mode."""
    return [{line: values[:, mode] for line, values in gathered.items()} for mode in range(MODES)]


def _columns(gathered: Mapping[Line, Array]) -> dict[str, list[float]]:
    return {
        f"{line.label}: frequency {mode + 1} (Hz)": values[:, mode].tolist()
        for line, values in gathered.items()
        for mode in range(values.shape[1])
    }


def _hertz(panels: Sequence[Axes], curves: Sequence[Array]) -> None:
    """Logarithmic frequency axes around the curves."""
    low = 0.8 * min(float(curve.min()) for curve in curves)
    high = 1.25 * max(float(curve.max()) for curve in curves)
    for axes in panels:
        plain_log(axes, low, high)


def _name_modes(axes: Axes, x: Array, gathered: Mapping[Line, Array]) -> None:
    """The number of the mode at the right end of its curves, eq. (25)'s where it lies apart."""
    exact = [values for line, values in gathered.items() if line is not SEGMENTS_PRINTED]
    heights = [float(exact[-1][-1, mode]) for mode in range(MODES)] if exact else []
    for mode, height in enumerate(heights):
        _write(axes, f"mode {mode + 1}", float(x[-1]), height, (6.0, -3.0))
    printed = gathered.get(SEGMENTS_PRINTED)
    if printed is None:
        return
    least = 0.07 * axes.get_ylim()[1]
    for mode, height in enumerate(printed[-1]):
        if all(abs(height - other) > least for other in heights):
            text = f"mode {mode + 1},\neq. (25)"
            _write(axes, text, float(x[-1]), float(height), (6.0, -8.0))


def _write(axes: Axes, text: str, x: float, y: float, away: tuple[float, float]) -> None:
    """A small text `away` (pt) from a point of the axes."""
    axes.annotate(text, (x, y), xytext=away, textcoords="offset points", fontsize=8.5)
