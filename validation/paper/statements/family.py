"""Statements about robots with longer legs and the same stroke (paper §2.3 and §3.3)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement, Relation
from validation.context import Context
from validation.models.options import LITERAL_ORDER, SEGMENT_ORDER, ModelName, ModelOptions
from validation.paper.robot import (
    ALPHAS,
    FIGURE_POINTS,
    Deflections,
    Modes,
    Places,
    compliances,
    deflections,
    family,
    frequencies,
    modes,
)
from validation.paper.statements.statement import FORMULAS, Compute, Statement
from validation.variations.decision import spearman

EQUIVALENT = ModelOptions(legs="equivalent")
_GROUP = "paper.family"
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


def _modes(context: Context, point: str, reading: ModelOptions) -> list[Modes]:
    return context.get(modes, "segments", _members(context, point), 2, reading)


def _trend_of(curve: Callable[[Context, ModelOptions], Array], reference: float) -> Compute:
    def compute(context: Context, reading: ModelOptions) -> Measurement:
        return Measurement(_trend(curve(context, reading)), reference=reference, exact=True)

    return compute


def _deflection_trend(name: str, point: str, reference: float) -> Compute:
    return _trend_of(lambda context, _: getattr(_deflected(context, point), name), reference)


def _simplified_trend(point: str) -> Compute:
    return _trend_of(lambda context, _: _simplified(context, point), 1.0)


def _frequency_trend(mode: int, point: str) -> Compute:
    def curve(context: Context, reading: ModelOptions) -> Array:
        return np.array([one.frequencies[mode] for one in _modes(context, point, reading)])

    return _trend_of(curve, -1.0)


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
    """Largest displacement along `directions` under unit `loads`, in % of that along the load."""

    def compute(context: Context, _reading: ModelOptions) -> Measurement:
        everywhere = [at for point in FIGURE_POINTS for at in _members(context, point)]
        found = context.get(compliances, "vjm", everywhere, EQUIVALENT)
        largest = max(
            np.max(np.linalg.norm(found[:, directions, load], axis=1))
            / np.max(np.linalg.norm(found[:, _plane_or_z(load), load], axis=1))
            for load in loads
        )
        return Measurement(
            100.0 * float(largest),
            reference=0.0,
            exact=True,
            notes=(
                "The foot's couplings of planes and z alone make any: constant-section legs have "
                "none.",
            ),
        )

    return compute


def _plane_or_z(load: int) -> tuple[int, ...]:
    return (2,) if load == 2 else (0, 1)


def _lowest_two(point: str) -> Compute:
    def compute(context: Context, reading: ModelOptions) -> Measurement:
        along_z = np.array([one.kinetic["z"] for one in _modes(context, point, reading)])
        shown = (along_z[:, 0] >= _DIRECTED) & (along_z[:, 1] <= 1.0 - _DIRECTED)
        return Measurement(float(np.sum(~shown)), reference=0.0, exact=True)

    return compute


def _stiffest(context: Context, _reading: ModelOptions) -> Measurement:
    def best(model: ModelName) -> float:
        found = _deflected(context, "centre", model)
        planar = np.maximum(found.planar_x, found.planar_y)
        worst = planar if model == "simplified" else np.maximum(planar, found.along_z)
        chosen: float = ALPHAS[int(np.argmin(worst))]
        return chosen

    return _shorter(best("vjm"), best("simplified"))


def _fastest(context: Context, reading: ModelOptions) -> Measurement:
    first = np.array([one.frequencies[0] for one in _modes(context, "centre", reading)])
    found = first, _simplified(context, "centre")
    refined, simplified = (ALPHAS[int(np.argmax(curve))] for curve in found)
    return _shorter(refined, simplified)


def _shorter(refined: float, simplified: float) -> Measurement:
    step = ALPHAS[1] - ALPHAS[0]
    return Measurement(
        refined,
        reference=simplified - step,
        exact=True,
        notes=(f"α = {refined:g} by the refined model, {simplified:g} by the simplified one.",),
    )


_REASON = "±1 means throughout; one exchanged pair among eleven members changes it by 0.01"
_TREND = ("rank correlation with α from 1 to 2", "1", Absolute(0.005), _REASON)


def _trends() -> tuple[Statement, ...]:
    planar = {
        f"{point}, force along {axis}": _deflection_trend(f"planar_{axis}", point, -1.0)
        for point in FIGURE_POINTS
        for axis in "xy"
    }
    rises = {point: _simplified_trend(point) for point in FIGURE_POINTS}
    single = (
        Statement(
            "family.planar-falls",
            "§2.3, Fig. 6",
            "Longer legs: smaller planar deflection under a force along x, at the centre",
            *_TREND,
            _planar_falls,
            group=_GROUP,
            sentence="Longer legs: smaller planar deflections (six curves)",
            curves=planar,
            figure="deflection.family",
        ),
        Statement(
            "family.simplified-rises",
            "§3.3, Fig. 12",
            "Simplified model: longer legs, higher first frequency, at the centre",
            *_TREND,
            _simplified_rises,
            group=_GROUP,
            sentence="Simplified model: longer legs, higher frequency (three points)",
            curves=rises,
            figure="frequency.family-simplified",
        ),
    )
    per_point = (
        statement
        for point in FIGURE_POINTS
        for statement in (_z_rises(point), _frequencies_fall(point), _lowest(point))
    )
    return (*single, *per_point)


def _z_rises(point: str) -> Statement:
    compute = _deflection_trend("along_z", point, 1.0)
    return Statement(
        f"family.z-rises[{point}]",
        "§2.3, Fig. 6",
        f"Longer legs: larger deflection along z ({point})",
        *_TREND,
        compute,
        group=_GROUP,
        sentence="Longer legs: larger deflections along z (three points)",
        curves={point: compute},
        figure="deflection.family",
    )


def _frequencies_fall(point: str) -> Statement:
    return Statement(
        f"family.refined-falls[{point}]",
        "§3.3, Fig. 13",
        f"Rigid segments: longer legs, lower first frequency ({point})",
        *_TREND,
        _frequency_trend(0, point),
        order=SEGMENT_ORDER,
        group=_GROUP,
        sentence="Rigid segments: longer legs, lower frequencies (six curves)",
        curves={
            f"{point}, {name}": _frequency_trend(mode, point)
            for mode, name in enumerate(("first", "second"))
        },
        differs=FORMULAS,
        figure="frequency.family",
    )


def _lowest(point: str) -> Statement:
    compute = _lowest_two(point)
    return Statement(
        f"family.lowest-two[{point}]",
        "§3.3, Fig. 13",
        f"Longer legs keep one mode along z and one in the plane below all others ({point})",
        "members whose first mode is not along z or whose second is not planar",
        "1",
        Absolute(0.5),
        "a count is a whole number; a mode has a direction if 95 % of its motion goes there",
        compute,
        order=LITERAL_ORDER,
        group=_GROUP,
        effort=2.0,
        sentence="Longer legs: a mode along z and one in the plane stay the lowest two",
        curves={point: compute},
        differs=FORMULAS,
        judged="as printed",
        figure="frequency.family",
    )


STATEMENTS = (
    *_trends(),
    Statement(
        "family.other-directions-null",
        "§2.3, Fig. 6",
        "Longer legs: planar forces deflect nothing along z, a force along z nothing in the plane",
        "largest displacement across the force's plane or axis, of that along it",
        "%",
        Absolute(1.0),
        "a curve drawn as far above the axis as a line is wide, a hundredth of the figure, is null",
        _across((0, 1), (2,)),
        group=_GROUP,
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
        Relation.AT_MOST,
        group=_GROUP,
        curves={"by deflection": _stiffest, "by first frequency": _fastest},
        differs=FORMULAS,
    ),
)
