"""All models over a number of the robot file, and how far they are apart."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.robot_file.key_units import unit_of
from lumped.robot_file.variation import Variation
from validation.context import SWEEPS_FOLDER, Context
from validation.exhibits import PARAMETERS, Figure, PlannedFigure
from validation.report.figures.declared import compared_with, curves
from validation.report.figures.mechanism.curves import (
    HELD,
    ONE_SHAPE,
    OWN_LOADS,
    deflection_chart,
    frequency_chart,
)
from validation.sweeps.studies import journal_in
from validation.variations.curves import VariedCurves, variation_study


def figures_over(variations: Sequence[Variation]) -> tuple[PlannedFigure, ...]:
    """Deflections and frequencies over each number that is varied."""
    return tuple(
        PlannedFigure(
            f"vary.{number}.{what}",
            f"{title} over {variation.key}",
            partial(draw, variation=variation, number=number),
            section=PARAMETERS,
            group=f"vary.{number}",
            effort=float(len(variation.values)),
        )
        for number, variation in enumerate(variations, start=1)
        for what, title, draw in (
            ("deflections", "Deflection", deflections),
            ("frequencies", "Natural frequencies", frequencies),
        )
    )


def deflections(context: Context, *, variation: Variation, number: int) -> Figure:
    """A panel for each direction, under a force or a moment along it."""
    found = _curves(context, variation)
    place = _place(context, found)
    at = f", with the tool at {place}" if place else ""
    said = f"Of the loaded point{at}. {HELD}{_alike(variation)}"
    chart = deflection_chart(found.statics, *_over(context, variation))
    return curves(chart, said, compared_with(found.statics.against)).figure(
        f"vary.{number}.deflections",
        f"Deflection over {variation.key}: {OWN_LOADS}",
        PARAMETERS,
    )


def frequencies(context: Context, *, variation: Variation, number: int) -> Figure:
    """A panel for each of the first frequencies, in ascending order at each value."""
    found = _curves(context, variation)
    place = _place(context, found)
    said = f"With the tool at {place}." if place else ""
    chart = frequency_chart(found.dynamics, *_over(context, variation))
    against = compared_with(found.dynamics.against)
    return curves(chart, said, f"{ONE_SHAPE}{_alike(variation)}", against).figure(
        f"vary.{number}.frequencies", f"Natural frequencies over {variation.key}", PARAMETERS
    )


def _curves(context: Context, variation: Variation) -> VariedCurves:
    journal = journal_in(context.options.get(SWEEPS_FOLDER, ""))
    return variation_study(context.robot_file, variation, context.preset, journal)


def _place(context: Context, found: VariedCurves) -> str:
    return shown_pose(context.robot_file.mechanism, np.array(found.pose))


def _over(
    context: Context, variation: Variation
) -> tuple[Array, str, Mapping[str, Sequence[float]]]:
    unit = unit_of(context.robot_file.tables, variation.keys[0])
    label = f"{variation.key} ({unit})" if unit else variation.key
    values = np.array(variation.values)
    return values, label, {label: values.tolist()}


def _alike(variation: Variation) -> str:
    keys = len(variation.keys)
    return "" if keys == 1 else f" {keys} numbers change alike."
