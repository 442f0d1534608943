"""The family of robots with longer legs, as solids, at the three points of Figs 6 and 13."""

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Measurement, Relation
from validation.case_group import CaseGroup, numbered
from validation.cases.robot.stroke import CURVES
from validation.context import Context, Preset
from validation.exhibits import LENGTHS
from validation.sweeps.decision import OBJECTIVES, Objective, spearman
from validation.sweeps.plans import COARSE, RIGID
from validation.sweeps.studies import GROUP, PAPER, PLANS, POINTS, family_of

_REFINED_PRESETS: tuple[Preset, ...] = ("standard", "fine")


# That rigid faces change next to nothing but torsion is true of the paper's legs, rectangles of
# ν = 0. For any other robot `robot.solid.statics-…` judges every cause by its own size.
paper_cases = CaseGroup(
    presets=_REFINED_PRESETS, section=LENGTHS, group=GROUP, figure="decision.family"
)
_differences = paper_cases.family(
    unit="%",
    reference_kind="independent-solver",
    relation=Relation.AT_MOST,
    model="solid",
    effort=0.3,
)
_BENDING = "bending and tension with ν = 0 are exact, what is left is the mesh"
_TORSION = "rigid end faces restrain warping: stiffer in torsion and with it along z"
# Limit and tolerance (%) of each curve, why, and presets: two elements across the section leave
# 0.2 % of torsion open, more than the tolerance.
_LIMITS = (
    (0.01, Absolute(0.005), _BENDING, _REFINED_PRESETS),
    (0.01, Absolute(0.005), _BENDING, _REFINED_PRESETS),
    (2.1, Absolute(0.05), _TORSION, ("fine",)),
)


@paper_cases.case(
    "paper.decision.contradiction[{objective}]",
    "Solid legs order the family by {objective} against the simplified model",
    over={"objective": OBJECTIVES},
    quantity="Spearman's ρ of simplified and solid over the family, centre of stroke",
    unit="1",
    reference_kind="paper-statement",
    citation=PAPER,
    tolerance=Absolute(0.1),
    tolerance_reason="the paper's 'in contradiction': opposite order, but for an exchange of "
    "neighbours among five designs or more, 12/n(n² − 1)",
    effort=0.1,
)
def _contradiction(context: Context, objective: Objective) -> Measurement:
    alphas, curves = family_of(context)
    simple = curves["simplified", "centre"]
    solid, coarse = (curves[label, "centre"] for label in (RIGID, COARSE))
    if objective == "deflection":
        pair = simple.deflections.planar_x, solid.deflections.along_z
        on_coarse = coarse.deflections.along_z
        what = "deflection (µm)"
    else:
        pair = simple.frequencies[:, 0], solid.frequencies[:, 0]
        on_coarse = coarse.frequencies[:, 0]
        what = "first frequency (Hz)"
    found = spearman(*pair)
    return Measurement(
        found,
        reference=-1.0,
        value_uncertainty=abs(found - spearman(pair[0], on_coarse)),
        table={
            "α": alphas,
            f"simplified: {what}": tuple(pair[0].tolist()),
            f"solid: {what}": tuple(pair[1].tolist()),
        },
    )


@_differences.case(
    "family.statics.solid-vjm.{name}",
    "Longer legs as solids give the virtual joints' {meaning}",
    over={
        "name, attribute, meaning, limit, tolerance, why, presets": tuple(
            (*curve, *limits) for curve, limits in zip(CURVES, _LIMITS, strict=True)
        )
    },
    quantity="largest difference in {meaning} over α and the points of the stroke",
    citation="virtual joint method, eqs (3) to (9), same equivalent legs",
    tolerance_reason="rounding of the bound; {why}",
)
def _family_static(context: Context, attribute: str, limit: float) -> Measurement:
    _, curves = family_of(context)

    def values(label: str) -> Array:
        return np.array([getattr(curves[label, at].deflections, attribute) for at in POINTS])

    return _worst(context, values(RIGID), values(COARSE), values("VJM"), limit)


@_differences.case(
    "family.frequency.solid-segments[{mode}]",
    "Longer legs as solids give frequency {mode} of the robot in segments",
    over={"index, mode": numbered(2)},
    quantity="largest difference in frequency {mode} over α and the points of the stroke",
    citation="Timoshenko segments, paper §3.2",
    tolerance=Absolute(0.5),
    tolerance_reason="rounding of the paper's 1 % for 20 segments (§3.2)",
)
def _family_frequency(context: Context, index: int) -> Measurement:
    _, curves = family_of(context)

    def values(label: str) -> Array:
        return np.array([curves[label, at].frequencies[:, index] for at in POINTS])

    return _worst(context, values(RIGID), values(COARSE), values("segments"), limit=1.0)


def _worst(
    context: Context, found: Array, coarse: Array, reference: Array, limit: float
) -> Measurement:
    """The largest relative difference (%) of values by point of the stroke and α."""
    alphas, _ = family_of(context)
    plan = PLANS[context.preset]
    at = np.unravel_index(int(np.argmax(np.abs(found / reference - 1.0))), found.shape)
    point, alpha = list(POINTS)[int(at[0])], alphas[int(at[1])]
    return Measurement(
        100.0 * abs(float(found[at]) / float(reference[at]) - 1.0),
        reference=limit,
        value_uncertainty=100.0
        * plan.refinement
        * abs(float(found[at]) - float(coarse[at]))
        / float(reference[at]),
        notes=(
            f"Largest difference at α = {alpha:g}, {point} of the stroke: {found[at]:.5g} against "
            f"{reference[at]:.5g}.",
        ),
    )
