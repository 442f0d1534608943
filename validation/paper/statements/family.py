"""Statements about robots with longer legs and the same stroke (paper §2.3 and §3.3)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement, Relation, Sides
from validation.context import Context
from validation.models.options import LITERAL_ORDER, SEGMENT_ORDER, ModelName, ModelOptions
from validation.paper.robot import (
    ALPHAS,
    FIGURE_POINTS,
    Deflections,
    ModeShares,
    Places,
    compliances,
    deflections,
    family,
    frequencies,
    modes,
)
from validation.paper.statements.statement import (
    FORMULAS,
    SEGMENTS,
    SIMPLIFIED,
    VJM,
    Compute,
    Statement,
)
from validation.variations.decision import spearman

EQUIVALENT = ModelOptions(legs="equivalent")
# Two values of a curve closer than this (relative) are equal: a curve that rounding alone moves
# neither rises nor falls.
_EQUAL = 1e-9
# A mode is named by its direction if 95 % of its motion goes there.
_DIRECTED = 0.95


def _trend(curve: Array) -> float:
    """Spearman's rank correlation with α: +1 rises throughout, −1 falls throughout, 0 constant."""
    steps = np.round(curve / (_EQUAL * np.max(np.abs(curve))))
    return 0.0 if np.ptp(steps) <= 1.0 else spearman(np.array(ALPHAS), steps)


def _members(context: Context, point: str) -> tuple[Places, ...]:
    return context.get(family, context.robot_file, FIGURE_POINTS[point])


def _deflected(context: Context, point: str, model: ModelName = "vjm") -> Deflections:
    return context.get(deflections, model, _members(context, point), EQUIVALENT)


def _simplified(context: Context, point: str) -> Array:
    return context.get(frequencies, "simplified", _members(context, point), 1)[:, 0]


def _modes(context: Context, point: str, reading: ModelOptions) -> list[ModeShares]:
    return context.get(modes, "segments", _members(context, point), 2, reading)


def _refined(context: Context, point: str, reading: ModelOptions, mode: int) -> Array:
    return np.array([one.frequencies[mode] for one in _modes(context, point, reading)])


def _trend_of(curve: Callable[[Context, ModelOptions], Array], reference: float) -> Compute:
    def compute(context: Context, reading: ModelOptions) -> Measurement:
        return Measurement(_trend(curve(context, reading)), reference=reference, exact=True)

    return compute


def _deflection_trend(name: str, point: str, reference: float) -> Compute:
    return _trend_of(lambda context, _: getattr(_deflected(context, point), name), reference)


def _simplified_trend(point: str) -> Compute:
    return _trend_of(lambda context, _: _simplified(context, point), 1.0)


def _frequency_trend(mode: int, point: str) -> Compute:
    return _trend_of(lambda context, reading: _refined(context, point, reading, mode), -1.0)


def _planar_falls(context: Context, reading: ModelOptions) -> Measurement:
    found = {point: _deflected(context, point).planar_x for point in FIGURE_POINTS}
    return replace(
        _deflection_trend("planar_x", "centre", -1.0)(context, reading),
        notes=(
            "At the ends of the stroke, where one leg carries the force along its axis, the "
            f"deflection is small and grows with the leg: {found['left'][0]:.2f} to "
            f"{found['left'][-1]:.2f} µm on the left, {found['right'][0]:.2f} to "
            f"{found['right'][-1]:.2f} µm on the right.",
        ),
        table={"α": ALPHAS}
        | {f"{point} (µm)": tuple(curve.tolist()) for point, curve in found.items()},
    )


def _simplified_rises(context: Context, reading: ModelOptions) -> Measurement:
    return replace(
        _simplified_trend("centre")(context, reading),
        notes=(
            "At both ends of the stroke the simplified first frequency does not depend on α: "
            f"{_simplified(context, 'left')[0]:.1f} Hz throughout.",
        ),
    )


def _across(loads: tuple[int, ...], directions: tuple[int, ...]) -> Compute:
    """Largest displacement along `directions` under unit `loads`, in % of that along the loads."""

    def compute(context: Context, _reading: ModelOptions) -> Measurement:
        everywhere = [at for point in FIGURE_POINTS for at in _members(context, point)]
        found = context.get(compliances, "vjm", everywhere, EQUIVALENT)[:, :, loads]
        across, along = (
            np.max(np.linalg.norm(found[:, rows], axis=1), axis=0) for rows in (directions, loads)
        )
        return Measurement(
            100.0 * float(np.max(across / along)),
            reference=0.0,
            exact=True,
            notes=(
                "The foot's couplings of planes and z alone make any: constant-section legs have "
                "none.",
            ),
        )

    return compute


def _lowest_two(point: str) -> Compute:
    def compute(context: Context, reading: ModelOptions) -> Measurement:
        along_z = np.array([one.kinetic["z"] for one in _modes(context, point, reading)])
        shown = (along_z[:, 0] >= _DIRECTED) & (along_z[:, 1] <= 1.0 - _DIRECTED)
        return Measurement(float(np.sum(~shown)), reference=0.0, exact=True)

    return compute


