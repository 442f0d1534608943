"""The family of robots with longer legs, as solids, at the three points of Figs 6 and 13."""

from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.case import Absolute, Case, Measurement, Relation
from validation.context import Context, Preset
from validation.exhibits import LENGTHS
from validation.sweeps.decision import OBJECTIVES, Objective, spearman
from validation.sweeps.plans import COARSE, RIGID
from validation.sweeps.studies import GROUP, PAPER, PLANS, POINTS, family_of

CURVES = {
    "planar-x": ("planar_x", "planar deflection under 1000 N along x"),
    "planar-y": ("planar_y", "planar deflection under 1000 N along y"),
    "along-z": ("along_z", "deflection along z under 1000 N along z"),
}
_REFINED_PRESETS: tuple[Preset, ...] = ("standard", "fine")


def paper_cases() -> tuple[Case, ...]:
    """What the paper's family shows with solid legs; for the paper's robot alone.

    That rigid faces change next to nothing but torsion is true of its legs, rectangles of ν = 0.
    For any other robot `robot.solid.statics-…` judges every cause by its own size.
    """
    return (
        *_family_statics(),
        *_family_frequencies(),
        *(
            Case(
                id=f"paper.decision.contradiction[{objective}]",
                title=f"Solid legs order the family by {objective} against the simplified model",
                quantity="Spearman's ρ of simplified and solid over the family, centre of stroke",
                unit="1",
                reference_kind="paper-statement",
                citation=PAPER,
                tolerance=Absolute(0.1),
                tolerance_reason="the paper's 'in contradiction': opposite order, but for an "
                "exchange of neighbours among five designs or more, 12/n(n² − 1)",
                compute=partial(_contradiction, objective=objective),
                presets=_REFINED_PRESETS,
                section=LENGTHS,
                group=GROUP,
                figure="decision.family",
                effort=0.1,
            )
            for objective in OBJECTIVES
        ),
    )


def _family_statics() -> list[Case]:
    return [
        Case(
            id=f"family.statics.solid-vjm.{curve}",
            title=f"Longer legs as solids give the virtual joints' {meaning}",
            quantity=f"largest difference in {meaning} over α and the points of the stroke",
            unit="%",
            reference_kind="independent-solver",
            citation="virtual joint method, eqs (3) to (9), same equivalent legs",
            tolerance=Absolute(0.05 if curve == "along-z" else 0.005),
            relation=Relation.AT_MOST,
            tolerance_reason="rounding of the bound; "
            + (
                "rigid end faces restrain warping: stiffer in torsion and with it along z"
                if curve == "along-z"
                else "bending and tension with ν = 0 are exact, what is left is the mesh"
            ),
            compute=partial(
                _family_static, attribute=attribute, limit=2.1 if curve == "along-z" else 0.01
            ),
            # Two elements across the section leave 0.2 % of torsion open, more than the tolerance.
            presets=("fine",) if curve == "along-z" else _REFINED_PRESETS,
            model="solid",
            section=LENGTHS,
            group=GROUP,
            figure="decision.family",
            effort=0.3,
        )
        for curve, (attribute, meaning) in CURVES.items()
    ]


def _family_frequencies() -> list[Case]:
    return [
        Case(
            id=f"family.frequency.solid-segments[{index + 1}]",
            title=f"Longer legs as solids give frequency {index + 1} of the robot in segments",
            quantity=f"largest difference in frequency {index + 1} over α and the points of the "
            "stroke",
            unit="%",
            reference_kind="independent-solver",
            citation="Timoshenko segments, paper §3.2",
            tolerance=Absolute(0.5),
            relation=Relation.AT_MOST,
            tolerance_reason="rounding of the paper's 1 % for 20 segments (§3.2)",
            compute=partial(_family_frequency, index=index),
            presets=_REFINED_PRESETS,
            model="solid",
            section=LENGTHS,
            group=GROUP,
            figure="decision.family",
            effort=0.3,
        )
        for index in range(2)
    ]


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


def _family_static(context: Context, attribute: str, limit: float) -> Measurement:
    _, curves = family_of(context)

    def values(label: str) -> Array:
        return np.array([getattr(curves[label, at].deflections, attribute) for at in POINTS])

    return _worst(context, values(RIGID), values(COARSE), values("VJM"), limit)


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
