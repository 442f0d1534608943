"""Deflections over the stroke and along the family of robots with longer legs."""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array
from validation.cases.paper_family import ALPHAS, FIGURE_POINTS
from validation.cases.robot import SECTION
from validation.context import Context
from validation.drawings.lines import (
    ALPHA_LABEL,
    BEAM,
    PLACES,
    POSTURES,
    SEGMENTS,
    SIMPLIFIED,
    STATIC_LINES,
    VJM_EQUIVALENT,
    VJM_GIVEN,
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
from validation.drawings.sweeps import deflections_at, stations
from validation.exhibits import Drawing, Figure
from validation.quantities import LOAD, Deflections, family_deflections
from validation.report.style import canvas, csv_of, plot_style, svg_of

FAMILY_SECTION = "Robots with longer legs"
LOADS = {
    "planar_x": ("x", "planar"),
    "planar_y": ("y", "planar"),
    "along_z": ("z", "along z"),
}
_GROUP = "drawings.statics"
# Relative difference of two models of the same legs: a thousand times rounding.
_SAME = 1e-6
_ONE_FORMULATION = (VJM_EQUIVALENT, SEGMENTS, BEAM)


def drawings() -> tuple[Drawing, ...]:
    """Planar deflections of the simplified model, those of all models, and the family's."""
    return (
        Drawing(
            "deflection.simplified",
            "Planar deflections, simplified model against beams (paper Fig. 3)",
            simplified_deflections,
            section=SECTION,
            group=_GROUP,
        ),
        Drawing(
            "deflection.stroke",
            "Deflections over the stroke, all models (paper Fig. 5)",
            all_deflections,
            section=SECTION,
            group=_GROUP,
        ),
        Drawing(
            "deflection.family",
            "Deflections of robots with longer legs (paper Fig. 6)",
            deflections_of_the_family,
            section=FAMILY_SECTION,
            group=_GROUP,
        ),
    )


def simplified_deflections(context: Context) -> Figure:
    """Two panels on logarithmic axes: a force along x and one along y."""
    x, gathered, notes = _over_the_stroke(context, (SIMPLIFIED, BEAM))
    names = ("planar_x", "planar_y")
    finite = [getattr(d, name) for d in gathered.values() for name in names]
    high = max(float(curve.max()) for curve in finite)
    with plot_style():
        picture, panels = canvas(columns=2)
        for axes, letter, name in zip(panels, "ab", names, strict=True):
            # Zero has no place on a logarithmic axis: such a curve leaves it downwards.
            curves = {line: getattr(d, name) for line, d in gathered.items()}
            draw_lines(axes, x, {line: np.maximum(c, 1e-9) for line, c in curves.items()})
            plain_log(axes, high / 100.0, 1.6 * high)
            axes.set(xlabel="x of B (m)", ylabel=f"deflection under {LOAD:g} N (µm)")
            axes.set_title(f"({letter}) planar, force along {LOADS[name][0]}")
        panels[1].set_ylabel("")
        legend_above(picture)
        svg = svg_of(picture)
    caption = [
        "Norm of the planar deflection of B: drives alone elastic (simplified), and the legs as "
        "beams with their feet (finite elements)."
    ]
    if SIMPLIFIED in gathered and BEAM in gathered:
        simple, beam = gathered[SIMPLIFIED], gathered[BEAM]
        caption += [
            f"Simplified: at most {simple.largest_planar:.2f} µm; under a force along x "
            f"{simple.planar_x[0]:.1f} and {simple.planar_x[-1]:.1f} µm at the ends of the stroke "
            "(where a curve falls to zero it leaves the logarithmic axis). "
            f"Beams: up to {beam.largest_planar:.1f} µm, "
            f"{beam.largest_planar / simple.largest_planar:.1f} times as much."
        ]
        if beam.largest_planar > 2.0 * simple.largest_planar:
            caption.append("The simplified model is no estimate of the deflection.")
    return Figure(
        id="deflection.simplified",
        title="Planar deflections, simplified model against beams (paper Fig. 3)",
        caption=" ".join([*caption, *notes]),
        section=SECTION,
        svg=svg,
        data=_stroke_table(x, gathered),
    )


def all_deflections(context: Context) -> Figure:
    """Three panels: planar under a force along x, along y, and out of the plane."""
    x, gathered, notes = _over_the_stroke(context, STATIC_LINES)
    with plot_style():
        picture, panels = canvas(columns=3)
        for axes, letter, (name, (load, meaning)) in zip(panels, "abc", LOADS.items(), strict=True):
            draw_lines(axes, x, {line: getattr(d, name) for line, d in gathered.items()})
            from_zero(axes)
            axes.set(xlabel="x of B (m)", ylabel="deflection (µm)" if letter == "a" else "")
            axes.set_title(f"({letter}) {meaning}, {LOAD:g} N along {load}")
        legend_above(picture, columns=3)
        svg = svg_of(picture)
    return Figure(
        id="deflection.stroke",
        title="Deflections over the stroke, all models (paper Fig. 5)",
        caption=" ".join(["Deflections of the loaded point.", *_reading(gathered), *notes]),
        section=SECTION,
        svg=svg,
        data=_stroke_table(x, gathered),
    )


def deflections_of_the_family(context: Context) -> Figure:
    """A column of panels for each point of the stroke, a row for each load."""
    lines = (SIMPLIFIED, *_ONE_FORMULATION)
    alphas = np.array(ALPHAS)
    found: dict[str, Mapping[Line, Deflections]] = {}
    notes: tuple[str, ...] = ()
    for point, fraction in FIGURE_POINTS.items():
        found[point], new = _family(context, lines, fraction)
        notes += tuple(note for note in new if note not in notes)
    with plot_style():
        picture, panels = canvas(rows=3, columns=3, height=6.6)
        grid = np.array(panels).reshape(3, 3)
        for row, (name, (load, meaning)) in zip(grid, LOADS.items(), strict=True):
            for axes, gathered in zip(row, found.values(), strict=True):
                draw_lines(axes, alphas, {line: getattr(d, name) for line, d in gathered.items()})
            top = max(axes.get_ylim()[1] for axes in row)
            for axes in row:
                axes.set_ylim(0.0, 1.08 * top)
            row[0].set_ylabel(f"{meaning}, {LOAD:g} N along {load}\n(µm)")
        for axes, letter, point in zip(grid[0], "abc", found, strict=True):
            axes.set_title(f"({letter}) {PLACES[point]}")
        for axes in grid[-1]:
            axes.set_xlabel(ALPHA_LABEL)
        legend_above(picture)
        svg = svg_of(picture)
    data = {"alpha": list(ALPHAS)} | {
        f"{point}: {heading}": column
        for point, gathered in found.items()
        for heading, column in _columns(gathered).items()
    }
    return Figure(
        id="deflection.family",
        title="Deflections of robots with longer legs (paper Fig. 6)",
        caption=" ".join([*_family_reading(found), *notes]),
        section=FAMILY_SECTION,
        svg=svg,
        data=csv_of(data),
    )


def _over_the_stroke(
    context: Context, lines: tuple[Line, ...]
) -> tuple[Array, Mapping[Line, Deflections], tuple[str, ...]]:
    x = stations(context.robot, POSTURES[context.preset])
    gathered = gather(
        lines,
        lambda line: context.get(deflections_at, line.model, context.robot, x, line.options),
    )
    return x, gathered.values, gathered.notes


def _family(
    context: Context, lines: tuple[Line, ...], fraction: float
) -> tuple[Mapping[Line, Deflections], tuple[str, ...]]:
    gathered = gather(
        lines,
        lambda line: context.get(
            family_deflections, line.model, context.robot, ALPHAS, fraction, line.options
        ),
    )
    return gathered.values, gathered.notes


def _columns(gathered: Mapping[Line, Deflections]) -> dict[str, list[float]]:
    return {
        f"{line.label}: deflection {meaning} under {LOAD:g} N along {load} (µm)": values.tolist()
        for line, deflections in gathered.items()
        for name, (load, meaning) in LOADS.items()
        if np.any(np.isfinite(values := getattr(deflections, name)))
    }


def _stroke_table(x: Array, gathered: Mapping[Line, Deflections]) -> str:
    return csv_of({"x (m)": x.tolist()} | _columns(gathered))


def _reading(gathered: Mapping[Line, Deflections]) -> list[str]:
    """What the curves over the stroke say, in numbers of this robot."""
    said = []
    if VJM_GIVEN in gathered and SIMPLIFIED in gathered:
        given, simple = gathered[VJM_GIVEN], gathered[SIMPLIFIED]
        along_z = float(given.along_z.max())
        said.append(
            f"Virtual joints with the legs as given reach {given.largest_planar:.1f} µm in the "
            f"plane, {given.largest_planar / simple.largest_planar:.1f} times the simplified "
            f"model, and {along_z:.1f} µm along z, {along_z / given.largest_planar:.1f} times the "
            "planar ones: what the simplified model leaves out is the larger part."
        )
    alike = [gathered[line] for line in _ONE_FORMULATION if line in gathered]
    if len(alike) > 1:
        apart = max(spread([getattr(d, name) for d in alike]) for name in LOADS)
        said.append(
            "With the same equivalent legs, virtual joints, segments and beam elements lie on one "
            f"curve (they differ by {accuracy(apart)})."
        )
        if VJM_GIVEN in gathered:
            given = gathered[VJM_GIVEN]
            apart = max(spread([getattr(given, n), getattr(alike[0], n)]) for n in LOADS)
            said.append(
                "The legs as given have constant sections: they lie on it too."
                if apart < _SAME
                else "What separates it from the legs as given is the data of the legs, not the "
                "formulation."
            )
    return said


def _family_reading(found: Mapping[str, Mapping[Line, Deflections]]) -> list[str]:
    centre = {line: d for line, d in found["centre"].items() if line is not SIMPLIFIED}
    reference = list(centre.values())[-1]
    planar, along_z = reference.planar_x, reference.along_z
    return [
        "Legs α times as long, stroke and sections unchanged.",
        f"At the centre the planar deflection under a force along x {course(planar)} from "
        f"{planar[0]:.1f} to {planar[-1]:.1f} µm, the one along z {course(along_z)} from "
        f"{along_z[0]:.0f} to {along_z[-1]:.0f} µm.",
        *(
            [
                "The simplified model knows nothing of the deflection along z: an optimum found "
                "with it has legs that are too long."
            ]
            if course(along_z) == "rises"
            else []
        ),
    ]
