"""Statements about robots with longer legs and the same stroke (paper §2.3 and §3.3)."""

from collections.abc import Callable

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement
from validation.cases.paper_statement import Statement
from validation.context import Context
from validation.models.options import ModelName, ModelOptions
from validation.quantities import Deflections, family_deflections, family_frequencies
from validation.ranks import spearman

ALPHAS = tuple(np.linspace(1.0, 2.0, 11).tolist())
# Where Figs 6, 12 and 13 are drawn, as a fraction of the stroke.
FIGURE_POINTS = {"centre": 0.5, "left": 0.0, "right": 1.0}
EQUIVALENT = ModelOptions(legs="equivalent")


def _trend(curve: Array) -> float:
    """Spearman's rank correlation with α: +1 rises throughout, −1 falls throughout."""
    return spearman(ALPHAS, curve)


def _family(context: Context, model: ModelName, point: str) -> Deflections:
    fraction = FIGURE_POINTS[point]
    return context.get(
        family_deflections,
        model,
        context.robot,
        ALPHAS,
        fraction,
        EQUIVALENT,
    )


def _family_first(context: Context, model: ModelName, point: str) -> Array:
    fraction = FIGURE_POINTS[point]
    frequencies = context.get(
        family_frequencies,
        model,
        context.robot,
        ALPHAS,
        fraction,
        1,
    )
    return frequencies[:, 0]


def _planar_falls(context: Context) -> Measurement:
    found = {point: _family(context, "vjm", point).planar_x for point in FIGURE_POINTS}
    return Measurement(
        _trend(found["centre"]),
        reference=-1.0,
        notes=(
            "At the ends of the stroke, where one leg carries the force along its axis, the "
            f"deflection is small and grows with the leg: {found['left'][0]:.2f} to "
            f"{found['left'][-1]:.2f} µm on the left, {found['right'][0]:.2f} to "
            f"{found['right'][-1]:.2f} µm on the right.",
        ),
        table={"α": ALPHAS}
        | {f"{point} (µm)": tuple(curve.tolist()) for point, curve in found.items()},
    )


def _z_rises(point: str) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        return Measurement(_trend(_family(context, "vjm", point).along_z), reference=1.0)

    return compute


def _simplified_rises(context: Context) -> Measurement:
    found = {point: _family_first(context, "simplified", point) for point in FIGURE_POINTS}
    return Measurement(
        _trend(found["centre"]),
        reference=1.0,
        notes=(
            "At both ends of the stroke the simplified first frequency does not depend on α: "
            f"{found['left'][0]:.1f} Hz throughout.",
        ),
    )


def _refined_falls(point: str) -> Callable[[Context], Measurement]:
    def compute(context: Context) -> Measurement:
        return Measurement(_trend(_family_first(context, "segments", point)), reference=-1.0)

    return compute


def _trends() -> tuple[Statement, ...]:
    quantity = "rank correlation with α from 1 to 2"
    reason = "±1 means throughout; one exchanged pair among eleven members changes it by 0.01"
    tolerance = Absolute(0.005)
    single = [
        (
            "family.planar-falls",
            "§2.3, Fig. 6a",
            "Longer legs: smaller planar deflection under a force along x, at the centre",
            _planar_falls,
        ),
        (
            "family.simplified-rises",
            "§3.3, Fig. 12a",
            "Simplified model: longer legs, higher first frequency, at the centre",
            _simplified_rises,
        ),
    ]
    per_point = [
        (
            f"family.z-rises[{point}]",
            f"§2.3, Fig. 6 ({point})",
            f"Longer legs: larger deflection along z ({point})",
            _z_rises(point),
        )
        for point in FIGURE_POINTS
    ] + [
        (
            f"family.refined-falls[{point}]",
            f"§3.3, Fig. 13 ({point})",
            f"Rigid segments: longer legs, lower first frequency ({point})",
            _refined_falls(point),
        )
        for point in FIGURE_POINTS
    ]
    return tuple(
        Statement(
            name, where, says, quantity, "1", tolerance, reason, compute, group="paper.family"
        )
        for name, where, says, compute in (*single, *per_point)
    )


STATEMENTS = _trends()
