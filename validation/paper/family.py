"""Cases on the paper's statements about robots with longer legs and the same stroke.

Input: the paper's robot with legs α times as long (α from 1 to 2). Output: a verdict on each
statement: trend of a deflection or frequency with α, and best α by each model. Rule for trends:
Spearman's rank correlation with α is +1 or −1.
"""

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
    RobotOnStroke,
    compliances,
    deflections,
    deflections_and_frequencies,
    family,
    frequencies,
    mode_shares,
    over_stroke,
)
from validation.paper.statement import AS_PRINTED, FORMULAS, PAPER, Statements
from validation.variations.decision import equally_good, spearman

# Axes of loads, or directions of displacements: 0, 1, 2 for x, y, z.
_Axes: TypeAlias = tuple[int, ...]
_PLANE: _Axes = (0, 1)
_ALONG_Z: _Axes = (2,)
_EQUIVALENT = ModelOptions(legs="equivalent")
# Relative difference below which two values of a curve are equal, so that round-off does not make a
# curve rise or fall.
_EQUAL = 1e-9
_CONCLUSIONS = "§2.3, §3.3 and conclusions"
# Relative leg lengths for which solid legs are solved.
_SOLID_ALPHAS = ALPHAS[::2]
# Divisions of solid legs by preset, and those of the coarse mesh that gives the uncertainty.
_DIVISIONS: dict[Preset, int] = {"standard": 2, "fine": 3}
_COARSE = 1
# Number of evenly spaced postures over the stroke of each robot.
_POSTURES = 21
# Share of kinetic energy along a direction from which on a mode is attributed to it.
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
    """Spearman's rank correlation of a curve with α, as a measurement.

    +1 if the curve rises throughout, −1 if it falls throughout, 0 if it is constant. `reference`:
    correlation that the paper's statement claims.
    """
    steps = np.round(curve / (_EQUAL * np.max(np.abs(curve))))
    value = 0.0 if np.ptp(steps) <= 1.0 else spearman(np.array(ALPHAS), steps)
    notes = (note,) if note else ()
    return Measurement(value, reference, exact=True, notes=notes, table=table or {})


def _members(context: Context, point: str) -> tuple[RobotOnStroke, ...]:
    return context.get(family, context.robot_file, FIGURE_POINTS[point])


def _family_deflections(context: Context, point: str, model: ModelName = "vjm") -> Deflections:
    return context.get(deflections, model, _members(context, point), _EQUIVALENT)


def _simplified_frequencies(context: Context, point: str) -> Array:
    return context.get(frequencies, "simplified", _members(context, point), 1)[:, 0]


def _segment_modes(context: Context, point: str, variant: ModelOptions) -> list[ModeShares]:
    return context.get(mode_shares, "segments", _members(context, point), 2, variant)


def _segment_frequencies(
    context: Context, point: str, variant: ModelOptions, mode: int = 0
) -> Array:
    modes_by_member = _segment_modes(context, point, variant)
    return np.array([modes.frequencies[mode] for modes in modes_by_member])


