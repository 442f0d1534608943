"""Statements about robots with longer legs and the same stroke, and which to choose."""

from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement, Relation
from validation.context import Context, Preset
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
    over_stroke,
)
from validation.paper.statement import AS_PRINTED, FORMULAS, PAPER, Statements
from validation.variations.decision import equally_good, spearman

# Of the loads, or of the directions of displacements.
_Axes: TypeAlias = tuple[int, ...]
_PLANE: _Axes = (0, 1)
_ALONG_Z: _Axes = (2,)
_EQUIVALENT = ModelOptions(legs="equivalent")
# Two values of a curve closer than this (relative) are equal: a curve that rounding alone moves
# neither rises nor falls.
_EQUAL = 1e-9
_CONCLUSIONS = "§2.3, §3.3 and conclusions"
# Members of the family as solids, elements across the smaller side of their sections.
_SOLIDS = ALPHAS[::2]
_DIVISIONS: dict[Preset, int] = {"standard": 2, "fine": 3}
_COARSE = 1
_POSTURES = 21
# A mode is named by its direction if 95 % of its motion goes there.
_DIRECTED = 0.95
statements = Statements(**PAPER)
trends = statements.family(
    quantity="rank correlation with α from 1 to 2",
    tolerance=Absolute(0.005),
    tolerance_reason="±1 means throughout; one exchanged pair among eleven members changes it by "
    "0.01",
)


def _trend(
    curve: Array,
    reference: float,
    note: str = "",
    table: dict[str, tuple[float | str, ...]] | None = None,
) -> Measurement:
    """Spearman's rank correlation with α: +1 rises throughout, −1 falls throughout, 0 constant."""
    steps = np.round(curve / (_EQUAL * np.max(np.abs(curve))))
    value = 0.0 if np.ptp(steps) <= 1.0 else spearman(np.array(ALPHAS), steps)
    notes = (note,) if note else ()
    return Measurement(value, reference, exact=True, notes=notes, table=table or {})


def _members(context: Context, point: str) -> tuple[Places, ...]:
    return context.get(family, context.robot_file, FIGURE_POINTS[point])


def _deflected(context: Context, point: str, model: ModelName = "vjm") -> Deflections:
    return context.get(deflections, model, _members(context, point), _EQUIVALENT)


def _simplified(context: Context, point: str) -> Array:
    return context.get(frequencies, "simplified", _members(context, point), 1)[:, 0]


def _modes(context: Context, point: str, reading: ModelOptions) -> list[ModeShares]:
    return context.get(modes, "segments", _members(context, point), 2, reading)


def _refined(context: Context, point: str, reading: ModelOptions, mode: int = 0) -> Array:
    return np.array([one.frequencies[mode] for one in _modes(context, point, reading)])


@trends.says(
    "family.planar-falls",
    "§2.3, Fig. 6",
    "Longer legs: smaller planar deflection under a force along x, at the centre",
    sentence="Longer legs: smaller planar deflections (six curves)",
    curves={
        f"{point}, force along {axis}": {"point": point, "axis": axis}
        for point in FIGURE_POINTS
        for axis in "xy"
    },
    figure="deflection.family",
)
def _planar_falls(context: Context, point: str = "centre", axis: str = "x") -> Measurement:
    found = {of: _deflected(context, of).planar_x for of in FIGURE_POINTS}
    return _trend(
        getattr(_deflected(context, point), f"planar_{axis}"),
        -1.0,
        "At the ends of the stroke, where one leg carries the force along its axis, the "
        f"deflection is small and grows with the leg: {found['left'][0]:.2f} to "
        f"{found['left'][-1]:.2f} µm on the left, {found['right'][0]:.2f} to "
        f"{found['right'][-1]:.2f} µm on the right.",
        {"α": ALPHAS} | {f"{of} (µm)": tuple(curve.tolist()) for of, curve in found.items()},
    )


@trends.says(
    "family.simplified-rises",
    "§3.3, Fig. 12",
    "Simplified model: longer legs, higher first frequency, at the centre",
    sentence="Simplified model: longer legs, higher frequency (three points)",
    curves={point: {"point": point} for point in FIGURE_POINTS},
    figure="frequency.family",
)
def _simplified_rises(context: Context, point: str = "centre") -> Measurement:
    return _trend(
        _simplified(context, point),
        1.0,
        "At both ends of the stroke the simplified first frequency does not depend on α: "
        f"{_simplified(context, 'left')[0]:.1f} Hz throughout.",
    )


@trends.says(
    "family.z-rises[{point}]",
    "§2.3, Fig. 6",
    "Longer legs: larger deflection along z ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Longer legs: larger deflections along z (three points)",
    curves={"{point}": {}},
    figure="deflection.family",
)
def _along_z_rises(context: Context, point: str) -> Measurement:
    return _trend(_deflected(context, point).along_z, 1.0)


@trends.says(
    "family.refined-falls[{point}]",
    "§3.3, Fig. 13",
    "Rigid segments: longer legs, lower first frequency ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Rigid segments: longer legs, lower frequencies (six curves)",
    curves={"{point}, first": {"mode": 0}, "{point}, second": {"mode": 1}},
    order=SEGMENT_ORDER,
    differs=FORMULAS,
    figure="frequency.family",
)
def _refined_falls(
    context: Context, reading: ModelOptions, point: str, mode: int = 0
) -> Measurement:
    return _trend(_refined(context, point, reading, mode), -1.0)


