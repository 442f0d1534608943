"""Deflections over the stroke and along the family of robots with longer legs."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.context import Context
from validation.drawing.chart import Panel, Series, compared, lettered
from validation.drawing.scales import Scale, from_zero, largest, plain_log, up_to
from validation.exhibits import FAMILY, STROKE
from validation.report.figures.curves.computed import (
    FAMILY_SAID,
    along_the_family,
    deflections_at,
    family_chart,
    family_panel,
    over_the_stroke,
    stroke_chart,
)
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
    spread,
)
from validation.report.figures.declared import FigureGroup, Shown, compared_with, curves
from validation.studies.quantities import ALPHAS, LOAD, Deflections, family_deflections

Found: TypeAlias = Mapping[Line, Deflections]
LOADS = {
    "planar_x": ("x", "planar"),
    "planar_y": ("y", "planar"),
    "along_z": ("z", "along z"),
}
# Relative difference of two models of the same legs: a thousand times rounding.
_SAME = 1e-6
_ONE_FORMULATION = (VJM_EQUIVALENT, SEGMENTS, BEAM)
over_stroke = FigureGroup(STROKE, "figures.statics")
over_family = FigureGroup(FAMILY, "figures.statics")


@over_stroke.figure(
    "deflection.simplified",
    f"Planar deflections, simplified model against beams {as_in_paper(3)}",
)
def simplified_deflections(context: Context) -> Shown:
    """Two panels on logarithmic axes: a force along x and one along y."""
    x, found, notes = _over_the_stroke(context, (SIMPLIFIED, BEAM))
    names = ("planar_x", "planar_y")
    high = max(float(getattr(d, name).max()) for d in found.values() for name in names)
    scale = partial(plain_log, low=high / 100.0, high=1.6 * high)
    panels = [
        _panel(found, x, name, scale, "" if place else f"deflection under {LOAD:g} N (µm)", BEAM)
        for place, name in enumerate(names)
    ]
    caption = [
        "Norm of the planar deflection of B: drives alone elastic (simplified), and the legs as "
        "beams with their feet (finite elements)."
    ]
    if SIMPLIFIED in found and BEAM in found:
        simple, beam = found[SIMPLIFIED], found[BEAM]
        caption += [
            f"Simplified: at most {simple.largest_planar:.2f} µm; under a force along x "
            f"{simple.planar_x[0]:.1f} and {simple.planar_x[-1]:.1f} µm at the ends of the stroke "
            "(where a curve falls to zero it leaves the logarithmic axis). "
            f"Beams: up to {beam.largest_planar:.1f} µm, "
            f"{beam.largest_planar / simple.largest_planar:.1f} times as much."
        ]
        if beam.largest_planar > 2.0 * simple.largest_planar:
            caption.append("The simplified model is no estimate of the deflection.")
    below = compared_with(BEAM.label) if BEAM in found else ""
    return curves(stroke_chart(x, lettered(panels)), *caption, below, notes)


@over_stroke.figure(
    "deflection.stroke", f"Deflections over the stroke, all models {as_in_paper(5)}"
)
def all_deflections(context: Context) -> Shown:
    """Three panels: planar under a force along x, along y, and out of the plane."""
    x, found, notes = _over_the_stroke(context, STATIC_LINES)
    panels = [
        _panel(found, x, name, from_zero, "" if place else "deflection (µm)", VJM_GIVEN)
        for place, name in enumerate(LOADS)
    ]
    return curves(
        stroke_chart(x, lettered(panels), legend_columns=3),
        "Deflections of the loaded point.",
        *_reading(found),
        compared_with(VJM_GIVEN.label) if VJM_GIVEN in found else "",
        notes,
    )


@over_family.figure("deflection.family", f"Deflections of robots with longer legs {as_in_paper(6)}")
def deflections_of_the_family(context: Context) -> Shown:
    """A column of panels for each point of the stroke, a row for each load."""
    found, notes = along_the_family(
        (SIMPLIFIED, *_ONE_FORMULATION),
        lambda line, fraction: context.get(
            family_deflections, line.model, context.robot, ALPHAS, fraction, line.options
        ),
    )
    panels = []
    for name, (load, meaning) in LOADS.items():
        top = largest(getattr(d, name) for at in found.values() for d in at.values())
        label = f"{meaning}, {LOAD:g} N along {load}\n(µm)"
        panels += [
            family_panel(point, _series(at, np.array(ALPHAS), name), label, partial(up_to, top=top))
            for point, at in found.items()
        ]
    return curves(family_chart(panels, high=1.9), *_family_reading(found), notes)


def _over_the_stroke(context: Context, lines: Sequence[Line]) -> tuple[Array, Found, str]:
    x, gathered = over_the_stroke(
        context,
        lines,
        lambda line, x: context.get(deflections_at, line.model, context.robot, x, line.options),
    )
    return x, gathered.values, " ".join(gathered.notes)


def _series(found: Found, x: Array, name: str) -> list[Series]:
    load, meaning = LOADS[name]
    quantity = f"deflection {meaning} under {LOAD:g} N along {load} (µm)"
    return [line.series(x, getattr(d, name), quantity) for line, d in found.items()]


def _panel(found: Found, x: Array, name: str, scale: Scale, y_label: str, against: Line) -> Panel:
    load, meaning = LOADS[name]
    title = (
        f"{LOAD:g} N along {load}" if load == meaning[-1] else f"{meaning}, {LOAD:g} N along {load}"
    )
    return compared(Panel(_series(found, x, name), title, y_label, scale), against.label)


def _reading(found: Found) -> list[str]:
    """What the curves over the stroke say, in numbers of this robot."""
    said = []
    if VJM_GIVEN in found and SIMPLIFIED in found:
        given, simple = found[VJM_GIVEN], found[SIMPLIFIED]
        along_z = float(given.along_z.max())
        said.append(
            f"Virtual joints with the legs as given reach {given.largest_planar:.1f} µm in the "
            f"plane, {given.largest_planar / simple.largest_planar:.1f} times the simplified "
            f"model, and {along_z:.1f} µm along z, {along_z / given.largest_planar:.1f} times the "
            "planar ones: what the simplified model leaves out is the larger part."
        )
    alike = [found[line] for line in _ONE_FORMULATION if line in found]
    if len(alike) > 1:
        apart = max(spread([getattr(d, name) for d in alike]) for name in LOADS)
        said.append(
            "With the same equivalent legs, virtual joints, segments and beam elements lie on one "
            f"curve (they differ by {accuracy(apart)})."
        )
        if VJM_GIVEN in found:
            given = found[VJM_GIVEN]
            apart = max(spread([getattr(given, n), getattr(alike[0], n)]) for n in LOADS)
            said.append(
                "The legs as given have constant sections: they lie on it too."
                if apart < _SAME
                else "What separates it from the legs as given is the data of the legs, not the "
                "formulation."
            )
    return said


def _family_reading(found: Mapping[str, Found]) -> list[str]:
    centre = [d for line, d in found["centre"].items() if line is not SIMPLIFIED]
    if not centre:
        return [FAMILY_SAID]
    planar, along_z = centre[-1].planar_x, centre[-1].along_z
    return [
        FAMILY_SAID,
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
