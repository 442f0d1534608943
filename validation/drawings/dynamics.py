"""Natural frequencies over the stroke and along the family of robots with longer legs."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.cases.paper_family import ALPHAS, FIGURE_POINTS
from validation.cases.robot import SECTION
from validation.context import Context
from validation.drawings.lines import (
    ALPHA_LABEL,
    BEAM,
    DYNAMIC_LINES,
    PLACES,
    POSTURES,
    SEGMENTS,
    SEGMENTS_PRINTED,
    SIMPLIFIED,
    Line,
    accuracy,
    course,
    draw_lines,
    from_zero,
    gather,
    legend_above,
    plain_log,
    spread,
)
from validation.drawings.statics import FAMILY_SECTION
from validation.drawings.sweeps import frequencies_at, stations
from validation.exhibits import Drawing, Figure
from validation.quantities import family_frequencies
from validation.report.style import canvas, csv_of, plot_style, svg_of

MODES = 2
_GROUP = "drawings.dynamics"


def drawings() -> tuple[Drawing, ...]:
    """First frequencies over the stroke and along the family, simplified and refined."""
    return (
        Drawing(
            "frequency.simplified",
            "First natural frequency, simplified model against beams (paper Fig. 7)",
            simplified_frequency,
            section=SECTION,
            group=_GROUP,
        ),
        Drawing(
            "frequency.stroke",
            "First two natural frequencies over the stroke (paper Fig. 10)",
            refined_frequencies,
            section=SECTION,
            group=_GROUP,
            effort=2.0,
        ),
        Drawing(
            "frequency.family-simplified",
            "First natural frequency of robots with longer legs, simplified model against beams "
            "(paper Fig. 12)",
            simplified_family,
            section=FAMILY_SECTION,
            group=_GROUP,
        ),
        Drawing(
            "frequency.family",
            "First two natural frequencies of robots with longer legs (paper Fig. 13)",
            refined_family,
            section=FAMILY_SECTION,
            group=_GROUP,
        ),
    )


def simplified_frequency(context: Context) -> Figure:
    """Left all models on a logarithmic axis, right the simplified one alone."""
    x, gathered, notes = _over_the_stroke(context, DYNAMIC_LINES)
    first = {line: values[:, 0] for line, values in gathered.items()}
    with plot_style():
        picture, (together, alone) = canvas(columns=2)
        draw_lines(together, x, first)
        _hertz(together, list(first.values()))
        together.set(xlabel="x of B (m)", ylabel="first natural frequency (Hz)")
        together.set_title("(a) all models")
        if SIMPLIFIED in first:
            draw_lines(alone, x, {SIMPLIFIED: first[SIMPLIFIED]})
        alone.set(xlabel="x of B (m)")
        alone.set_title("(b) the simplified model alone")
        legend_above(picture)
        svg = svg_of(picture)
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
        title="First natural frequency, simplified model against beams (paper Fig. 7)",
        caption=" ".join([*caption, *notes]),
        section=SECTION,
        svg=svg,
        data=csv_of({"x (m)": x.tolist()} | _columns({k: v[:, :1] for k, v in gathered.items()})),
    )


def refined_frequencies(context: Context) -> Figure:
    """Both frequencies of segments and beams in one pair of axes, with the printed eq. (25)."""
    x, gathered, notes = _over_the_stroke(context, (SEGMENTS, SEGMENTS_PRINTED, BEAM))
    with plot_style():
        picture, (axes,) = canvas(height=3.9)
        for mode in range(MODES):
            draw_lines(axes, x, {line: values[:, mode] for line, values in gathered.items()})
        from_zero(axes)
        _name_modes(axes, x, gathered)
        axes.set(xlabel="x of B (m)", ylabel="natural frequency (Hz)")
        legend_above(picture)
        svg = svg_of(picture)
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
    return Figure(
        id="frequency.stroke",
        title="First two natural frequencies over the stroke (paper Fig. 10)",
        caption=" ".join([*caption, *notes]),
        section=SECTION,
        svg=svg,
        data=csv_of({"x (m)": x.tolist()} | _columns(gathered)),
    )


def simplified_family(context: Context) -> Figure:
    """First frequency against α at three points, logarithmic axes."""
    found, notes = _families(context, DYNAMIC_LINES)
    everything = [v[:, 0] for gathered in found.values() for v in gathered.values()]
    with plot_style():
        picture, panels = canvas(columns=3)
        for axes, letter, (point, gathered) in zip(panels, "abc", found.items(), strict=True):
            draw_lines(axes, np.array(ALPHAS), {k: v[:, 0] for k, v in gathered.items()})
            _hertz(axes, everything)
            axes.set(xlabel=ALPHA_LABEL)
            axes.set_title(f"({letter}) {PLACES[point]}")
        panels[0].set_ylabel("first natural frequency (Hz)")
        legend_above(picture)
        svg = svg_of(picture)
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
        title="First natural frequency of robots with longer legs, simplified model against "
        "beams (paper Fig. 12)",
        caption=" ".join([*caption, *notes]),
        section=FAMILY_SECTION,
        svg=svg,
        data=_family_table({p: {k: v[:, :1] for k, v in g.items()} for p, g in found.items()}),
    )


def refined_family(context: Context) -> Figure:
    """Both frequencies against α at three points."""
    found, notes = _families(context, (SEGMENTS, BEAM))
    alphas = np.array(ALPHAS)
    with plot_style():
        picture, panels = canvas(columns=3)
        for axes, letter, (point, gathered) in zip(panels, "abc", found.items(), strict=True):
            for mode in range(MODES):
                draw_lines(axes, alphas, {k: v[:, mode] for k, v in gathered.items()})
                start = max(float(v[:4, mode].max()) for v in gathered.values())
                axes.annotate(
                    f"mode {mode + 1}",
                    (alphas[0], start),
                    xytext=(0.0, 6.0),
                    textcoords="offset points",
                    fontsize=8.5,
                )
            axes.set(xlabel=ALPHA_LABEL)
            axes.set_title(f"({letter}) {PLACES[point]}")
        top = max(axes.get_ylim()[1] for axes in panels)
        for axes in panels:
            axes.set_ylim(0.0, 1.1 * top)
        panels[0].set_ylabel("natural frequency (Hz)")
        legend_above(picture)
        svg = svg_of(picture)
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
        title="First two natural frequencies of robots with longer legs (paper Fig. 13)",
        caption=" ".join([*caption, *notes]),
        section=FAMILY_SECTION,
        svg=svg,
        data=_family_table(found),
    )


def _over_the_stroke(
    context: Context, lines: tuple[Line, ...]
) -> tuple[Array, Mapping[Line, Array], tuple[str, ...]]:
    x = stations(context.robot, POSTURES[context.preset])
    gathered = gather(
        lines,
        lambda line: context.get(frequencies_at, line.model, context.robot, x, MODES, line.options),
    )
    return x, gathered.values, gathered.notes


def _families(
    context: Context, lines: tuple[Line, ...]
) -> tuple[dict[str, Mapping[Line, Array]], tuple[str, ...]]:
    found: dict[str, Mapping[Line, Array]] = {}
    notes: dict[str, None] = {}
    for point, fraction in FIGURE_POINTS.items():
        gathered = gather(
            lines,
            lambda line, fraction=fraction: context.get(  # type: ignore[misc]
                family_frequencies,
                line.model,
                context.robot,
                ALPHAS,
                fraction,
                MODES,
                line.options,
            ),
        )
        found[point] = gathered.values
        notes |= dict.fromkeys(gathered.notes)
    return found, tuple(notes)


def _columns(gathered: Mapping[Line, Array]) -> dict[str, list[float]]:
    return {
        f"{line.label}: frequency {mode + 1} (Hz)": values[:, mode].tolist()
        for line, values in gathered.items()
        for mode in range(values.shape[1])
    }


def _family_table(found: Mapping[str, Mapping[Line, Array]]) -> str:
    columns: dict[str, list[float]] = {"alpha": list(ALPHAS)}
    for point, gathered in found.items():
        columns |= {f"{point}: {heading}": column for heading, column in _columns(gathered).items()}
    return csv_of(columns)


def _hertz(axes: Axes, curves: list[Array]) -> None:
    """Logarithmic frequency axis around the curves."""
    plain_log(
        axes,
        0.8 * min(float(curve.min()) for curve in curves),
        1.25 * max(float(curve.max()) for curve in curves),
    )


def _name_modes(axes: Axes, x: Array, gathered: Mapping[Line, Array]) -> None:
    """The number of the mode at the right end of its curves, eq. (25)'s where it lies apart."""
    exact = [values for line, values in gathered.items() if line is not SEGMENTS_PRINTED]
    names = {f"mode {mode + 1}": exact[-1][-1, mode] for mode in range(MODES)} if exact else {}
    for text, height in names.items():
        axes.annotate(
            text, (x[-1], height), xytext=(6.0, -3.0), textcoords="offset points", fontsize=8.5
        )
    printed = gathered.get(SEGMENTS_PRINTED)
    highest = axes.get_ylim()[1]
    if printed is not None:
        for mode in range(MODES):
            height = printed[-1, mode]
            if all(abs(height - other) > 0.07 * highest for other in names.values()):
                axes.annotate(
                    f"mode {mode + 1},\neq. (25)",
                    (x[-1], height),
                    xytext=(6.0, -8.0),
                    textcoords="offset points",
                    fontsize=8.5,
                )