@trends.statement(
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
    curves = {name: _family_deflections(context, name).planar_x for name in FIGURE_POINTS}
    at_left, at_right = curves["left"], curves["right"]
    return _trend(
        getattr(_family_deflections(context, point), f"planar_{axis}"),
        -1.0,
        "At the ends of the stroke one leg carries the force along its axis. The deflection there "
        f"is small and grows with the length of the leg: {at_left[0]:.2f} to {at_left[-1]:.2f} µm "
        f"at the left end, {at_right[0]:.2f} to {at_right[-1]:.2f} µm at the right end.",
        {"α": ALPHAS} | {f"{name} (µm)": tuple(curve.tolist()) for name, curve in curves.items()},
    )


@trends.statement(
    "family.simplified-rises",
    "§3.3, Fig. 12",
    "Simplified model: longer legs, higher first frequency, at the centre",
    sentence="Simplified model: longer legs, higher frequency (three points)",
    curves={point: {"point": point} for point in FIGURE_POINTS},
    figure="frequency.family",
)
def _simplified_rises(context: Context, point: str = "centre") -> Measurement:
    return _trend(
        _simplified_frequencies(context, point),
        1.0,
        "At both ends of the stroke the simplified first frequency does not depend on α: "
        f"{_simplified_frequencies(context, 'left')[0]:.1f} Hz for every α.",
    )


@trends.statement(
    "family.z-rises[{point}]",
    "§2.3, Fig. 6",
    "Longer legs: larger deflection along z ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Longer legs: larger deflections along z (three points)",
    curves={"{point}": {}},
    figure="deflection.family",
)
def _along_z_rises(context: Context, point: str) -> Measurement:
    return _trend(_family_deflections(context, point).along_z, 1.0)


@trends.statement(
    "family.refined-falls[{point}]",
    "§3.3, Fig. 13",
    "Rigid segments: longer legs, lower first frequency ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Rigid segments: longer legs, lower frequencies (six curves)",
    curves={"{point}, first": {"mode": 0}, "{point}, second": {"mode": 1}},
    order=SEGMENT_ORDER,
    corrections=FORMULAS,
    figure="frequency.family",
)
def _refined_falls(
    context: Context, variant: ModelOptions, point: str, mode: int = 0
) -> Measurement:
    return _trend(_segment_frequencies(context, point, variant, mode), -1.0)


@statements.statement(
    "family.lowest-two[{point}]",
    "§3.3, Fig. 13",
    "Longer legs keep one mode along z and one in the plane below all others ({point})",
    over={"point": FIGURE_POINTS},
    sentence="Longer legs: a mode along z and one in the plane stay the lowest two",
    curves={"{point}": {}},
    quantity="members whose first mode is not along z or whose second is not planar",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number; a mode has a direction if 95 % of its kinetic "
    "energy is along it",
    order=LITERAL_ORDER,
    effort=2.0,
    corrections=FORMULAS,
    reported=AS_PRINTED,
    figure="frequency.family",
)
def _lowest_two(context: Context, variant: ModelOptions, point: str) -> Measurement:
    along_z = np.array([modes.kinetic["z"] for modes in _segment_modes(context, point, variant)])
    confirmed = (along_z[:, 0] >= _DIRECTED) & (along_z[:, 1] <= 1.0 - _DIRECTED)
    return Measurement(float(np.sum(~confirmed)), reference=0.0, exact=True)


@statements.statement(
    "family.other-directions-null",
    "§2.3, Fig. 6",
    "Longer legs: planar forces cause no deflection along z, a force along z none in the plane",
    sentence="Deformations along the other directions are null",
    curves={
        "along z under planar forces": {},
        "in the plane under a force along z": {"loads": _ALONG_Z, "directions": _PLANE},
    },
    quantity="largest displacement perpendicular to the loads, in % of the largest along them",
    unit="%",
    tolerance=Absolute(1.0),
    tolerance_reason="a hundredth of the figure's height is the width of a drawn line: a curve no "
    "higher above the axis reads as zero",
    figure="deflection.family",
)
def _perpendicular_displacement(
    context: Context, loads: _Axes = _PLANE, directions: _Axes = _ALONG_Z
) -> Measurement:
    """Largest displacement along `directions`, in per cent of the displacement along the loads.

    `loads` and `directions` are axes. Both displacements are those under unit `loads`.
    """
    robots = [robot for point in FIGURE_POINTS for robot in _members(context, point)]
    compliance = context.get(compliances, "vjm", robots, _EQUIVALENT)[:, :, loads]
    perpendicular, along = (
        np.max(np.linalg.norm(compliance[:, rows], axis=1), axis=0) for rows in (directions, loads)
    )
    note = (
        "Only the foot's compliance couples motion in the plane with motion along z; legs of "
        "constant section have no such coupling."
    )
    return Measurement(
        100.0 * float(np.max(perpendicular / along)), reference=0.0, exact=True, notes=(note,)
    )


@statements.statement(
    "family.shorter-is-best",
    _CONCLUSIONS,
    "The refined models choose shorter legs than the simplified one, at the centre",
    curves={"by deflection": {}, "by first frequency": {"objective": "frequency"}},
    quantity="best α by the refined model, compared with one step below that by the simplified one",
    tolerance=Absolute(0.05),
    tolerance_reason="half a step of α: the refined optimum is shorter by at least one member",
    relation=Relation.AT_MOST,
    corrections=FORMULAS,
)
def _shorter_is_best(
    context: Context,
    variant: ModelOptions,
    objective: Literal["deflection", "frequency"] = "deflection",
) -> Measurement:
    """Best leg length α by the refined model (VJM for deflections, segments for frequencies).

    The reference is the best α by the simplified model, less one step of α. The best robot has the
    highest first frequency if `objective` is "frequency". Otherwise it is the robot whose largest
    deflection over the directions of load is smallest.
    """
    if objective == "frequency":
        best = np.argmax(_segment_frequencies(context, "centre", variant))
        best_simplified = np.argmax(_simplified_frequencies(context, "centre"))
    else:
        refined, simplified = (
            _family_deflections(context, "centre", model) for model in ("vjm", "simplified")
        )
        best = np.argmin(np.max([refined.planar_x, refined.planar_y, refined.along_z], axis=0))
        best_simplified = np.argmin(np.maximum(simplified.planar_x, simplified.planar_y))
    alpha, alpha_simplified = ALPHAS[best], ALPHAS[best_simplified]
    note = f"α = {alpha:g} by the refined model, {alpha_simplified:g} by the simplified one."
    reference = alpha_simplified - (ALPHAS[1] - ALPHAS[0])
    return Measurement(alpha, reference, exact=True, notes=(note,))


@statements.statement(
    "decision.longest",
    _CONCLUSIONS,
    "By the simplified model the longest legs are among the best",
    quantity="largest α among the members with the smallest deflection",
    tolerance=Absolute(0.1),
    tolerance_reason="a tenth of the paper's range of α",
)
def _longest(context: Context) -> Measurement:
    strokes = (over_stroke(robot.mechanism, _POSTURES) for robot in _members(context, "centre"))
    worst = np.array(
        [context.get(deflections, "simplified", robots).largest_planar for robots in strokes]
    )
    best = [ALPHAS[number] for number in equally_good(worst, "deflection")]
    note = f"All members from α = {best[0]:.4g} on have the smallest deflection."
    return Measurement(best[-1], reference=ALPHAS[-1], exact=True, notes=(note,))


@statements.statement(
    "decision.contradiction[{objective}]",
    _CONCLUSIONS,
    "Solid legs rank the family by {objective} in the order opposite to the simplified model",
    over={"objective": ("deflection", "frequency")},
    quantity="Spearman's ρ of simplified and solid over the family, centre of stroke",
    tolerance=Absolute(0.1),
    tolerance_reason="the paper's 'in contradiction': opposite order, except for one exchange of "
    "neighbours among five designs or more, 12/n(n² − 1)",
    group="paper.decision",
    effort=3.0,
    presets=("standard", "fine"),
    model="solid",
)
def _contradiction(context: Context, objective: str) -> Measurement:
    def curve(model: ModelName, divisions: int = _COARSE) -> Array:
        options = ModelOptions(divisions=divisions)
        members = context.get(family, context.robot_file, FIGURE_POINTS["centre"], _SOLID_ALPHAS)
        # Each solid leg is factorised once for both objectives.
        deflection, lowest = context.get(deflections_and_frequencies, model, members, options)
        if objective == "frequency":
            return lowest
        return deflection.planar_x if model == "simplified" else deflection.along_z

    simplified, solid = curve("simplified"), curve("solid", _DIVISIONS[context.preset])
    correlation = spearman(simplified, solid)
    label = "deflection (µm)" if objective == "deflection" else "first frequency (Hz)"
    return Measurement(
        correlation,
        reference=-1.0,
        value_uncertainty=abs(correlation - spearman(simplified, curve("solid"))),
        table={
            "α": _SOLID_ALPHAS,
            f"simplified: {label}": tuple(simplified.tolist()),
            f"solid: {label}": tuple(solid.tolist()),
        },
    )
