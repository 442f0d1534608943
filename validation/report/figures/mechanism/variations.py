"""All models over a number of the robot file, and how far they are apart."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from lumped.robot_file.key_units import unit_of
from lumped.robot_file.variation import Variation
from validation.adequacy.mechanism.path import has_given
from validation.context import SWEEPS_FOLDER, Context
from validation.exhibits import PARAMETERS, Drawing, Figure
from validation.report.figures.mechanism.curves import (
    HELD,
    ONE_SHAPE,
    OWN_LOADS,
    deflection_panels,
    frequency_panels,
)
from validation.report.figures.mechanism.panels import Abscissa, compared_figure
from validation.sweeps.studies import journal_in
from validation.variations.curves import VariedCurves, variation_study


def drawings(variations: Sequence[Variation]) -> tuple[Drawing, ...]:
    """Deflections and frequencies over each number that is varied."""
    return tuple(
        Drawing(
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
    return compared_figure(
        f"vary.{number}.deflections",
        f"Deflection over {variation.key}: {OWN_LOADS}",
        f"Of the loaded point{_place(context, found)}. {HELD}{_alike(variation)}",
        PARAMETERS,
        _over(context, variation),
        deflection_panels(found.statics),
        found.statics.against,
    )


def frequencies(context: Context, *, variation: Variation, number: int) -> Figure:
    """A panel for each of the first frequencies, in ascending order at each value."""
    found = _curves(context, variation)
    place = _place(context, found).removeprefix(", ")
    said = f"{place[:1].upper()}{place[1:]}. " if place else ""
    return compared_figure(
        f"vary.{number}.frequencies",
        f"Natural frequencies over {variation.key}",
        f"{said}{ONE_SHAPE}{_alike(variation)}",
        PARAMETERS,
        _over(context, variation),
        frequency_panels(found.dynamics, bracket=has_given(context.robot_file.mechanism)),
        found.dynamics.against,
        columns=2,
    )


def _curves(context: Context, variation: Variation) -> VariedCurves:
    journal = journal_in(context.options.get(SWEEPS_FOLDER, ""))
    return variation_study(context.robot_file, variation, context.preset, journal)


def _place(context: Context, found: VariedCurves) -> str:
    moves = context.robot_file.mechanism.tool.moves
    at = ", ".join(
        f"{move} = {value:.6g} {'rad' if move.startswith('phi') else 'm'}"
        for move, value in zip(moves, found.pose, strict=True)
    )
    return f", with the tool at {at}" if at else ""


def _over(context: Context, variation: Variation) -> Abscissa:
    unit = unit_of(context.robot_file.tables, variation.keys[0])
    label = f"{variation.key} ({unit})" if unit else variation.key
    values = np.array(variation.values)
    return Abscissa(values, label, {label: values.tolist()})


def _alike(variation: Variation) -> str:
    keys = len(variation.keys)
    return "" if keys == 1 else f" {keys} numbers change alike."
