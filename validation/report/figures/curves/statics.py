"""Deflections over the stroke and along the family of robots with longer legs."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.context import Context
from validation.exhibits import FAMILY, STROKE, Drawing, Figure
from validation.report.figures.curves.lines import (
    BEAM,
    SEGMENTS,
    SIMPLIFIED,
    STATIC_LINES,
    VJM_EQUIVALENT,
    VJM_GIVEN,
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
from validation.report.figures.curves.sweeps import deflections_at
from validation.studies.quantities import ALPHAS, LOAD, Deflections, family_deflections

LOADS = {
    "planar_x": ("x", "planar"),
    "planar_y": ("y", "planar"),
    "along_z": ("z", "along z"),
}
_SIMPLIFIED_TITLE = f"Planar deflections, simplified model against beams {as_in_paper(3)}"
_STROKE_TITLE = f"Deflections over the stroke, all models {as_in_paper(5)}"
_FAMILY_TITLE = f"Deflections of robots with longer legs {as_in_paper(6)}"
_GROUP = "figures.statics"
# Relative difference of two models of the same legs: a thousand times rounding.
_SAME = 1e-6
_ONE_FORMULATION = (VJM_EQUIVALENT, SEGMENTS, BEAM)


def drawings() -> tuple[Drawing, ...]:
    """Planar deflections of the simplified model, those of all models, and the family's."""
    return (
        Drawing(
            "deflection.simplified",
            _SIMPLIFIED_TITLE,
            simplified_deflections,
            section=STROKE,
            group=_GROUP,
        ),
        Drawing(
            "deflection.stroke",
            _STROKE_TITLE,
            all_deflections,
            section=STROKE,
            group=_GROUP,
        ),
        Drawing(
            "deflection.family",
            _FAMILY_TITLE,
            deflections_of_the_family,
            section=FAMILY,
            group=_GROUP,
        ),
    )


def simplified_deflections(context: Context) -> Figure:
    """Two panels on logarithmic axes: a force along x and one along y."""
    x, (gathered, notes) = _over_the_stroke(context, (SIMPLIFIED, BEAM))
    names = ("planar_x", "planar_y")
    high = max(float(getattr(d, name).max()) for d in gathered.values() for name in names)
    panels = [
        # Zero has no place on a logarithmic axis: such a curve leaves it downwards.
        Panel(
            f"planar, force along {LOADS[name][0]}",
            [{line: np.maximum(getattr(d, name), 1e-9) for line, d in gathered.items()}],
            "" if place else f"deflection under {LOAD:g} N (µm)",
        )
        for place, name in enumerate(names)
    ]

    def logarithmic(drawn: Sequence[Axes]) -> None:
        for axes in drawn:
            plain_log(axes, high / 100.0, 1.6 * high)

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
        title=_SIMPLIFIED_TITLE,
        caption=" ".join([*caption, *notes]),
        section=STROKE,
        svg=panels_svg(x, STROKE_LABEL, panels, logarithmic, columns=2, against=BEAM),
        data=stroke_table(x, _columns(gathered)),
    )


def all_deflections(context: Context) -> Figure:
    """Three panels: planar under a force along x, along y, and out of the plane."""
    x, (gathered, notes) = _over_the_stroke(context, STATIC_LINES)
    panels = [
        Panel(
            f"{meaning}, {LOAD:g} N along {load}",
            [{line: getattr(d, name) for line, d in gathered.items()}],
            "" if place else "deflection (µm)",
        )
        for place, (name, (load, meaning)) in enumerate(LOADS.items())
    ]
    return Figure(
        id="deflection.stroke",
        title=_STROKE_TITLE,
        caption=" ".join(["Deflections of the loaded point.", *_reading(gathered), *notes]),
        section=STROKE,
        svg=panels_svg(
            x, STROKE_LABEL, panels, all_from_zero, columns=3, legend_columns=3, against=VJM_GIVEN
        ),
        data=stroke_table(x, _columns(gathered)),
    )


def deflections_of_the_family(context: Context) -> Figure:
    """A column of panels for each point of the stroke, a row for each load."""
    found, notes = along_the_family(
        (SIMPLIFIED, *_ONE_FORMULATION),
        lambda line, fraction: context.get(
            family_deflections, line.model, context.robot, ALPHAS, fraction, line.options
        ),
    )
    panels = [
        panel
        for name, (load, meaning) in LOADS.items()
        for panel in family_panels(
            found,
            lambda gathered, name=name: [  # type: ignore[misc]
                {line: getattr(d, name) for line, d in gathered.items()}
            ],
            f"{meaning}, {LOAD:g} N along {load}\n(µm)",
        )
    ]

    def rows_alike(drawn: Sequence[Axes]) -> None:
        for start in range(0, len(drawn), len(found)):
            common_top(drawn[start : start + len(found)])

    return Figure(
        id="deflection.family",
        title=_FAMILY_TITLE,
        caption=" ".join([*_family_reading(found), *notes]),
        section=FAMILY,
        svg=family_svg(panels, rows_alike, height=6.6),
        data=family_table({point: _columns(gathered) for point, gathered in found.items()}),
    )


def _over_the_stroke(
    context: Context, lines: Sequence[Line]
) -> tuple[Array, tuple[Mapping[Line, Deflections], tuple[str, ...]]]:
    x, gathered = over_the_stroke(
        context,
        lines,
        lambda line, x: context.get(deflections_at, line.model, context.robot, x, line.options),
    )
    return x, (gathered.values, gathered.notes)


def _columns(gathered: Mapping[Line, Deflections]) -> dict[str, list[float]]:
    return {
        f"{line.label}: deflection {meaning} under {LOAD:g} N along {load} (µm)": values.tolist()
        for line, deflections in gathered.items()
        for name, (load, meaning) in LOADS.items()
        if np.any(np.isfinite(values := getattr(deflections, name)))
    }


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
    drawn = "Legs α times as long, stroke and sections unchanged."
    centre = [d for line, d in found["centre"].items() if line is not SIMPLIFIED]
    if not centre:
        return [drawn]
    planar, along_z = centre[-1].planar_x, centre[-1].along_z
    return [
        drawn,
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