def _stiffest(context: Context, _reading: ModelOptions) -> Measurement:
    refined, simplified = (_deflected(context, "centre", of) for of in ("vjm", "simplified"))
    worst = np.max([refined.planar_x, refined.planar_y, refined.along_z], axis=0)
    worst_simplified = np.maximum(simplified.planar_x, simplified.planar_y)
    return _shorter(np.argmin(worst), np.argmin(worst_simplified))


def _fastest(context: Context, reading: ModelOptions) -> Measurement:
    first = _refined(context, "centre", reading, 0)
    return _shorter(np.argmax(first), np.argmax(_simplified(context, "centre")))


def _shorter(refined: np.intp, simplified: np.intp) -> Measurement:
    """The member that the refined model chooses, against the one before the simplified model's."""
    alpha, simple = ALPHAS[refined], ALPHAS[simplified]
    return Measurement(
        alpha,
        reference=simple - (ALPHAS[1] - ALPHAS[0]),
        exact=True,
        notes=(f"α = {alpha:g} by the refined model, {simple:g} by the simplified one.",),
    )


_REASON = "±1 means throughout; one exchanged pair among eleven members changes it by 0.01"
_TREND = ("rank correlation with α from 1 to 2", "1", Absolute(0.005), _REASON)


STATEMENTS = (
    Statement(
        "family.planar-falls",
        "§2.3, Fig. 6",
        "Longer legs: smaller planar deflection under a force along x, at the centre",
        *_TREND,
        _planar_falls,
        VJM,
        sentence="Longer legs: smaller planar deflections (six curves)",
        curves={
            f"{point}, force along {axis}": _deflection_trend(f"planar_{axis}", point, -1.0)
            for point in FIGURE_POINTS
            for axis in "xy"
        },
        figure="deflection.family",
    ),
    Statement(
        "family.simplified-rises",
        "§3.3, Fig. 12",
        "Simplified model: longer legs, higher first frequency, at the centre",
        *_TREND,
        _simplified_rises,
        SIMPLIFIED,
        sentence="Simplified model: longer legs, higher frequency (three points)",
        curves={point: _simplified_trend(point) for point in FIGURE_POINTS},
        figure="frequency.family-simplified",
    ),
    *(
        Statement(
            f"family.z-rises[{point}]",
            "§2.3, Fig. 6",
            f"Longer legs: larger deflection along z ({point})",
            *_TREND,
            _deflection_trend("along_z", point, 1.0),
            VJM,
            sentence="Longer legs: larger deflections along z (three points)",
            curves={point: _deflection_trend("along_z", point, 1.0)},
            figure="deflection.family",
        )
        for point in FIGURE_POINTS
    ),
    *(
        Statement(
            f"family.refined-falls[{point}]",
            "§3.3, Fig. 13",
            f"Rigid segments: longer legs, lower first frequency ({point})",
            *_TREND,
            _frequency_trend(0, point),
            SEGMENTS,
            order=SEGMENT_ORDER,
            sentence="Rigid segments: longer legs, lower frequencies (six curves)",
            curves={
                f"{point}, {name}": _frequency_trend(mode, point)
                for mode, name in enumerate(("first", "second"))
            },
            differs=FORMULAS,
            figure="frequency.family",
        )
        for point in FIGURE_POINTS
    ),
    *(
        Statement(
            f"family.lowest-two[{point}]",
            "§3.3, Fig. 13",
            f"Longer legs keep one mode along z and one in the plane below all others ({point})",
            "members whose first mode is not along z or whose second is not planar",
            "1",
            Absolute(0.5),
            "a count is a whole number; a mode has a direction if 95 % of its motion goes there",
            _lowest_two(point),
            SEGMENTS,
            order=LITERAL_ORDER,
            effort=2.0,
            sentence="Longer legs: a mode along z and one in the plane stay the lowest two",
            curves={point: _lowest_two(point)},
            differs=FORMULAS,
            judged="as printed",
            figure="frequency.family",
        )
        for point in FIGURE_POINTS
    ),
    Statement(
        "family.other-directions-null",
        "§2.3, Fig. 6",
        "Longer legs: planar forces deflect nothing along z, a force along z nothing in the plane",
        "largest displacement across the force's plane or axis, of that along it",
        "%",
        Absolute(1.0),
        "a curve drawn as far above the axis as a line is wide, a hundredth of the figure, is null",
        _across((0, 1), (2,)),
        VJM,
        sentence="Deformations along the other directions are null",
        curves={
            "along z under planar forces": _across((0, 1), (2,)),
            "in the plane under a force along z": _across((2,), (0, 1)),
        },
        figure="deflection.family",
    ),
    Statement(
        "family.shorter-is-best",
        "§2.3, §3.3 and conclusions",
        "The refined models choose shorter legs than the simplified one, at the centre",
        "best α by the refined model, a step below that by the simplified one",
        "1",
        Absolute(0.05),
        "half a step of the family: shorter by one member at least",
        _stiffest,
        Sides(VJM.value, SIMPLIFIED.value),
        Relation.AT_MOST,
        curves={"by deflection": _stiffest, "by first frequency": _fastest},
        differs=FORMULAS,
    ),
)