@statements.says(
    "family.lowest-two[{point}]",
    "§3.3, Fig. 13",
    "Longer legs keep one mode along z and one in the plane below all others ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Longer legs: a mode along z and one in the plane stay the lowest two",
    curves={"{point}": {}},
    quantity="members whose first mode is not along z or whose second is not planar",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number; a mode has a direction if 95 % of its motion goes "
    "there",
    order=LITERAL_ORDER,
    effort=2.0,
    differs=FORMULAS,
    judged=AS_PRINTED,
    figure="frequency.family",
)
def _lowest_two(context: Context, reading: ModelOptions, point: str) -> Measurement:
    along_z = np.array([one.kinetic["z"] for one in _modes(context, point, reading)])
    shown = (along_z[:, 0] >= _DIRECTED) & (along_z[:, 1] <= 1.0 - _DIRECTED)
    return Measurement(float(np.sum(~shown)), reference=0.0, exact=True)


@statements.says(
    "family.other-directions-null",
    "§2.3, Fig. 6",
    "Longer legs: planar forces deflect nothing along z, a force along z nothing in the plane",
    sentence="Deformations along the other directions are null",
    curves={
        "along z under planar forces": {},
        "in the plane under a force along z": {"loads": _ALONG_Z, "directions": _PLANE},
    },
    quantity="largest displacement across the force's plane or axis, of that along it",
    unit="%",
    tolerance=Absolute(1.0),
    tolerance_reason="a curve drawn as far above the axis as a line is wide, a hundredth of the "
    "figure, is null",
    figure="deflection.family",
)
def _across(context: Context, loads: _Axes = _PLANE, directions: _Axes = _ALONG_Z) -> Measurement:
    """Largest displacement along `directions` under unit `loads`, in % of that along the loads."""
    everywhere = [at for point in FIGURE_POINTS for at in _members(context, point)]
    found = context.get(compliances, "vjm", everywhere, _EQUIVALENT)[:, :, loads]
    across, along = (
        np.max(np.linalg.norm(found[:, rows], axis=1), axis=0) for rows in (directions, loads)
    )
    note = "The foot's couplings of planes and z alone make any: constant-section legs have none."
    return Measurement(
        100.0 * float(np.max(across / along)), reference=0.0, exact=True, notes=(note,)
    )


@statements.says(
    "family.shorter-is-best",
    _CONCLUSIONS,
    "The refined models choose shorter legs than the simplified one, at the centre",
    curves={"by deflection": {}, "by first frequency": {"by": "frequency"}},
    quantity="best α by the refined model, a step below that by the simplified one",
    tolerance=Absolute(0.05),
    tolerance_reason="half a step of the family: shorter by one member at least",
    relation=Relation.AT_MOST,
    differs=FORMULAS,
)
def _shorter_is_best(
    context: Context, reading: ModelOptions, by: Literal["deflection", "frequency"] = "deflection"
) -> Measurement:
    """The member that the refined model chooses, against the one before the simplified model's."""
    if by == "frequency":
        refined, simplified = _refined(context, "centre", reading), _simplified(context, "centre")
        best, simply_best = np.argmax(refined), np.argmax(simplified)
    else:
        found, simple = (_deflected(context, "centre", of) for of in ("vjm", "simplified"))
        best = np.argmin(np.max([found.planar_x, found.planar_y, found.along_z], axis=0))
        simply_best = np.argmin(np.maximum(simple.planar_x, simple.planar_y))
    alpha, longer = ALPHAS[best], ALPHAS[simply_best]
    note = f"α = {alpha:g} by the refined model, {longer:g} by the simplified one."
    return Measurement(alpha, longer - (ALPHAS[1] - ALPHAS[0]), exact=True, notes=(note,))


@statements.says(
    "decision.longest",
    _CONCLUSIONS,
    "The simplified model has nothing against the longest legs",
    quantity="largest α among its best by deflection",
    tolerance=Absolute(0.1),
    tolerance_reason="a tenth of the paper's range of α",
)
def _longest(context: Context) -> Measurement:
    strokes = (over_stroke(at.mechanism, _POSTURES) for at in _members(context, "centre"))
    found = [context.get(deflections, "simplified", places) for places in strokes]
    worst = np.array([one.largest_planar for one in found])
    best = [ALPHAS[number] for number in equally_good(worst, "deflection")]
    note = f"Equally good from α = {best[0]:.4g} on."
    return Measurement(best[-1], reference=ALPHAS[-1], exact=True, notes=(note,))


@statements.says(
    "decision.contradiction[{objective}]",
    _CONCLUSIONS,
    "Solid legs order the family by {objective} against the simplified model",
    over={"objective": ("deflection", "frequency")},
    quantity="Spearman's ρ of simplified and solid over the family, centre of stroke",
    tolerance=Absolute(0.1),
    tolerance_reason="the paper's 'in contradiction': opposite order, but for an exchange of "
    "neighbours among five designs or more, 12/n(n² − 1)",
    group="paper.decision",
    effort=3.0,
    presets=("standard", "fine"),
    model="solid",
)
def _contradiction(context: Context, objective: str) -> Measurement:
    def curve(model: ModelName, divisions: int = _COARSE) -> Array:
        options = ModelOptions(divisions=divisions)
        members = context.get(family, context.robot_file, FIGURE_POINTS["centre"], _SOLIDS)
        if objective == "frequency":
            return context.get(frequencies, model, members, 1, options)[:, 0]
        found = context.get(deflections, model, members, options)
        return found.planar_x if model == "simplified" else found.along_z

    simple, solid = curve("simplified"), curve("solid", _DIVISIONS[context.preset])
    found = spearman(simple, solid)
    what = "deflection (µm)" if objective == "deflection" else "first frequency (Hz)"
    return Measurement(
        found,
        reference=-1.0,
        value_uncertainty=abs(found - spearman(simple, curve("solid"))),
        table={
            "α": _SOLIDS,
            f"simplified: {what}": tuple(simple.tolist()),
            f"solid: {what}": tuple(solid.tolist()),
        },
    )
